#include "common/patient_threads.hpp"

#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace tailrun {
namespace {

bool chosen_by_user = false;

}  // namespace

void wait_patiently(char** arguments) {
  if (std::getenv("GOMP_SPINCOUNT") || std::getenv("OMP_WAIT_POLICY")) return;
  setenv("GOMP_SPINCOUNT", "10000", 1);
  execv("/proc/self/exe", arguments);
}

void set_threads(int count) {
  chosen_by_user = true;
  omp_set_num_threads(count);
}

void limit_threads(std::size_t pieces, std::size_t enough) {
  if (chosen_by_user || std::getenv("OMP_NUM_THREADS")) return;
  const auto most = std::max<std::size_t>(1, pieces / enough);
  if (most < static_cast<std::size_t>(omp_get_max_threads())) omp_set_num_threads(static_cast<int>(most));
}

}  // namespace tailrun
