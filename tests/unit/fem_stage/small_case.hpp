// A case of a 4 x 4 m rectangle that nothing is wrong with, for tests that change one thing of it.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "common/error.hpp"

namespace tailrun::fem {

inline const std::filesystem::path folder = std::filesystem::temp_directory_path();

inline std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline std::filesystem::path case_file(const std::string& shake, const std::string& more = "") {
  std::ofstream(folder / "tailrun_requests.json") << fmt::format(
      R"({{ "mesh": {{ "rectangle": {{ "width": 4, "height": 4, "columns": 4, "rows": 4, "region": "s" }} }},
      "materials": {{ "s": {{ "model": "linear_elastic", "shear_modulus": 1e7, "density": 1900 }} }},
      "regions": {{ "s": {{ "material": "s", "permeability": [1e-6] }} }},
      "boundaries": {{ "base": {{ "line": "bottom", "type": "rigid" }}, "roller_lines": ["left", "right"] }},
      {} "shake": {{ {} }} }})",
      more, shake);
  return folder / "tailrun_requests.json";
}

}  // namespace tailrun::fem
