#include "common/plausible_voids.hpp"

#include <fmt/core.h>

namespace tailrun {
namespace {

constexpr double largest_share = 1.2;      // PM4Sand takes relative densities up to here
constexpr double largest_void_ratio = 15;  // 1

}  // namespace

void check_voids(const CaseNode& node) {
  for (const char* key : {"relative_density", "porosity", "saturation"})
    if (const auto share = node.peek(key); share && *share > largest_share && *share <= 100.0 * largest_share)
      node.fail(key, fmt::format("found {0:g}, but allowed is a fraction of at most 1; {0:g} % are {1:g}", *share,
                                 0.01 * *share));
  for (const char* key : {"e_min", "e_max", "void_ratio"})
    if (const auto voids = node.peek(key); voids && *voids > largest_void_ratio)
      node.fail(key, fmt::format("found {0:g}, but allowed is at most {1:g}: a void ratio is voids over grains, sand "
                                 "has 0.4 to 1.2; {0:g} % are {2:g}",
                                 *voids, largest_void_ratio, 0.01 * *voids));
}

}  // namespace tailrun
