// newtonian_fluid: weakly compressible Newtonian fluid.
//
//   p = K (rho / rho_0 - 1), s = -p I + 2 eta dev(D)
//
// rho_0 belongs to the particle: it is such that each starts with the stress that it is given (a "stress" of the case
// file, or that of a particles file) at the mass and volume that it has. Without a stress it starts at no pressure.
//
// Linear in the density; Monaghan's (1994) exponent of 7 makes no difference at the small compression that is meant. K
// need not be the fluid's own: with waves ten times as fast as the flow, density varies by about one per cent. Pressure
// under zero is let go (allow_tension false): a fluid with a free surface comes apart.
//
// Viscous stress is explicit, so viscosity limits the time step (explicit_viscosity).
#include <algorithm>
#include <cmath>

#include "common/case_file.hpp"
#include "mpm_stage/material/plane_strain.hpp"
#include "mpm_stage/material/three_dimensions.hpp"

namespace tailrun::mpm {

namespace {

struct Own {
  bool allow_tension;
};

void read(const CaseNode& node, Material& m) {
  // Cure of volumetric locking.
  m.average_volumetric_strain = node.boolean_or("average_volumetric_strain", true);
  // Of particles made here; a particles file has its own masses and volumes.
  m.density = node.number("density", "kg/m3", Range::positive());
  // K.
  m.bulk_modulus = node.number("bulk_modulus", "Pa", Range::positive());
  // eta, dynamic.
  m.rate.consistency = node.number_or("viscosity", "Pa s", Range::non_negative(), 0.0);
  // Whether pressure may fall under zero, down to -K.
  m.own.set(Own{node.boolean_or("allow_tension", false)});
}

double lowest_pressure(const MaterialConstants& k) {
  return k.own.get<Own>().allow_tension ? -k.bulk : 0.0;
}

// m3/kg. Drops that come apart carry no stress; the room between them is not theirs.
double largest_specific_volume(const MaterialConstants& k) {
  return k.own.get<Own>().allow_tension ? 1e300 : k.largest_specific_volume;
}

// m3 at no pressure. Particles that a scene did not make are taken at the material's density.
template <int Dim>
double rest_volume(const MaterialConstants& k, const Particles<Dim>& P, std::size_t p) {
  return P.rest_volume.empty() ? P.mass[p] / k.reference_density : P.rest_volume[p];
}

double update_plane(const MaterialConstants& k, Particles<2>& P, std::size_t begin, std::size_t end,
                    const double* trace, double dt) {
  const PlaneColumns c(P, trace, begin);
  Vec4 dissipated = {};
  const double viscous = dt > 0.0 ? 2.0 * k.explicit_viscosity / dt : 0.0;
  const Vec4 low = splat(lowest_pressure(k));
  const double most = largest_specific_volume(k);
  const bool own = !P.rest_volume.empty();
  const double* rest = own ? P.rest_volume.data() + begin : c.mass;
  const double to_volume = own ? 1.0 : 1.0 / k.reference_density;
  for_each_group(
      0, end - begin, [&](const auto& g) __attribute__((always_inline)) {
        const Vec4 t = g.read(c.trace);
        const Vec4 growth = (1.0 + 0.25 * t) / (1.0 - 0.25 * t);
        const Vec4 volume = smaller(g.read(c.volume) * (growth * growth), most * g.read(c.mass));
        const Vec4 pressure = larger(low, k.bulk * (to_volume * g.read(rest) / volume - 1.0));
        const Vec4 gxx = g.read(c.gxx), gyy = g.read(c.gyy), third = (gxx + gyy) * (1.0 / 3.0);
        const Vec4 exx = gxx - third, eyy = gyy - third, exy = 0.5 * (g.read(c.gxy) + g.read(c.gyx));
        g.write(c.volume, volume);
        g.write(c.sxx, viscous * exx - pressure);
        g.write(c.syy, viscous * eyy - pressure);
        g.write(c.szz, -(viscous * third) - pressure);
        g.write(c.sxy, viscous * exy);
        dissipated += g.only(viscous * (exx * exx + eyy * eyy + third * third + 2.0 * exy * exy) * volume);
      });
  return sum_of_lanes(dissipated);
}

double update_solid(const MaterialConstants& k, Particles<3>& P, std::size_t begin, std::size_t end,
                    const double* trace, double dt) {
  double dissipated = 0.0;
  const double low = lowest_pressure(k);
  for (std::size_t p = begin; p < end; ++p) {
    const double t = trace[p - begin];
    const Matrix3 e = deviator_of(gradient_matrix(P, p));
    P.volume[p] = std::min(P.volume[p] * volume_ratio(t), largest_specific_volume(k) * P.mass[p]);
    const double pressure = std::max(low, k.bulk * (rest_volume(k, P, p) / P.volume[p] - 1.0));
    const double viscous = dt > 0.0 ? 2.0 * k.explicit_viscosity / dt : 0.0;
    store(P, p, viscous * e - pressure * Matrix3::Identity());
    dissipated += viscous * e.squaredNorm() * P.volume[p];
  }
  return dissipated;
}

// Work of the pressure K (1 / J - 1) on the compression from the volume at no pressure, `whole`, to J of it, J:
// K V_0 (J - 1 - ln J).
double stored_energy(const MaterialConstants& k, double whole, double volume) {
  const double J = volume / whole;
  return J < 1.0 || k.own.get<Own>().allow_tension ? k.bulk * whole * (J - 1.0 - std::log(J)) : 0.0;
}

template <int Dim>
double energy(const MaterialConstants& k, const Particles<Dim>& P, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t p = begin; p < end; ++p) sum += stored_energy(k, rest_volume(k, P, p), P.volume[p]);
  return sum;
}

template <int Dim>
double energy_after(const MaterialConstants& k, const Particles<Dim>& P, std::size_t p, double trace) {
  const double growth = (1.0 + 0.5 * trace / Dim) / (1.0 - 0.5 * trace / Dim);
  return stored_energy(k, rest_volume(k, P, p), P.volume[p] * std::pow(growth, Dim));
}

void set_constants(const Material& m, double /*cell_size*/, MaterialConstants& k) {
  k.bulk = m.bulk_modulus;
  k.explicit_viscosity = m.rate.consistency;
  k.own = m.own;
  k.plane = {update_plane, energy<2>, energy_after<2>};
  k.solid = {update_solid, energy<3>, energy_after<3>};
}

}  // namespace

namespace laws {
extern const MaterialLaw newtonian_fluid = {
    .name = "newtonian_fluid", .flows = true, .keeps_rest_volume = true, .read = read, .set_constants = set_constants};
}

}  // namespace tailrun::mpm
