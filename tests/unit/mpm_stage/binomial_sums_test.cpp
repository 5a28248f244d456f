#include "mpm_stage/grid/binomial_sums.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tailrun::mpm;

namespace {

// A smooth field on the nodes of 3^Dim blocks, the middle one's node 0 at the origin; block 0 is missing.
template <int Dim>
void compare() {
  constexpr int B = Block<Dim>::cells, nodes = Block<Dim>::nodes;
  const auto field = [](double x, double y, double z) { return std::sin(x + 0.3 * y * y - 0.7 * z); };
  const auto at = [&](int block, int n) {
    const auto step = neighbour_step<Dim>(block);
    return field(n % B + B * step[0], n / B % B + B * step[1], Dim == 3 ? n / (B * B) + B * step[Dim - 1] : 0);
  };
  std::array<int, Block<Dim>::neighbours> around;
  for (int s = 0; s < Block<Dim>::neighbours; ++s) around[static_cast<std::size_t>(s)] = s == 0 ? -1 : s;
  Vec4 sum[nodes];
  BinomialSums<Dim>().make(
      around, [&](std::size_t k) { return Vec4{at(static_cast<int>(k) / nodes, static_cast<int>(k) % nodes)}; }, sum);
  for (int n = 0; n < nodes; ++n) {
    double wanted = 0.0;
    const int place[3] = {n % B, n / B % B, Dim == 3 ? n / (B * B) : 0}, far = Dim == 3 ? 2 : 0;
    for (int k = -far; k <= far; ++k)
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
          constexpr double weight[] = {1.0, 4.0, 6.0, 4.0, 1.0};
          const int x = place[0] + i, y = place[1] + j, z = place[2] + k;
          if (x < 0 && y < 0 && (Dim == 2 || z < 0)) continue;
          wanted += weight[i + 2] * weight[j + 2] * (Dim == 3 ? weight[k + 2] : 1.0) * field(x, y, z);
        }
    const double summed = sum[n][0];  // no reference binds to a lane of a vector
    CHECK(summed == doctest::Approx(wanted).epsilon(1e-12).scale(1.0));
  }
}

}  // namespace

TEST_CASE("binomial sums around a block's nodes are those of all nodes there are, in 2-D and 3-D") {
  compare<2>();
  compare<3>();
}
