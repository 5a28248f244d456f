// OpenMP threads that do no harm on a busy machine, and no more of them than a scene has work for. OMP_NUM_THREADS,
// OMP_WAIT_POLICY, GOMP_SPINCOUNT and --threads still rule.
#pragma once

#include <cstddef>

namespace tailrun {

// Makes threads that wait give their core away after some tenths of a millisecond. GNU's OpenMP spins for as long as
// it takes unless its environment says otherwise when it is loaded, and then two threads beside other work cost 9 to 17
// times one. So the program starts itself once more with that environment; call first in main. Where that fails, all
// goes on as it is.
void wait_patiently(char** arguments);

// --threads: what limit_threads() says no longer counts.
void set_threads(int count);

// At most one thread per `enough` pieces of work (particles, elements), unless the user has said how many.
void limit_threads(std::size_t pieces, std::size_t enough);

}  // namespace tailrun
