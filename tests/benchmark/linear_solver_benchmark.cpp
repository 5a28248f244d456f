// The implicit step's system by two sparse solvers: CHOLMOD's L D L^T without pivoting, which the program uses because
// the matrix is quasi-definite, and UMFPACK's LU with pivoting, without iterative refinement (IRSTEP = 0). Numeric
// factorisation and one solution, processor time of one thread, on the matrix that shaking begins with.
//
//   bench_linear_solver --benchmark_format=json fem.json coarse default fine
//
// Rows are named size/solver/part; counters: equations, non-zeros of the factors (L, or L and U), residual of the
// solution over the right side.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <omp.h>
#include <spdlog/spdlog.h>
#include <umfpack.h>

#include <Eigen/SparseCore>
#include <cmath>
#include <filesystem>
#include <memory>

#include "common/error.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/stage_freedoms.hpp"
#include "fem_stage/solver/element_forces.hpp"
#include "fem_stage/solver/symmetric_system.hpp"
#include "fem_stage/stage/geostatic.hpp"

namespace {

using namespace tailrun;
using namespace tailrun::fem;
using Vector = Eigen::VectorXd;

// The matrix of Newmark's first step, twice: as SymmetricSystem has it and in full for UMFPACK.
struct Systems {
  std::unique_ptr<SymmetricSystem> symmetric;
  Eigen::SparseMatrix<double, Eigen::ColMajor, int> full;
  Vector right;
};

Systems assemble(const FemCase& options, const std::filesystem::path& mesh_file) {
  mesh_geometry(options.mesh.geometry, {.parameters = options.mesh.parameters}, mesh_file);
  const Model model = build_model(options, mesh_file);
  MaterialPoints points = make_material_points(model);
  State state;
  run_geostatic(model, points, state);
  ElementForces forces(model, 0.0, options.shake.large_displacement);
  forces.reset(points, state);
  const auto equations = shaking_freedoms(model).number(true, true);
  const auto numbers = element_equations(model.mesh, equations);
  const double dt = options.shake.time_step, mass = 1.0 / (options.shake.beta * dt * dt),
               c1 = options.shake.gamma / (options.shake.beta * dt), flow = 1.0 / c1,
               storage = 1.0 / (c1 * options.shake.theta * dt);
  // Both blocks of the diagonal brought to one size, as Newmark does.
  double diagonal[2] = {}, local[144];
  for (std::size_t e = 0; e < model.count(); ++e) {
    forces.matrix(e, mass, 1.0, storage, flow, 1.0, local);
    for (std::size_t i = 0; i < 12; ++i)
      if (numbers[12 * e + i] >= 0) diagonal[i % 3 == freedom_p] += std::abs(local[13 * i]);
  }
  const double scale = std::exp2(std::round(0.5 * std::log2(0.5 * diagonal[0] / diagonal[1])));

  Systems out;
  out.symmetric = std::make_unique<SymmetricSystem>(equations.count, numbers, 12);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t e = 0; e < model.count(); ++e) {
    forces.matrix(e, mass, 1.0, storage, flow, scale, local);
    out.symmetric->add_element(e, local);
    for (std::size_t i = 0; i < 144; ++i) {
      const int row = numbers[12 * e + i / 12], column = numbers[12 * e + i % 12];
      if (row >= 0 && column >= 0) entries.emplace_back(row, column, local[i]);
    }
  }
  out.full.resize(equations.count, equations.count);
  out.full.setFromTriplets(entries.begin(), entries.end());
  out.full.makeCompressed();
  out.right = Vector::Random(equations.count);
  return out;
}

struct Umfpack {
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  void *symbolic = nullptr, *numeric = nullptr;
  const Eigen::SparseMatrix<double, Eigen::ColMajor, int>& matrix;

  explicit Umfpack(const Eigen::SparseMatrix<double, Eigen::ColMajor, int>& given, double strategy) : matrix(given) {
    umfpack_di_defaults(control);
    control[UMFPACK_IRSTEP] = 0;
    control[UMFPACK_STRATEGY] = strategy;
    check(umfpack_di_symbolic(matrix.rows(), matrix.cols(), matrix.outerIndexPtr(), matrix.innerIndexPtr(),
                              matrix.valuePtr(), &symbolic, control, info));
  }
  ~Umfpack() {
    umfpack_di_free_numeric(&numeric);
    umfpack_di_free_symbolic(&symbolic);
  }
  Umfpack(const Umfpack&) = delete;
  Umfpack& operator=(const Umfpack&) = delete;

  static void check(int status) {
    if (status != UMFPACK_OK) throw ComputationError(fmt::format("UMFPACK returned {}", status));
  }
  void factorise() {
    umfpack_di_free_numeric(&numeric);
    check(umfpack_di_numeric(matrix.outerIndexPtr(), matrix.innerIndexPtr(), matrix.valuePtr(), symbolic, &numeric,
                             control, info));
  }
  void solve(const Vector& right, Vector& x) {
    check(umfpack_di_solve(UMFPACK_A, matrix.outerIndexPtr(), matrix.innerIndexPtr(), matrix.valuePtr(), x.data(),
                           right.data(), numeric, control, info));
  }
};

void count(benchmark::State& run, const Systems& systems, double factor_entries, const Vector& x) {
  run.counters["equations"] = static_cast<double>(systems.right.size());
  run.counters["factor_entries"] = factor_entries;
  if (x.size() > 0) run.counters["residual"] = (systems.full * x - systems.right).norm() / systems.right.norm();
}

void add_benchmarks(const std::string& size, const std::shared_ptr<Systems>& systems) {
  const auto add = [&](const std::string& name, auto body) {
    benchmark::RegisterBenchmark((size + "/" + name).c_str(), body)->Unit(benchmark::kMillisecond);
  };
  add("cholmod_ldlt/factorise", [systems](benchmark::State& run) {
    for (auto _ : run) systems->symmetric->factorise();
    count(run, *systems, systems->symmetric->factor_entries(), {});
  });
  add("cholmod_ldlt/solve", [systems](benchmark::State& run) {
    Vector x(systems->right.size());
    systems->symmetric->factorise();
    for (auto _ : run)
      systems->symmetric->solve({systems->right.data(), static_cast<std::size_t>(x.size())},
                                {x.data(), static_cast<std::size_t>(x.size())});
    count(run, *systems, systems->symmetric->factor_entries(), x);
  });
  for (const auto& [name, strategy] : {std::pair{"umfpack_symmetric", UMFPACK_STRATEGY_SYMMETRIC},
                                       std::pair{"umfpack_unsymmetric", UMFPACK_STRATEGY_UNSYMMETRIC}}) {
    const double chosen = strategy;
    add(std::string(name) + "/factorise", [systems, chosen](benchmark::State& run) {
      Umfpack solver(systems->full, chosen);
      for (auto _ : run) solver.factorise();
      count(run, *systems, solver.info[UMFPACK_LNZ] + solver.info[UMFPACK_UNZ], {});
    });
    add(std::string(name) + "/solve", [systems, chosen](benchmark::State& run) {
      Umfpack solver(systems->full, chosen);
      solver.factorise();
      Vector x(systems->right.size());
      for (auto _ : run) solver.solve(systems->right, x);
      count(run, *systems, solver.info[UMFPACK_LNZ] + solver.info[UMFPACK_UNZ], x);
    });
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc < 3) {
    fmt::print(stderr, "bench_linear_solver [benchmark options] fem.json SIZE...\n");
    return 1;
  }
  omp_set_num_threads(1);
  spdlog::set_level(spdlog::level::warn);
  std::vector<FemCase> cases;
  for (int i = 2; i < argc; ++i) cases.push_back(read_fem_case(argv[1], argv[i]));
  const auto folder = std::filesystem::temp_directory_path() / "tailrun_bench_linear_solver";
  std::filesystem::create_directories(folder);
  for (int i = 2; i < argc; ++i)
    add_benchmarks(argv[i],
                   std::make_shared<Systems>(assemble(cases[static_cast<std::size_t>(i - 2)], folder / "mesh.msh")));
  std::filesystem::remove_all(folder);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
