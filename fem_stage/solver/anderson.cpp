#include "fem_stage/solver/anderson.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace tailrun::fem {

Anderson::Anderson(std::size_t unknowns, int depth, std::vector<double> weights)
    : n_(unknowns),
      depth_(static_cast<std::size_t>(depth)),
      weights_(std::move(weights)),
      last_correction_(unknowns),
      last_step_(unknowns),
      correction_changes_(depth_, std::vector<double>(unknowns)),
      step_and_changes_(depth_, std::vector<double>(unknowns)),
      gram_(depth_ * depth_) {}

double Anderson::product(const std::vector<double>& a, std::span<const double> b) const {
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (std::size_t i = 0; i < n_; ++i) sum += weights_[i] * a[i] * b[i];
  return sum;
}

void Anderson::restart() {
  first_ = true;
  stored_ = next_ = 0;
}

void Anderson::accelerate(std::span<double> correction) {
  if (depth_ == 0) return;
  if (!first_) {
    auto& dd = correction_changes_[next_];
    auto& ds = step_and_changes_[next_];
    for (std::size_t i = 0; i < n_; ++i) {
      dd[i] = correction[i] - last_correction_[i];
      ds[i] = last_step_[i] + dd[i];
    }
    stored_ = std::min(stored_ + 1, depth_);
    for (std::size_t k = 0; k < stored_; ++k)
      gram_[depth_ * std::max(k, next_) + std::min(k, next_)] = product(correction_changes_[k], dd);
    next_ = (next_ + 1) % depth_;
  }
  first_ = false;
  std::copy(correction.begin(), correction.end(), last_correction_.begin());
  if (stored_ > 0) {
    const auto m = static_cast<Eigen::Index>(stored_);
    Eigen::MatrixXd gram(m, m);
    Eigen::VectorXd right(m);
    for (std::size_t a = 0; a < stored_; ++a) {
      right(static_cast<Eigen::Index>(a)) = product(correction_changes_[a], correction);
      for (std::size_t b = 0; b <= a; ++b)
        gram(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
            gram(static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(a)) = gram_[depth_ * a + b];
    }
    gram.diagonal() *= 1.0 + 1e-10;  // nearly parallel changes must not blow the combination up
    const Eigen::VectorXd share = gram.ldlt().solve(right);
    if (share.allFinite())
      for (Eigen::Index a = 0; a < m; ++a) {
        const auto& ds = step_and_changes_[static_cast<std::size_t>(a)];
        for (std::size_t i = 0; i < n_; ++i) correction[i] -= share(a) * ds[i];
      }
  }
  std::copy(correction.begin(), correction.end(), last_step_.begin());
}

}  // namespace tailrun::fem
