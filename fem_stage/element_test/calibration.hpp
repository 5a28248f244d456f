// `fem_stage calibrate target.json -o folder`: parameters of PM4Sand from what a soil is known to do. h_po so that the
// cyclic strength at N cycles is the target; Q (R given) so that the shear stress at a working strain is the target
// residual strength over a range of vertical effective stresses.
//
//   {"material": {"model": "pm4sand", "relative_density": 0.35, "G0": 476, "hpo": 1.0, "R": 3.75, "density": 1870},
//    "cyclic_strength": {"csr": 0.09, "cycles": 15, "shear_strain": 0.03, "vertical_effective_stress": 1e5, "K0": 0.5},
//    "residual_strength": {"shear_strain": 0.1, "K0": 0.5,
//                          "targets": [{"vertical_effective_stress": 17e3, "shear_stress": 3.2e3},
//                                      {"vertical_effective_stress": 186e3, "shear_stress": 9.1e3}]}}
//
// `hpo` and `Q` of the material are first guesses. Either target may be left out.
#pragma once

#include <filesystem>

namespace tailrun::fem {

struct CalibrationOptions {
  std::filesystem::path case_file;
  std::filesystem::path output_folder;  // created if need be; gets calibration.json, two CSV curves and a picture
};

// Returns exit_done. calibration.json has the values found, what is reached with them and a "materials" block for
// fem.json. Throws InputError for an unusable target file, ComputationError when the targets cannot be met, or not
// together; all files are written before that, with the nearest values and what each target asks for by itself.
int run_calibration(const CalibrationOptions& options);

}  // namespace tailrun::fem
