// Largest difference of one distorted element's matrices from OpenSees' (tests/data/opensees/quadA_*.csv), each over
// the largest entry of its kind, in the mode that shares OpenSees' integrals; and that the free stiffness has exactly
// three rigid motions. Prints it, writes fem_element_matrices.json into the folder that TAILRUN_VERIFICATION_DIR names,
// and exits with 1 when it is more than 1e-6.
#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "fem_stage/element/sspquadup.hpp"

using namespace tailrun::fem;

namespace {

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

// Largest difference and largest entry of one kind of matrix.
struct Difference {
  double difference = 0.0, largest = 0.0;
  void add(double ours, double peer) {
    difference = std::max(difference, std::abs(ours - peer));
    largest = std::max(largest, std::abs(peer));
  }
  double relative() const { return difference / largest; }
};

}  // namespace

int main() {
  const auto start = std::chrono::steady_clock::now();
  Mesh mesh;
  mesh.position = {0, 0, 1.2, 0.1, 1.0, 1.3, -0.1, 0.9};
  mesh.quads = {0, 1, 2, 3};
  mesh.region = {0};
  mesh.region_names = {"soil"};
  const std::vector<double> thickness = {1.0};
  const SspQuadUp e = build_sspquadup(mesh, {}, thickness, HourglassShape::opensees, 1);
  // kPa, m, Mg: E 1e4, nu 0.3, rho 1.9, K_f 2.2e6, permeability 1e-6 and 2e-6 m2/(kPa s), e 0.7, alpha 1e-6
  const double shear = 1e4 / 2.6, bulk = 1e4 / (3.0 * 0.4), porosity = 0.7 / 1.7;
  double stiffness[64];
  sspquadup_stiffness(e, 0, bulk, shear, shear, stiffness);
  const auto K = table("quadA_K.csv"), C = table("quadA_C.csv"), M = table("quadA_M.csv");
  if (K.size() != 12 || C.size() != 12 || M.size() != 12) {
    fmt::print(stderr, "OpenSees' tables are missing\n");
    return 1;
  }
  Difference k, q, h, s, m;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b < 4; ++b) {
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j) k.add(stiffness[8 * (2 * a + i) + 2 * b + j], K[3 * a + i][3 * b + j]);
      // OpenSees' "C" holds -Q and -H, its "M" the lumped mass and -(S + S_alpha).
      q.add(-0.25 * e.volume[0] * e.dndx[a], C[3 * a][3 * b + 2]);
      q.add(-0.25 * e.volume[0] * e.dndy[a], C[3 * a + 1][3 * b + 2]);
      const auto ab = static_cast<std::size_t>(lower(static_cast<int>(a), static_cast<int>(b)));
      h.add(-(1e-6 * e.gradient_xx[ab] + 2e-6 * e.gradient_yy[ab]), C[3 * a + 2][3 * b + 2]);
      s.add(-(porosity / 2.2e6 * e.mass_matrix[ab] + 1e-6 * (e.gradient_xx[ab] + e.gradient_yy[ab])),
            M[3 * a + 2][3 * b + 2]);
    }
    m.add(1.9 * e.nodal_volume[a], M[3 * a][3 * a]);
  }
  const Eigen::Map<const Eigen::Matrix<double, 8, 8, Eigen::RowMajor>> free(stiffness);
  const Eigen::VectorXd modes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(free).eigenvalues();
  const bool three = std::abs(modes[2]) < 1e-10 * modes[7] && modes[3] > 1e-3 * modes[7];
  const double error = std::max({k.relative(), q.relative(), h.relative(), s.relative(), m.relative()});
  const double ceiling = 1e-6,
               seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("stiffness {:.2e}, coupling {:.2e}, seepage {:.2e}, storage {:.2e}, mass {:.2e}; {} rigid motions\n",
             k.relative(), q.relative(), h.relative(), s.relative(), m.relative(), three ? "three" : "not three");
  if (const char* folder = std::getenv("TAILRUN_VERIFICATION_DIR"))
    std::ofstream(std::string(folder) + "/fem_element_matrices.json")
        << fmt::format(R"({{"name": "fem_element_matrices", "row": "element_matrices", "quantity": )"
                       R"("stiffness, coupling, seepage, storage and mass of a distorted element", )"
                       R"("against": "OpenSees, SSPquadUP", "error": {:.6g}, "ceiling": {:g}, "seconds": {:.3g}}})",
                       error, ceiling, seconds)
        << '\n';
  return three && error <= ceiling ? 0 : 1;
}
