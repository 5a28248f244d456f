// Side boundaries that know the free field: dashpots between a vertical side of the model and a soil column that shakes
// beside it by itself (Lysmer & Kuhlemeyer 1969; Zienkiewicz, Bicanic & Shen 1989). Per area, with n the outward
// normal,
//
//   t = rho V_p (v_ff - v)_n + rho V_s (v_ff - v)_t + (sigma_ff - sigma_ff,0) n
//
// sigma_ff the column's total stress and sigma_ff,0 its geostatic value (the static part is held by the reactions of
// the released rollers). The column does not feel the model, so its motion at the end of a step is taken from an
// extrapolation over the step: velocity with its acceleration, stress with its last rate.
#pragma once

#include <span>
#include <vector>

#include "fem_stage/model/model.hpp"
#include "fem_stage/solver/newmark.hpp"

namespace tailrun::fem {

class FreeField {
 public:
  // Velocities that the case does not give come from the soil behind the line at the start: its elastic moduli, and in
  // saturated soil K_f / n for the pressure wave. Throws InputError: no such line, a line that is not vertical, a
  // column without nodes at the line's heights.
  FreeField(const Model& model, const MaterialPoints& points, const State& state);

  const std::vector<Dashpot>& dashpots() const { return dashpots_; }  // their own part: -rho V A v
  void observe(const State& state);                                   // after every accepted step
  void add_forces(double time, std::span<double> force) const;        // N, (N, 2): the column's part, at `time` (s)
  // What observe() has kept of the last steps, for a run that goes on. Throws InputError when its length is another's.
  std::vector<double> memory() const;
  void restore(std::span<const double> memory);

 private:
  struct Link {
    std::int64_t node, column_node;
    double normal_impedance, shear_impedance;  // N s/m
  };
  struct Face {
    std::int64_t a, b;
    std::size_t column_element;
    double half_area, outward;        // m2, and +1 or -1: the normal's x
    double xx, xy, xx_rate, xy_rate;  // Pa, Pa/s: change of the column's total stress
  };
  const Model& model_;
  std::vector<Link> links_;
  std::vector<Face> faces_;
  std::vector<Dashpot> dashpots_;
  double time_ = 0.0;
  std::vector<double> velocity_, acceleration_;  // (links, 2), of the column
};

}  // namespace tailrun::fem
