// The scene of the MPM benchmark: a square block of soil, four particles a cell, stirred by vortices so that it shears,
// yields and crosses cells; without gravity unless it stands on a bed.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "mpm_stage/step/solver.hpp"

namespace tailrun::bench {

struct BlockOptions {
  std::string law = "mohr_coulomb";
  mpm::SolverOptions solver;
  mpm::PorePressure pore_pressure = mpm::PorePressure::total;
  bool averaged = true;  // volumetric strain, of this material
  bool terrain = false;
};

class StirredBlock {
 public:
  static constexpr double cell = 0.5;  // m

  StirredBlock(std::size_t particles, const BlockOptions& options) : gravity_{0.0, options.terrain ? -9.81 : 0.0} {
    const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(particles))));
    const double spacing = 0.5 * cell, length = spacing * static_cast<double>(side);
    mpm::Particles<2> P;
    P.resize(side * side, options.solver.transfer != mpm::TransferName::flip,
             options.pore_pressure != mpm::PorePressure::total);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> jitter(-0.2, 0.2);
    for (std::size_t p = 0; p < P.count(); ++p) {
      const double x = (static_cast<double>(p % side) + 0.5 + jitter(random)) * spacing;
      const double y = (static_cast<double>(p / side) + 0.5 + jitter(random)) * spacing;
      const double k = M_PI / 20.0;  // vortices of 20 m, 2 m/s, free of divergence
      P.position[0][p] = x;
      P.position[1][p] = y;
      P.velocity[0][p] = 2.0 * std::sin(k * x) * std::cos(k * y);
      P.velocity[1][p] = -2.0 * std::cos(k * x) * std::sin(k * y);
      P.mass[p] = 2000.0 * spacing * spacing;
      P.volume[p] = spacing * spacing;
      P.strength[p] = 5e3;
      P.identity[p] = static_cast<std::int32_t>(p);
      const double weight = options.terrain ? 2000.0 * 9.81 * (length - y) : 0.0;
      for (int c = 0; c < 3; ++c) P.stress[c][p] = -weight;
      if (!P.pore_pressure.empty()) P.pore_pressure[p] = 0.2 * weight;
    }
    if (options.terrain)
      terrain_.add_line({{{-10.0, 0.0}}, {{0.5 * length, 0.0}}, {{length + 10.0, -0.1 * length}}}, {0.35, 0.35}, false);
    mpm::Material soil;
    soil.name = "soil";
    soil.law = &mpm::law_named(options.law);
    soil.youngs_modulus = 1e7;
    soil.poisson_ratio = 0.3;
    soil.friction_angle = 30.0;
    soil.cohesion = 5e3;
    soil.bulk_modulus = 1e7;
    soil.density = 2000.0;
    soil.rate.consistency = options.law == "newtonian_fluid" ? 10.0 : 0.0;
    soil.pore_pressure = options.pore_pressure;
    soil.average_volumetric_strain = options.averaged;
    solver_ = mpm::make_solver<2>(options.solver, cell, {}, std::move(P), {soil}, terrain_, mpm::Walls<2>{});
    solver_->start(1e300);
  }

  void step() { solver_->step(gravity_, {0.0, 0.0}, 1e300); }
  mpm::Solver<2>& solver() { return *solver_; }

  // Memory of particles and grid, bytes per particle.
  double bytes_per_particle() {
    std::size_t columns = 0;
    solver_->particles().for_each_column([&](const auto& c) { columns += c.capacity() * sizeof(double); });
    columns += (solver_->particles().material.capacity() + solver_->particles().identity.capacity()) * 4;
    return static_cast<double>(columns + solver_->grid_bytes()) / static_cast<double>(solver_->particles().count());
  }

 private:
  std::array<double, 2> gravity_;
  mpm::Terrain terrain_;
  std::unique_ptr<mpm::Solver<2>> solver_;
};

}  // namespace tailrun::bench
