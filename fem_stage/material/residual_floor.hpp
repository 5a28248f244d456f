// The residual strength of liquefied soil as a floor under what the material's own model carries. Beside the model
// works an elastic-perfectly-plastic deviator b in the plane, of von Mises' strength in plane strain with no volume
// change:
//
//   db = 2 G_b de until |b| = max(0, s_R - |s|),  G_b = s_R/gamma_m,   |.| = radius of Mohr's circle (Pa)
//
// s: deviator of the model's stress, e: of the strain, s_R: residual strength (Pa), gamma_m: engineering shear strain
// over which the floor is mobilised (1). Sheared on, model and floor point the same way and carry max(|s|, s_R)
// together; in no state do they carry more than that, because |s + b| <= |s| + |b|. Mean stress is the model's alone.
//
// b starts at zero when a point is activated, so that no stress jumps. What is left over when the model takes up
// strength goes radially: the plastic strain always points along b, and the floor never makes energy. The model itself
// is not touched: it sees the same strains and forgets nothing.
//
// Why: deformation analyses of dams give liquefied soil the residual strength of case histories (Boulanger, Montgomery
// & Ziotopoulou 2015), as PM4Sand's own plateau at large strain is no measured quantity. A stiffness of s_R over a
// strain, far below PM4Sand's own, is our choice: it leaves the small cycles of liquefied soil to the model.
#pragma once

#include <span>
#include <vector>

namespace tailrun::fem {

class ResidualFloor {
 public:
  // `strength` s_R (Pa) and `mobilisation_strain` gamma_m (1, > 0), one per point; a point of strength 0 has no floor.
  // No point is active yet.
  ResidualFloor(std::vector<double> strength, std::span<const double> mobilisation_strain);

  std::size_t size() const { return strength_.size(); }
  double strength(std::size_t point) const { return strength_[point]; }  // Pa
  bool is_active(std::size_t point) const { return active_[point] != 0.0; }
  // From now on, for good. Of no effect on a point without a floor.
  void activate(std::size_t point);
  // Pa: elastic shear modulus that the floor adds, 0 where it is not active.
  double shear(std::size_t point) const { return active_[point] * modulus_[point]; }

  // `strain_increment` (n, 3) since the last commit as for MaterialPoints::update; `stress` (n, 4), Pa, tension
  // positive, of the model in the same frame: the floor's trial stress is added. Repeatable.
  void update(std::span<const double> strain_increment, std::span<double> stress);
  // Makes the last update's stress the committed one.
  void commit() { committed_ = trial_; }

  // Committed b, (n, 2): (xx - yy)/2 and xy, Pa, in the frame of the stress; and 1 where active, else 0.
  std::span<const double> stress() const { return committed_; }
  std::span<const double> active() const { return active_; }
  // Goes on from these.
  void restore(std::span<const double> stress, std::span<const double> active);

 private:
  std::vector<double> strength_, modulus_, active_;  // Pa, Pa, 1
  std::vector<double> committed_, trial_;            // Pa, (n, 2)
};

}  // namespace tailrun::fem
