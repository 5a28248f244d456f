// Sums over the 5^Dim nodes around each node of a block, with the binomial weights 1 4 6 4 1 along each axis: what a
// field on the nodes looks like when details of a cell or two are gone. Weights are not divided by their sum.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

template <int Dim>
class BinomialSums {
 public:
  // value(k) is that of node k, counted through a row of blocks of which `around` are those around this one (-1: there
  // is none, and nothing at its nodes). Writes Block::nodes sums.
  template <class Value>
  void make(const std::array<int, Block<Dim>::neighbours>& around, Value value, Vec4* sum) {
    for (int s = 0; s < Block<Dim>::neighbours; ++s) load(s, around[static_cast<std::size_t>(s)], value);
    // Along one axis after the other; the sum for the node two steps on is written where its first term was.
    int stride = 1;
    for (int d = 0; d < Dim; ++d, stride *= side)
      for (int n = 0; n < nodes - 4 * stride; ++n)
        if (n / stride % side < B)
          at_[n] += 4.0 * (at_[n + stride] + at_[n + 3 * stride]) + 6.0 * at_[n + 2 * stride] + at_[n + 4 * stride];
    for (int n = 0; n < Block<Dim>::nodes; ++n) sum[n] = at_[(n / (B * B) * side + n / B % B) * side + n % B];
  }

 private:
  static constexpr int B = Block<Dim>::cells, margin = 2, side = B + 2 * margin, nodes = power(side, Dim);

  template <class Value>
  void load(int s, int block, Value value) {
    int from[3] = {0, 0, 0}, to[3] = {1, 1, 1}, shift[3] = {0, 0, 0};
    const auto step = neighbour_step<Dim>(s);
    for (int d = 0; d < Dim; ++d) {
      from[d] = step[d] < 0 ? B - margin : 0;
      to[d] = step[d] > 0 ? margin : B;
      shift[d] = margin + step[d] * B;
    }
    for (int k = from[2]; k < to[2]; ++k)
      for (int j = from[1]; j < to[1]; ++j)
        for (int i = from[0]; i < to[0]; ++i) {
          const int n = (k * B + j) * B + i;
          at_[((k + shift[2]) * side + j + shift[1]) * side + i + shift[0]] =
              block < 0 ? Vec4{}
                        : value(static_cast<std::size_t>(block) * Block<Dim>::nodes + static_cast<std::size_t>(n));
        }
  }

  alignas(32) std::array<Vec4, nodes> at_;
};

}  // namespace tailrun::mpm
