#include "mpm_stage/output/energy_remarks.hpp"

#include <fmt/core.h>

#include <cmath>

namespace tailrun::mpm {

namespace {

constexpr double largest_residual = 0.05;  // of the turnover
constexpr double least_given = 0.05;       // of the turnover
constexpr double next_to_nothing = 1e-6;   // m, by which all of the mass would have to fall for the turnover
constexpr double earth = 9.81;             // m/s2

}  // namespace

std::vector<std::string> energy_remarks(const LedgerRow& first, const LedgerRow& last, double turnover, bool flows) {
  std::vector<std::string> remarks;
  if (!(turnover > next_to_nothing * earth * last.mass)) return remarks;
  const double free = first.gravitational - last.gravitational + first.kinetic + first.elastic + last.work.external +
                      last.work.pore_pressure;
  const double given = last.work.crowding;
  if (given > free && given > least_given * turnover)
    remarks.push_back(fmt::format(
        "crowded soil was given {:.3g} J as it was pushed apart (crowding_J), more than all that was set free ({:.3g} "
        "J): it is this that keeps it moving, as weak soil and fluids in a pool are. Read nothing of its last motion; "
        "scheme/transfer 'apic' calms it",
        given, free));
  if (flows && !std::isnan(last.work.transfer) && std::fabs(last.residual) > largest_residual * turnover)
    remarks.push_back(fmt::format(
        "{:.1f} % of the energy turned over {} explained by neither soil, contact nor transfer (residual_J): a shorter "
        "step (time/courant) tells whether the answer depends on it",
        100.0 * std::fabs(last.residual) / turnover, last.residual > 0.0 ? "was lost and is" : "was made and is"));
  return remarks;
}

}  // namespace tailrun::mpm
