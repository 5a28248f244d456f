// What several readers of mpm.json share.
#pragma once

#include <string>

#include "common/case_file.hpp"

namespace tailrun::mpm {

// A name that becomes part of a column's name in a CSV file: letters, digits, _ and - (narrower than
// common/plain_names.hpp, since units follow behind an underscore). Throws InputError at `key`.
void require_column_word(const CaseNode& node, const std::string& key, const std::string& name);

// A key that belongs to one choice: an InputError when it is there although `key` of `node` is `found`.
// `needs` are the choices that take it, for the message: "'flip'".
void refuse_with_other_choice(const CaseNode& node, const std::string& misplaced, const std::string& key,
                              const std::string& found, const std::string& needs);

// A coefficient of friction that looks like an angle in degrees: a warning. `on` says whose it is.
void check_friction(const CaseNode& node, const std::string& key, double friction, const std::string& on);

}  // namespace tailrun::mpm
