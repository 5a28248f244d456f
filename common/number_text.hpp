// Numbers in text files, read the same way in every locale: the decimal point is a point, exponents are E or Fortran's
// D, a leading + is allowed, and nothing is taken for a number that is one only in part.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace tailrun {

// The finite number at the front of `text`; `used` is the number of characters it takes. Nothing, with `used` 0, when
// there is none.
std::optional<double> leading_number(std::string_view text, std::size_t& used);

// The number that the whole word is.
std::optional<double> number_of(std::string_view word);

// The numbers of a line that Fortran wrote: separated by blanks, glued where a sign shows the next one
// ("0.12E-01-0.34E-01"), or glued without one in columns of equal width. Nothing when there is any doubt; `bad` is then
// the word.
std::optional<std::vector<double>> fortran_numbers(std::string_view line, std::string_view& bad);

}  // namespace tailrun
