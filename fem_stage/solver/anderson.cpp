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
      step_and_changes_(depth_, std::vector<double>(unknowns)) {}

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
    next_ = (next_ + 1) % depth_;
    stored_ = std::min(stored_ + 1, depth_);
  }
  first_ = false;
  std::copy(correction.begin(), correction.end(), last_correction_.begin());
  if (stored_ > 0) {
    const auto m = static_cast<Eigen::Index>(stored_);
    Eigen::MatrixXd gram(m, m);
    Eigen::VectorXd right(m);
    for (Eigen::Index a = 0; a < m; ++a) {
      const auto& da = correction_changes_[static_cast<std::size_t>(a)];
      double r = 0.0;
      for (std::size_t i = 0; i < n_; ++i) r += weights_[i] * da[i] * correction[i];
      right(a) = r;
      for (Eigen::Index b = 0; b <= a; ++b) {
        const auto& db = correction_changes_[static_cast<std::size_t>(b)];
        double g = 0.0;
        for (std::size_t i = 0; i < n_; ++i) g += weights_[i] * da[i] * db[i];
        gram(a, b) = gram(b, a) = g;
      }
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
