// The sparse solver, the freedoms and the accelerator, each against something known.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "fem_stage/boundary/freedoms.hpp"
#include "fem_stage/solver/anderson.hpp"
#include "fem_stage/solver/symmetric_system.hpp"

using namespace tailrun::fem;

TEST_CASE("an indefinite but quasi-definite system is solved, tied freedoms count twice") {
  // Two springs in a row with the middle and right ends tied, and one pressure-like unknown with a negative diagonal.
  SymmetricSystem system(2, {0, 0, 1}, 3);
  const double local[9] = {3, 1, 2, 1, 5, 4, 2, 4, -7};
  system.clear();
  system.add_element(0, local);
  system.factorise();
  std::vector<double> x = {1.0, 2.0};
  system.solve(x, x);
  // tied: [3 + 1 + 1 + 5, 2 + 4; 2 + 4, -7] = [10, 6; 6, -7]
  CHECK(10.0 * x[0] + 6.0 * x[1] == doctest::Approx(1.0));
  CHECK(6.0 * x[0] - 7.0 * x[1] == doctest::Approx(2.0));
}

TEST_CASE("a singular system names the equation that nothing resists") {
  SymmetricSystem system(3, {0, 1, 1, 2}, 2);
  const double spring[4] = {1, -1, -1, 1};
  system.add_element(0, spring);
  system.add_element(1, spring);
  CHECK_THROWS_AS(system.factorise(), SingularSystem);
  system.add_diagonal(0, 1.0);
  CHECK_NOTHROW(system.factorise());
}

TEST_CASE("freedoms: fixed stays fixed through ties, equal heights share an equation") {
  Mesh mesh;
  mesh.position = {0, 0, 1, 0, 0, 1, 1, 1};
  Freedoms freedoms(4);
  freedoms.fix(1, freedom_uy);
  const std::vector<std::int64_t> all = {0, 1, 2, 3};
  constexpr Freedom both[] = {freedom_ux, freedom_uy};
  tie_equal_heights(freedoms, mesh, all, 1e-9, both, "test");
  CHECK(freedoms.fixed(0, freedom_uy));
  CHECK_FALSE(freedoms.fixed(2, freedom_uy));
  const auto equations = freedoms.number(true, true);
  CHECK(equations.number[0] == equations.number[3]);
  CHECK(equations.number[0] != equations.number[6]);
  CHECK(equations.number[1] == -1);
  CHECK(equations.count == 2 + 1 + 4);
}

TEST_CASE("Anderson acceleration solves a linear problem in as many steps as it has unknowns") {
  // x <- x + (b - A x): A = diag(0.2, 0.9, 1.5) converges slowly or not at all without acceleration
  const double a[3] = {0.2, 0.9, 1.5}, b[3] = {1.0, -2.0, 0.5};
  Anderson anderson(3, 5, {1.0, 1.0, 1.0});
  std::vector<double> x(3, 0.0);
  for (int iteration = 0; iteration < 5; ++iteration) {
    std::vector<double> correction(3);
    for (int i = 0; i < 3; ++i) correction[i] = b[i] - a[i] * x[i];
    anderson.accelerate(correction);
    for (int i = 0; i < 3; ++i) x[i] += correction[i];
  }
  for (int i = 0; i < 3; ++i) CHECK(x[i] == doctest::Approx(b[i] / a[i]).epsilon(1e-6));
}
