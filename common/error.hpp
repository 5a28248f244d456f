// The two ways in which a run can end badly, and the exit status that each one has.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tailrun {

constexpr int exit_done = 0;
constexpr int exit_bad_input = 1;
constexpr int exit_computation_failed = 2;

// What the user gave cannot be used. The message names the file, the place in it, what was found and what is allowed.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The input was sound but the computation could not go on. The last good state has been saved before this is thrown.
struct ComputationError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Stopped from outside, for instance by a signal; everything needed to go on is on disk.
struct InterruptedError : ComputationError {
  using ComputationError::ComputationError;
};

// The candidate nearest to `word` (Damerau-Levenshtein, letter case aside); empty when none is near enough to be meant.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

// " Did you mean 'x'?" or an empty string.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

// "a, b, c" for messages.
std::string joined(const std::vector<std::string>& words);

}  // namespace tailrun
