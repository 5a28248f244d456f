// linear_elastic: isotropic Hooke's law, incremental, in the frame that turns with the particle.
//
//   ds = lambda tr(de) I + 2 mu de, the old stress turned by Hughes & Winget's (1980) midpoint rotation
//
// For bodies that are strong beside their load (walls, beams, rock), and for verification: closed forms exist. It never
// yields, so its surface lasts, and it does not flow: the front looks at other materials where there are any.
//
// Keys: average_volumetric_strain (false) and those of elastic_solid.cpp (density, youngs_modulus, poisson_ratio,
// pore_pressure (total), pore_stiffness).
#include "common/case_file.hpp"
#include "mpm_stage/material/elastic_energy.hpp"
#include "mpm_stage/material/elastic_solid.hpp"
#include "mpm_stage/material/plane_strain.hpp"
#include "mpm_stage/material/three_dimensions.hpp"

namespace tailrun::mpm {

namespace {

void read(const CaseNode& node, Material& m) {
  // Cure of volumetric locking.
  m.average_volumetric_strain = node.boolean_or("average_volumetric_strain", false);
  read_elastic_solid(node, "total", m);
}

double update_plane(const MaterialConstants& k, Particles<2>& P, std::size_t begin, std::size_t end,
                    const double* trace, double /*dt*/) {
  const PlaneColumns c(P, trace, begin);
  for_each_group(
      0, end - begin, [&](const auto& g) __attribute__((always_inline)) {
        const PlaneTrial t = elastic_trial(k, c, g);
        g.write(c.sxx, t.p + t.q);
        g.write(c.syy, t.p - t.q);
        g.write(c.szz, t.zz);
        g.write(c.sxy, t.r);
        g.write(c.volume, g.read(c.volume) * t.volume_ratio);
      });
  return 0.0;
}

double update_solid(const MaterialConstants& k, Particles<3>& P, std::size_t begin, std::size_t end,
                    const double* trace, double /*dt*/) {
  for (std::size_t p = begin; p < end; ++p) {
    const double t = trace[p - begin];
    const Matrix3 G = gradient_matrix(P, p), e = deviator_of(G);
    P.volume[p] *= volume_ratio(t);
    store(P, p, elastic_trial(k, P, p, G, e, t));
  }
  return 0.0;
}

void set_constants(const Material& m, double /*cell_size*/, MaterialConstants& k) {
  set_elastic_constants(m, k);
  k.plane = {update_plane, isotropic_energy};
  k.solid = {update_solid, isotropic_energy};
}

}  // namespace

namespace laws {
extern const MaterialLaw linear_elastic = {
    .name = "linear_elastic", .moves = false, .keeps_surface = true, .read = read, .set_constants = set_constants};
}

}  // namespace tailrun::mpm
