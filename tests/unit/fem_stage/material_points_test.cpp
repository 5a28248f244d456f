// The material points of a model: stages, trial and commit, saved states, threads.
#include <doctest/doctest.h>
#include <omp.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "fem_stage/material/material_points.hpp"
#include "material_drive.hpp"

using namespace tailrun;
using namespace tailrun::fem;
using namespace tailrun::fem::testing;

namespace {

std::vector<MaterialDefinition> four_materials() {
  LinearElasticParameters elastic;
  elastic.shear_modulus = 1e8;
  elastic.density = 2000.0;
  MohrCoulombParameters mc;
  mc.shear_modulus = 677 * 101.3e3;
  mc.cohesion = 25e3;
  mc.friction_angle = 35.0;
  mc.density = 1690.0;
  Pm4SiltParameters silt;
  silt.strength_ratio = 0.25;
  silt.shear_coefficient = 500.0;
  silt.contraction_rate = 20.0;
  silt.density = 1800.0;
  return {{"rock", elastic}, {"dam", mc}, {"tailings", tailings()}, {"silt", silt}};
}

MaterialPoints level_ground(std::size_t count) {
  std::vector<int> index(count);
  for (std::size_t i = 0; i < count; ++i) index[i] = static_cast<int>(i % 4);
  MaterialPoints points(four_materials(), index);
  std::vector<double> stress;
  for (std::size_t i = 0; i < count; ++i) {
    const double vertical = -(20e3 + 1e3 * static_cast<double>(i));
    stress.insert(stress.end(), {0.5 * vertical, vertical, 0.5 * vertical, 0.0});
  }
  points.set_stress(stress);
  points.start_plastic_stage(true);
  return points;
}

std::vector<double> shaken(MaterialPoints& points, int steps) {
  std::vector<double> strain(3 * points.size()), stress(4 * points.size());
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      strain[3 * i + 2] = 1e-4 * std::sin(0.3 * step + 0.01 * static_cast<double>(i)) * (i % 7 == 0 ? 10.0 : 1.0);
      strain[3 * i] = 1e-6 * static_cast<double>(i % 3);
    }
    const UpdateReport report = points.update(strain, stress);
    REQUIRE(report.failed_point == -1);
    points.commit();
  }
  return stress;
}

}  // namespace

TEST_CASE("material points: an increment that cannot be integrated fails as often as it is tried") {
  MaterialPoints points = level_ground(4);
  std::vector<double> stress(16);
  for (std::size_t i = 0; i < 4; ++i)
    for (const double bad : {HUGE_VAL, 1e6})
      for (int attempt = 0; attempt < 2; ++attempt) {
        std::vector<double> strain(12, 0.0);
        strain[3 * i + 2] = bad;
        const bool adaptive = i >= 2;  // elastic stress and its return to yield take any finite strain
        CAPTURE(i);
        CAPTURE(attempt);
        if (bad == HUGE_VAL || adaptive) CHECK(points.update(strain, stress).failed_point == static_cast<int>(i));
      }
}

TEST_CASE("material points: elastic stage with nu = K0/(1 + K0) gives K0, and its moduli are G_0 p_A") {
  MaterialPoints points(four_materials(), {2});
  const double nu = 0.5 / 1.5;
  points.start_elastic_stage(std::vector<double>{NAN, NAN, nu, NAN});
  std::vector<double> stress(4), bulk(1), shear(1);
  points.update(std::vector<double>{0.0, -1e-3, 0.0}, stress);
  points.commit();
  points.elastic_moduli(bulk, shear);
  CHECK(shear[0] == doctest::Approx(476.0 * 101.3e3));
  CHECK(bulk[0] == doctest::Approx(2.0 / 3.0 * shear[0] * (1.0 + nu) / (1.0 - 2.0 * nu)));
  CHECK(stress[1] == doctest::Approx(-1e-3 * (bulk[0] + 4.0 / 3.0 * shear[0])));
  CHECK(stress[0] / stress[1] == doctest::Approx(0.5));
  CHECK(stress[2] / stress[1] == doctest::Approx(0.5));
  // Switching to PM4Sand leaves the stress where it was; Poisson's ratio is the material's own again.
  points.start_plastic_stage(true);
  std::vector<double> after(4);
  points.update(std::vector<double>{0.0, 0.0, 0.0}, after);
  for (int k = 0; k < 4; ++k) CHECK(after[k] == doctest::Approx(stress[k]));
  points.initial_moduli(bulk, shear);
  CHECK(bulk[0] == doctest::Approx(bulk_over_shear_of(0.3) * shear[0]));
}

TEST_CASE("material points: tension left by elastic gravity is handed through unchanged") {
  MaterialPoints points(four_materials(), {2, 2});
  points.set_stress(std::vector<double>{15e3, -4e3, 5e3, 2e3, 20e3, 8e3, 9e3, -3e3});
  points.start_plastic_stage(true);
  std::vector<double> stress(8);
  points.update(std::vector<double>(6, 0.0), stress);
  CHECK(stress[0] == doctest::Approx(15e3));
  CHECK(stress[1] == doctest::Approx(-4e3));
  CHECK(stress[3] == doctest::Approx(2e3));
  CHECK(stress[4] == doctest::Approx(20e3));
}

TEST_CASE("material points: the same bits with one, two and four threads") {
  std::vector<double> first;
  std::vector<double> first_state;
  const int before = omp_get_max_threads();
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    MaterialPoints points = level_ground(400);
    const std::vector<double> stress = shaken(points, 12);
    const std::vector<double> state = points.save_state();
    if (first.empty()) first = stress, first_state = state;
    CHECK(std::memcmp(first.data(), stress.data(), sizeof(double) * stress.size()) == 0);
    CHECK(std::memcmp(first_state.data(), state.data(), sizeof(double) * state.size()) == 0);
  }
  omp_set_num_threads(before);
}

TEST_CASE("material points: a restored state goes on bit for bit as the original") {
  MaterialPoints original = level_ground(40), copy = level_ground(40);
  shaken(original, 5);
  const std::vector<double> state = original.save_state();
  copy.restore_state(state);
  const std::vector<double> a = shaken(original, 5), b = shaken(copy, 5);
  CHECK(std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0);
  CHECK_THROWS_AS(copy.restore_state(std::vector<double>(3)), InputError);
}

TEST_CASE("material points: the trial stress does not depend on trials before it") {
  MaterialPoints points = level_ground(40);
  shaken(points, 3);
  std::vector<double> a(160), b(160), strain(120, 2e-5), other(120, -3e-4);
  points.update(strain, a);
  points.update(other, b);
  points.update(strain, b);
  CHECK(std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0);
}

TEST_CASE("material points: without strain nothing changes and nothing is computed") {
  MaterialPoints points = level_ground(40);
  std::vector<double> before = shaken(points, 4), after(160), zero(120, 0.0);
  points.committed_stress(before);
  const UpdateReport report = points.update(zero, after);
  CHECK(report.substeps == 0);
  CHECK(std::memcmp(before.data(), after.data(), sizeof(double) * after.size()) == 0);
}

TEST_CASE("material points: second initialisation forgets fabric; A_do and z_max as asked") {
  MaterialPoints points(four_materials(), {2});
  points.set_stress(std::vector<double>{-50e3, -100e3, -50e3, 0.0});
  points.start_plastic_stage(true);
  std::vector<double> stress(4), fabric(1);
  for (int i = 0; i < 600; ++i) {
    points.update(std::vector<double>{0.0, 0.0, i % 2 == 0 ? 2e-3 : -2e-3}, stress);
    points.commit();
  }
  points.start_plastic_stage(false);
  points.internal_variable("fabric", fabric);
  CHECK(fabric[0] == 0.0);
  CHECK_THROWS_AS(points.internal_variable("fabrics", fabric), InputError);
}

// F_sed = F_min + (1 - F_min) p/(20 p_sed), p_sed = p_A/5 z_cum/(z_cum + z_max) <1 - M_cur/M_d>^(1/4).
TEST_CASE("material points: post-shaking moduli of PM4Sand are reduced by fabric at low stress, and come back") {
  MaterialPoints points(four_materials(), {2});
  points.set_stress(std::vector<double>{-50e3, -100e3, -50e3, 0.0});
  points.start_plastic_stage(true);
  std::vector<double> stress(4), z_cum(1), ratio(1), bulk(1), shear(1), reduced(1);
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 40; ++k) {
      points.update(std::vector<double>{0.0, 0.0, i % 2 == 0 ? 5e-4 : -5e-4}, stress);
      points.commit();
    }
  }
  while (std::fabs(stress[3]) > 100.0) {  // back to hardly any shear stress
    points.update(std::vector<double>{0.0, 0.0, stress[3] > 0.0 ? -2e-6 : 2e-6}, stress);
    points.commit();
  }
  points.internal_variable("fabric_cumulative", z_cum);
  points.internal_variable("stress_ratio", ratio);
  REQUIRE(z_cum[0] > 0.1);
  points.elastic_moduli(bulk, shear);
  points.set_post_shaking(true);
  points.elastic_moduli(bulk, reduced);
  const double p = -0.5 * (stress[0] + stress[1]), p_A = 101.3e3;
  const auto fresh = drive(tailings(), 50e3, 100e3);
  const double M_d = fresh.law.surfaces(fresh.constants, p, 0.35).M_d;
  const double z_max = fresh.constants.z_max, F_min = 0.03 * std::exp(2.6 * 0.35);
  const double p_sed = 0.2 * p_A * z_cum[0] / (z_cum[0] + z_max) * std::pow(1.0 - ratio[0] / M_d, 0.25);
  CHECK(reduced[0] / shear[0] ==
        doctest::Approx(std::min(1.0, F_min + (1.0 - F_min) * p / (20.0 * p_sed))).epsilon(1e-6));
  CHECK(reduced[0] < 0.5 * shear[0]);
  points.set_post_shaking(false);
  points.elastic_moduli(bulk, reduced);
  CHECK(reduced[0] == shear[0]);
}

TEST_CASE("material points: density, porosity, bad indices, a strain that is not a number") {
  MaterialPoints points(four_materials(), {0, 1, 2, 3});
  std::vector<double> value(4);
  points.density(value);
  CHECK(value[2] == 1870.0);
  points.porosity(value);
  CHECK(value[2] == doctest::Approx(0.695 / 1.695));
  CHECK(value[3] == doctest::Approx(0.9 / 1.9));
  CHECK_THROWS_AS(MaterialPoints(four_materials(), {4}), InputError);
  points.start_plastic_stage(true);
  std::vector<double> stress(16), strain(12, 0.0);
  strain[8] = NAN;
  const UpdateReport report = points.update(strain, stress);
  CHECK(report.failed_point == 2);
  CHECK(report.reason.find("tailings") != std::string::npos);
  for (const double s : stress) CHECK(std::isfinite(s));
}

TEST_CASE("material points: Mohr-Coulomb shears off at c cos(phi) + p sin(phi) and counts plastic strain") {
  MaterialPoints points(four_materials(), {1});
  points.set_stress(std::vector<double>{-100e3, -100e3, -100e3, 0.0});
  points.start_plastic_stage(true);
  std::vector<double> stress(4), plastic(1);
  for (int i = 0; i < 100; ++i) {
    points.update(std::vector<double>{0.0, 0.0, 1e-4}, stress);
    points.commit();
  }
  const double phi = 35.0 * M_PI / 180.0, p = -0.5 * (stress[0] + stress[1]);
  CHECK(std::hypot(0.5 * (stress[0] - stress[1]), stress[3]) ==
        doctest::Approx(25e3 * std::cos(phi) + p * std::sin(phi)).epsilon(1e-6));
  points.internal_variable("plastic_strain", plastic);
  CHECK(plastic[0] > 4e-3);
}

TEST_CASE("material definition: a wrong model, a value out of range, a missing key and both stiffnesses are refused") {
  const auto read = [](const std::string& text) {
    const auto path = std::filesystem::temp_directory_path() / "tailrun_material_test.json";
    std::ofstream(path) << text;
    const CaseFile file(path);
    const MaterialDefinition material = read_material(file.root());
    file.finish();
    return material;
  };
  CHECK_THROWS_AS(read(R"({"model": "pm5sand"})"), InputError);
  CHECK_THROWS_AS(read(R"({"model": "pm4sand", "relative_density": -0.1, "hpo": 1, "density": 1800})"), InputError);
  CHECK_THROWS_AS(read(R"({"model": "pm4sand", "relative_density": 0.5, "density": 1800})"), InputError);
  CHECK_THROWS_AS(read(R"({"model": "pm4silt", "G0": 500, "hpo": 20, "density": 1800})"), InputError);
  CHECK_THROWS_AS(read(R"({"model": "linear_elastic", "shear_modulus": 1, "youngs_modulus": 1, "density": 1})"),
                  InputError);
  const auto good = read(R"({"model": "pm4sand", "relative_density": 0.5, "hpo": 0.4, "density": 1800,
                             "compatibility": "opensees"})");
  CHECK(std::get<Pm4SandParameters>(good.model).compatibility == Pm4Compatibility::opensees);
  const auto elastic =
      read(R"({"model": "linear_elastic", "youngs_modulus": 2.6, "poisson_ratio": 0.3, "density": 1})");
  CHECK(std::get<LinearElasticParameters>(elastic.model).shear_modulus == doctest::Approx(1.0));
}
