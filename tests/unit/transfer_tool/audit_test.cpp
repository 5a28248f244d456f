#include "transfer_tool/audit/audit.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/error.hpp"
#include "example_mesh.hpp"
#include "transfer_tool/audit/particle_set.hpp"

using namespace tailrun::transfer;

namespace {

struct HandOver {
  tailrun::Snapshot mesh = example::rectangle(6, 4);
  std::vector<bool> kept;
  tailrun::ParticleSet particles;

  HandOver(Layout layout, int count, Recovery stress = Recovery::element) {
    example::set_motion(mesh);
    example::Noise noise;
    for (double& value : mesh.effective_stress) value = 1e5 * noise();
    for (double& value : mesh.pore_pressure) value = 1e5 * (1.5 + noise());
    kept.assign(mesh.elements(), true);
    kept[3] = false;
    MapOptions options;
    options.stress = stress;
    const auto points = sample(mesh, kept, example::sampling(layout, count));
    const auto state = map_state(mesh, points, options);
    particles = particle_set(mesh, points, state, assign(mesh, points, state, {Rule{"soil", {}, std::nullopt}}));
  }
  Audit result() const { return audit(mesh, kept, mesh.base_velocity, particles); }
};

double error_of(const Audit& result, const std::string& quantity) {
  for (const auto& row : result.rows)
    if (row.quantity == quantity) return row.error();
  return NAN;
}

}  // namespace

TEST_CASE("mass, volume, centre of mass and momentum are the mesh's own for every layout and count") {
  for (const Layout layout : {Layout::gauss, Layout::uniform})
    for (int count = 1; count <= 5; ++count) {
      const Audit result = HandOver(layout, count).result();
      CAPTURE(count);
      for (const auto& row : result.rows)
        if (row.conserved) CHECK_MESSAGE(row.error() < 1e-12, row.quantity);
      CHECK_NOTHROW(require_conserved(result, 1e-12));
    }
}

TEST_CASE("kinetic energy is exact from two Gauss points on and approaches the mesh's from below for uniform cells") {
  CHECK(error_of(HandOver(Layout::gauss, 2).result(), "kinetic energy") < 1e-12);
  const double one = error_of(HandOver(Layout::uniform, 1).result(), "kinetic energy");
  const double four = error_of(HandOver(Layout::uniform, 4).result(), "kinetic energy");
  CHECK(one > 0.1);  // velocities vary over each element, and one point keeps their mean alone
  CHECK(four < one / 10.0);
}

TEST_CASE("stress times volume is the mesh's with the elements' own stress, and about that when recovered") {
  CHECK(error_of(HandOver(Layout::gauss, 3).result(), "sum sigma'_yy V") < 1e-12);
  const double nodal = error_of(HandOver(Layout::gauss, 3, Recovery::nodal).result(), "sum sigma'_yy V");
  CHECK(nodal > 1e-12);
  CHECK(nodal < 1.0);
}

TEST_CASE("the audit finds a particle that lost mass, moved, or was pushed") {
  HandOver lighter(Layout::gauss, 2), moved(Layout::gauss, 2), pushed(Layout::gauss, 2);
  lighter.particles.mass[7] *= 1.0 - 1e-5;
  moved.particles.position[3 * 7] += 1e-4;
  pushed.particles.velocity[3 * 7 + 1] += 1e-4;
  const auto message = [](const HandOver& hand_over) {
    return example::message_of<tailrun::ComputationError>([&] { require_conserved(hand_over.result()); });
  };
  CHECK(message(lighter).find("does not conserve mass") != std::string::npos);
  CHECK(message(moved).find("centre of mass x") != std::string::npos);
  CHECK(message(pushed).find("momentum y") != std::string::npos);
}

TEST_CASE("the audit's table and JSON tell materials and the mass left out") {
  const HandOver hand_over(Layout::gauss, 2);
  const Audit result = hand_over.result();
  CHECK(result.excluded_mass == doctest::Approx(1800.0 * area(initial_corners(hand_over.mesh, 3))));
  CHECK(audit_table(result).find("soil") != std::string::npos);
  const auto json = audit_json(result);
  CHECK(json["materials"][0]["particles"] == 23 * 4);
  CHECK(json["integrals"].size() == result.rows.size());
}
