// The sparse factor in blocks: a system large enough to have branches and a trunk, its residual, and the same bits for
// any number of threads.
#include <doctest/doctest.h>
#include <omp.h>

#include <cmath>
#include <random>
#include <vector>

#include "fem_stage/solver/symmetric_system.hpp"

using namespace tailrun::fem;

namespace {

constexpr int columns = 120, rows = 40, per_node = 3;

// Quadrilaterals on a grid with two displacement-like unknowns and a pressure-like one (negative diagonal) at each
// node.
struct Grid {
  std::vector<int> equations;  // (M, 12)
  std::vector<double> local;   // (M, 12, 12)
  int count = per_node * (columns + 1) * (rows + 1);

  Grid() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> value(-1.0, 1.0);
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const int corner = j * (columns + 1) + i;
        for (const int node : {corner, corner + 1, corner + columns + 2, corner + columns + 1})
          for (int k = 0; k < per_node; ++k) equations.push_back(per_node * node + k);
        const std::size_t start = local.size();
        local.resize(start + 144);
        for (std::size_t a = 0; a < 12; ++a)
          for (std::size_t b = 0; b <= a; ++b)
            local[start + 12 * a + b] = local[start + 12 * b + a] =
                a == b ? (a % 3 == 2 ? -9.0 : 9.0) + value(random) : value(random);
      }
  }
  std::size_t elements() const { return equations.size() / 12; }

  std::vector<double> product(const std::vector<double>& x) const {
    std::vector<double> out(x.size(), 0.0);
    for (std::size_t e = 0; e < elements(); ++e)
      for (std::size_t a = 0; a < 12; ++a)
        for (std::size_t b = 0; b < 12; ++b)
          out[static_cast<std::size_t>(equations[12 * e + a])] +=
              local[144 * e + 12 * a + b] * x[static_cast<std::size_t>(equations[12 * e + b])];
    return out;
  }
  std::vector<double> solution(const std::vector<double>& right, int threads) const {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    SymmetricSystem system(count, equations, 12);
    system.clear();
    for (std::size_t e = 0; e < elements(); ++e) system.add_element(e, &local[144 * e]);
    std::vector<double> x(right.size());
    for (int repeat = 0; repeat < 2; ++repeat) {  // the second factor into the memory of the first
      system.factorise();
      system.solve(right, x);
    }
    omp_set_num_threads(before);
    return x;
  }
};

}  // namespace

TEST_CASE("block factor: a large quasi-definite system is solved to round-off, with the same bits for any threads") {
  const Grid grid;
  std::vector<double> right(static_cast<std::size_t>(grid.count));
  for (std::size_t i = 0; i < right.size(); ++i) right[i] = std::sin(static_cast<double>(i));
  const std::vector<double> x = grid.solution(right, 1), back = grid.product(x);
  double worst = 0.0;
  for (std::size_t i = 0; i < right.size(); ++i) worst = std::max(worst, std::abs(back[i] - right[i]));
  CHECK(worst < 1e-11);
  for (const int threads : {2, 3}) CHECK(grid.solution(right, threads) == x);
}
