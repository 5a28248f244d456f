// A state of stress that cannot be: signs and units of stresses, pressures and densities, judged against the weight of
// the soil. Whoever reads or makes a state asks here, for elements and particles alike.
#pragma once

#include <string>
#include <vector>

#include "common/particles.hpp"
#include "common/snapshot.hpp"

namespace tailrun {

// Columns over elements or particles; those that are not known are empty.
struct StateColumns {
  std::string file, what;                  // "snapshot.h5", "elements": for messages
  std::vector<double> x, y;                // m
  std::vector<double> vertical_effective;  // Pa, sigma'_v0, compression positive
  std::vector<double> pressure_ratio;      // r_u
  std::vector<double> density;             // kg/m3
  std::vector<double> total_vertical;      // Pa, compression positive
  std::vector<double> weight_above;        // Pa, of soil, and of water standing on it
  std::vector<double> pore_pressure;       // Pa
  std::vector<double> hydrostatic;         // Pa, below the phreatic line; empty without one
  double water_density = 1000.0;           // kg/m3
  bool before_motion = false;              // sigma'_v0, weight and pore pressure are of one time
};

// In the order of the checks, with their reasons:
//   density under 30 kg/m3: g/cm3 or kN/m3 (error); under water's in a tenth of all saturated: would float (warning)
//   sigma'_v0 <= 0: soil carries no tension. Beyond a hundredth of all a warning; of more than half an error, for which
//     the sign is the likely reason
//   total vertical stress against the weight above, summed: an arch or a slope moves it by tens of per cent. Off by
//   more
//     than 2 a warning, by more than 10 an error, with the unit whose factor fits
//   sigma'_v0 against what the weight above leaves beside the pore pressure, summed, where that is a fifth of the
//   weight
//     or more: water alone may carry half of the total, so stresses in kPa beside pressures in Pa pass the check
//     before. Under a tenth an error, under half or over 1.7 (total stresses given as effective ones) a warning
//   pore pressure against that of water at rest below the phreatic line, summed: under a hundredth, kPa (warning)
//   r_u outside [-0.5, 1.2]: dilation and what flows in pass that here and there. Beyond a tenth of all a warning
void check_state(const StateColumns& state);

// Of the elements with `kept` (all when empty). Nothing is checked without gravity. `weights`: whether stresses are
// compared with the weight above; a state that was computed here is in balance, and loads may stand on it.
StateColumns columns_of(const Snapshot& snapshot, const std::string& file, const std::vector<bool>& kept, bool weights);

// Of particles in plane strain, under `gravity` (m/s2, downwards).
StateColumns columns_of(const ParticleSet& particles, const std::string& file, double gravity);

}  // namespace tailrun
