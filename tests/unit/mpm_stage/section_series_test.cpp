#include "mpm_stage/output/section_series.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

constexpr double h = 1.0, spacing = 0.5, depth = 2.0;

// Soil from x = 0 to 20 m, 2 m deep, in front of it a section at 25 m, one through it at 10 m.
Scene layer(double sign) {
  Scene scene;
  scene.cell_size = h;
  Material soil;
  soil.name = "soil";
  soil.law = &law_named("tresca");
  scene.materials = {soil};
  scene.particles.material_names = {"soil"};
  scene.output.front_sign = sign;
  scene.output.sections = {{"inside", sign * 10.0}, {"ahead", sign * 25.0}};
  for (double x = 0.5 * spacing; x < 20.0; x += spacing)
    for (double y = 0.5 * spacing; y < depth; y += spacing) {
      for (const double c : {sign * x, y, 0.0}) scene.particles.position.push_back(c);
      scene.particles.volume.push_back(spacing * spacing);
      scene.particles.mass.push_back(2000.0 * spacing * spacing);
      scene.particles.material_id.push_back(0);
    }
  return scene;
}

// The same soil, moved on by `way` (m) along the flow, at 3 m/s.
Particles<2> moved(const Scene& scene, double way) {
  Particles<2> P;
  P.resize(scene.particles.mass.size(), true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.position[0][p] = scene.particles.position[3 * p] + scene.output.front_sign * way;
    P.position[1][p] = scene.particles.position[3 * p + 1];
    P.velocity[0][p] = scene.output.front_sign * 3.0;
    P.volume[p] = scene.particles.volume[p];
    P.mass[p] = scene.particles.mass[p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  return P;
}

}  // namespace

TEST_CASE("a layer that moves past a section: depth, discharge and what has passed, along either direction") {
  for (const double sign : {1.0, -1.0}) {
    const Scene scene = layer(sign);
    SectionSeries sections(scene);
    sections.sample(0.0, moved(scene, 0.0));
    sections.sample(2.0, moved(scene, 6.0));
    const SectionState& inside = sections.rows().back().of[0];
    CHECK(inside.area == doctest::Approx(depth));
    CHECK(inside.discharge == doctest::Approx(3.0 * depth));
    CHECK(inside.volume == doctest::Approx(6.0 * depth));
    CHECK(inside.mass == doctest::Approx(2000.0 * 6.0 * depth));
    const SectionState& ahead = sections.rows().back().of[1];
    CHECK(ahead.area == doctest::Approx(0.5 * (26.0 - 24.0) * depth).epsilon(0.01));
    CHECK(ahead.volume == doctest::Approx(1.0 * depth));
    CHECK(sections.summary()[1]["time_of_largest_discharge_s"] == 2.0);
  }
}

TEST_CASE("soil that swells where it is passes no section") {
  const Scene scene = layer(1.0);
  SectionSeries sections(scene);
  Particles<2> P = moved(scene, 0.0);
  for (double& volume : P.volume) volume *= 1.1;
  sections.sample(0.0, P);
  CHECK(sections.rows().back().of[0].volume == doctest::Approx(0.0));
}

TEST_CASE("soil that has not flowed yet is no flow, and a section without soil has neither depth nor speed") {
  const Scene scene = layer(1.0);
  SectionSeries sections(scene);
  sections.sample(0.0, moved(scene, 0.5));
  CHECK(sections.rows().back().of[0].area == 0.0);
  CHECK(sections.rows().back().of[0].volume == doctest::Approx(0.5 * depth));
  CHECK(sections.rows().back().of[1].speed() == 0.0);
}
