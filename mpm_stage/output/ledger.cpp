#include "mpm_stage/output/ledger.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/application.hpp"
#include "common/error.hpp"
#include "mpm_stage/output/csv_cell.hpp"

namespace tailrun::mpm {

namespace {

double losses(const WorkDone& w) {
  return w.plastic + w.friction + w.contact + w.damping + w.removed;
}

// What may help, by where the energy came from. A shorter step brings down what the integration in time makes, and
// nothing else.
std::string advice(const LedgerRow& now) {
  if (!std::isfinite(now.total())) return "a shorter time step (time/courant) may help";
  if (std::isnan(now.work.transfer))
    return "if a shorter time step (time/courant) does not help, another scheme/transfer may, or a higher "
           "scheme/fmpm_order";
  if (-now.work.transfer > -now.residual)
    return "it was made between particles and nodes, where a shorter time step does not help: scheme/transfer 'apic', "
           "or with 'aflip' a larger scheme/transfer_damping, may";
  return "it was made as motion and stress were integrated in time: a shorter time step (time/courant) may help, and "
         "where soil is faster than its own waves or crushed to a fraction of its volume, a larger youngs_modulus "
         "(bulk_modulus of a fluid)";
}

}  // namespace

template <int Dim>
double Ledger<Dim>::turnover(const LedgerRow& now, double largest_kinetic) const {
  const LedgerRow& first = rows_.empty() ? now : rows_.front();
  return std::max({std::fabs(first.gravitational - now.gravitational), first.kinetic + first.elastic, largest_kinetic,
                   losses(now.work)}) +
         std::fabs(now.work.external) + std::fabs(now.work.pore_pressure) + std::fabs(now.work.crowding);
}

template <int Dim>
LedgerRow Ledger<Dim>::measure(double time, Solver<Dim>& solver) const {
  const Particles<Dim>& P = solver.particles();
  LedgerRow row;
  row.time = time;
  for (std::size_t p = 0; p < P.count(); ++p) {
    double v2 = 0.0, height = 0.0;
    for (int d = 0; d < Dim; ++d) {
      v2 += P.velocity[d][p] * P.velocity[d][p];
      height -= gravity_[d] * P.position[d][p];
      row.momentum[d] += P.mass[p] * P.velocity[d][p];
    }
    row.kinetic += 0.5 * P.mass[p] * v2;
    row.gravitational += P.mass[p] * height;
    row.mass += P.mass[p];
    row.angular_momentum += P.mass[p] * (P.position[0][p] * P.velocity[1][p] - P.position[1][p] * P.velocity[0][p]);
  }
  row.elastic = solver.elastic_energy();
  row.work = solver.work();
  if (rows_.empty()) return row;
  const LedgerRow& first = rows_.front();
  row.lost =
      first.total() + row.work.external + row.work.pore_pressure + row.work.crowding - losses(row.work) - row.total();
  // A particle that left took its height's energy along, so mass that went is no longer comparable.
  if (row.mass < first.mass * (1.0 - 1e-12)) row.lost = std::nan("");
  row.residual = row.lost - (std::isnan(row.work.transfer) ? 0.0 : row.work.transfer + row.work.impact);
  return row;
}

template <int Dim>
void Ledger<Dim>::check(const LedgerRow& now, double scale, const Solver<Dim>& solver, double limit) const {
  const double start = rows_.empty() ? now.total() : rows_.front().total(), grown = 0.5 * gain_ - now.lost;
  if (std::isfinite(now.total()) && !(grown > limit * scale + 1e-9 * std::fabs(start))) return;
  throw ComputationError(fmt::format(
      "{}, the most of all per mass: energy has grown without work that explains it, by {:.4g} J of {:.4g} J turned "
      "over (limit {} of it); {}",
      solver.most_energetic(), grown, scale, limit, advice(now)));
}

template <int Dim>
const LedgerRow& Ledger<Dim>::sample(double time, Solver<Dim>& solver, double limit) {
  rows_.push_back(measure(time, solver));
  largest_kinetic_ = std::max(largest_kinetic_, rows_.back().kinetic);
  check(rows_.back(), turnover(), solver, limit);
  return rows_.back();
}

template <int Dim>
LedgerRow Ledger<Dim>::look(double time, Solver<Dim>& solver, double limit) const {
  const LedgerRow now = measure(time, solver);
  check(now, turnover(now, std::max(largest_kinetic_, now.kinetic)), solver, limit);
  return now;
}

template <int Dim>
void Ledger<Dim>::write(const std::filesystem::path& path) const {
  std::string text =
      "time_s,kinetic_J,elastic_J,gravitational_J,plastic_J,friction_J,contact_J,damping_J,external_J,pore_pressure_J,"
      "crowding_J,transfer_J,impact_J,residual_J,mass_kg,momentum_x_Ns,momentum_y_Ns,momentum_z_Ns,angular_momentum_"
      "Nms\n";
  for (const auto& r : rows_) {
    text += fmt::format("{:.9g}", r.time);
    for (const double energy :
         {r.kinetic, r.elastic, r.gravitational, r.work.plastic, r.work.friction, r.work.contact, r.work.damping,
          r.work.external, r.work.pore_pressure, r.work.crowding, r.work.transfer, r.work.impact, r.residual})
      text += csv_cell(energy, 10);
    for (const double kept : {r.mass, r.momentum[0], r.momentum[1], r.momentum[2], r.angular_momentum})
      text += csv_cell(kept, 15);
    text += '\n';
  }
  write_text_file(path.string(), text);
}

template class Ledger<2>;
template class Ledger<3>;

}  // namespace tailrun::mpm
