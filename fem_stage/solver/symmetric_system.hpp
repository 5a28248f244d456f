// A sparse symmetric system assembled from element matrices, factorised as L D L^T by CHOLMOD without pivoting: right
// for positive definite and for quasi-definite matrices [A, -Q; -Q^T, -D] (Vanderbei 1995), which the u-p problem
// gives. The pattern and its symbolic analysis are made once.
#pragma once

#include <cholmod.h>

#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

namespace tailrun::fem {

struct SingularSystem : std::runtime_error {
  explicit SingularSystem(int which) : std::runtime_error("singular system"), equation(which) {}
  int equation;  // where the pivot vanished
};

class SymmetricSystem {
 public:
  // `element_equations` (M, local_size): equation numbers, -1 where fixed.
  SymmetricSystem(int equations, std::vector<int> element_equations, int local_size);
  ~SymmetricSystem();
  SymmetricSystem(const SymmetricSystem&) = delete;
  SymmetricSystem& operator=(const SymmetricSystem&) = delete;

  void clear();
  void add_element(std::size_t element, const double* local);  // (local_size, local_size) row-major, symmetric
  void add_diagonal(int equation, double value);
  std::vector<double> diagonal() const;
  void factorise();                                                // throws SingularSystem
  void solve(std::span<const double> right, std::span<double> x);  // x may be the same array

  int equations() const { return equations_; }
  long factorisations() const { return factorisations_; }
  long solves() const { return solves_; }
  double factor_entries() const;  // non-zeros of L

 private:
  int equations_, local_size_;
  std::vector<int> element_equations_;
  std::vector<int> slot_;           // (M, local_size^2): place in the value array, -1 when not stored
  std::vector<int> diagonal_slot_;  // (equations)
  cholmod_common common_;
  cholmod_sparse* matrix_ = nullptr;
  cholmod_factor* factor_ = nullptr;
  cholmod_dense *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;
  long factorisations_ = 0, solves_ = 0;
};

}  // namespace tailrun::fem
