// What every law of the list has to keep, whatever it computes. A new law is tested here without a change.
#include "mpm_stage/material/material_list.hpp"

#include <doctest/doctest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "common/error.hpp"
#include "mpm_stage/material/stress_update.hpp"
#include "mpm_stage/scene/scene.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

using Json = nlohmann::ordered_json;

// A case file that has one entry of "materials".
CaseFile case_file(const Json& entry) {
  const auto path =
      std::filesystem::temp_directory_path() / ("tailrun_material_list_" + std::to_string(getpid()) + ".json");
  std::ofstream(path) << Json{{"materials", {{"soil", entry}}}}.dump();
  CaseFile file(path);
  std::filesystem::remove(path);
  return file;
}

// Reads the entry as a scene does.
Material material_of(const Json& entry) {
  const CaseFile file = case_file(entry);
  const Material m = read_material("soil", file.root().object("materials").object("soil"), 0.5);
  file.finish();
  return m;
}

std::string message_of(const Json& entry) {
  try {
    material_of(entry);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// The entry with nothing but what the law requires: 0.3 for each key whose absence is an error (in SI units soft and
// light, but a material).
Json least_entry(const MaterialLaw& law) {
  Json entry = {{"model", law.name}};
  for (int tries = 0; tries < 30; ++tries) {
    const std::string message = message_of(entry), place = "/materials/soil/";
    if (message.empty()) return entry;
    const auto from = message.find(place), to = message.find(": missing");
    REQUIRE_MESSAGE((from != std::string::npos && to != std::string::npos), message);
    entry[message.substr(from + place.size(), to - from - place.size())] = 0.3;
  }
  FAIL("keys without end");
  return entry;
}

template <int Dim>
Particles<Dim> one_particle() {
  Particles<Dim> P;
  P.resize(1, true, true);
  P.mass[0] = 0.3;
  P.volume[0] = 1.0;
  P.strength[0] = 1e-4;
  for (int i = 0; i < 3; ++i) P.stress[i][0] = -1e-3;
  return P;
}

}  // namespace

TEST_CASE("material list: names are unique, and each finds its own law") {
  std::set<std::string> names;
  for (const MaterialLaw* law : material_laws()) {
    CAPTURE(law->name);
    CHECK(names.insert(law->name).second);
    CHECK(&law_named(law->name) == law);
    CHECK((law->read && law->set_constants));
  }
  CHECK(law_names().size() == material_laws().size());
  CHECK(names.size() >= 5);
}

TEST_CASE("material list: every file of a law is in the list, and every law in docs/mpm.md") {
  const std::filesystem::path root = TAILRUN_SOURCE_DIR;
  const auto text_of = [](const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  };
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(root / "mpm_stage/material"))
    if (text_of(entry.path()).find("extern const MaterialLaw " + entry.path().stem().string() + " =") !=
        std::string::npos)
      files.insert(entry.path().stem().string());
  const auto names = law_names();
  CHECK(files == std::set<std::string>(names.begin(), names.end()));
  const std::string page = text_of(root / "docs/mpm.md");
  for (const auto& name : names) CHECK_MESSAGE(page.find("`" + name + "`") != std::string::npos, name);
}

TEST_CASE("material list: each law reads its own keys and nothing else") {
  for (const MaterialLaw* law : material_laws()) {
    CAPTURE(law->name);
    const Json least = least_entry(*law);
    const Material m = material_of(least);
    CHECK(m.law == law);
    CHECK(m.name == "soil");
    CHECK(m.cohesion_factor == (law->residual_strength ? 0.5 : 1.0));
    CHECK((law->rigid || m.density > 0.0));
    Json more = least;
    more["strenght"] = 1.0;
    const std::string message = message_of(more);
    CHECK(message.find("unknown key 'strenght'") != std::string::npos);
    // What the least entry holds is all required.
    for (const auto& entry : least.items()) {
      const std::string& key = entry.key();
      Json less = least;
      less.erase(key);
      CHECK_MESSAGE(message_of(less).find("/" + key + ": missing") != std::string::npos, key);
    }
  }
}

TEST_CASE("material list: an unknown model is an error with the nearest name") {
  const std::string message = message_of({{"model", "mohr_coulom"}});
  CHECK(message.find("/materials/soil/model: found 'mohr_coulom', but allowed is one of linear_elastic, ") !=
        std::string::npos);
  CHECK(message.find("Did you mean 'mohr_coulomb'?") != std::string::npos);
  CHECK_THROWS_WITH_AS(law_named("treska"), doctest::Contains("Did you mean 'tresca'?"), InputError);
}

TEST_CASE("material list: constants are complete, and properties agree with each other") {
  for (const MaterialLaw* law : material_laws()) {
    CAPTURE(law->name);
    const MaterialConstants k = constants_of(material_of(least_entry(*law)), 1.0);
    REQUIRE((k.plane.update && k.plane.energy && k.solid.update && k.solid.energy));
    if (law->rigid) {
      CHECK_FALSE(law->moves);
      Particles<2> P = one_particle<2>();
      const double none = 0.0;
      CHECK_THROWS_AS(update_stress(k, P, 0, 1, &none, 1e-3), ComputationError);
      continue;
    }
    CHECK(k.wave_modulus() > 0.0);
    CHECK(k.bulk > 0.0);
    // Strength that does not follow the mean stress is what makes relaxing it safe.
    CHECK((!k.phi_zero || k.flows));
    CHECK(std::isfinite(k.explicit_viscosity));
  }
}

TEST_CASE("material list: plane strain is the three-dimensional law with nothing along z") {
  for (const MaterialLaw* law : material_laws()) {
    if (law->rigid) continue;
    CAPTURE(law->name);
    const MaterialConstants k = constants_of(material_of(least_entry(*law)), 1.0);
    Particles<2> P = one_particle<2>();
    Particles<3> Q = one_particle<3>();
    // Twenty steps of shear with some compression, which take soil well past its strength.
    const double gxx = -2e-4, gxy = 1e-3, gyx = -4e-4, gyy = 1e-4, trace = gxx + gyy, dt = 1e-3;
    double lost = 0.0;
    for (int step = 0; step < 20; ++step) {
      P.gradient[0][0] = Q.gradient[0][0] = gxx;
      P.gradient[1][0] = Q.gradient[1][0] = gxy;
      P.gradient[2][0] = Q.gradient[3][0] = gyx;
      P.gradient[3][0] = Q.gradient[4][0] = gyy;
      const StressWork plane = update_stress(k, P, 0, 1, &trace, dt);
      const StressWork solid = update_stress(k, Q, 0, 1, &trace, dt);
      CHECK(plane.dissipated >= 0.0);
      CHECK(solid.dissipated == doctest::Approx(plane.dissipated).epsilon(1e-5));
      lost += plane.dissipated;
    }
    const double size = std::fabs(P.stress[0][0]) + std::fabs(P.stress[3][0]);
    CHECK(size > 0.0);
    for (int i = 0; i < 4; ++i) CHECK(Q.stress[i][0] == doctest::Approx(P.stress[i][0]).epsilon(1e-6).scale(size));
    for (int i = 4; i < 6; ++i) CHECK(std::fabs(Q.stress[i][0]) <= 1e-9 * size);
    CHECK(Q.volume[0] == doctest::Approx(P.volume[0]).epsilon(1e-9));
    CHECK(Q.plastic_strain[0] == doctest::Approx(P.plastic_strain[0]).epsilon(1e-6));
    const double energy = elastic_energy(k, P, 0, 1);
    CHECK(energy >= 0.0);
    CHECK(elastic_energy(k, Q, 0, 1) == doctest::Approx(energy).epsilon(1e-6));
    if (law->returned) CHECK(lost > 0.0);
  }
}
