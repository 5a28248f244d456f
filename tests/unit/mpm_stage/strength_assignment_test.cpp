// "residual_strength" of mpm.json: strengths of the hand-over as they are, times a factor, or chosen again.
#include <doctest/doctest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "common/residual_strength/relations.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/scene/scene.hpp"
#include "tests/unit/mpm_stage/four_particles.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

namespace fs = std::filesystem;

constexpr double stresses[] = {17e3, 50e3, 100e3, 186e3};  // Pa, sigma'_v0

const std::string weber =
    R"({"model": "weber", "blow_count": 6, "percentile": 50, "factor": 0.9, "drained_cap": false})";

// Four particles: three of liquefied soil with strengths by a law, one of rock without.
ParticleSet particles_with(const std::string& law) {
  ParticleSet p = four_particles({"liquefied", "rock"});
  p.material_id = {0, 0, 0, 1};
  p.initial_vertical_effective_stress.assign(std::begin(stresses), std::end(stresses));
  p.residual_strength = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < 3; ++k) p.residual_strength[k] = 0.9 * weber_2015(6, stresses[k]);
  if (law.empty()) return p;
  p.strength_law = {0, 0, 0, -1};
  p.strength_laws = {law};
  return p;
}

Scene read(const std::string& said, const ParticleSet& p, const std::string& cohesion = R"("from_particles")") {
  const fs::path stem = fs::temp_directory_path() / ("tailrun_strengths_" + std::to_string(getpid()));
  const fs::path particles_path = stem.string() + ".h5", case_path = stem.string() + ".json";
  write_particles(particles_path, p, {});
  std::ofstream(case_path) << R"({"grid": {"cell_size": 1}, "time": {"end": 1}, "materials": {
      "liquefied": {"model": "tresca", "youngs_modulus": 1e7, "poisson_ratio": 0.3, "cohesion": )"
                           << cohesion << R"(}, "rock": {"model": "linear_elastic", "youngs_modulus": 1e7,
      "poisson_ratio": 0.3}}, "residual_strength": )"
                           << said << "}";
  const CaseFile file(case_path);
  Scene scene = read_scene(file, particles_path);
  file.finish();
  fs::remove(case_path);
  fs::remove(particles_path);
  return scene;
}

std::string message(const std::string& said, const ParticleSet& p,
                    const std::string& cohesion = R"("from_particles")") {
  try {
    read(said, p, cohesion);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("strengths are the hand-over's, times the factor") {
  const ParticleSet p = particles_with(weber);
  CHECK(read("{}", p).cohesion == p.residual_strength);
  const Scene half = read(R"({"factor": 0.5})", p);
  for (std::size_t k = 0; k < 3; ++k) CHECK(half.cohesion[k] == 0.5 * p.residual_strength[k]);
  // What frames and summary say is what was computed with.
  CHECK(half.particles.residual_strength == half.cohesion);
  REQUIRE(half.strengths.size() == 1);
  CHECK(half.strengths[0].material == "liquefied");
  CHECK(half.strengths[0].from == "hand-over");
  CHECK((*half.strengths[0].law)["blow_count"] == 6);
  CHECK(half.strengths[0].factor == 0.5);
  CHECK(half.strengths[0].found.count == 3);
  CHECK(half.strengths[0].found.stress.most == 100e3);
  CHECK(half.strengths[0].found.strength.most == half.cohesion[2]);
}

TEST_CASE("the very law of the hand-over, chosen again, gives its strengths to the last bit") {
  const ParticleSet p = particles_with(weber);
  for (const char* said : {R"({"model": "weber"})", R"({"percentile": 50})", R"({"factor": 1.0, "model": "weber"})",
                           R"({"model": "weber", "blow_count": 6, "percentile": 50, "drained_cap": false})"}) {
    const Scene again = read(said, p);
    CHECK(again.cohesion == p.residual_strength);
    CHECK(again.strengths.at(0).from == "mpm.json");
  }
}

TEST_CASE("another model acts by each particle's sigma'_v0, and the factor multiplies what it gives") {
  const Scene scene = read(R"({"model": "kramer_wang", "percentile": 33, "factor": 0.8})", particles_with(weber));
  const double z = standard_normal_quantile(0.33);
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(scene.cohesion[k] == doctest::Approx(0.8 * kramer_wang_2015(6, stresses[k], z)).epsilon(1e-14));
  CHECK(scene.cohesion[3] == 0.0);
  CHECK((*scene.strengths.at(0).law)["model"] == "kramer_wang");
}

TEST_CASE("a particles file without laws takes a model that is given in full") {
  const ParticleSet p = particles_with("");
  CHECK(read(R"({"model": "constant", "strength": 4000, "drained_cap": false})", p).cohesion[1] == 4000.0);
  CHECK(message(R"({"percentile": 33})", p).find("/residual_strength/model: missing: ") != std::string::npos);
  CHECK(message(R"({"model": "weber"})", p).find("/residual_strength/blow_count: missing") != std::string::npos);
}

TEST_CASE("what cannot be chosen is an error that says why") {
  ParticleSet p = particles_with(weber);
  CHECK(message(R"({"model": "webber"})", p).find("Did you mean 'weber'?") != std::string::npos);
  CHECK(message(R"({"modle": "weber"})", p).find("Did you mean 'model'?") != std::string::npos);
  CHECK(message(R"({"model": "weber", "percentil": 3})", p).find("Did you mean 'percentile'?") != std::string::npos);
  CHECK(message(R"({"model": "weber", "percentile": 130})", p).find("allowed is (0, 100)") != std::string::npos);
  CHECK(message(R"({"model": "weber"})", p, "5000").find("no soil whose strength could be chosen") !=
        std::string::npos);
  CHECK(message(R"({"percentile": 33})", particles_with(R"({"model": "constant", "strength": 5000})"))
            .find("the model 'constant' has no percentile") != std::string::npos);
  CHECK(message(R"({"model": "weber"})", particles_with("[1]")).find("/tailrun/strength_laws, row 0: is not a JSON") !=
        std::string::npos);
  p.initial_vertical_effective_stress.clear();
  CHECK(message(R"({"model": "weber"})", p).find("no dataset /VTKHDF/PointData/initial_vertical_effective_stress") !=
        std::string::npos);
}

TEST_CASE("soil that was handed over without a strength may get one here") {
  ParticleSet p = particles_with(weber);
  p.residual_strength.clear();
  p.strength_law = {-1, -1, -1, -1};
  CHECK(message("{}", p).find("asks for residual_strength") != std::string::npos);
  CHECK(read(R"({"model": "ratio", "ratio": 0.1})", p).cohesion[2] == doctest::Approx(10e3));
}

TEST_CASE("stresses beyond the case histories are warned about where the law is chosen") {
  ParticleSet p = particles_with(weber);
  p.initial_vertical_effective_stress[1] = 600e3;
  forget_warnings();
  read("{}", p);
  const std::size_t before = warnings().size();
  read(R"({"model": "weber"})", p);
  REQUIRE(warnings().size() > before);
  CHECK(warnings().back().find("1 of 3 points have sigma'_v0 outside") != std::string::npos);
}

TEST_CASE("bins that were materials of their own in an earlier version are told what became of them") {
  ParticleSet p = particles_with(weber);
  p.material_names = {"liquefied_2", "rock"};
  CHECK(message("{}", p).find("make the hand-over again and they are all 'liquefied'") != std::string::npos);
}
