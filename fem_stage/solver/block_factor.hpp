// Factor L D L^T of a sparse symmetric matrix, without pivoting, in dense blocks (supernodes; Ashcraft & Grimes 1989):
// columns whose entries lie in the same rows are one block, so that the work is that of dense kernels. CHOLMOD finds
// the order and the blocks; its own numerical factorisation in blocks is that of L L^T, which takes positive definite
// matrices only, and its L D L^T goes column by column: five times slower here, and twice as slow to solve with.
//
// Branches of the elimination tree are independent of each other and are shared out between threads. Which branches
// there are does not depend on the number of threads, and what they add to the trunk is summed up in their order: the
// bits are the same for any number.
#pragma once

#include <cholmod.h>

#include <span>
#include <vector>

namespace tailrun::fem {

class BlockFactor {
 public:
  // `analysis`: of the matrix below, supernodal (cholmod_analyze with CHOLMOD_SUPERNODAL). `start`, `row`: lower
  // triangle of the matrix, column by column.
  BlockFactor(const cholmod_factor& analysis, std::span<const int> start, std::span<const int> row);

  // `values` of the matrix, as `row`. Returns the equation whose pivot is zero, or has lost nearly all digits of its
  // diagonal entry (less than 1e-14 of it is left); -1 if there is none.
  int factorise(std::span<const double> values);
  // x = A^-1 right; may be the same array.
  void solve(std::span<const double> right, std::span<double> x);

  double entries() const { return entries_; }  // stored in L

 private:
  // Columns first .. first + columns of the ordered matrix; `rows` of them all, the diagonal block's first.
  struct Block {
    int first = 0, columns = 0, rows = 0;
    std::size_t row_list = 0, values = 0;  // where its rows and its values (rows x columns, column-major) begin
    std::size_t updates = 0, updates_end = 0;
  };
  // What block `from` subtracts: its rows begin .. end are columns of the other block.
  struct Update {
    int from, begin, end;
  };
  struct Scratch;

  void plan_branches(const std::vector<int>& parent);
  void factorise_block(int which, Scratch& scratch);
  void forward(const Block& block, double* line);
  void backward(const Block& block, double* line);  // `line`: room for most_rows_
  bool eliminate(const Block& block);

  int equations_ = 0, most_rows_ = 0;
  double entries_ = 0.0;
  std::vector<int> order_;  // equation of each column of the ordered matrix
  std::vector<Block> blocks_;
  std::vector<int> row_list_;  // of the ordered matrix
  std::vector<int> target_;    // as row_list_, where solve() adds up: past equations_, a branch's share of the trunk's
  std::vector<Update> updates_;             // by the block that they go to
  std::vector<std::size_t> place_;          // in values_, of each entry of the matrix
  std::vector<std::size_t> diagonal_;       // in the matrix's values, by column of the ordered matrix
  std::vector<std::vector<int>> branches_;  // blocks of each, in order; largest work first
  std::vector<int> trunk_;                  // blocks above all branches
  std::vector<int> share_row_;              // of the ordered matrix: row of each entry past equations_
  std::vector<double> values_, pivots_, work_;
  std::vector<char> bad_;  // by block: a pivot vanished
};

}  // namespace tailrun::fem
