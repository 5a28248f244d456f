// "bodies" of mpm.json: boxes that move as prescribed.
#include <fmt/core.h>

#include <algorithm>

#include "mpm_stage/scene/key_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

std::vector<MovingBody<3>> read_bodies(const CaseNode& root, int dimension) {
  const auto n = static_cast<std::size_t>(dimension);
  std::vector<MovingBody<3>> bodies;
  for (const CaseNode& node : root.list_or_empty("bodies")) {
    MovingBody<3> body;
    body.name = node.text_or("name", fmt::format("body_{}", bodies.size()));
    require_column_word(node, "name", body.name);
    for (const MovingBody<3>& other : bodies)
      if (other.name == body.name) node.fail("name", fmt::format("'{}' is the name of two bodies", body.name));
    const auto low = node.numbers("low", "m", Range::any(), n), high = node.numbers("high", "m", Range::any(), n);
    for (std::size_t d = 0; d < n; ++d)
      if (!(high[d] > low[d])) node.fail("high", "must be larger than low in every direction");
    std::copy(low.begin(), low.end(), body.low.begin());
    std::copy(high.begin(), high.end(), body.high.begin());
    if (node.has("velocity_history")) {
      const auto rows = node.table("velocity_history", "s, m/s", n + 1);
      for (std::size_t r = 0; r < rows.size(); r += n + 1) {
        if (!body.time.empty() && !(rows[r] > body.time.back()))
          node.fail("velocity_history", fmt::format("time {} s does not come after {} s", rows[r], body.time.back()));
        body.time.push_back(rows[r]);
        body.velocity.emplace_back();
        std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(r) + 1, n, body.velocity.back().begin());
      }
      if (body.time.empty()) node.fail("velocity_history", "needs at least one row");
    } else {
      const auto v = node.numbers("velocity", "m/s", Range::any(), n);
      body.time.push_back(0.0);
      body.velocity.emplace_back();
      std::copy(v.begin(), v.end(), body.velocity.back().begin());
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

}  // namespace tailrun::mpm
