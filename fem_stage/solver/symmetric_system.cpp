#include "fem_stage/solver/symmetric_system.hpp"

#include <algorithm>
#include <cmath>

namespace tailrun::fem {

SymmetricSystem::SymmetricSystem(int equations, std::vector<int> element_equations, int local_size)
    : equations_(equations), local_size_(local_size), element_equations_(std::move(element_equations)) {
  cholmod_start(&common_);
  common_.supernodal = CHOLMOD_SIMPLICIAL;  // L D L^T, which an indefinite matrix needs
  common_.final_ll = 0;
  common_.print = 0;

  // Pattern of the lower triangle, column by column.
  const std::size_t k = static_cast<std::size_t>(local_size), elements = element_equations_.size() / k;
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(equations));
  for (int i = 0; i < equations; ++i) rows[static_cast<std::size_t>(i)].push_back(i);
  for (std::size_t e = 0; e < elements; ++e)
    for (std::size_t a = 0; a < k; ++a)
      for (std::size_t b = 0; b < k; ++b) {
        const int i = element_equations_[k * e + a], j = element_equations_[k * e + b];
        if (j >= 0 && i > j) rows[static_cast<std::size_t>(j)].push_back(i);
      }
  std::size_t entries = 0;
  for (auto& column : rows) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    entries += column.size();
  }
  const auto n = static_cast<std::size_t>(equations);
  matrix_ = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, &common_);
  int* start = static_cast<int*>(matrix_->p);
  int* row = static_cast<int*>(matrix_->i);
  start[0] = 0;
  for (std::size_t j = 0; j < n; ++j) {
    std::copy(rows[j].begin(), rows[j].end(), row + start[j]);
    start[j + 1] = start[j] + static_cast<int>(rows[j].size());
    diagonal_slot_.push_back(start[j]);
  }
  // A pair with i == j but a != b (tied freedoms) counts twice, once from each side, as it must.
  slot_.assign(elements * k * k, -1);
  for (std::size_t e = 0; e < elements; ++e)
    for (std::size_t a = 0; a < k; ++a)
      for (std::size_t b = 0; b < k; ++b) {
        const int i = element_equations_[k * e + a], j = element_equations_[k * e + b];
        if (j < 0 || i < j) continue;
        slot_[k * (k * e + a) + b] = static_cast<int>(std::lower_bound(row + start[j], row + start[j + 1], i) - row);
      }
  clear();
  factor_ = cholmod_analyze(matrix_, &common_);
}

SymmetricSystem::~SymmetricSystem() {
  cholmod_free_dense(&x_, &common_);
  cholmod_free_dense(&y_, &common_);
  cholmod_free_dense(&e_, &common_);
  cholmod_free_factor(&factor_, &common_);
  cholmod_free_sparse(&matrix_, &common_);
  cholmod_finish(&common_);
}

void SymmetricSystem::clear() {
  double* values = static_cast<double*>(matrix_->x);
  std::fill(values, values + matrix_->nzmax, 0.0);
}

void SymmetricSystem::add_element(std::size_t element, const double* local) {
  double* values = static_cast<double*>(matrix_->x);
  const std::size_t size = static_cast<std::size_t>(local_size_ * local_size_);
  const int* slot = &slot_[size * element];
  for (std::size_t i = 0; i < size; ++i)
    if (slot[i] >= 0) values[slot[i]] += local[i];
}

void SymmetricSystem::add_diagonal(int equation, double value) {
  static_cast<double*>(matrix_->x)[diagonal_slot_[static_cast<std::size_t>(equation)]] += value;
}

std::vector<double> SymmetricSystem::diagonal() const {
  std::vector<double> values;
  for (const int slot : diagonal_slot_) values.push_back(static_cast<double*>(matrix_->x)[slot]);
  return values;
}

void SymmetricSystem::factorise() {
  ++factorisations_;
  cholmod_factorize(matrix_, factor_, &common_);
  const int* order = static_cast<int*>(factor_->Perm);
  if (factor_->minor < factor_->n) throw SingularSystem(order[factor_->minor]);
  // Rounding hides an exact zero: a pivot that lost (nearly) all digits of its diagonal entry is as good as none.
  const double *values = static_cast<double*>(matrix_->x), *factor = static_cast<double*>(factor_->x);
  const int* start = static_cast<int*>(factor_->p);
  for (std::size_t j = 0; j < factor_->n; ++j) {
    const double pivot = factor[start[j]];
    const double entry = values[diagonal_slot_[static_cast<std::size_t>(order[j])]];
    if (!(std::abs(pivot) > 1e-14 * std::abs(entry))) throw SingularSystem(order[j]);
  }
}

void SymmetricSystem::solve(std::span<const double> right, std::span<double> x) {
  ++solves_;
  cholmod_dense b{};
  b.nrow = b.d = b.nzmax = static_cast<std::size_t>(equations_);
  b.ncol = 1;
  b.x = const_cast<double*>(right.data());  // read only; the library's type has no const
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, factor_, &b, nullptr, &x_, nullptr, &y_, &e_, &common_);
  std::copy_n(static_cast<double*>(x_->x), equations_, x.data());
}

double SymmetricSystem::factor_entries() const {
  return common_.lnz;
}

}  // namespace tailrun::fem
