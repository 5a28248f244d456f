// "particles" of mpm.json: boxes and polygons filled with particles, for scenes that need no other program.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/error.hpp"
#include "mpm_stage/scene/polygon.hpp"
#include "mpm_stage/scene/request_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

// Initial stress, velocity field and position of what one entry of "particles" makes.
struct Filling {
  std::array<double, 3> low, high;  // m
  std::vector<double> polygon;      // m, (n, 2); empty for a box
  std::array<int, 3> count{1, 1, 1};
  bool random = false;
  unsigned seed = 1;
  std::array<double, 3> velocity{};
  double spin = 0.0;  // 1/s, about the centre, in the x-y plane
  std::array<double, 3> centre{};
  std::vector<double> wave;  // amplitude (m/s), wave number (1/m), axes of motion and variation, phase
  bool geostatic = false;
  std::array<double, 2> surface{};     // m, a point of the free surface
  double slope = 0.0;                  // radians, of the surface, positive where it falls with x
  double shear_ratio = 0.0, k0 = 1.0;  // shear over normal stress on planes parallel to the surface
  double rotation = 0.0;               // radians, of a box about its low corner

  // Whether x (m) lies in the shape, and not on its edge.
  bool contains(const double* x, int dimension) const {
    if (!polygon.empty()) return inside_polygon(polygon, x[0], x[1]);
    const double c = std::cos(rotation), s = std::sin(rotation), dx = x[0] - low[0], dy = x[1] - low[1];
    const std::array<double, 3> in = {low[0] + c * dx + s * dy, low[1] - s * dx + c * dy, x[2]};
    for (int d = 0; d < dimension; ++d) {
      const double edge = 1e-9 * (high[d] - low[d]);
      if (!(in[d] > low[d] + edge && in[d] < high[d] - edge)) return false;
    }
    return true;
  }
};

// A shape and the rows of the particles that it made.
struct Filled {
  Filling shape;
  std::size_t begin, end;
};

// Particles of one shape inside another would be soil of twice the density. Refuses them, with the count and the place.
void check_overlap(const CaseNode& node, const ParticleSet& set, const std::vector<Filled>& before, const Filled& now) {
  for (std::size_t k = 0; k < before.size(); ++k) {
    std::size_t count = 0, place = 0;
    const auto look = [&](const Filled& particles, const Filled& other) {
      for (std::size_t p = particles.begin; p < particles.end; ++p) {
        if (!other.shape.contains(&set.position[3 * p], set.dimension)) continue;
        if (count++ == 0) place = p;
      }
    };
    look(now, before[k]);
    look(before[k], now);
    if (count == 0) continue;
    const double* x = &set.position[3 * place];
    node.fail(
        "shape",
        fmt::format("this shape overlaps /particles/{}: {} of the {} particles of both lie in the other, the "
                    "first at {}, and would double the density there; let the shapes meet at their edges",
                    k, count, now.end - now.begin + before[k].end - before[k].begin, place_text(x, set.dimension)));
  }
}

// A surface under the whole shape gives it no stress.
void check_stress(const CaseNode& node, const ParticleSet& set, const Filled& now) {
  const auto components = static_cast<std::ptrdiff_t>(set.components());
  const auto first = set.effective_stress.begin();
  if (now.shape.geostatic &&
      std::all_of(first + components * static_cast<std::ptrdiff_t>(now.begin),
                  first + components * static_cast<std::ptrdiff_t>(now.end), [](double s) { return s == 0.0; }))
    node.warn("stress",
              fmt::format("gives no stress: its surface, y = {:g} m{}, lies under the whole shape, or gravity is "
                          "0",
                          now.shape.surface[1],
                          now.shape.slope != 0.0 ? fmt::format(" at x = {:g} m", now.shape.surface[0]) : ""));
}

// Refuses an outline that has no one inside: mass would be that of the signed area, none for a figure of eight.
void check_polygon(const CaseNode& node, const std::vector<double>& polygon) {
  if (polygon.size() < 6) node.fail("points", "a polygon needs at least 3 points");
  if (const auto crossing = polygon_crossing(polygon))
    node.fail("points",
              fmt::format("the polygon crosses itself: its edges from points {} and {} (counted from 0) meet at "
                          "({:.6g}, {:.6g}) m; list the points in order around the body",
                          crossing->first, crossing->second, crossing->point[0], crossing->point[1]));
  const double length = polygon_perimeter(polygon);
  if (!(polygon_area(polygon) > 1e-10 * length * length))
    node.fail("points",
              fmt::format("the polygon has no area: its {} points, from ({:.6g}, {:.6g}) m on, lie on a line or "
                          "its parts turn against each other",
                          polygon.size() / 2, polygon[0], polygon[1]));
}

Filling read_filling(const CaseNode& node, int dimension, double h, const std::array<double, 3>& origin) {
  Filling f;
  const std::string shape = node.choice("shape", {"box", "polygon"});
  if (shape == "polygon") {
    if (dimension == 3) node.fail("shape", "a polygon needs dimension 2");
    f.polygon = node.table("points", "m", 2);
    check_polygon(node, f.polygon);
    f.low = {f.polygon[0], f.polygon[1], 0.0};
    f.high = f.low;
    for (std::size_t i = 0; i < f.polygon.size(); ++i) {
      f.low[i % 2] = std::min(f.low[i % 2], f.polygon[i]);
      f.high[i % 2] = std::max(f.high[i % 2], f.polygon[i]);
    }
    // Points lie on the grid's own pattern, so that a polygon that follows cell edges is filled evenly.
    for (int d = 0; d < 2; ++d) {
      f.low[d] = origin[d] + std::floor((f.low[d] - origin[d]) / h + 1e-9) * h;
      f.high[d] = origin[d] + std::ceil((f.high[d] - origin[d]) / h - 1e-9) * h;
    }
  } else {
    const auto low = node.numbers("low", "m", Range::any(), static_cast<std::size_t>(dimension));
    const auto high = node.numbers("high", "m", Range::any(), static_cast<std::size_t>(dimension));
    for (int d = 0; d < dimension; ++d) {
      if (!(high[d] > low[d])) node.fail("high", "must be larger than low in every direction");
      f.low[d] = low[d];
      f.high[d] = high[d];
    }
    f.rotation = node.number_or("rotation", "deg", Range::between(-180.0, 180.0), 0.0) * M_PI / 180.0;
    if (f.rotation != 0.0 && dimension == 3) node.fail("rotation", "needs dimension 2");
  }
  const int per_cell = static_cast<int>(node.integer_or("points_per_cell_side", 1, 10, 2));
  std::array<double, 3> along{1.0, 1.0, 1.0};
  for (int d = 0; d < dimension; ++d) along[d] = (f.high[d] - f.low[d]) / h * per_cell;
  check_particle_count(node, along, dimension);
  for (int d = 0; d < dimension; ++d) f.count[d] = std::max(1, static_cast<int>(std::lround(along[d])));
  f.random = node.choice_or("placement", {"regular", "random"}, "regular") == "random";
  f.seed = static_cast<unsigned>(node.integer_or("seed", 0, 1000000, 1));
  const auto velocity = node.numbers_or("velocity", "m/s", Range::any(), std::vector<double>(dimension, 0.0),
                                        static_cast<std::size_t>(dimension));
  for (int d = 0; d < dimension; ++d) {
    f.velocity[d] = velocity[d];
    f.centre[d] = 0.5 * (f.low[d] + f.high[d]);
  }
  f.spin = node.number_or("angular_velocity", "rad/s", Range::any(), 0.0);
  if (const auto wave = node.object_if("velocity_wave")) {
    f.wave = {wave->number("amplitude", "m/s", Range::any()), wave->number("wave_number", "1/m", Range::any()),
              static_cast<double>(wave->integer_or("motion_axis", 0, dimension - 1, 0)),
              static_cast<double>(wave->integer_or("variation_axis", 0, dimension - 1, 0)),
              wave->number_or("phase", "rad", Range::any(), 0.0)};
  }
  if (const auto stress = node.object_if("stress")) {
    f.geostatic = true;
    if (stress->choice("kind", {"geostatic", "slope"}) == "geostatic") {
      f.surface = {0.0, stress->number("surface", "m", Range::any())};
    } else {
      const auto point = stress->numbers("surface_point", "m", Range::any(), 2);
      f.surface = {point[0], point[1]};
      f.slope = stress->number("angle", "deg", Range::between(-89.0, 89.0)) * M_PI / 180.0;
      f.shear_ratio = stress->number_or("shear_ratio", "1", Range::any(), std::tan(f.slope));
    }
    f.k0 = stress->number_or("k0", "1", Range::between(0.0, 5.0), 1.0);
  }
  return f;
}

// Velocity (m/s) and its gradient (1/s, [3 i + j]) at x, before the box is turned.
struct Motion {
  std::array<double, 3> v;
  std::array<double, 9> gradient{};
};

Motion motion_at(const Filling& f, const std::array<double, 3>& x) {
  Motion m{f.velocity};
  m.v[0] -= f.spin * (x[1] - f.centre[1]);
  m.v[1] += f.spin * (x[0] - f.centre[0]);
  m.gradient[1] = -f.spin;
  m.gradient[3] = f.spin;
  if (!f.wave.empty()) {
    const auto motion = static_cast<std::size_t>(f.wave[2]), variation = static_cast<std::size_t>(f.wave[3]);
    const double angle = f.wave[1] * (x[variation] - f.low[variation]) + f.wave[4];
    m.v[motion] += f.wave[0] * std::sin(angle);
    m.gradient[3 * motion + variation] += f.wave[0] * f.wave[1] * std::cos(angle);
  }
  return m;
}

// v <- Q v and gradient <- Q gradient Q^T, Q turning the x-y plane.
void turn(double c, double s, Motion& m) {
  m.v = {c * m.v[0] - s * m.v[1], s * m.v[0] + c * m.v[1], m.v[2]};
  const std::array<double, 9> Q = {c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0}, g = m.gradient;
  m.gradient = {};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) m.gradient[3 * i + j] += Q[3 * i + k] * g[3 * k + l] * Q[3 * j + l];
}

void fill(const CaseNode& node, const Filling& f, int dimension, int material, double density,
          const std::array<double, 3>& gravity, ParticleSet& set, std::vector<double>& gradient) {
  std::array<double, 3> size{1.0, 1.0, 1.0};
  for (int d = 0; d < dimension; ++d) size[d] = (f.high[d] - f.low[d]) / f.count[d];
  const double volume = size[0] * size[1] * size[2];
  std::mt19937 random(f.seed);
  std::uniform_real_distribution<double> jitter(0.0, 1.0);
  const std::size_t first = set.count();
  for (int k = 0; k < f.count[2]; ++k)
    for (int j = 0; j < f.count[1]; ++j)
      for (int i = 0; i < f.count[0]; ++i) {
        const std::array<int, 3> index = {i, j, k};
        std::array<double, 3> x{};
        for (int d = 0; d < dimension; ++d) x[d] = f.low[d] + (index[d] + (f.random ? jitter(random) : 0.5)) * size[d];
        if (!f.polygon.empty() && !inside_polygon(f.polygon, x[0], x[1])) continue;
        Motion motion = motion_at(f, x);
        if (f.rotation != 0.0) {
          const double c = std::cos(f.rotation), s = std::sin(f.rotation), dx = x[0] - f.low[0], dy = x[1] - f.low[1];
          x[0] = f.low[0] + c * dx - s * dy;
          x[1] = f.low[1] + s * dx + c * dy;
          turn(c, s, motion);
        }
        gradient.insert(gradient.end(), motion.gradient.begin(), motion.gradient.end());
        for (int d = 0; d < 3; ++d) {
          set.position.push_back(x[d]);
          set.velocity.push_back(motion.v[d]);
        }
        set.mass.push_back(density * volume);
        set.volume.push_back(volume);
        set.material_id.push_back(material);
        std::vector<double> stress = {0.0, 0.0, 0.0};
        if (f.geostatic) {
          // Infinite slope: stresses grow with the distance to the surface; turned into the axes.
          const double c = std::cos(f.slope), sn = std::sin(f.slope);
          const double depth = std::max(0.0, (f.surface[0] - x[0]) * sn + (f.surface[1] - x[1]) * c);
          const double normal = density * gravity[1] * c * depth, along = f.k0 * normal,
                       shear = -f.shear_ratio * normal;
          const double xx = along * c * c + normal * sn * sn + 2.0 * shear * c * sn;
          const double yy = along * sn * sn + normal * c * c - 2.0 * shear * c * sn;
          const double xy = (normal - along) * c * sn + shear * (c * c - sn * sn);
          stress = {xx, yy, f.k0 * normal, xy};
        }
        stress.resize(static_cast<std::size_t>(set.components()), 0.0);
        set.effective_stress.insert(set.effective_stress.end(), stress.begin(), stress.end());
      }
  // A polygon's particles share its exact area.
  if (!f.polygon.empty() && set.count() > first) {
    const double area = polygon_area(f.polygon), filled = volume * static_cast<double>(set.count() - first);
    // Both differ by what the outline cuts off of particles' squares, unless parts of the outline turn against each
    // other.
    if (std::fabs(filled - area) > polygon_perimeter(f.polygon) * (size[0] + size[1]))
      node.fail("points",
                fmt::format("the polygon overlaps or touches itself: its outline holds {:.4g} m2, the particles "
                            "inside it {:.4g} m2; make one polygon of each part",
                            area, filled));
    const double scale = area / filled;
    for (std::size_t p = first; p < set.count(); ++p) {
      set.mass[p] *= scale;
      set.volume[p] *= scale;
    }
  }
}

}  // namespace

void generate_particles(const CaseNode& root, const std::vector<Material>& materials, Scene& scene) {
  ParticleSet set;
  set.dimension = scene.dimension;
  std::vector<std::string> names;
  for (const auto& m : materials) names.push_back(m.name);
  std::vector<Filled> shapes;
  for (const CaseNode& node : root.list("particles")) {
    const std::string name = node.text("material");
    std::size_t material = 0;
    while (material < names.size() && names[material] != name) ++material;
    if (material == names.size())
      node.fail("material", fmt::format("'{}' is not one of the materials ({}).{}", name, joined(names),
                                        did_you_mean(name, names)));
    if (materials[material].law->rigid) node.fail("material", "particles cannot be of a rigid material");
    Filled now{read_filling(node, scene.dimension, scene.cell_size, scene.origin), set.count(), 0};
    fill(node, now.shape, scene.dimension, static_cast<int>(material), materials[material].density, scene.gravity, set,
         scene.velocity_gradient);
    now.end = set.count();
    if (now.end == now.begin)
      node.fail("shape",
                fmt::format("no particle lies inside this shape, which is thinner than the particles' spacing of "
                            "{:.4g} m; more points_per_cell_side or smaller cells may fill it",
                            scene.cell_size / static_cast<double>(node.integer_or("points_per_cell_side", 1, 10, 2))));
    check_overlap(node, set, shapes, now);
    check_stress(node, set, now);
    shapes.push_back(std::move(now));
  }
  if (set.count() == 0) root.fail("particles", "no particle lies inside the shapes given");
  set.material_names = names;
  set.region_names = {"scene"};
  set.region_id.assign(set.count(), 0);
  set.pore_pressure.assign(set.count(), 0.0);
  double volume = 0.0;
  for (const double v : set.volume) volume += v;
  set.particle_size = std::pow(volume / static_cast<double>(set.count()), 1.0 / scene.dimension);
  scene.particles = std::move(set);
}

}  // namespace tailrun::mpm
