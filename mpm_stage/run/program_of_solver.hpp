// The solvers that no dam's runout needs are in a program of their own beside mpm_stage (step/main_solver.cpp): a fresh
// machine has mpm_stage minutes earlier, and whoever asks for another solver waits for the other program once.
#pragma once

#include <filesystem>

namespace tailrun::mpm {

// Returns when this program has the solver that the case file asks for. Otherwise mpm_stage_all takes this process over
// with the same arguments (argv), and this does not return. Throws InputError: wrong input, or there is no
// mpm_stage_all beside this program; the message says how to build it.
void take_program_with_solver(const std::filesystem::path& case_file, char** arguments);

}  // namespace tailrun::mpm
