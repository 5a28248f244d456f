// Water that a phreatic line puts above the ground. The line alone gives the soil its pore pressures, and no weight to
// the water that would stand on it: under 5 m of such water soil is in tension. A pond (boundaries/ponded_water) has
// both.
#pragma once

#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

// Warns, with the depth (m) and place, where the phreatic line is above the ground and nothing there says what the
// water does: neither a pond, nor held_pressure, nor a load.
void warn_of_weightless_water(const Model& model);

// The phreatic line meets a pond at its level: where the ground is under the pond's water, line and level are one. Off
// by more than 1 m the soil under the pond would have other water than the pond (p = 0 is held above the line, rho g
// depth on the pond's ground): throws InputError with level, line and place; warns from 0.1 m.
void check_ponds_meet_line(const Model& model);

}  // namespace tailrun::fem
