#include "fem_stage/solver/block_factor.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace tailrun::fem {
namespace {

using Matrix = Eigen::MatrixXd;
using Strided = Eigen::OuterStride<>;
using View = Eigen::Map<Matrix, 0, Strided>;
using Values = Eigen::Map<Eigen::VectorXd>;

constexpr int panel_width = 24;     // columns that are eliminated before the rest of a block is updated
constexpr int most_branches = 32;   // enough to keep any number of threads in question busy
constexpr long least_work = 20000;  // products; less is not worth a thread of its own

}  // namespace

struct BlockFactor::Scratch {
  std::vector<int> local;  // row of the ordered matrix to row of the block
  Matrix product, scaled;
};

BlockFactor::BlockFactor(const cholmod_factor& analysis, std::span<const int> start, std::span<const int> row)
    : equations_(static_cast<int>(analysis.n)) {
  const auto n = analysis.n, count = analysis.nsuper;
  const auto* order = static_cast<const int*>(analysis.Perm);
  const auto *first = static_cast<const int*>(analysis.super), *list = static_cast<const int*>(analysis.pi),
             *rows = static_cast<const int*>(analysis.s);
  order_.assign(order, order + n);
  row_list_.assign(rows, rows + list[count]);
  std::vector<int> block_of(n);
  std::size_t values = 0;
  for (std::size_t s = 0; s < count; ++s) {
    const int columns = first[s + 1] - first[s], height = list[s + 1] - list[s];
    blocks_.push_back({first[s], columns, height, static_cast<std::size_t>(list[s]), values, 0, 0});
    values += static_cast<std::size_t>(columns) * static_cast<std::size_t>(height);
    most_rows_ = std::max(most_rows_, height);
    std::fill_n(block_of.begin() + first[s], columns, static_cast<int>(s));
  }
  values_.resize(values);
  pivots_.resize(n);
  entries_ = static_cast<double>(values);
  bad_.assign(count, 0);

  // Whom each block updates, by stretches of its rows; and its parent, the first of them.
  std::vector<int> parent(count, -1);
  std::vector<std::vector<Update>> to(count);
  for (std::size_t s = 0; s < count; ++s) {
    const Block& block = blocks_[s];
    const int* at = &row_list_[block.row_list];
    for (int k = block.columns; k < block.rows;) {
      const int target = block_of[static_cast<std::size_t>(at[k])];
      int end = k + 1;
      while (end < block.rows && block_of[static_cast<std::size_t>(at[end])] == target) ++end;
      to[static_cast<std::size_t>(target)].push_back({static_cast<int>(s), k, end});
      if (parent[s] < 0) parent[s] = target;
      k = end;
    }
  }
  for (std::size_t s = 0; s < count; ++s) {
    blocks_[s].updates = updates_.size();
    updates_.insert(updates_.end(), to[s].begin(), to[s].end());
    blocks_[s].updates_end = updates_.size();
  }

  std::vector<int> column_of(n);
  for (std::size_t k = 0; k < n; ++k) column_of[static_cast<std::size_t>(order_[k])] = static_cast<int>(k);
  place_.resize(row.size());
  diagonal_.resize(n);
  for (std::size_t j = 0; j < n; ++j)
    for (auto k = static_cast<std::size_t>(start[j]); k < static_cast<std::size_t>(start[j + 1]); ++k) {
      const int a = column_of[j], b = column_of[static_cast<std::size_t>(row[k])];
      const int column = std::min(a, b), line = std::max(a, b);
      const Block& block = blocks_[static_cast<std::size_t>(block_of[static_cast<std::size_t>(column)])];
      const auto begin = row_list_.begin() + static_cast<std::ptrdiff_t>(block.row_list);
      const auto local = std::lower_bound(begin, begin + block.rows, line) - begin;
      place_[k] = block.values + static_cast<std::size_t>(local) +
                  static_cast<std::size_t>(block.rows) * static_cast<std::size_t>(column - block.first);
      if (column == line) diagonal_[static_cast<std::size_t>(column)] = k;
    }
  plan_branches(parent);
}

// Cuts the tree from its roots downwards until no branch has more than a sixteenth of the work.
void BlockFactor::plan_branches(const std::vector<int>& parent) {
  const std::size_t count = blocks_.size();
  std::vector<long> work(count);
  std::vector<std::vector<int>> children(count);
  std::vector<int> roots;
  for (std::size_t s = 0; s < count; ++s) {  // children come before their parents
    work[s] += static_cast<long>(blocks_[s].rows) * blocks_[s].rows * blocks_[s].columns;
    if (parent[s] < 0) {
      roots.push_back(static_cast<int>(s));
    } else {
      work[static_cast<std::size_t>(parent[s])] += work[s];
      children[static_cast<std::size_t>(parent[s])].push_back(static_cast<int>(s));
    }
  }
  const auto work_of = [&](int s) { return work[static_cast<std::size_t>(s)]; };
  const long total = std::transform_reduce(roots.begin(), roots.end(), 0L, std::plus<>(), work_of);
  const long enough = std::max(least_work, total / 16);
  std::vector<char> in_trunk(count, 0);
  while (!roots.empty()) {
    const auto largest =
        std::max_element(roots.begin(), roots.end(), [&](int a, int b) { return work_of(a) < work_of(b); });
    if (work_of(*largest) <= enough || roots.size() >= most_branches) break;
    const int cut = *largest;
    roots.erase(largest);
    in_trunk[static_cast<std::size_t>(cut)] = 1;
    roots.insert(roots.end(), children[static_cast<std::size_t>(cut)].begin(),
                 children[static_cast<std::size_t>(cut)].end());
  }
  std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) { return work_of(a) > work_of(b); });
  std::vector<int> branch_of(count, -1);
  branches_.resize(roots.size());
  for (std::size_t k = 0; k < roots.size(); ++k) branch_of[static_cast<std::size_t>(roots[k])] = static_cast<int>(k);
  for (std::size_t s = count; s-- > 0;)
    if (branch_of[s] < 0 && parent[s] >= 0 && !in_trunk[s])
      branch_of[s] = branch_of[static_cast<std::size_t>(parent[s])];
  for (std::size_t s = 0; s < count; ++s)
    (branch_of[s] < 0 ? trunk_ : branches_[static_cast<std::size_t>(branch_of[s])]).push_back(static_cast<int>(s));

  // Whatever a branch adds to the trunk lies in the rows below its root block (Liu 1990): its share.
  target_ = row_list_;
  std::vector<int> share(static_cast<std::size_t>(equations_), -1);
  for (std::size_t k = 0; k < roots.size(); ++k) {
    const Block& root = blocks_[static_cast<std::size_t>(roots[k])];
    const int* outside = &row_list_[root.row_list + static_cast<std::size_t>(root.columns)];
    for (int i = 0; i < root.rows - root.columns; ++i) {
      share[static_cast<std::size_t>(outside[i])] = equations_ + static_cast<int>(share_row_.size());
      share_row_.push_back(outside[i]);
    }
    const int last = root.first + root.columns;
    for (const int s : branches_[k]) {
      const Block& block = blocks_[static_cast<std::size_t>(s)];
      for (int i = block.columns; i < block.rows; ++i) {
        int& line = target_[block.row_list + static_cast<std::size_t>(i)];
        if (line >= last) line = share[static_cast<std::size_t>(line)];
      }
    }
  }
  work_.assign(static_cast<std::size_t>(equations_) + share_row_.size(), 0.0);
}

// L D L^T of the block's columns, whose diagonal block comes first; panels of columns, then the rest of the block.
bool BlockFactor::eliminate(const Block& block) {
  View a(&values_[block.values], block.rows, block.columns, Strided(block.rows));
  double* d = &pivots_[static_cast<std::size_t>(block.first)];
  bool good = true;
  for (int begin = 0; begin < block.columns; begin += panel_width) {
    const int end = std::min(begin + panel_width, block.columns);
    for (int j = begin; j < end; ++j) {
      d[j] = a(j, j);
      if (d[j] == 0.0 || !std::isfinite(d[j])) good = false;
      const int below = block.rows - j - 1;
      const double inverse = 1.0 / d[j];
      for (int k = j + 1; k < end; ++k)
        a.col(k).tail(block.rows - k).noalias() -= (a(k, j) * inverse) * a.col(j).tail(block.rows - k);
      a.col(j).tail(below) *= inverse;
    }
    const int rest = block.columns - end;
    if (rest == 0) break;
    const Matrix scaled = a.block(end, begin, rest, end - begin) * Values(d + begin, end - begin).asDiagonal();
    a.block(end, end, block.rows - end, rest).noalias() -=
        a.block(end, begin, block.rows - end, end - begin) * scaled.transpose();
  }
  return good;
}

void BlockFactor::factorise_block(int which, Scratch& scratch) {
  const Block& block = blocks_[static_cast<std::size_t>(which)];
  View mine(&values_[block.values], block.rows, block.columns, Strided(block.rows));
  if (block.updates < block.updates_end)
    for (int i = 0; i < block.rows; ++i)
      scratch.local[static_cast<std::size_t>(row_list_[block.row_list + static_cast<std::size_t>(i)])] = i;
  for (std::size_t u = block.updates; u < block.updates_end; ++u) {
    const Update& update = updates_[u];
    const Block& from = blocks_[static_cast<std::size_t>(update.from)];
    const View theirs(&values_[from.values], from.rows, from.columns, Strided(from.rows));
    const int width = update.end - update.begin, height = from.rows - update.begin;
    scratch.scaled.noalias() = theirs.middleRows(update.begin, width) *
                               Values(&pivots_[static_cast<std::size_t>(from.first)], from.columns).asDiagonal();
    scratch.product.noalias() = theirs.bottomRows(height) * scratch.scaled.transpose();
    const int* rows = &row_list_[from.row_list + static_cast<std::size_t>(update.begin)];
    for (int j = 0; j < width; ++j) {
      double* column = &mine(0, rows[j] - block.first);
      const double* product = &scratch.product(0, j);
      for (int i = j; i < height; ++i) column[scratch.local[static_cast<std::size_t>(rows[i])]] -= product[i];
    }
  }
  bad_[static_cast<std::size_t>(which)] = !eliminate(block);
}

int BlockFactor::factorise(std::span<const double> values) {
#pragma omp parallel
  {
#pragma omp for schedule(static)
    for (std::size_t k = 0; k < values_.size(); ++k) values_[k] = 0.0;
#pragma omp for schedule(static)
    for (std::size_t k = 0; k < place_.size(); ++k) values_[place_[k]] = values[k];
    Scratch scratch{std::vector<int>(static_cast<std::size_t>(equations_)), {}, {}};
#pragma omp for schedule(dynamic, 1)
    for (std::size_t k = 0; k < branches_.size(); ++k)
      for (const int s : branches_[k]) factorise_block(s, scratch);
#pragma omp single
    for (const int s : trunk_) factorise_block(s, scratch);
  }
  // Rounding hides an exact zero: a pivot that lost (nearly) all digits of its diagonal entry is as good as none.
  for (std::size_t j = 0; j < order_.size(); ++j)
    if (!(std::abs(pivots_[j]) > 1e-14 * std::abs(values[diagonal_[j]])) || !std::isfinite(pivots_[j]))
      return order_[j];
  return -1;
}

// L y = b for the block's columns, and what they take off the rows below. Four columns at a time, because blocks are
// small and each pass over the rows costs as much as its arithmetic.
void BlockFactor::forward(const Block& block, double* line) {
  const int columns = block.columns, rows = block.rows;
  double* mine = &work_[static_cast<std::size_t>(block.first)];
  std::copy_n(mine, columns, line);
  std::fill(line + columns, line + rows, 0.0);
  const double* a = &values_[block.values];
  int j = 0;
  for (; j + 4 <= columns; j += 4, a += 4 * rows) {
    const double *a0 = a, *a1 = a0 + rows, *a2 = a1 + rows, *a3 = a2 + rows;
    const double y0 = line[j];
    const double y1 = line[j + 1] - a0[j + 1] * y0;
    const double y2 = line[j + 2] - a0[j + 2] * y0 - a1[j + 2] * y1;
    const double y3 = line[j + 3] - a0[j + 3] * y0 - a1[j + 3] * y1 - a2[j + 3] * y2;
    line[j + 1] = y1;
    line[j + 2] = y2;
    line[j + 3] = y3;
#pragma omp simd
    for (int i = j + 4; i < rows; ++i) line[i] -= a0[i] * y0 + a1[i] * y1 + a2[i] * y2 + a3[i] * y3;
  }
  for (; j < columns; ++j, a += rows) {
    const double y = line[j];
#pragma omp simd
    for (int i = j + 1; i < rows; ++i) line[i] -= a[i] * y;
  }
  std::copy_n(line, columns, mine);
  const int* to = &target_[block.row_list];
  for (int i = columns; i < rows; ++i) work_[static_cast<std::size_t>(to[i])] += line[i];
}

// D L^T x = y for the block's columns, the rows below being known.
void BlockFactor::backward(const Block& block, double* line) {
  const int columns = block.columns, rows = block.rows;
  double* mine = &work_[static_cast<std::size_t>(block.first)];
  const int* from = &row_list_[block.row_list];
  for (int i = columns; i < rows; ++i) line[i] = work_[static_cast<std::size_t>(from[i])];
  const double* d = &pivots_[static_cast<std::size_t>(block.first)];
  const double* a = &values_[block.values] + static_cast<std::ptrdiff_t>(columns) * rows;
  int j = columns;
  for (; j % 4 != 0; --j) {
    a -= rows;
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int i = j; i < rows; ++i) sum += a[i] * line[i];
    line[j - 1] = mine[j - 1] / d[j - 1] - sum;
  }
  for (; j > 0; j -= 4) {
    a -= 4 * rows;
    const double *a0 = a, *a1 = a0 + rows, *a2 = a1 + rows, *a3 = a2 + rows;
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
#pragma omp simd reduction(+ : s0, s1, s2, s3)
    for (int i = j; i < rows; ++i) {
      s0 += a0[i] * line[i];
      s1 += a1[i] * line[i];
      s2 += a2[i] * line[i];
      s3 += a3[i] * line[i];
    }
    const double x3 = mine[j - 1] / d[j - 1] - s3;
    const double x2 = mine[j - 2] / d[j - 2] - s2 - a2[j - 1] * x3;
    const double x1 = mine[j - 3] / d[j - 3] - s1 - a1[j - 1] * x3 - a1[j - 2] * x2;
    line[j - 4] = mine[j - 4] / d[j - 4] - s0 - a0[j - 1] * x3 - a0[j - 2] * x2 - a0[j - 3] * x1;
    line[j - 3] = x1;
    line[j - 2] = x2;
    line[j - 1] = x3;
  }
  std::copy_n(line, columns, mine);
}

void BlockFactor::solve(std::span<const double> right, std::span<double> x) {
  const auto n = static_cast<std::size_t>(equations_);
  for (std::size_t k = 0; k < n; ++k) work_[k] = right[static_cast<std::size_t>(order_[k])];
  std::fill(work_.begin() + equations_, work_.end(), 0.0);
  // A small system is solved before another thread has woken up.
#pragma omp parallel if (entries_ > 2e5)
  {
    std::vector<double> scratch(static_cast<std::size_t>(most_rows_));
    double* line = scratch.data();
#pragma omp for schedule(dynamic, 1)
    for (std::size_t k = 0; k < branches_.size(); ++k)
      for (const int s : branches_[k]) forward(blocks_[static_cast<std::size_t>(s)], line);
#pragma omp single
    {
      for (std::size_t k = 0; k < share_row_.size(); ++k)
        work_[static_cast<std::size_t>(share_row_[k])] += work_[n + k];
      for (const int s : trunk_) forward(blocks_[static_cast<std::size_t>(s)], line);
      for (std::size_t k = trunk_.size(); k-- > 0;) backward(blocks_[static_cast<std::size_t>(trunk_[k])], line);
    }
#pragma omp for schedule(dynamic, 1)
    for (std::size_t k = 0; k < branches_.size(); ++k)
      for (std::size_t b = branches_[k].size(); b-- > 0;)
        backward(blocks_[static_cast<std::size_t>(branches_[k][b])], line);
  }
  for (std::size_t k = 0; k < n; ++k) x[static_cast<std::size_t>(order_[k])] = work_[k];
}

}  // namespace tailrun::fem
