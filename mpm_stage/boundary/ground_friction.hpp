// Coulomb friction of the ground, as an impulse in momentum, after the approach of every node has been stopped.
//
// What a node may lose along the ground is friction times its normal impulse. Nodes just under the ground have little
// mass but gradients as large as any, so their share of the normal impulses exceeds their share of the momentum: taken
// node by node, slow sliding would stop them altogether and waste the rest of their friction, and a block would creep
// down a slope that should hold it. So nodes share what they have (friction_pool.hpp).
// What the soil can carry (soil_limit.hpp) is shared alike, and the less of both counts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm_stage/boundary/contact_gap.hpp"
#include "mpm_stage/boundary/friction_pool.hpp"
#include "mpm_stage/boundary/ground_push.hpp"

namespace tailrun::mpm {

// The push of the ground as friction sees it. A stiff body at rest rings, and its normal impulse with it; friction that
// follows each swing lets go in the troughs and cannot make up for it at the crests, so a block creeps down a slope
// that should hold it (at 96 % of the friction, a tenth of a cell a second). So what counts where material stays in
// place is the normal force over the mass of the node, averaged over the time that a wave takes through
// `smoothing_cells` cells: the same in the mean. Where it slides, other material comes to the node, and the memory is
// the shorter the faster it slides: half as long at `forgetting_speed` (of the fastest wave's), so it never goes back
// more than 0.02 cells.
constexpr double smoothing_cells = 7.0, forgetting_speed = 0.004;

// Share of the way to the present value that the memory goes in a step; `wave` and `slip` (cells) are how far the
// fastest wave and the node's material move in it.
inline double smoothing_share(double wave, double slip) {
  const double speed = slip / (forgetting_speed * wave);
  return std::min(1.0, wave / smoothing_cells * (1.0 + speed * speed));
}

// Speed along the ground, m/s. Lifting off is not sliding: it goes with a small push, which must not count for more.
template <int Dim>
inline double sliding_speed(const NodeContact& contact, const std::array<double, Dim>& v) {
  const auto& n = contact.point[0].normal;
  double squares = -(v[0] * n[0] + v[1] * n[1]) * (v[0] * n[0] + v[1] * n[1]);
  for (int d = 0; d < Dim; ++d) squares += v[d] * v[d];
  return std::sqrt(std::max(0.0, squares));
}

// `smoothed` (m/s2, friction coefficient times normal impulse over mass and time) is the node's memory, 0 without one.
// Sets the friction of the grip; a node that the ground has just let go of still grips with what it remembers.
inline void smooth_grip(const NodeContact& contact, double mass, double dt, double share, double& smoothed,
                        NodeGrip& grip) {
  remembered(grip.friction / (mass * dt), share, smoothed);
  if (grip.mass == 0.0 && (contact.count != 1 || contact.adhere || smoothed <= 0.0)) return;
  if (grip.mass == 0.0) grip.normal = contact.point[0].normal;
  grip.mass = mass;
  grip.friction = smoothed * mass * dt;
}

// Whether the soil at a node is known and carries no more than its strength.
template <int Dim>
bool is_limited(const Gap<Dim>& soil) {
  return soil.volume > 0.0 && soil.strength < smallest_unlimited * soil.volume;
}

// N s, what the soil at a node carries in a step on the part of the ground's surface that is the node's and under soil.
template <int Dim>
double carried_by_soil(const Gap<Dim>& soil, const GroundShare<Dim>& ground, double dt) {
  return is_limited(soil) ? dt * ground.under(soil.cover) * soil.strength / soil.volume : no_soil_limit;
}

// The grip of a node beyond contact's reach whose function the ground's surface still cuts: of phi = 0 soil it takes
// part in what nodes in contact share, for the shear stress at the surface pulls at it, too. Without that, soil can
// slide off inside itself between these rows of nodes, held back by as much less than it carries as its functions reach
// into the ground: a slab with a factor of safety of 1.05 ran away at 11 m/s in 8 s where the ground lay 0.45 cells
// over a row of nodes. (Frictional soil presses on fewer nodes by as much more.) `soil` is what is known of the soil at
// the node, `mass` (kg) the node's, `carried` (N s) what the soil carries there.
template <int Dim>
NodeGrip grip_beside(const NodeContact& contact, const Gap<Dim>& soil, double mass, double carried) {
  NodeGrip grip;
  if (!is_limited(soil)) return grip;
  grip.mass = mass;
  grip.normal = contact.point[0].normal;
  grip.carried = carried;
  return grip;
}

// N s, by which the ground brakes soil that sticks to it (phi = 0 soil whose strength softens or grows with the rate,
// fluids, cohesive frictional soil), at such a node: traction along it on what is the node's of the surface and
// under soil.
// Soil sticks as long as that is less than Coulomb's friction; where it slides, nodes in contact brake it with all of
// its weight. Between half and three quarters of Coulomb's friction the drag fades, since tractions of particles
// scatter.
template <int Dim>
double drag_beside(const NodeContact& contact, const Gap<Dim>& soil, const GroundShare<Dim>& ground, double dt) {
  if (!(soil.held > 0.0)) return 0.0;
  const double coulomb = contact.point[0].friction * soil.pressure;
  const double reserve = contact.adhere ? 1.0 : coulomb > soil.shear ? 1.0 - soil.shear / coulomb : 0.0;
  const double share = std::clamp(4.0 * reserve - 1.0, 0.0, 1.0);
  return share > 0.0 ? dt * ground.under(soil.cover) * share * soil.held / soil.volume : 0.0;
}

// m/s, the part of `v` along the ground.
template <int Dim>
inline std::array<double, Dim> sliding_of(const NodeGrip& grip, const std::array<double, Dim>& v) {
  const double vn = v[0] * grip.normal[0] + v[1] * grip.normal[1];
  std::array<double, Dim> t = v;
  t[0] -= vn * grip.normal[0];
  t[1] -= vn * grip.normal[1];
  return t;
}

// Takes at most `impulse` (N s) off the tangential momentum. Returns the energy lost to sliding, J: the impulse times
// the velocity that the node keeps, for it is that velocity which displaces it.
template <int Dim>
inline double apply_friction(const NodeGrip& grip, double impulse, std::array<double, Dim>& v) {
  const std::array<double, Dim> t = sliding_of<Dim>(grip, v);
  double sliding = 0.0;
  for (int d = 0; d < Dim; ++d) sliding += t[d] * t[d];
  sliding = std::sqrt(sliding);
  const double left = std::max(0.0, sliding - impulse / grip.mass);
  const double taken = sliding > 0.0 ? 1.0 - left / sliding : 0.0;
  for (int d = 0; d < Dim; ++d) v[d] -= taken * t[d];
  return grip.mass * (sliding - left) * left;
}

}  // namespace tailrun::mpm
