// Softening of an element as a band of reference thickness would have it (Pietruszczak & Mroz 1981): once it has
// sheared beyond a strain, its model is driven by h/h_ref times the deviator of the strain, h the element's height.
// Where strain gathers in a band one element wide, strength is then a function of the slip across the band and not of
// slip over h, on every mesh. Mean strain, hence contraction under pressure and the water's volume, is not scaled.
//
// Stress stays a function of the strain's history through the same model, so that a closed loop of shear without change
// of volume, as liquefied soil does within seconds, takes h_ref/h times the work of the model's own loop: dissipation
// stays dissipation. The elastic shear modulus is scaled with it.
#pragma once

#include <span>
#include <vector>

namespace tailrun::fem {

class SofteningScale {
 public:
  // `scale` h/h_ref (1, > 0), one per point; none is active yet.
  explicit SofteningScale(std::vector<double> scale) : scale_(std::move(scale)), active_(scale_.size(), 0.0) {}

  std::size_t size() const { return scale_.size(); }
  bool is_active(std::size_t point) const { return active_[point] != 0.0; }
  void activate(std::size_t point) { active_[point] = 1.0; }  // for good
  // On deviator and shear modulus: `scale` where active, else 1.
  double factor(std::size_t point) const { return is_active(point) ? scale_[point] : 1.0; }
  // From strain increments (n, 3) as for MaterialPoints::update, those that the models are to see. Valid until the next
  // call.
  std::span<const double> driving_strain(std::span<const double> strain_increment);

  std::span<const double> active() const { return active_; }  // (n): 1 where active, else 0
  void restore(std::span<const double> active) { active_.assign(active.begin(), active.end()); }

 private:
  std::vector<double> scale_, active_, driving_;  // 1, 1, 1 (n, 3)
};

}  // namespace tailrun::fem
