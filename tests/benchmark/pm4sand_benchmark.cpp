// PM4Sand: microseconds per element update and per accepted sub-step, by state and strain increment, for the improved
// and the OpenSees-compatible integration, and the update of many points by thread count.
//
//   pm4sand_benchmark --benchmark_filter=improved --benchmark_format=json
//
// Rows are named mode/state/direction/increment; counters: substeps per update, us_per_substep. `improved` updates one
// point alone, as an element test does; `improved_block` 32 points at once, as a dam does, with increments up to a
// tenth apart.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>
#include <string>

#include "fem_stage/material/material_points.hpp"
#include "fem_stage/material/pm4_point.hpp"
#include "fem_stage/material/point_store.hpp"

namespace {

using namespace tailrun::fem;

Pm4SandParameters soil(bool tailings, Pm4Compatibility mode) {
  Pm4SandParameters p;
  p.relative_density = tailings ? 0.35 : 0.55;
  p.shear_coefficient = tailings ? 476.0 : 677.0;
  p.contraction_rate = tailings ? 2.70 : 0.40;
  p.Q = tailings ? 11.998 : 10.0;
  p.R = tailings ? 3.75 : 1.5;
  p.density = 1800.0;
  p.compatibility = mode;
  return p;
}

enum State { virgin, liquefied, flowing };

struct Point {
  Pm4SandLaw law;
  Pm4PointConstants constants;
  Pm4State state;
  double direction = 1.0;

  Point(State wanted, Pm4Compatibility mode) : law(resolve(soil(wanted != liquefied, mode))) {
    initialise(law, PlaneStress{75e3, {-25e3, 0.0}}, true, constants, state);
    const auto step = [&](double gamma) {
      Pm4State trial;
      trial_update(law, constants, {}, state, {0.0, {0.0, 0.5 * gamma}}, trial);
      commit_update(law, constants, state, trial);
    };
    if (wanted == virgin) {
      for (int i = 0; i < 200; ++i) step(1e-6);
    } else if (wanted == flowing) {
      while (state.v.p > 6.5e3) step(1e-5);
    } else {
      // Cyclic mobility: cycles of 16 kPa until the shear strain has reached 3 %.
      double gamma = 0.0;
      while (std::fabs(gamma) < 0.03) {
        step(direction * 1e-5);
        gamma += direction * 1e-5;
        if (direction * state.v.s.xy >= 16e3) direction = -direction;
      }
    }
  }
};

void update(benchmark::State& bench, Pm4Compatibility mode, State state, double increment) {
  const Point point(state, mode);
  Pm4State trial;
  long substeps = 0;
  const PlaneStrain strain{0.0, {0.0, 0.5 * point.direction * increment}};
  for (auto _ : bench) {
    substeps += trial_update(point.law, point.constants, {}, point.state, strain, trial);
    benchmark::DoNotOptimize(trial);
  }
  bench.counters["substeps"] = static_cast<double>(substeps) / static_cast<double>(bench.iterations());
  bench.counters["us_per_substep"] = benchmark::Counter(1e-6 * static_cast<double>(substeps),
                                                        benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void update_many(benchmark::State& bench, State state, double increment) {
  const Point point(state, Pm4Compatibility::improved);
  constexpr std::size_t count = tailrun::fem::update_block;
  std::vector<Pm4State> trial(count);
  std::vector<Pm4Update> updates;
  for (std::size_t k = 0; k < count; ++k) {
    const double gamma = point.direction * increment * (1.0 + 0.1 * static_cast<double>(k) / count);
    updates.push_back({&point.constants, &point.state, {0.0, {0.0, 0.5 * gamma}}, &trial[k], 0});
  }
  long substeps = 0;
  for (auto _ : bench) {
    trial_updates(point.law, {}, updates);
    for (const Pm4Update& u : updates) substeps += u.substeps;
    benchmark::DoNotOptimize(trial.data());
  }
  bench.SetItemsProcessed(static_cast<std::int64_t>(bench.iterations() * count));
  bench.counters["substeps"] = static_cast<double>(substeps) / static_cast<double>(bench.iterations() * count);
  bench.counters["us_per_substep"] = benchmark::Counter(1e-6 * static_cast<double>(substeps),
                                                        benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// 4000 points of which every fiftieth flows, as in a dam whose slip has formed.
void many_points(benchmark::State& bench) {
  omp_set_num_threads(static_cast<int>(bench.range(0)));
  constexpr std::size_t count = 4000;
  MaterialPoints points({{"tailings", soil(true, Pm4Compatibility::improved)}}, std::vector<int>(count, 0));
  std::vector<double> stress, strain(3 * count);
  for (std::size_t i = 0; i < count; ++i) stress.insert(stress.end(), {-50e3, -100e3, -50e3, 0.0});
  points.set_stress(stress);
  points.start_plastic_stage(true);
  for (std::size_t i = 0; i < count; ++i) strain[3 * i + 2] = i % 50 == 0 ? 1e-3 : 1e-6;
  for (int i = 0; i < 100; ++i) {
    points.update(strain, stress);
    points.commit();
  }
  double sign = 1.0;
  for (auto _ : bench) {
    // Alternating amounts, because an unchanged increment is not computed again.
    for (std::size_t i = 0; i < count; ++i) strain[3 * i + 2] *= sign > 0.0 ? 1.1 : 1.0 / 1.1;
    sign = -sign;
    benchmark::DoNotOptimize(points.update(strain, stress));
  }
  bench.SetItemsProcessed(static_cast<std::int64_t>(bench.iterations() * count));
}

}  // namespace

int main(int argc, char** argv) {
  const char* states[] = {"virgin", "liquefied", "flowing"};
  for (const State state : {virgin, liquefied, flowing}) {
    for (const double size : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
      for (const double sign : {1.0, -1.0}) {
        for (const bool opensees : {false, true}) {
          if (opensees && size > 5e-3) continue;  // thousands of pieces
          const auto mode = opensees ? Pm4Compatibility::opensees : Pm4Compatibility::improved;
          char name[80];
          std::snprintf(name, sizeof name, "%s/%s/%s/%.0e", opensees ? "opensees" : "improved", states[state],
                        sign > 0 ? "onward" : "reversed", size);
          benchmark::RegisterBenchmark(name, update, mode, state, sign * size)->Unit(benchmark::kMicrosecond);
        }
        char name[80];
        std::snprintf(name, sizeof name, "improved_block/%s/%s/%.0e", states[state], sign > 0 ? "onward" : "reversed",
                      size);
        benchmark::RegisterBenchmark(name, update_many, state, sign * size)->Unit(benchmark::kMicrosecond);
      }
    }
  }
  benchmark::RegisterBenchmark("points/4000", many_points)
      ->Arg(1)
      ->Arg(2)
      ->UseRealTime()
      ->Unit(benchmark::kMicrosecond);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
