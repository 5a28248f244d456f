// Whether particles lie where they can be computed. What is wrong for most of them is refused, what is for some is a
// warning and a remark in the summary, each with the count and a place.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/log.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

void warn(Scene& scene, const std::string& text) {
  log_warn("{}", text);
  scene.remarks.push_back(text);
}

std::string material_of(const Scene& scene, std::size_t p) {
  return scene.materials[static_cast<std::size_t>(scene.particles.material_id[p])].name;
}

// What lies outside of the domain would leave it in the first step: an error unless the scene says what becomes of it,
// and one in any case where nothing is left.
void check_inside_domain(const CaseNode& root, const Scene& scene) {
  const Walls<3>& walls = scene.walls;
  if (!walls.bounded) return;
  const ParticleSet& set = scene.particles;
  std::size_t outside = 0, first = 0;
  for (std::size_t p = 0; p < set.count(); ++p) {
    bool inside = true;
    for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimension); ++d)
      inside = inside && set.position[3 * p + d] >= walls.low[d] && set.position[3 * p + d] <= walls.high[d];
    if (inside || outside++ > 0) continue;
    first = p;
  }
  if (outside == 0) return;
  const std::string found = fmt::format(
      "{} of {} particles lie outside of the domain, which goes from {} to {}; the first is '{}' at {}", outside,
      set.count(), place_text(walls.low.data(), set.dimension), place_text(walls.high.data(), set.dimension),
      material_of(scene, first), place_text(&set.position[3 * first], set.dimension));
  if (walls.leaving == LeavingParticles::error || outside == set.count()) root.fail("domain", found);
  root.warn("domain", fmt::format("{}; leaving_particles {} in the first step", found,
                                  walls.leaving == LeavingParticles::remove ? "'remove' takes them out"
                                                                            : "'wall' moves them to its sides"));
}

// Material lies on the left of a line. Nothing holds what lies on its right, and a line drawn from the wrong end has
// all of it there.
void check_sides(const CaseNode& root, Scene& scene) {
  const ParticleSet& set = scene.particles;
  const std::size_t n = set.count();
  // Less than a quarter of a particle is what cutting a body along a line leaves.
  const double shallow = 0.25 * set.particle_size;
  for (std::size_t l = 0; l < scene.terrain_lines.size(); ++l) {
    const TerrainInput& line = scene.terrain_lines[l];
    Terrain alone;
    alone.add_line(line.points, line.friction, line.adhere);
    std::size_t behind = 0, deepest = 0;
    double depth = 0.0;
    for (std::size_t p = 0; p < n; ++p) {
      const double d = -alone.distance(set.position[3 * p], set.position[3 * p + 1]);
      if (!(d > shallow)) continue;
      ++behind;
      if (d > depth) {
        depth = d;
        deepest = p;
      }
    }
    if (behind == 0) continue;
    const std::string found = fmt::format(
        "{} of {} particles lie behind terrain line '{}', up to {:.4g} m deep ('{}' at {})", behind, n, line.name,
        depth, material_of(scene, deepest), place_text(&set.position[3 * deepest], set.dimension));
    if (2 * behind > n)
      root.fail(
          fmt::format("terrain/{}", l),
          found +
              "; material lies on the left of a line as it is drawn: give its points in the other order, or put the "
              "particles above it");
    warn(scene, found + "; the ground does not hold them");
  }
}

// Soil that nothing carries falls until it meets the ground: where that is farther below than the soil is high, one of
// the two is on another datum.
void check_hanging(const CaseNode& root, const Scene& scene) {
  if (scene.terrain.empty() || scene.walls.any_wall() || !scene.walls.bodies.empty()) return;
  const ParticleSet& set = scene.particles;
  double least = std::numeric_limits<double>::infinity(), low = least, high = -least;
  std::size_t nearest = 0;
  for (std::size_t p = 0; p < set.count(); ++p) {
    const double* x = &set.position[3 * p];
    low = std::min(low, x[1]);
    high = std::max(high, x[1]);
    const double d = scene.terrain.distance(x[0], x[1]);
    if (d >= least) continue;
    least = d;
    nearest = p;
  }
  if (least > std::max(4.0 * scene.cell_size, high - low))
    root.warn("terrain",
              fmt::format("all soil hangs in the air: the particle nearest to the ground is {:.4g} m off ('{}' "
                          "at {}); are soil and ground heights y of one datum?",
                          least, material_of(scene, nearest), place_text(&set.position[3 * nearest], set.dimension)));
}

// Rows of particles in the same place: the same particle twice.
void check_duplicates(const CaseNode& root, const Scene& scene) {
  const ParticleSet& set = scene.particles;
  std::vector<std::size_t> order(set.count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t p) {
    return std::array{set.position[3 * p], set.position[3 * p + 1], set.position[3 * p + 2]};
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  std::size_t count = 0, first = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (place(order[k - 1]) != place(order[k])) continue;
    if (count++ == 0) first = order[k];
  }
  if (count > 0)
    root.fail("particles",
              fmt::format("{} of {} particles lie exactly where another one does, the first at {} ('{}'): the "
                          "density there is doubled",
                          count, set.count(), place_text(&set.position[3 * first], set.dimension),
                          material_of(scene, first)));
}

// Volume of the particles in cubes of four cells, which hold at most their own: bodies laid over each other show here
// whatever made them. Half more is left for cubes that particles askew to the grid fill unevenly.
void check_room(Scene& scene) {
  const ParticleSet& set = scene.particles;
  const double edge = 4.0 * scene.cell_size, room = std::pow(edge, scene.dimension);
  using Cube = std::array<long, 3>;
  std::vector<std::pair<Cube, std::size_t>> cubes(set.count());
  for (std::size_t p = 0; p < set.count(); ++p) {
    Cube c{};
    for (int d = 0; d < scene.dimension; ++d)
      c[static_cast<std::size_t>(d)] = std::lround(std::floor((set.position[3 * p + d] - scene.origin[d]) / edge));
    cubes[p] = {c, p};
  }
  std::sort(cubes.begin(), cubes.end());
  std::size_t crowded = 0, particles = 0, place = 0;
  double fullest = 0.0;
  for (std::size_t k = 0; k < cubes.size();) {
    double volume = 0.0;
    const std::size_t first = k;
    for (; k < cubes.size() && cubes[k].first == cubes[first].first; ++k) volume += set.volume[cubes[k].second];
    if (volume <= 1.5 * room) continue;
    ++crowded;
    particles += k - first;
    if (volume > fullest) {
      fullest = volume;
      place = cubes[first].second;
    }
  }
  if (crowded > 0)
    warn(scene,
         fmt::format("{} particles have more volume than the place that they lie in, up to {:.2f} times at {}: are "
                     "there bodies laid over each other?",
                     particles, fullest / room, place_text(&set.position[3 * place], set.dimension)));
}

}  // namespace

std::string place_text(const double* x, int dimension) {
  return dimension == 2 ? fmt::format("({:.6g}, {:.6g}) m", x[0], x[1])
                        : fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]);
}

void check_placement(const CaseNode& root, Scene& scene) {
  check_inside_domain(root, scene);
  check_sides(root, scene);
  check_hanging(root, scene);
  check_duplicates(root, scene);
  check_room(scene);
}

}  // namespace tailrun::mpm
