// Scenes whose particles cannot be where they are put: refused, or remarked on, with the count and the place.
#include <doctest/doctest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "mpm_stage/material/stress_update.hpp"
#include "mpm_stage/scene/polygon.hpp"
#include "mpm_stage/scene/scene.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

using Json = nlohmann::ordered_json;

Json box(std::vector<double> low, std::vector<double> high) {
  return {{"shape", "box"}, {"low", low}, {"high", high}, {"material", "soil"}};
}

Json polygon(const std::vector<std::vector<double>>& points) {
  return {{"shape", "polygon"}, {"points", points}, {"material", "soil"}};
}

Json line(const std::vector<std::vector<double>>& points) {
  return {{"points", points}, {"friction", 0.5}};
}

Json scene_of(const std::vector<Json>& shapes, const std::vector<Json>& terrain = {}, int dimension = 2) {
  Json scene = {
      {"dimension", dimension},
      {"grid", {{"cell_size", 0.5}}},
      {"time", {{"end", 1.0}}},
      {"materials",
       {{"soil", {{"model", "linear_elastic"}, {"density", 2000}, {"youngs_modulus", 1e7}, {"poisson_ratio", 0.3}}}}},
      {"particles", shapes},
      {"terrain", terrain}};
  if (dimension == 3) scene["gravity"] = {0, -9.81, 0};
  return scene;
}

Scene read(const Json& json) {
  const auto path =
      std::filesystem::temp_directory_path() / ("tailrun_placement_" + std::to_string(getpid()) + ".json");
  std::ofstream(path) << json.dump();
  const CaseFile file(path);
  std::filesystem::remove(path);
  return read_scene(file, {});
}

std::string refusal(const Json& json) {
  try {
    read(json);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

double mass(const Scene& scene) {
  double sum = 0.0;
  for (const double m : scene.particles.mass) sum += m;
  return sum;
}

}  // namespace

TEST_CASE("a terrain line drawn from the wrong end is refused with its name, the count and a place, in 2-D and 3-D") {
  const Json right = line({{-50, 0}, {50, 0}}), wrong = line({{50, 0}, {-50, 0}});
  CHECK(read(scene_of({box({0, 0}, {4, 2})}, {right})).remarks.empty());
  const std::string flat = refusal(scene_of({box({0, 0}, {4, 2})}, {wrong}));
  CHECK(holds(flat, "/terrain/0"));
  CHECK(holds(flat, "128 of 128 particles lie behind terrain line 'terrain_0', up to 1.875 m deep ('soil' at ("));
  CHECK(holds(flat, "in the other order"));
  CHECK(holds(refusal(scene_of({box({0, 0, 0}, {4, 2, 1})}, {wrong}, 3)), "512 of 512 particles lie behind"));
  // A valley of two lines, the second of them reversed.
  const Json wall = line({{-2, 50}, {-2, -50}}), reversed = line({{-2, -50}, {-2, 50}});
  CHECK(refusal(scene_of({box({0, 0}, {4, 2})}, {right, wall})).empty());
  CHECK(holds(refusal(scene_of({box({0, 0}, {4, 2})}, {right, reversed})), "/terrain/1"));
}

TEST_CASE("particles under the ground are refused when most are, and remarked on when some are") {
  const Json ground = line({{-100, 0}, {100, 0}});
  CHECK(holds(refusal(scene_of({box({0, -5}, {4, -3})}, {ground})), "128 of 128 particles lie behind"));
  const Scene some = read(scene_of({box({0, -0.5}, {4, 2})}, {ground}));
  REQUIRE(some.remarks.size() == 1);
  CHECK(holds(some.remarks[0],
              "32 of 160 particles lie behind terrain line 'terrain_0', up to 0.375 m deep ('soil' at ("));
  // A slope: the box's corner dips under it.
  const Scene slope = read(scene_of({box({0, 0}, {4, 4})}, {line({{-10, 4}, {10, -4}})}));
  CHECK(slope.remarks.empty());
  CHECK(read(scene_of({box({-2, 0}, {4, 4})}, {line({{-10, 4}, {10, -4}})})).remarks.size() == 1);
}

TEST_CASE("shapes that overlap are refused, shapes that meet are not") {
  const std::string same = refusal(scene_of({box({0, 0}, {4, 2}), box({0, 0}, {4, 2})}));
  CHECK(holds(same, "/particles/1"));
  CHECK(holds(same, "256 of the 256 particles of both lie in the other, the first at (0.125, 0.125) m"));
  CHECK(holds(refusal(scene_of({box({0, 0}, {4, 2}), box({3.5, 1}, {6, 3})})), "overlaps /particles/0: 16 of the"));
  CHECK(holds(refusal(scene_of({box({0, 0, 0}, {2, 2, 2}), box({1, 1, 1}, {3, 3, 3})}, {}, 3)), "128 of the 1024"));
  CHECK(holds(refusal(scene_of({box({0, 0}, {4, 2}), polygon({{1, 1}, {3, 1}, {2, 3}})})), "overlaps"));
  Json turned = box({4, -1}, {6, 1});
  turned["rotation"] = 45;
  CHECK(refusal(scene_of({box({0, 0}, {2, 2}), turned})).empty());
  CHECK(holds(refusal(scene_of({box({2, 0}, {4, 2}), turned})), "overlaps"));
  CHECK(read(scene_of({box({0, 0}, {4, 2}), box({4, 0}, {6, 2}), box({0, 2}, {6, 3})})).remarks.empty());
  // A ring around a core, sharing its edges.
  CHECK(refusal(
            scene_of({polygon({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {3, 2}, {3, 3}, {0, 3}}), box({1, 1}, {3, 2})}))
            .empty());
  // Jitter stays in each particle's own square.
  Json jittered = box({0, 0}, {10, 10}), beside = box({10, 0}, {20, 10});
  for (Json* shape : {&jittered, &beside}) (*shape)["placement"] = "random";
  CHECK(read(scene_of({jittered, beside})).remarks.empty());
}

TEST_CASE("particles of a file that are there twice are refused, bodies laid over each other remarked on") {
  // read_scene takes a file's particles through the same check.
  Scene scene = read(scene_of({box({0, 0}, {8, 8})}));
  const auto path =
      std::filesystem::temp_directory_path() / ("tailrun_placement_case_" + std::to_string(getpid()) + ".json");
  std::ofstream(path) << "{}";
  const CaseFile file(path);
  std::filesystem::remove(path);
  const auto doubled = [&](double shift) {
    Scene twice = scene;
    ParticleSet& set = twice.particles;
    const std::size_t n = set.count();
    for (std::size_t p = 0; p < n; ++p) {
      for (int d = 0; d < 3; ++d) set.position.push_back(set.position[3 * p + d] + (d < 2 ? shift : 0.0));
      set.mass.push_back(set.mass[p]);
      set.volume.push_back(set.volume[p]);
      set.material_id.push_back(0);
    }
    return twice;
  };
  Scene same = doubled(0.0), beside = doubled(0.06);
  CHECK_THROWS_WITH_AS(check_placement(file.root(), same),
                       doctest::Contains("1024 of 2048 particles lie exactly where"), InputError);
  check_placement(file.root(), beside);
  REQUIRE(beside.remarks.size() == 1);
  CHECK(holds(beside.remarks[0], "up to 2.00 times at"));
  CHECK(scene.remarks.empty());
}

TEST_CASE("a polygon that crosses or overlaps itself, or has no area, is refused with the place") {
  const std::string bow = refusal(scene_of({polygon({{0, 0}, {4, 4}, {4, 0}, {0, 4}})}));
  CHECK(holds(bow, "/particles/0/points"));
  CHECK(holds(bow, "its edges from points 0 and 2 (counted from 0) meet at (2, 2) m"));
  // A star of five points, whose area by the corners is not 0; a small loop at the end of a large body.
  CHECK(holds(refusal(scene_of({polygon({{0, 3}, {6, 3}, {1, 0}, {3, 5}, {5, 0}})})), "crosses itself"));
  CHECK(holds(refusal(scene_of({polygon({{0, 0}, {9, 0}, {10, 3}, {10, 0.5}, {9, 3}, {0, 3}})})), "crosses itself"));
  // Two triangles that touch in a point that both name, one each way around.
  CHECK(!refusal(scene_of({polygon({{0, 0}, {2, 2}, {4, 4}, {4, 0}, {2, 2}, {0, 4}})})).empty());
  CHECK(holds(refusal(scene_of({polygon({{0, 0}, {4, 0}, {2, 0}})})), "has no area"));
  // Once around twice.
  CHECK(!refusal(scene_of({polygon({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {8, 0}, {8, 8}, {0, 8}})})).empty());
  CHECK(holds(refusal(scene_of({box({0, 0}, {4, 4}), polygon({{5, 0.01}, {6, 0.01}, {6, 0.02}})})),
              "no particle lies inside"));
}

TEST_CASE("polygons that are in order are filled with their own mass, either way around") {
  const std::vector<std::vector<double>> dam = {{0, 0}, {20, 0}, {12, 4.3}, {8, 4.3}};
  std::vector<std::vector<double>> back(dam.rbegin(), dam.rend());
  for (const auto& points : {dam, back})
    CHECK(mass(read(scene_of({polygon(points)}))) == doctest::Approx(2000 * 0.5 * 24 * 4.3));
  // Concave, and with a hole that a seam leads to and from.
  CHECK(mass(read(scene_of({polygon({{0, 0}, {8, 0}, {8, 8}, {4, 2}, {0, 8}})}))) == doctest::Approx(2000 * 40.0));
  CHECK(mass(read(
            scene_of({polygon({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}})}))) ==
        doctest::Approx(2000 * 48.0));
}

// A fluid's pressure follows from its volume, which says nothing of the stress it is given.
TEST_CASE("a fluid starts with the pressure that it is given, at the mass and volume that it has") {
  const auto check = [&]<int Dim>() {
    Json json = scene_of({box(std::vector<double>(Dim, 0.0), std::vector<double>(Dim, 2.0))}, {}, Dim);
    json["materials"]["soil"] = {
        {"model", "newtonian_fluid"}, {"density", 1000}, {"bulk_modulus", 2e6}, {"viscosity", 1.0}};
    json["particles"][0]["stress"] = {{"kind", "geostatic"}, {"surface", 2}};
    Scene scene = read(json);
    // As a particles file might have it: heavier than the material says.
    for (double& m : scene.particles.mass) m *= 1.3;
    const MaterialConstants k = constants_of(scene.materials[0], 0.5);
    Particles<Dim> P = solver_particles<Dim>(scene);
    const std::vector<double> none(P.count(), 0.0);
    const std::size_t n = P.count();
    CHECK(elastic_energy(k, P, 0, n) > 0.0);
    CHECK(update_stress(k, P, 0, n, none.data(), 1e-3).dissipated == 0.0);
    double worst = 0.0;
    for (std::size_t p = 0; p < n; ++p)
      for (int c = 0; c < stress_components<Dim>; ++c)
        worst = std::max(worst, std::fabs(P.stress[c][p] - (c < 3 ? -1000 * 9.81 * (2.0 - P.position[1][p]) : 0.0)));
    CHECK(worst < 1e-6);
    // Let go and pushed back, it has the pressure that it had.
    std::vector<double> open(n, 0.05), shut(n, -0.05);
    update_stress(k, P, 0, n, open.data(), 1e-3);
    CHECK(P.stress[1][0] == 0.0);
    update_stress(k, P, 0, n, shut.data(), 1e-3);
    CHECK(P.stress[1][0] == doctest::Approx(-1000 * 9.81 * (2.0 - P.position[1][0])));
  };
  check.operator()<2>();
  check.operator()<3>();
}
