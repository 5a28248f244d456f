// Whole steps of the MPM stage in 2-D: particle-steps per second and core by material, transfer, number of particles
// and threads; what each feature that a scene may leave out costs; memory per particle; and the shares of this
// machine's memory bandwidth and multiply-add rate, which a probe measures first. At last a whole run with and without
// sleeping blocks, with what they change of its outcome.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <omp.h>

#include <map>

#include "common/error.hpp"
#include "machine_probe.hpp"
#include "quiet_bed.hpp"
#include "stirred_block.hpp"

namespace {

using namespace tailrun;
using bench::BlockOptions;

std::map<int, double> bandwidth;  // bytes/s by threads
double flop_rate = 0.0;           // flops/s of a core

// Bytes that a step has to move between memory and core per particle when the block does not fit into the caches: each
// column that is read counts once and each that is written twice (fetch and write back); tiles and nodes are left out.
double bytes_per_step(const BlockOptions& o) {
  const bool affine = o.solver.transfer != mpm::TransferName::flip;
  const int affine_columns = affine ? 4 : 0, pore = o.pore_pressure != mpm::PorePressure::total ? 1 : 0;
  const bool averaging = o.averaged && o.solver.volumetric_average;
  const int strength = o.law == "mohr_coulomb" || o.law == "tresca" ? 1 : 0;
  // G2P: position, velocity, affine and gradient written, mass read.
  int columns = 2 * 2 + 2 * 2 + 2 * affine_columns + 2 * 4 + 1;
  // Average, in the same pass: volume and three stresses read besides what G2P has just had.
  if (averaging) columns += 1 + 3 + pore;
  // Stress and P2G of a block, one pass: gradient, position, velocity, affine and mass read; stress, volume, plastic
  // strain and pore pressure written; strength read.
  columns += 4 + 2 + 2 + affine_columns + 1 + 2 * (4 + 1 + strength + pore) + strength;
  return 8.0 * columns;
}

// Floating point operations of a step per particle with quadratic shape functions and an affine transfer, counted from
// the formulae (a multiply-add is two; lanes that carry nothing do not count).
double flops_per_step(const BlockOptions& o) {
  const bool flip = o.solver.transfer != mpm::TransferName::apic;
  const double weights = 2 * 14;
  // A line's differences and its three sums are 12, of 3 rows x 2 components with 2 products each, and of 2 columns;
  // change; midpoint gradient, motion, energy.
  const double gather = 3 * 2 * (12 + 4) + 2 * 12 + (flip ? 9 * 2 * 2 + 3 * 2 * 2 + 8 : 0) + 34;
  // Factors of 3 rows and 3 columns; 9 nodes x 3 values (m, px, py) x 2 products, or 4 values (px, py, fx, fy) and m.
  const double scatter = 14 + (flip ? 8 * 5 : 4 * 8) + 15 + (flip ? 9 * 4 * 4 + 9 * 2 : 9 * 3 * 4);
  const double stress = o.law == "mohr_coulomb" ? 150 : o.law == "tresca" ? 125 : 50;
  const double average = 2 * 10 + 10 + 4 * (3 * 2 + 2) + 4 * 2 * 2 + 6;
  return 2 * weights + gather + scatter + stress + (o.averaged && o.solver.volumetric_average ? average : 0.0);
}

void measure(benchmark::State& state, const BlockOptions& options) {
  const auto particles = static_cast<std::size_t>(state.range(0));
  const int threads = static_cast<int>(state.range(1));
  omp_set_num_threads(threads);
  bench::StirredBlock block(particles, options);
  for (int i = 0; i < 3; ++i) block.step();
  const auto sorts = block.solver().sorts();
  const mpm::PhaseSeconds before = block.solver().seconds();
  const double since = bench::seconds();
  for (auto _ : state) block.step();
  const double seconds = bench::seconds() - since;
  const mpm::PhaseSeconds& after = block.solver().seconds();
  const double done = static_cast<double>(state.iterations()) * static_cast<double>(block.solver().particles().count());
  const double per_core = done / seconds / threads;
  state.counters["particle_steps_per_s_core"] = per_core;
  state.counters["bytes_per_particle"] = block.bytes_per_particle();
  state.counters["bytes_per_particle_step"] = bytes_per_step(options);
  state.counters["bandwidth_share"] = bytes_per_step(options) * per_core * threads / bandwidth[threads];
  if (options.solver.shape == mpm::ShapeName::quadratic)
    state.counters["flops_share"] = flops_per_step(options) * per_core / flop_rate;
  state.counters["sorts"] = static_cast<double>(block.solver().sorts() - sorts);
  const auto ns = [&](double mpm::PhaseSeconds::*phase) {
    return 1e9 * (after.*phase - before.*phase) * threads / done;
  };
  state.counters["ns_grid"] = ns(&mpm::PhaseSeconds::grid);
  state.counters["ns_g2p"] = ns(&mpm::PhaseSeconds::grid_to_particles);
  state.counters["ns_average"] = ns(&mpm::PhaseSeconds::volumetric);
  state.counters["ns_stress_p2g"] = ns(&mpm::PhaseSeconds::stress_and_scatter);
  state.counters["ns_sort"] = ns(&mpm::PhaseSeconds::sort);
}

// A run that fails is a line of its own in the results and does not end the others.
void steps(benchmark::State& state, BlockOptions options) {
  try {
    measure(state, options);
  } catch (const ComputationError& error) {
    state.SkipWithError(error.what());
  }
}

// As many steps as make ten million particle-steps: about a second.
void add(const std::string& name, const BlockOptions& options, long particles, int threads) {
  benchmark::RegisterBenchmark(name.c_str(), steps, options)
      ->Args({particles, threads})
      ->ArgNames({"particles", "threads"})
      ->Iterations(10'000'000 / particles)
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}

void add_main_table(int most_threads) {
  // Name in the results, and of the law.
  const std::pair<const char*, const char*> models[] = {{"mohr_coulomb", "mohr_coulomb"},
                                                        {"tresca", "tresca"},
                                                        {"newtonian", "newtonian_fluid"},
                                                        {"linear_elastic", "linear_elastic"}};
  const std::pair<const char*, mpm::TransferName> transfers[] = {{"apic", mpm::TransferName::apic},
                                                                 {"aflip", mpm::TransferName::aflip}};
  for (const auto& [model_name, law] : models)
    for (const auto& [transfer_name, transfer] : transfers)
      for (const long particles : {50'000L, 200'000L, 1'000'000L})
        for (int threads = 1; threads <= most_threads; ++threads) {
          BlockOptions o;
          o.law = law;
          o.solver.transfer = transfer;
          o.averaged = o.law != "linear_elastic";
          add(fmt::format("step/{}/{}", model_name, transfer_name), o, particles, threads);
        }
}

// One feature changed at a time against Mohr-Coulomb soil with APIC, quadratic shape functions and nothing else.
void add_features() {
  BlockOptions plain;
  plain.averaged = false;
  plain.solver.transfer = mpm::TransferName::apic;
  const auto line = [&](const char* name, auto change) {
    BlockOptions o = plain;
    change(o);
    add(fmt::format("feature/{}", name), o, 200'000, 1);
  };
  line("none", [](BlockOptions&) {});
  line("volumetric_average", [](BlockOptions& o) { o.averaged = true; });
  line("pore_pressure_frozen", [](BlockOptions& o) { o.pore_pressure = mpm::PorePressure::frozen; });
  line("pore_pressure_undrained", [](BlockOptions& o) { o.pore_pressure = mpm::PorePressure::undrained; });
  line("terrain", [](BlockOptions& o) { o.terrain = true; });
  line("local_damping", [](BlockOptions& o) { o.solver.local_damping = 0.1; });
  line("aflip", [](BlockOptions& o) { o.solver.transfer = mpm::TransferName::aflip; });
  line("flip", [](BlockOptions& o) { o.solver.transfer = mpm::TransferName::flip; });
  // Linear functions throw light nodes of the free surface about; with more mass cut off there they last for this run.
  line("linear", [](BlockOptions& o) {
    o.solver.shape = mpm::ShapeName::linear;
    o.solver.mass_cutoff = 0.05;
    o.solver.courant = 0.2;
  });
  line("gimp", [](BlockOptions& o) { o.solver.shape = mpm::ShapeName::gimp; });
  line("cubic", [](BlockOptions& o) { o.solver.shape = mpm::ShapeName::cubic; });
}

void quiet_bed(benchmark::State& state, const mpm::SleepOptions& sleep) {
  omp_set_num_threads(1);
  bench::QuietBedOutcome out;
  for (auto _ : state) out = bench::run_quiet_bed(sleep);
  state.counters["front_m"] = out.front;
  state.counters["moved_mass_kg"] = out.moved_mass;
  state.counters["share_asleep"] = out.share_asleep;
  state.counters["particle_steps"] = out.particle_steps;
}

void add_quiet_bed() {
  const std::pair<const char*, double> speeds[] = {{"off", 0.0}, {"0.01_m_per_s", 0.01}, {"0.03_m_per_s", 0.03}};
  for (const auto& [name, speed] : speeds)
    benchmark::RegisterBenchmark(fmt::format("sleeping_blocks/{}", name).c_str(), quiet_bed,
                                 mpm::SleepOptions{.speed = speed})
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  const int most_threads = std::min(2, omp_get_max_threads());
  for (int threads = 1; threads <= most_threads; ++threads) {
    bandwidth[threads] = bench::triad_bandwidth(threads);
    benchmark::AddCustomContext(fmt::format("triad_GB_per_s_{}_threads", threads),
                                fmt::format("{:.2f}", 1e-9 * bandwidth[threads]));
  }
  flop_rate = bench::multiply_add_rate();
  benchmark::AddCustomContext("multiply_add_Gflops_per_s_core", fmt::format("{:.2f}", 1e-9 * flop_rate));
  add_main_table(most_threads);
  add_features();
  add_quiet_bed();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
