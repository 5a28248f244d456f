// Moving bodies that never meet anything, or whose motion is of another time than the run's.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "mpm_stage/scene/request_checks.hpp"
#include "mpm_stage/scene/scene_checks.hpp"
#include "mpm_stage/scene/span.hpp"

namespace tailrun::mpm {

namespace {

using Box = std::array<Span, 3>;

constexpr double much_longer = 50.0;     // times the run
constexpr std::size_t few_rows = 3;      // within the run
constexpr double few_steps = 3.0;        // of the solver
constexpr double clear_of_ground = 2.0;  // cells

// Where `body` comes by within the run, m.
Box swept(const MovingBody<3>& body, double end) {
  constexpr int pieces = 2000;
  std::array<double, 3> at{};
  Box box;
  const double step = end / pieces;
  for (int i = 0; i <= pieces; ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      box[d].add(body.low[d] + at[d]);
      box[d].add(body.high[d] + at[d]);
    }
    const auto v = body.velocity_at((i + 0.5) * step);
    for (std::size_t d = 0; d < 3; ++d) at[d] += step * v[d];
  }
  return box;
}

// Of soil and ground as drawn; of the domain where there is one, for nothing is computed beyond it.
Box scene_box(const Scene& scene) {
  Box box;
  if (scene.walls.bounded) {
    for (std::size_t d = 0; d < 3; ++d) box[d] = {scene.walls.low[d], scene.walls.high[d]};
    return box;
  }
  for (std::size_t i = 0; i < scene.particles.position.size(); ++i) box[i % 3].add(scene.particles.position[i]);
  for (const TerrainInput& line : scene.terrain_lines)
    for (const auto& point : line.points)
      for (std::size_t d = 0; d < 2; ++d) box[d].add(point[d]);
  return box;
}

std::string text_of(const Box& box, int dimension) {
  std::string text;
  for (int d = 0; d < dimension; ++d)
    text += fmt::format("{}{} from {:.4g} to {:.4g} m", d ? ", " : "", "xyz"[d], box[d].low, box[d].high);
  return text;
}

// Flows go far beyond what is drawn, so that only what is farther off than all of it is large counts as off the scene.
void check_reach(const CaseNode& root, const std::string& key, const Scene& scene, const MovingBody<3>& body) {
  const Box way = swept(body, scene.end_time), all = scene_box(scene);
  const auto n = static_cast<std::size_t>(scene.dimension);
  double far = 0.0, size = 0.0;
  for (std::size_t d = 0; d < n; ++d) {
    far = std::max({far, way[d].low - all[d].high, all[d].low - way[d].high});
    size += all[d].length() * all[d].length();
  }
  if (far > (scene.walls.bounded ? 0.0 : std::sqrt(size)))
    return root.warn(
        key, fmt::format("'{}' is never near anything: on its way through the run it has {}; {} has {}", body.name,
                         text_of(way, scene.dimension), scene.walls.bounded ? "the domain" : "all soil and ground",
                         text_of(all, scene.dimension)));
  if (scene.terrain.empty()) return;
  constexpr int places = 100;
  for (int i = 0; i <= places; ++i)
    if (scene.terrain.distance(way[0].low + way[0].length() * i / places, way[1].high) >
        -clear_of_ground * scene.cell_size)
      return;
  root.warn(key, fmt::format("'{}' stays under the ground for the whole run ({}), where no soil comes to", body.name,
                             text_of(way, scene.dimension)));
}

void check_history(const CaseNode& root, const std::string& key, const Scene& scene, const MovingBody<3>& body,
                   double step) {
  if (body.time.size() < 2) return;
  const double first = body.time.front(), last = body.time.back(), end = scene.end_time;
  const auto within =
      static_cast<std::size_t>(std::count_if(body.time.begin(), body.time.end(), [end](double t) { return t <= end; }));
  if (first >= end)
    root.warn(key + "/velocity_history",
              fmt::format("begins at {:g} s, when the run of {:g} s is over: '{}' has its first velocity all the time; "
                          "{:g} ms are {:g} s",
                          first, end, body.name, first, 1e-3 * first));
  else if (last > much_longer * end && within <= few_rows)
    root.warn(
        key + "/velocity_history",
        fmt::format("goes to {:g} s, but the run is over after {:g} s, with {} of its {} rows; {:g} ms are {:g} s",
                    last, end, within, body.time.size(), last, 1e-3 * last));
  else if (body.time.size() > 2 && last - first < few_steps * step)
    root.warn(
        key + "/velocity_history",
        fmt::format("all its {} rows lie within {:.3g} s, but steps are {:.2g} s long, so that '{}' does not move "
                    "as they say; times are in s",
                    body.time.size(), last - first, step, body.name));
}

// Nodes can only have one velocity.
void check_doubled(const CaseNode& root, const std::string& key, const std::vector<MovingBody<3>>& bodies,
                   std::size_t b) {
  for (std::size_t o = 0; o < b; ++o) {
    if (bodies[o].low != bodies[b].low || bodies[o].high != bodies[b].high) continue;
    if (bodies[o].time != bodies[b].time || bodies[o].velocity != bodies[b].velocity)
      root.fail(key, fmt::format("'{}' begins in the place of '{}' (/bodies/{}) and moves otherwise; nodes have one "
                                 "velocity",
                                 bodies[b].name, bodies[o].name, o));
    root.warn(key, fmt::format("'{}' is where '{}' (/bodies/{}) is and moves as that does: soil pushes on one of them, "
                               "and bodies.csv has nothing for the other",
                               bodies[b].name, bodies[o].name, o));
  }
}

}  // namespace

void check_bodies(const CaseNode& root, const Scene& scene) {
  const auto& bodies = scene.walls.bodies;
  if (bodies.empty()) return;
  const double step = std::min(scene.solver.courant * scene.cell_size / fastest_wave(scene), scene.solver.maximum_step);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string key = fmt::format("bodies/{}", b);
    check_doubled(root, key, bodies, b);
    check_history(root, key, scene, bodies[b], step);
    check_reach(root, key, scene, bodies[b]);
  }
}

}  // namespace tailrun::mpm
