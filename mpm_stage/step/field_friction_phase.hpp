// The friction that velocity fields exert on each other (boundary/field_friction.hpp), when their approach and the
// ground's has been stopped at all nodes; included by explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::clear_grips(std::size_t a) {
  for (int pair = 0; pair < pairs_of(fields_.count()); ++pair) {
    const std::size_t first = grip_of(pair, a);
    if (!gripping_[first / block_nodes]) continue;
    std::fill_n(field_grip_.begin() + static_cast<std::ptrdiff_t>(first), block_nodes, FieldGrip<Dim>{});
    gripping_[first / block_nodes] = 0;
  }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::rub_fields(double dt) {
  const std::vector<std::size_t>& blocks = fields_.shared_blocks();
  const int pairs = pairs_of(fields_.count());
  const auto node = [this](unsigned fields, std::size_t a, int n) {
    return node_of(std::countr_zero(fields), a) + static_cast<std::size_t>(n);
  };
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t s = 0; s < blocks.size(); ++s)
    for (int pair = 0; pair < pairs; ++pair) {
      const std::size_t first = grip_of(pair, blocks[s]);
      FieldGrip<Dim>* grip = field_grip_.data() + first;
      double* smoothed = smoothed_push_.empty() ? nullptr : smoothed_push_.data() + first;
      if (!gripping_[first / block_nodes]) {
        if (smoothed) std::fill_n(smoothed, block_nodes, 0.0);
        continue;
      }
      for (int n = 0; n < block_nodes; ++n) {
        if (!grip[n].any()) {
          if (smoothed) smoothed[n] = 0.0;
          continue;
        }
        std::array<double, Dim> u = velocity_at(node(grip[n].fields[0], blocks[s], n));
        const std::array<double, Dim> other = velocity_at(node(grip[n].fields[1], blocks[s], n));
        const double fast = std::sqrt(std::max(square<Dim>(u), square<Dim>(other)));
        for (int d = 0; d < Dim; ++d) u[d] -= other[d];
        grip[n].sliding = grip[n].reduced_mass() * std::sqrt(square<Dim>(sliding_of<Dim>(grip[n], u)));
        if (smoothed) grip[n].smooth(dt, smoothing_share(dt * h1_ * fastest_wave_, dt * h1_ * fast), smoothed[n]);
      }
    }
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t s = 0; s < blocks.size(); ++s)
    for (int pair = 0; pair < pairs; ++pair) {
      const std::size_t first = grip_of(pair, blocks[0]);
      Spread* spread = field_spread_.data() + first + s * block_nodes;
      if (!gripping_[first / block_nodes + s])
        std::fill_n(spread, block_nodes, Spread{});
      else
        for (int n = 0; n < block_nodes; ++n)
          spread[n] = spread_of<Dim>(fields_.shared_around(s), field_grip_.data() + first, s, n);
    }
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t s = 0; s < blocks.size(); ++s) rub_fields_of(s);
}

// Brakes the sliding at the nodes of shared block s, pair by pair.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::rub_fields_of(std::size_t s) {
  const std::size_t a = fields_.shared_blocks()[s];
  GridSums<Dim>& sums = grid_sums_[a];
  for (int pair = 0; pair < pairs_of(fields_.count()); ++pair) {
    if (!gripping_[grip_of(pair, a) / block_nodes]) continue;
    const FieldGrip<Dim>* grip = field_grip_.data() + grip_of(pair, a);
    const Spread* spread = field_spread_.data() + grip_of(pair, fields_.shared_blocks()[0]);
    for (int n = 0; n < block_nodes; ++n) {
      if (!grip[n].any()) continue;
      const auto k = static_cast<std::size_t>(n);
      std::array<double, Dim> u = velocity_at(node_of(std::countr_zero(grip[n].fields[0]), a) + k);
      const std::array<double, Dim> other = velocity_at(node_of(std::countr_zero(grip[n].fields[1]), a) + k);
      for (int d = 0; d < Dim; ++d) u[d] -= other[d];
      const std::array<double, Dim> slide = sliding_of<Dim>(grip[n], u);
      const double speed = std::sqrt(square<Dim>(slide)), reduced = grip[n].reduced_mass();
      if (speed <= 0.0) continue;
      const double impulse =
          std::min(reduced * speed, pooled_impulse<Dim>(fields_.shared_around(s), grip[n], spread, n));
      // The impulse times the sliding that is left, for that is what displaces.
      sums.contact += impulse * std::max(0.0, speed - impulse / reduced);
      for (int side = 0; side < 2; ++side) {
        std::array<double, Dim> dv;
        for (int d = 0; d < Dim; ++d) dv[d] = (side == 0 ? -impulse : impulse) / grip[n].mass[side] * slide[d] / speed;
        brake_body(grip[n].fields[side], a, n, grip[n].mass[side], dv, sums);
      }
    }
  }
}

// The fields that move as one body of that mass (kg) at node n change their velocity by dv.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::brake_body(unsigned fields, std::size_t a, int n, double mass,
                                                             const std::array<double, Dim>& dv, GridSums<Dim>& sums) {
  bool booked = false;
  for (int f = 0; f < fields_.count(); ++f) {
    if (!(fields >> f & 1U)) continue;
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    for (int d = 0; d < Dim; ++d) velocity_[k][d] += dv[d];
    if constexpr (Split) {
      add_change(k, dv);
      for (int d = 0; d < Dim && !booked; ++d) {
        sums.kinetic_after += mass * dv[d] * (velocity_[k][d] - 0.5 * dv[d]);
        sums.impact += 0.5 * mass * dv[d] * change_of(k, d);
      }
    }
    booked = true;
  }
}

}  // namespace tailrun::mpm
