// SSPquadUP against closed forms and against OpenSees' matrices of one distorted element (tests/data/opensees/quadA_*).
#include "fem_stage/element/sspquadup.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <sstream>

using namespace tailrun::fem;

namespace {

Mesh one_quad(std::vector<double> corners) {
  Mesh mesh;
  mesh.position = std::move(corners);
  mesh.quads = {0, 1, 2, 3};
  mesh.region = {0};
  mesh.region_names = {"soil"};
  return mesh;
}

SspQuadUp build(const Mesh& mesh, HourglassShape shape = HourglassShape::constant_jacobian, int points = 2) {
  const std::vector<double> thickness = {1.0};
  return build_sspquadup(mesh, {}, thickness, shape, points);
}

const std::vector<double> skewed = {0, 0, 2, 0.2, 2.3, 1.7, -0.1, 1.4};

std::vector<std::vector<double>> table(const std::string& name) {
  std::ifstream stream(std::string(TAILRUN_TEST_DATA) + "/opensees/" + name);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

}  // namespace

TEST_CASE("centre derivatives, hourglass vector and lumped mass of a skewed element") {
  const SspQuadUp e = build(one_quad(skewed));
  const double dndx[] = {-0.189573, 0.268562, 0.189573, -0.268562}, dndy[] = {-0.331754, -0.363349, 0.331754, 0.363349};
  const double gamma[] = {0.277251, -0.267773, 0.222749, -0.232227}, mass[] = {0.7625, 0.7725, 0.8200, 0.8100};
  for (int a = 0; a < 4; ++a) {
    CHECK(e.dndx[a] == doctest::Approx(dndx[a]).epsilon(1e-5));
    CHECK(e.dndy[a] == doctest::Approx(dndy[a]).epsilon(1e-5));
    CHECK(e.gamma[a] == doctest::Approx(gamma[a]).epsilon(1e-5));
    CHECK(e.nodal_volume[a] == doctest::Approx(mass[a]).epsilon(1e-5));
  }
  CHECK(e.volume[0] == doctest::Approx(3.165).epsilon(1e-12));
}

TEST_CASE("hourglass stiffness of the two formulations differs for skewed elements only") {
  const SspQuadUp ours = build(one_quad(skewed)), peer = build(one_quad(skewed), HourglassShape::opensees);
  CHECK(ours.hourglass[0] == doctest::Approx(0.912059).epsilon(1e-5));
  CHECK(std::abs(ours.hourglass[1]) == doctest::Approx(0.292786).epsilon(1e-5));
  CHECK(ours.hourglass[2] == doctest::Approx(2.043181).epsilon(1e-5));
  CHECK(peer.hourglass[0] == doctest::Approx(0.891333).epsilon(1e-5));
  CHECK(std::abs(peer.hourglass[1]) == doctest::Approx(0.046507).epsilon(1e-4));
  CHECK(peer.hourglass[2] == doctest::Approx(2.010113).epsilon(1e-5));
  for (const auto shape : {HourglassShape::constant_jacobian, HourglassShape::opensees}) {
    const SspQuadUp rectangle = build(one_quad({0, 0, 2, 0, 2, 1, 0, 1}), shape);
    CHECK(rectangle.hourglass[0] == doctest::Approx(2.0 / 3.0));
    CHECK(rectangle.hourglass[1] == doctest::Approx(0.0));
    CHECK(rectangle.hourglass[2] == doctest::Approx(8.0 / 3.0));
  }
}

TEST_CASE("stiffness, coupling, seepage, mass and storage are OpenSees' to 1e-6") {
  const Mesh mesh = one_quad({0, 0, 1.2, 0.1, 1.0, 1.3, -0.1, 0.9});
  const SspQuadUp e = build(mesh, HourglassShape::opensees, 1);
  // E 1e4 kPa, nu 0.3, rho 1.9, K_f 2.2e6 kPa, permeability 1e-6 and 2e-6 m2/(kPa s), e 0.7, alpha 1e-6 (kPa, m, Mg)
  const double shear = 1e4 / 2.6, bulk = 1e4 / (3.0 * 0.4), porosity = 0.7 / 1.7;
  double stiffness[64];
  sspquadup_stiffness(e, 0, bulk, shear, shear, stiffness);
  const auto K = table("quadA_K.csv"), C = table("quadA_C.csv"), M = table("quadA_M.csv");
  REQUIRE(K.size() == 12);
  double largest_k = 0.0, largest_m = 0.0;
  for (const auto& row : K)
    for (const double v : row) largest_k = std::max(largest_k, std::abs(v));
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < 4; ++b) {
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j)
          CHECK(std::abs(stiffness[8 * (2 * a + i) + 2 * b + j] - K[3 * a + i][3 * b + j]) <= 1e-6 * largest_k);
      // OpenSees' "C" holds -Q and -H, its "M" the lumped mass and -(S + S_alpha)
      CHECK(0.25 * e.volume[0] * -e.dndx[a] == doctest::Approx(C[3 * a][3 * b + 2]).epsilon(1e-6));
      CHECK(0.25 * e.volume[0] * -e.dndy[a] == doctest::Approx(C[3 * a + 1][3 * b + 2]).epsilon(1e-6));
      const auto ab = static_cast<std::size_t>(lower(static_cast<int>(a), static_cast<int>(b)));
      const double gxx = e.gradient_xx[ab], gyy = e.gradient_yy[ab];
      CHECK(std::abs(1e-6 * gxx + 2e-6 * gyy + C[3 * a + 2][3 * b + 2]) <= 1e-12);
      const double storage = porosity / 2.2e6 * e.mass_matrix[ab] + 1e-6 * (gxx + gyy);
      largest_m = std::max(largest_m, std::abs(M[3 * a + 2][3 * b + 2]));
      CHECK(std::abs(storage + M[3 * a + 2][3 * b + 2]) <= 1e-6 * largest_m);
    }
  for (std::size_t a = 0; a < 4; ++a) CHECK(1.9 * e.nodal_volume[a] == doctest::Approx(M[3 * a][3 * a]).epsilon(1e-6));
}

TEST_CASE("patch test: a linear field gives constant strain and no hourglass amplitude; rigid motion gives no force") {
  const SspQuadUp e = build(one_quad(skewed));
  double stiffness[64], qx = 0.0, exx = 0.0, gxy = 0.0;
  sspquadup_stiffness(e, 0, 2e4, 1e4, 1e4, stiffness);
  for (std::size_t a = 0; a < 4; ++a) {
    const double x = skewed[2 * a], y = skewed[2 * a + 1], ux = 3.0 + 2.0 * x - 1.5 * y, uy = 0.5 * x + 4.0 * y;
    qx += e.gamma[a] * ux;
    exx += e.dndx[a] * ux;
    gxy += e.dndy[a] * ux + e.dndx[a] * uy;
  }
  CHECK(std::abs(qx) <= 1e-12);
  CHECK(exx == doctest::Approx(2.0).epsilon(1e-12));
  CHECK(gxy == doctest::Approx(-1.0).epsilon(1e-12));
  for (std::size_t row = 0; row < 8; ++row) {
    double translation = 0.0, rotation = 0.0;
    for (std::size_t a = 0; a < 4; ++a) {
      translation += stiffness[8 * row + 2 * a];
      rotation += -skewed[2 * a + 1] * stiffness[8 * row + 2 * a] + skewed[2 * a] * stiffness[8 * row + 2 * a + 1];
    }
    CHECK(std::abs(translation) <= 1e-8);
    CHECK(std::abs(rotation) <= 1e-8);
  }
}

TEST_CASE("2 x 2 points leave no checkerboard in the seepage matrix, one point does") {
  const double checkerboard[] = {1, -1, 1, -1};
  for (const int points : {1, 2}) {
    const SspQuadUp e = build(one_quad(skewed), HourglassShape::constant_jacobian, points);
    double energy = 0.0;
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b)
        energy += checkerboard[a] * checkerboard[b] *
                  (e.gradient_xx[static_cast<std::size_t>(lower(a, b))] +
                   e.gradient_yy[static_cast<std::size_t>(lower(a, b))]);
    if (points == 1)
      CHECK(std::abs(energy) <= 1e-12);
    else
      CHECK(energy > 0.1);
  }
}
