// Four points at a time: no number may depend on which points were together.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "material_drive.hpp"

using namespace tailrun::fem;
using namespace tailrun::fem::testing;

namespace {

struct Sample {
  std::vector<Pm4PointConstants> constants;
  std::vector<Pm4State> states;
  std::vector<PlaneStrain> strains;
};

// States on the way to liquefaction, with increments of all sizes.
Sample sample(const Pm4SandLaw& law) {
  Sample out;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 53; ++i) {
    Pm4PointConstants constants;
    Pm4State state, trial;
    initialise(law, PlaneStress{75e3 * (1.5 + unit(random)), {-10e3, 0.0}}, true, constants, state);
    double direction = 1.0;
    for (int k = 0; k < 40 * i; ++k) {
      trial_update(law, constants, {}, state, {0.0, {0.0, direction * 1e-5}}, trial);
      commit_update(law, constants, state, trial);
      if (direction * state.v.s.xy > 9e3) direction = -direction;
    }
    const double size = std::pow(10.0, -4.0 + 2.0 * unit(random));
    out.constants.push_back(constants);
    out.states.push_back(state);
    out.strains.push_back({0.1 * size * unit(random), {size * unit(random), size * unit(random)}});
  }
  return out;
}

std::vector<Pm4State> together(const Pm4SandLaw& law, const Sample& s, const std::vector<std::size_t>& order) {
  std::vector<Pm4State> trial(s.states.size());
  std::vector<Pm4Update> updates;
  for (const std::size_t i : order) updates.push_back({&s.constants[i], &s.states[i], s.strains[i], &trial[i], 0});
  trial_updates(law, {}, updates);
  for (const Pm4Update& u : updates) CHECK(u.substeps > 0);
  return trial;
}

bool same_bits(const Pm4State& a, const Pm4State& b) {
  return std::memcmp(&a, &b, sizeof(Pm4State)) == 0;
}

}  // namespace

TEST_CASE("PM4 lanes: a point's result has the same bits alone, in company and in any order") {
  const Pm4SandLaw law = resolve(tailings());
  const Sample s = sample(law);
  std::vector<std::size_t> order(s.states.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const std::vector<Pm4State> first = together(law, s, order);
  std::shuffle(order.begin(), order.end(), std::mt19937(11));
  const std::vector<Pm4State> shuffled = together(law, s, order);
  for (std::size_t i = 0; i < order.size(); ++i) {
    Pm4State alone;
    trial_update(law, s.constants[i], {}, s.states[i], s.strains[i], alone);
    CHECK(same_bits(first[i], alone));
    CHECK(same_bits(first[i], shuffled[i]));
  }
}

TEST_CASE("PM4 lanes: coefficients are those of single numbers") {
  const Pm4SandLaw law = resolve(tailings());
  const Sample s = sample(law);
  for (std::size_t i = 0; i + 3 < s.states.size(); i += 4) {
    const auto states = gather(s.states[i], s.states[i + 1], s.states[i + 2], s.states[i + 3]);
    const auto points = gather(s.constants[i], s.constants[i + 1], s.constants[i + 2], s.constants[i + 3]);
    const DeviatorOf<Lanes> along{0.6 * sqrt_half, 0.8 * sqrt_half};
    const auto all = coefficients(law, Pm4PlaceOf<Lanes>{points, states.memory, states.z_peak, states.v,
                                                         states.surfaces, states.moduli(), along});
    for (std::size_t k = 0; k < lane_count; ++k) {
      const Pm4State& one = s.states[i + k];
      const Pm4Coefficients c = coefficients(law, Pm4PlaceOf<double>{s.constants[i + k],
                                                                     one.memory,
                                                                     one.z_peak,
                                                                     one.v,
                                                                     one.surfaces,
                                                                     one.moduli(),
                                                                     {0.6 * sqrt_half, 0.8 * sqrt_half}});
      CHECK(all.H[k] == doctest::Approx(c.H).epsilon(1e-12));
      CHECK(all.B[k] == doctest::Approx(c.B).epsilon(1e-12));
      CHECK(all.dilatancy.at(states.v.p)[k] == doctest::Approx(c.dilatancy.at(one.v.p)).epsilon(1e-10));
      CHECK(all.fabric_rate[k] == doctest::Approx(c.fabric_rate).epsilon(1e-12));
    }
  }
}

TEST_CASE("PM4 lanes: exponential, logarithm and root") {
  for (double x = -30.0; x < 30.0; x += 0.37) {
    const Lanes all(Lanes::Vector{x, -x, 0.1 * x, 1e-6 * x});
    const Lanes e = number::exp(all), l = number::log(e), r = number::sqrt(e);
    for (std::size_t k = 0; k < lane_count; ++k) {
      CHECK(e[k] == doctest::Approx(std::exp(all[k])).epsilon(4e-16 * 4));
      CHECK(r[k] == std::sqrt(e[k]));
      CHECK(std::fabs(l[k] - std::log(e[k])) <= 4e-16 * std::max(1.0, std::fabs(all[k])));
    }
  }
}
