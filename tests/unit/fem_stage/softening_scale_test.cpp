// Softening by the height of elements: what the model sees, and strength over slip instead of over strain.
#include "fem_stage/material/softening_scale.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "fem_stage/material/material_points.hpp"
#include "material_drive.hpp"

using namespace tailrun::fem;

namespace {

// Shear stress (Pa) of the main case's tailings under a slip (m) across an element `height` high, at constant volume:
// scaled by height/reference once strained to the peak.
double strength_at_slip(double height, double reference, double slip) {
  MaterialPoints points({{"tailings", testing::tailings()}}, {0});
  SofteningScale scale({height / reference});
  std::array<double, 4> stress{-93e3, -186e3, -93e3, 0.0};
  points.set_stress(stress);
  points.start_plastic_stage(true);
  const auto shear = [&](double amount) {
    for (int k = 0; k < 1000; ++k) {
      const std::array<double, 3> e{0.0, 0.0, 1e-3 * amount};
      points.update(scale.driving_strain(e), stress);
      points.commit();
    }
  };
  shear(0.0075);
  scale.activate(0);
  shear(slip / height);
  return stress[3];
}

}  // namespace

TEST_CASE("softening scale: the deviator is scaled where active, the mean never") {
  SofteningScale scale({0.5, 0.5});
  scale.activate(1);
  const std::array<double, 6> e{3e-3, 1e-3, 4e-3, 3e-3, 1e-3, 4e-3};
  const auto seen = scale.driving_strain(e);
  for (std::size_t i = 0; i < 3; ++i) CHECK(seen[i] == e[i]);
  CHECK(seen[3] == doctest::Approx(2.5e-3));
  CHECK(seen[4] == doctest::Approx(1.5e-3));
  CHECK(seen[5] == doctest::Approx(2e-3));
  CHECK(scale.factor(0) == 1.0);
  CHECK(scale.factor(1) == 0.5);
  SofteningScale other({0.5, 0.5});
  other.restore(scale.active());
  CHECK_FALSE(other.is_active(0));
  CHECK(other.is_active(1));
}

TEST_CASE("softening scale: past the peak, elements of any height have the same strength at the same slip") {
  for (const double slip : {0.05, 0.15, 0.45}) {
    const double reference = strength_at_slip(1.5, 1.5, slip);
    CHECK(strength_at_slip(0.75, 1.5, slip) == doctest::Approx(reference).epsilon(0.01));
    CHECK(strength_at_slip(3.0, 1.5, slip) == doctest::Approx(reference).epsilon(0.01));
  }
  // What it is without.
  CHECK(strength_at_slip(0.75, 0.75, 0.15) < 0.6 * strength_at_slip(3.0, 3.0, 0.15));
}
