// Between steps 3 and 4 of the hand-over, when the case asks for it: stresses in balance on the grid of the runout.
//
// The finite elements' stresses are in balance on their own mesh, with the help of hourglass forces that no particle
// carries; on the grid of the particle stage they are not. Of all changes of stress that give every node of that grid
// the weight of what it carries, this is the smallest:
//   min sum_p V_p d_p : d_p   with   sum_p V_p (s_p + d_p) grad N_i(x_p) = m_i g   at every node i clear of the ground,
// d_p = sum_i (l_i (x) grad N_i)^sym, where the multipliers l solve a symmetric positive definite system (the closest
// admissible stress: Prager & Synge 1947). Total stress changes by d, pore pressure does not. N: the quadratic
// B-splines that are the particle stage's default, nodes at multiples of the cell size. Nodes within one and a half
// cells of a terrain line keep what they have: there the ground bears its part.
#pragma once

#include "common/particles.hpp"

namespace tailrun::transfer {

struct Balance {
  double before = 0.0,
         after = 0.0;     // 1, out-of-balance forces over weights, root mean squares over the nodes clear of the ground
  double change = 0.0;    // Pa, root mean square of d_p : d_p over the volume
  std::size_t nodes = 0;  // that were put in balance
};

// Changes particles.effective_stress (xx, yy, xy). `cell_size` in m, `gravity` in m/s2 downwards. Throws InputError
// when no node is clear of the ground, ComputationError when the system cannot be solved.
Balance equilibrate(ParticleSet& particles, double cell_size, double gravity);

}  // namespace tailrun::transfer
