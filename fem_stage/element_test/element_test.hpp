// `fem_stage element test.json -o out.csv [--summary out.json]`: one material point driven along a laboratory test.
//
// Case file:
//   {"material": {"model": "pm4sand", ...},
//    "initial": {"vertical_effective_stress": 1e5, "K0": 0.5, "static_shear_ratio": 0.0},
//    "loading": {"type": "cyclic_simple_shear" | "monotonic_simple_shear" | "plane_strain_compression" | "strain_path",
//                "drainage": "constant_volume" | "undrained" | "drained", "csr": 0.1, "shear_strain_increment": 5e-6,
//                ...},
//    "stop": {"cycles": 50, "shear_strain": 0.06}}
//
// CSV columns: step, cycle, shear_strain, shear_stress, vertical_effective_stress, mean_effective_stress,
// excess_pore_pressure_ratio, volumetric_strain. Pa and plain strains; effective stresses and volumetric strain are
// compression positive, shear stress and shear strain positive together.
#pragma once

#include <filesystem>

namespace tailrun::fem {

struct ElementTestOptions {
  std::filesystem::path case_file;
  std::filesystem::path output;   // CSV; empty: none is written
  std::filesystem::path summary;  // JSON; empty: only stdout
};

// Runs the test, writes the CSV and the summary, prints the summary on stdout. Returns exit_done. Throws InputError for
// a case that cannot be used and ComputationError when the material cannot follow the path.
int run_element_test(const ElementTestOptions& options);

}  // namespace tailrun::fem
