// Nodal residual of the semi-discrete u-p system (Zienkiewicz & Shiomi 1984), element part:
//
//   r_u = f_int(u) - Q p + a1 K_e v          internal force, water's share, stiffness proportional damping
//   r_p = Q^T v + (S + S_alpha) p' + H p - f_p
//
// Two passes over the elements with the materials' update between them, then a gather per node in a fixed order, so
// that the sums are the same for any number of threads.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem_stage/material/residual_floor.hpp"
#include "fem_stage/material/softening_scale.hpp"
#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

// What element matrices are made of besides the model: the last commit's.
struct MatrixBasis {
  std::vector<double> bulk, shear, mobility;  // Pa, Pa, 1, (M)
  std::vector<double> displacement;           // m, (N, 2), of the geometry; empty unless it moves
};

class ElementForces {
 public:
  // `damping` is a1 (s). With `large_displacement` the geometry follows the committed displacement and stress lives in
  // a frame that rotates with the element (/shake/spin).
  ElementForces(const Model& model, double damping, bool large_displacement);

  // Trial state: `increment` (m, (N, 2)) since the last commit, velocity (N, 2), pressure and rate (N). Writes
  // `residual` (N, 3) as above. Returns what the materials report.
  UpdateReport evaluate(MaterialPoints& points, std::span<const double> increment, std::span<const double> velocity,
                        std::span<const double> pressure, std::span<const double> pressure_rate,
                        std::span<double> residual);

  // Accepts the last evaluation: hourglass forces, moduli for tangent and damping, geometry when it moves.
  void commit(MaterialPoints& points, State& state, std::span<const double> increment);
  void reset(const MaterialPoints& points, const State& state);  // takes over a state's hourglass forces and moduli
  void restore_hourglass_work(std::vector<double> work) { hourglass_work_ = std::move(work); }  // J, (M), after reset()
  // Liquefied soil's residual strength, one point per element, beside the materials from now on. Before reset().
  void set_residual_floor(ResidualFloor floor) { residual_floor_ = std::move(floor); }
  void set_softening_scale(SofteningScale scale) { softening_scale_ = std::move(scale); }
  SofteningScale* softening_scale() { return softening_scale_ ? &*softening_scale_ : nullptr; }
  ResidualFloor* residual_floor() { return residual_floor_ ? &*residual_floor_ : nullptr; }

  // Element matrix of the Newmark system, 12 x 12, symmetric, pressure freedoms scaled by `scale` (Pa/m):
  //   [ mass_factor M + stiffness_factor K,  -Q ; -Q^T,  -(storage_factor (S + S_alpha) + flow_factor H) ]
  void matrix(std::size_t e, double mass_factor, double stiffness_factor, double storage_factor, double flow_factor,
              double scale, double local[144]) const;

  MatrixBasis matrix_basis() const { return {bulk_, shear_, mobility_, geometry_}; }
  void use_matrix_basis(const MatrixBasis& basis);

  const SspQuadUp& elements() const { return large_ ? moved_ : model_.elements; }
  std::span<const double> trial_stress() const {
    return global_stress_;
  }                                                                     // Pa, (M, 4), effective, of the last evaluation
  std::span<const double> strain_increment() const { return strain_; }  // (M, 3), global axes
  std::span<const double> hourglass_work() const { return hourglass_work_; }  // J, (M), done on these modes so far
  double damping_power(std::size_t e,
                       std::span<const double> velocity) const;  // W, of the stiffness proportional damping
  double damping() const { return damping_; }
  double material_seconds() const { return material_seconds_; }

 private:
  void take_moduli(const MaterialPoints& points);
  double hourglass_modulus(std::size_t e) const;
  void move_to(std::span<const double> displacement);
  double turn_since(std::size_t e, std::span<const double> displacement, std::span<const double> increment) const;

  const Model& model_;
  double damping_;
  bool large_;
  SspQuadUp moved_;
  std::optional<ResidualFloor> residual_floor_;
  std::optional<SofteningScale> softening_scale_;
  std::vector<double> bulk_, shear_;  // of the last commit
  std::vector<double> last_shear_;    // of the one before, where hourglass forces follow it
  std::vector<double> hourglass_committed_, hourglass_trial_, hourglass_mode_;  // N, N, m: (M, 2)
  std::vector<double> hourglass_work_;                                          // J, (M)
  std::vector<double> mobility_;  // 1, (M): share of the permeability, below 1 in a soft fluid under suction
  std::vector<double> geometry_;  // m, (N, 2): displacement of moved_
  std::vector<double> rotation_;  // rad, (M), only with large displacement
  std::vector<double> strain_, material_strain_, stress_, global_stress_, element_forces_;
  double material_seconds_ = 0.0;
};

}  // namespace tailrun::fem
