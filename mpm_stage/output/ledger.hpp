// The energy ledger: where the energy of the start went. What the separately counted losses do not explain has been
// lost by the scheme: between particles and nodes, in impacts (step/solver.hpp says how these two are counted), and the
// residual, by the integration in time of motion and stress, the averages of volumetric strain and mean stress, and
// sleep.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "mpm_stage/step/solver.hpp"

namespace tailrun::mpm {

struct LedgerRow {
  double time = 0.0;                                         // s
  double kinetic = 0.0, elastic = 0.0, gravitational = 0.0;  // J (per metre in plane strain)
  WorkDone work;                                             // J, since the start
  double lost = 0.0;                                         // J, by the scheme
  double residual = 0.0;                                     // J, of that neither in the transfer nor in impacts
  double mass = 0.0;                                         // kg
  std::array<double, 3> momentum{};                          // N s
  double angular_momentum = 0.0;                             // N m s, about the origin, z component
  double total() const { return kinetic + elastic + gravitational; }
};

template <int Dim>
class Ledger {
 public:
  explicit Ledger(std::array<double, Dim> gravity) : gravity_(gravity) {}

  // Adds a row. The first one is the reference. Throws ComputationError when energy has grown by more than `limit`
  // (share of the energy that has been set free so far) without work that explains it; the message names the particle
  // with the most energy per mass, and what may help.
  const LedgerRow& sample(double time, Solver<Dim>& solver, double limit);
  // After each step: what motion holds and has done (J, energy_watch.hpp). Velocities lie half a step before positions
  // and stresses, so whatever swings seems to gain and lose, by turns, half of what motion gains in a step (1 % of a
  // bar's at a courant number of 0.2); the limit is on what is left without that.
  void follow(double spent) {
    gain_ = std::isnan(spent_) ? 0.0 : spent - spent_;
    spent_ = spent;
  }
  // The same check between two rows: what would be one is returned and not kept.
  LedgerRow look(double time, Solver<Dim>& solver, double limit) const;

  const std::vector<LedgerRow>& rows() const { return rows_; }
  double largest_kinetic() const { return largest_kinetic_; }  // J, of all rows
  void restore(std::vector<LedgerRow> rows, double largest_kinetic) {
    rows_ = std::move(rows);
    largest_kinetic_ = largest_kinetic;
  }
  // The energy that the motion so far has turned over, J: the scale for the residual.
  double turnover() const { return turnover(rows_.back(), largest_kinetic_); }
  void write(const std::filesystem::path& path) const;

 private:
  LedgerRow measure(double time, Solver<Dim>& solver) const;
  double turnover(const LedgerRow& now, double largest_kinetic) const;
  void check(const LedgerRow& now, double scale, const Solver<Dim>& solver, double limit) const;

  std::array<double, Dim> gravity_;
  std::vector<LedgerRow> rows_;
  double largest_kinetic_ = 0.0;
  double spent_ = std::numeric_limits<double>::quiet_NaN(), gain_ = 0.0;  // J
};

}  // namespace tailrun::mpm
