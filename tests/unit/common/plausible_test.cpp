// What soil cannot be is said, with the likely unit; what it can be is not.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <fstream>

#include "common/error.hpp"
#include "common/plausible_material.hpp"
#include "common/plausible_state.hpp"
#include "common/residual_strength/strength_law.hpp"
#include "common/warnings.hpp"

using namespace tailrun;

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The error, or else the warnings, of an action.
std::string said(const std::function<void()>& action) {
  forget_warnings();
  try {
    action();
  } catch (const InputError& error) {
    return std::string("error: ") + error.what();
  }
  std::string text;
  for (const auto& warning : warnings()) text += warning + "\n";
  return text;
}

std::string said_of_material(const std::string& keys, const MaterialSetting& setting = {}) {
  const auto path = std::filesystem::temp_directory_path() / "tailrun_plausible.json";
  std::ofstream(path) << "{\"materials\": {\"clay\": {" << keys << "}}}";
  const CaseFile file(path);
  return said([&] { check_material(file.root().object("materials").object("clay"), setting); });
}

// A column of soil, 10 m of 2 m high elements, water table at its surface.
Snapshot column(double stress_factor = 1.0, double pressure_factor = 1.0) {
  Snapshot s;
  s.region_names = {"soil"};
  s.phreatic_line = {-1, 10, 2, 10};
  for (int i = 0; i <= 5; ++i) s.position.insert(s.position.end(), {0.0, 2.0 * i, 1.0, 2.0 * i});
  for (std::int64_t e = 0; e < 5; ++e) {
    s.quads.insert(s.quads.end(), {2 * e, 2 * e + 1, 2 * e + 3, 2 * e + 2});
    const double depth = 9.0 - 2.0 * static_cast<double>(e);
    s.region_id.push_back(0);
    s.density.push_back(2000.0);
    s.depth.push_back(depth);
    s.initial_vertical_effective_stress.push_back(stress_factor * 1000.0 * 9.81 * depth);
    s.initial_pore_pressure.push_back(pressure_factor * 1000.0 * 9.81 * depth);
    s.excess_pore_pressure_ratio.push_back(0.5);
  }
  return s;
}

std::string said_of(const Snapshot& snapshot) {
  return said([&] { check_state(columns_of(snapshot, "s.h5", {}, true)); });
}

}  // namespace

TEST_CASE("materials in another unit") {
  MaterialSetting wet;
  wet.has_water = true;
  CHECK(said_of_material(R"("density": 1900, "cohesion": 15000, "shear_modulus": 4e7, "friction_angle": 33)", wet) ==
        "");
  CHECK(said_of_material(R"("density": 1900, "cohesion": 0, "G0": 476)", wet) == "");
  CHECK(contains(said_of_material(R"("density": 1.9)"), "1.9 g/cm3 are 1900 kg/m3"));
  CHECK(said_of_material(R"("density": 1.9)").starts_with("error: "));
  CHECK(contains(said_of_material(R"("density": 19)"), "19 kN/m3 are 1937 kg/m3"));
  CHECK(contains(said_of_material(R"("density": 900)", wet), "/materials/clay/density: 900 kg/m3 is less than water"));
  CHECK(said_of_material(R"("density": 900)") == "");
  CHECK(contains(said_of_material(R"("density": 117)", wet), "117 lb/ft3 are 1874 kg/m3"));
  CHECK(contains(said_of_material(R"("cohesion": 15)"), "is it 15 kPa = 15000 Pa?"));
  CHECK(said_of_material(R"("cohesion": 15, "friction_angle": 25)") == "");
  MaterialSetting slurry;
  slurry.flows_by_rate = true;
  CHECK(said_of_material(R"("cohesion": 15)", slurry) == "");
  CHECK(contains(said_of_material(R"("shear_modulus": 40000)"), "is it 40000 kPa"));
  CHECK(contains(said_of_material(R"("youngs_modulus": 5000)"), "go flat"));
  CHECK(contains(said_of_material(R"("friction_angle": 0.59)"), "0.59 radians would be 33.8 degrees"));
  CHECK(contains(said_of_material(R"("G0": 47600000)"), "coefficient without unit"));
  CHECK(said_of_material(R"("strength": 25e3, "strength_ratio": 0.25, "atmospheric_pressure": 101300)") == "");
  CHECK(contains(said_of_material(R"("strength": 25)"), "/strength: 25 Pa is a thousandth"));
  CHECK(contains(said_of_material(R"("strength_ratio": 25)"), "error: "));
  CHECK(contains(said_of_material(R"("atmospheric_pressure": 101.3)"), "no pressure of the atmosphere"));
  CHECK(contains(said_of_material(R"("phi_b_max": 1.05)"), "1.05 radians would be 60.2 degrees"));
}

TEST_CASE("angles in radians, wherever a key is an angle of soil") {
  for (const char* key : {"friction_angle", "residual_friction_angle", "phi_cv", "phi_b_max"})
    CHECK(contains(said_of_material(fmt::format(R"("{}": 0.35)", key)),
                   fmt::format("/{}: 0.35 degrees; 0.35 radians would be 20.1 degrees", key)));
  CHECK(contains(said_of_material(R"("friction_angle": 33, "dilation_angle": 0.2)"), "would be 11.5 degrees"));
  // None, next to none, and what loose sand has.
  for (const double meant : {0.0, 0.1, 1.0, 5.0})
    CHECK(said_of_material(fmt::format(R"("friction_angle": 33, "dilation_angle": {})", meant)) == "");
}

TEST_CASE("stiffness and strengths that were multiplied once too often") {
  const auto soil = [](double young, double cohesion, double density = 1900.0) {
    return said_of_material(fmt::format(R"("density": {}, "youngs_modulus": {}, "cohesion": {}, "friction_angle": 30)",
                                        density, young, cohesion));
  };
  CHECK(soil(3e7, 15e3) == "");
  CHECK(soil(5e9, 5e5, 2100.0) == "");
  CHECK(soil(5e10, 1e7, 2700.0) == "");  // granite
  CHECK(contains(soil(3e10, 15e3), "/youngs_modulus: 3e+10 Pa is more than soil or rock has of 1900 kg/m3"));
  CHECK(contains(soil(3e10, 15e3), "is it 3e+07 or 30000 Pa?"));
  CHECK(contains(soil(3e13, 15e3), "more than any matter has"));
  CHECK(contains(soil(3e7, 15e6), "/cohesion: 1.5e+07 Pa is 0.5 of Young's modulus"));
  CHECK(contains(soil(3e7, 15e9), "An elastic law has no strength at all"));
  // Elastic bodies: acrylic, concrete, a soft bar; steel, whose density alone is remarked on.
  for (const char* bar : {R"("density": 1180, "youngs_modulus": 3e9)", R"("density": 2400, "youngs_modulus": 3e10)",
                          R"("density": 2000, "shear_modulus": 1e9)"})
    CHECK(said_of_material(bar) == "");
  CHECK_FALSE(contains(said_of_material(R"("density": 7850, "youngs_modulus": 2e11)"), "youngs_modulus"));
  CHECK(contains(said_of_material(R"("density": 1900, "shear_modulus": 5e10)"), "concrete, of 2400 kg/m3"));
  CHECK(contains(said_of_material(R"("strength": 25e6)"), "/strength: 2.5e+07 Pa is more than hard clay has"));
  CHECK(contains(said_of_material(R"("bulk_modulus": 2.2e12)"), "far above that of water"));
}

TEST_CASE("what compares with the soil's weight waits for a height") {
  MaterialSetting unknown;
  unknown.height = 0.0;
  CHECK(said_of_material(R"("shear_modulus": 4000, "cohesion": 15)", unknown) == "");
  CHECK(contains(said_of_material(R"("density": 1.9)", unknown), "1.9 g/cm3"));
}

TEST_CASE("void ratios and shares in per cent are refused, with gravity and without") {
  MaterialSetting none;
  none.gravity = 0.0;
  for (const char* keys : {R"("e_max": 80)", R"("e_min": 50)", R"("void_ratio": 90)", R"("relative_density": 35)",
                           R"("porosity": 40)", R"("saturation": 90)"}) {
    CHECK_MESSAGE(said_of_material(keys).starts_with("error: "), keys);
    CHECK_MESSAGE(contains(said_of_material(keys, none), " % are 0."), keys);
  }
  CHECK(said_of_material(R"("e_max": 1.3, "e_min": 0.5, "void_ratio": 9, "relative_density": 1.1)") == "");
}

TEST_CASE("small scenes and scenes without gravity keep their small numbers") {
  MaterialSetting tank;
  tank.height = 0.2;
  CHECK(said_of_material(R"("density": 1000, "cohesion": 20, "youngs_modulus": 1e5)", tank) == "");
  MaterialSetting none;
  none.gravity = 0.0;
  CHECK(said_of_material(R"("density": 1e-6, "cohesion": 1, "youngs_modulus": 1)", none) == "");
}

TEST_CASE("a state in balance passes; one in another unit or of another sign does not") {
  CHECK(said_of(column()) == "");
  CHECK(contains(said_of(column(1e-3, 1e-3)), "most likely kPa were taken for Pa"));
  CHECK(said_of(column(1e-3, 1e-3)).starts_with("error: s.h5: "));
  CHECK(contains(said_of(column(1.0 / 47.88, 1.0 / 47.88)), "most likely psf were taken for Pa"));
  CHECK(contains(said_of(column(1e3, 1e3)), "most likely Pa were taken for kPa"));
  CHECK(contains(said_of(column(-1.0)), "error: s.h5: sigma'_v0"));
  CHECK(contains(said_of(column(-1.0)), "most likely the sign of the stresses"));
  CHECK(contains(said_of(column(-1.0)), "5 of 5 elements"));
  CHECK(contains(said_of(column(1.0, 1e-3)), "initial pore pressure below the phreatic line is 0.001 times"));
  CHECK(contains(said_of(column(3.0, -1.0)), "is a suction"));
  // Half of the total is water's: only beside it the stresses show what they are.
  CHECK(said_of(column(1e-3, 1.0)).starts_with("error: s.h5: sigma'_v0 is 0.001 times"));
  CHECK(contains(said_of(column(1e-3, 1.0)), "most likely kPa were taken for Pa"));
  CHECK(contains(said_of(column(1.96, 1.0)), "not total ones?"));
  CHECK(said_of(column(1.4, 1.0)) == "");
}

TEST_CASE("densities, r_u and single elements in tension") {
  Snapshot s = column();
  s.density.assign(5, 1.9);
  CHECK(contains(said_of(s), "most likely g/cm3"));
  s.density.assign(5, 900.0);
  CHECK(contains(said_of(s), "soil with water in it is heavier than water"));
  s = column();
  s.excess_pore_pressure_ratio.assign(5, -2.5);
  CHECK(contains(said_of(s), "r_u is outside of [-0.5, 1.2] in 5 of 5 elements, -2.5 to -2.5"));
  s = column();
  s.initial_vertical_effective_stress[4] = -100.0;
  CHECK(contains(said_of(s), "not a compression in 1 of 5 elements"));
  CHECK_FALSE(said_of(s).starts_with("error"));
  s.gravity = 0.0;
  CHECK(said_of(s) == "");
}

TEST_CASE("particles are judged by the column above them") {
  ParticleSet p;
  p.material_names = {"clay"};
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) {
      p.position.insert(p.position.end(), {i + 0.5, j + 0.5, 0.0});
      const double vertical = -1900.0 * 9.81 * (10.0 - (j + 0.5));
      p.effective_stress.insert(p.effective_stress.end(), {0.5 * vertical, vertical, 0.5 * vertical, 0.0});
      p.mass.push_back(1900.0);
      p.volume.push_back(1.0);
      p.pore_pressure.push_back(0.0);
    }
  const auto said_of_particles = [&] { return said([&] { check_state(columns_of(p, "p.h5", 9.81)); }); };
  CHECK(said_of_particles() == "");
  const auto scaled = [&](double factor) {
    for (double& v : p.effective_stress) v *= factor;
    const std::string text = said_of_particles();
    for (double& v : p.effective_stress) v /= factor;
    return text;
  };
  CHECK(contains(scaled(1e-3), "kPa were taken for Pa"));
  CHECK(contains(scaled(-1.0), "most likely the sign"));
  p.effective_stress.assign(400, 0.0);
  CHECK(said_of_particles() == "");
}

TEST_CASE("residual strengths from data in another unit, or from one measurement of two") {
  const auto said_of_law = [](const std::string& keys) {
    const auto path = std::filesystem::temp_directory_path() / "tailrun_plausible.json";
    std::ofstream(path) << "{\"residual_strength\": {\"model\": " << keys << "}}";
    const CaseFile file(path);
    return said([&] { read_strength_law(file.root().object("residual_strength")); });
  };
  CHECK(said_of_law(R"("ratio", "ratio": 0.08)") == "");
  CHECK(said_of_law(R"("ratio", "ratio": 8)").starts_with("error: "));
  CHECK(contains(said_of_law(R"("ratio", "ratio": 8)"), "/residual_strength/ratio: found 8"));
  CHECK(contains(said_of_law(R"("ratio", "ratio": 8)"), "8 % are 0.08"));
  CHECK(contains(said_of_law(R"("ratio", "ratio": 0.08, "minimum_ratio": 2)"), "2 % are 0.02"));
  CHECK(said_of_law(R"("olson_stark", "cone_resistance": 3e6)") == "");
  CHECK(said_of_law(R"("olson_stark", "cone_resistance": 3)").starts_with("error: "));
  CHECK(contains(said_of_law(R"("olson_stark", "cone_resistance": 3)"), "3 MPa are 3e+06 Pa"));
  CHECK(contains(said_of_law(R"("olson_stark", "cone_resistance": 3000)"), "3000 kPa are 3e+06 Pa"));
  CHECK(contains(said_of_law(R"("olson_stark", "cone_resistance": 5e4)"), "0.2 to 10 MPa"));
  CHECK(said_of_law(R"("idriss_boulanger", "cone_resistance": 60)") == "");
  CHECK(contains(said_of_law(R"("idriss_boulanger", "cone_resistance": 3)"), "q_c1N = 3 is less than"));
  CHECK(contains(said_of_law(R"("robertson_2022", "cone_resistance": 3)"), "Q_tn,cs = 3 is less than"));
  CHECK(contains(said_of_law(R"("idriss_boulanger", "cone_resistance": 60, "blow_count": 6)"),
                 "/residual_strength/blow_count: is not used: 'idriss_boulanger' takes one of the two"));
  CHECK(said_of_law(R"("weber", "blow_count": 6, "cone_resistance": 60)") == "");  // kept for another model
  CHECK(contains(said_of_law(R"("weber", "blow_count": 6, "percentile": 0.33)"), "a fraction of 0.33 is 33 %"));
  CHECK(contains(said_of_law(R"("idriss_boulanger", "blow_count": 6, "fines_content": 0.15)"),
                 "a fraction of 0.15 is 15 %"));
}
