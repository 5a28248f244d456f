#include "fem_stage/model/doubled_entries.hpp"

#include <fmt/core.h>

namespace tailrun::fem {
namespace {

bool act_together(const LoadOptions& a, const LoadOptions& b) {
  return a.when == b.when || a.when == When::both || b.when == When::both;
}

bool equal(const TimeHistory& a, const TimeHistory& b, double duration) {
  constexpr int looks = 1000;
  if (a.constant() != b.constant() || a.largest() != b.largest()) return false;
  for (int k = 0; k <= looks; ++k)
    if (a.at(k * duration / looks) != b.at(k * duration / looks)) return false;
  return true;
}

bool equal(const LoadOptions& a, const LoadOptions& b, double duration) {
  return a.place.line == b.place.line && a.place.point == b.place.point && a.traction == b.traction &&
         a.pressure == b.pressure && act_together(a, b) && equal(a.history, b.history, duration);
}

}  // namespace

void warn_of_doubled_loads(const CaseNode& root, const std::vector<LoadOptions>& loads, double duration) {
  const auto nodes = root.list_or_empty("loads");
  for (std::size_t i = 0; i < loads.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (!equal(loads[i], loads[j], duration)) continue;
      const std::string place =
          loads[i].place.line.empty() ? std::string("there") : fmt::format("on line '{}'", loads[i].place.line);
      root.warn(fmt::format("loads/{}", i),
                fmt::format("is the same as {}: both act, so that the load {} is doubled; if it is meant, give "
                            "one of twice the size",
                            nodes[j].pointer(), place));
      break;
    }
}

void refuse_doubled_dashpots(const CaseNode& root, const std::vector<FreeFieldSide>& sides) {
  const auto nodes = root.object("boundaries").list_or_empty("free_field_dashpots");
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (sides[i].line == sides[j].line)
        nodes[i].fail("line", fmt::format("line '{}' has dashpots already ({}), and would take in waves twice",
                                          sides[i].line, nodes[j].pointer()));
}

void refuse_two_held_pressures(const CaseNode& root, const std::vector<HeldPressure>& held) {
  for (std::size_t i = 0; i < held.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (held[i].line == held[j].line && held[i].field != held[j].field)
        root.fail(held[i].where.substr(1),
                  fmt::format("line '{}' is held at another pore pressure already ({})", held[i].line, held[j].where));
}

}  // namespace tailrun::fem
