// `fem_stage calibrate target.json -o folder`: parameters of PM4Sand from what a soil is known to do. h_po so that the
// cyclic strength at N cycles is the target; Q (R given) so that the shear stress at a working strain is the target
// residual strength over a range of vertical effective stresses.
#pragma once

#include <filesystem>

namespace tailrun::fem {

struct CalibrationOptions {
  std::filesystem::path case_file;
  std::filesystem::path output_folder;  // created if need be; gets calibration.json, two CSV curves and a picture
};

// Returns exit_done. Throws InputError for an unusable target file, ComputationError when no parameter in its admissible
// range reaches a target (the message says how near it came).
int run_calibration(const CalibrationOptions& options);

}  // namespace tailrun::fem
