#include "fem_stage/solver/energy_watch.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tailrun::fem {

void EnergyWatch::observe(const EnergyLedger& ledger, double time) {
  const auto keep = [time](bool good, std::optional<double>& since) {
    if (good)
      since.reset();
    else if (!since)
      since = time;
  };
  keep(std::abs(ledger.residual()) <= accepted * ledger.largest(), open_since_);
  keep(ledger.hourglass_work <= accepted_hourglass * ledger.largest(), hourglass_since_);
}

std::string EnergyWatch::warning(const Model& model, const EnergyLedger& ledger,
                                 std::span<const double> hourglass_work) const {
  if (!open_since_ && !hourglass_since_) return {};
  std::string text = "energy: ";
  if (open_since_) {
    const double share = ledger.residual() / ledger.largest();
    text += fmt::format("{:.1f} % of it is {} from {:.2f} s on; ", 100.0 * std::abs(share),
                        share < 0.0 ? "made by nothing" : "lost to the time integration", *open_since_);
    text += share < 0.0 ? "something is unstable, and results after that time are not to be used. "
                        : "a shorter time_step or a smaller newmark/gamma keeps it, unless that damping is wanted. ";
  }
  if (hourglass_since_)
    text += fmt::format(
        "hourglass modes have taken more than {:g} % from {:.2f} s on, {:.1f} % at the end: elements fold into each "
        "other, and results after that time are not to be used. ",
        100.0 * accepted_hourglass, *hourglass_since_, 100.0 * ledger.hourglass_work / ledger.largest());
  std::vector<std::size_t> order(hourglass_work.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t shown = std::min<std::size_t>(3, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(shown), order.end(),
                    [&](std::size_t a, std::size_t b) { return hourglass_work[a] > hourglass_work[b]; });
  text += "Most work in hourglass modes:";
  for (std::size_t i = 0; i < shown; ++i) {
    const std::size_t e = order[i];
    const auto c = model.mesh.centre(e);
    text += fmt::format("{} element {} at ({:.4g}, {:.4g}) in '{}' {:.3g} J", i ? "," : "", e, c[0], c[1],
                        model.mesh.region_names[static_cast<std::size_t>(model.mesh.region[e])], hourglass_work[e]);
  }
  return text + fmt::format("; of all {:.3g} J", ledger.hourglass_work);
}

}  // namespace tailrun::fem
