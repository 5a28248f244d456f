// Thresholds so high that they decide over the result: a run that ends while soil flows, soil that sleeps as it flows,
// energy that may grow.
#include <fmt/core.h>

#include "mpm_stage/scene/scene_checks.hpp"

namespace tailrun::mpm {

namespace {

constexpr double slow_flow = 1.0;    // m/s, of a flow on its way
constexpr double creep = 0.1;        // m/s
constexpr double much_energy = 0.5;  // 1, of what was turned over
constexpr double long_way = 1000.0;  // m

}  // namespace

void check_thresholds(const CaseNode& root, const Scene& scene) {
  if (scene.gravity == std::array<double, 3>{}) return;
  if (scene.rest.active && scene.rest.speed > slow_flow)
    root.warn("time/rest/speed",
              fmt::format("{:g} m/s: soil that flows more slowly counts as at rest, and the run ends "
                          "after {:g} s of it",
                          scene.rest.speed, scene.rest.duration));
  if (const double speed = scene.solver.sleep.speed; speed > creep)
    root.warn("sleep/speed", fmt::format("{:g} m/s: soil that flows more slowly is left out of the step; 0.01 m/s is "
                                         "usual",
                                         speed));
  if (const double share = scene.energy_growth_limit; share > much_energy)
    root.warn("time/energy_growth_limit",
              fmt::format("{:g} is {:g} % of what was turned over: a run that makes energy is hardly stopped", share,
                          100.0 * share));
  if (const double way = scene.output.flow_distance; way > long_way)
    root.warn("output/flow_distance", fmt::format("{:g} m: what moves less counts as not having flowed, and has no "
                                                  "runout",
                                                  way));
}

}  // namespace tailrun::mpm
