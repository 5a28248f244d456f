// A scene that nothing is wrong with, for tests that change one thing of it: a block of soil, 4 x 2 m, on flat ground.
#pragma once

#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/output/place_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

using Json = nlohmann::ordered_json;

inline Json small_scene() {
  return Json::parse(R"({
    "grid": {"cell_size": 0.5}, "time": {"end": 1},
    "materials": {"soil": {"model": "mohr_coulomb", "density": 2000, "youngs_modulus": 1e7, "poisson_ratio": 0.3,
                           "cohesion": 1000, "friction_angle": 30}},
    "particles": [{"shape": "box", "low": [0, 0], "high": [4, 2], "material": "soil"}],
    "terrain": [{"points": [[-50, 0], [10, 0], [50, 0]], "friction": 0.5}]})");
}

// `changes` in the place of what small_scene() has, member by member (RFC 7396).
inline Json small_scene_with(const std::string& changes) {
  Json scene = small_scene();
  scene.merge_patch(Json::parse(changes));
  return scene;
}

// What the program says to a scene.
struct Answer {
  std::string refusal;  // empty when it was read
  std::vector<std::string> warnings;

  bool silent() const { return refusal.empty() && warnings.empty(); }
  bool warns(const std::string& part) const {
    return refusal.empty() && std::any_of(warnings.begin(), warnings.end(), [&part](const std::string& text) {
             return text.find(part) != std::string::npos;
           });
  }
  bool refuses(const std::string& part) const { return refusal.find(part) != std::string::npos; }
  std::string text() const {
    std::string all = refusal;
    for (const auto& warning : warnings) all += "\n" + warning;
    return all;
  }
};

inline Answer answer_to(const Json& json, const std::filesystem::path& particles = {}, const std::string& size = {}) {
  const auto path =
      std::filesystem::temp_directory_path() / ("tailrun_small_scene_" + std::to_string(getpid()) + ".json");
  std::ofstream(path) << json.dump();
  forget_warnings();
  Answer answer;
  try {
    const CaseFile file(path);
    const Scene scene = read_scene(file, particles, size);
    file.finish();
    check_output_places(file.root(), scene);
  } catch (const InputError& error) {
    answer.refusal = error.what();
  }
  answer.warnings = warnings();
  forget_warnings();
  std::filesystem::remove(path);
  return answer;
}

inline Answer answer_with(const std::string& changes) {
  return answer_to(small_scene_with(changes));
}

}  // namespace tailrun::mpm
