#include "mpm_stage/run/program_of_solver.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/case_file.hpp"
#include "common/error.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

void take_program_with_solver(const std::filesystem::path& case_file, char** arguments) {
  const CaseFile file(case_file);
  const int dimension = read_dimension(file.root());
  SolverOptions options;
  read_scheme(file.root(), options);
  if (has_solver(dimension, options)) return;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::filesystem::path program = folder / "mpm_stage_all";
  execv(program.c_str(), arguments);
  const std::string reason =
      errno == ENOENT ? "is not there" : fmt::format("cannot be started ({})", std::strerror(errno));
  const char* key = dimension == 3                          ? "dimension"
                    : options.shape != ShapeName::quadratic ? "scheme/shape_function"
                                                            : "scheme/transfer";
  file.root().fail(key, fmt::format("asks for a solver that is built apart: this program has the one of dimension 2, "
                                    "shape_function 'quadratic' and "
                                    "transfer 'aflip'; all others are in {}, which {}. Build it, once: "
                                    "make -f Makefile.cases solvers (or cmake --build {} --target mpm_stage_all)",
                                    program.string(), reason, folder.parent_path().string()));
}

}  // namespace tailrun::mpm
