// What an element test is to do, and what came of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fem_stage/element_test/laboratory_point.hpp"

namespace tailrun::fem {

enum class ElementTestType { cyclic_simple_shear, monotonic_simple_shear, plane_strain_compression, strain_path };
enum class Drainage { constant_volume, undrained, drained };

struct StrainPathLeg {
  LaboratoryStrain increment;  // normal strains compression positive
  long repeats = 1;
};

struct ElementTestCase {
  MaterialDefinition material;
  double vertical_effective_stress = 1e5;  // Pa
  double K0 = 0.5;
  double static_shear_ratio = 0.0;  // initial shear stress / initial vertical effective stress

  ElementTestType type = ElementTestType::cyclic_simple_shear;
  Drainage drainage = Drainage::constant_volume;
  double csr = 0.1;                   // cyclic shear stress amplitude / initial vertical effective stress
  double strain_increment = 1e-5;     // of the controlled strain (shear, or axial in compression)
  double fluid_bulk_modulus = 2.2e9;  // Pa; undrained
  double porosity = 0.4;              // undrained
  std::vector<StrainPathLeg> path;    // strain_path
  std::vector<double> report_strains{0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5};

  double stop_cycles = 100.0;
  double stop_strain = 0.1;  // |shear strain| (axial strain in compression)
  long output_every = 0;     // rows every so many steps; 0: wherever the curve has moved visibly
};

struct ElementTestRow {
  long step = 0;
  double cycle = 0.0;
  double shear_strain = 0.0;
  double shear_stress = 0.0;
  double vertical_effective_stress = 0.0;
  double mean_effective_stress = 0.0;
  double excess_pore_pressure_ratio = 0.0;
  double volumetric_strain = 0.0;
};

struct ElementTestResult {
  std::vector<ElementTestRow> rows;
  std::optional<double> cycles_to_ru_95, cycles_to_ru_98, cycles_to_strain_1, cycles_to_strain_3;
  double largest_ru = 0.0;
  double cycles = 0.0;  // at the end
  double peak_shear_stress = 0.0;
  double peak_shear_strain = 0.0;
  std::vector<std::pair<double, std::optional<double>>> shear_stress_at_strain;  // at first passing
  long steps = 0;
  long updates = 0;
  long substeps = 0;
  double seconds = 0.0;
};

// Throws InputError. See element_test.hpp for the keys.
ElementTestCase read_element_test(const std::filesystem::path& case_file);

// Runs it in memory. Throws ComputationError when the material cannot follow.
ElementTestResult simulate(const ElementTestCase& test);

}  // namespace tailrun::fem
