// tresca: soil without friction (phi = 0), as liquefied or undrained soil flows: linear elastic up to s1 - s3 = 2 c,
// volume kept (Tresca; de Souza Neto, Peric & Owen 2008, 8.1).
//
// On the plane s2 keeps its value, on an edge it joins s1 or s3; the mean stress never changes. With "rate" the
// strength grows with the rate of shear: a Bingham or Herschel-Bulkley fluid with a yield stress.
//
// Strength does not follow the mean stress, so this soil takes both cures of volumetric locking, and the ground under
// it never holds more than its strength (soil_limit.hpp). Stresses are total ones unless "pore_pressure" says
// otherwise. The case file's residual_strength/factor scales its cohesion.
//
// Keys: those of elastic_solid.cpp and soil_strength.cpp, and what read() has.
#include "mpm_stage/material/elastic_solid.hpp"
#include "mpm_stage/material/elasto_plastic.hpp"
#include "mpm_stage/material/soil_strength.hpp"

namespace tailrun::mpm {

namespace {

void read(const CaseNode& node, Material& m) {
  // Cure of volumetric locking.
  m.average_volumetric_strain = node.boolean_or("average_volumetric_strain", true);
  read_elastic_solid(node, "total", m);
  read_strength(node, m);
  read_softening(node, m);
}

struct Tresca {
  explicit Tresca(const MaterialConstants&) {}

  template <bool Softens, class Real>
  [[gnu::always_inline]] PrincipalOf<Real> returned(Real c, Real /*share*/, PrincipalOf<Real> t) const {
    const Real excess = t.s1 - t.s3 - 2.0 * c;
    const Real p1 = t.s1 - 0.5 * excess, p3 = t.s3 + 0.5 * excess;
    const Real mean = (t.s1 + t.s2 + t.s3) * (1.0 / 3.0), third = 2.0 / 3.0 * c;
    const auto above = t.s2 > p1, below = t.s2 < p3;
    const Real q1 = above ? mean + third : (below ? mean + 2.0 * third : p1);
    const Real q2 = above ? mean + third : (below ? mean - third : t.s2);
    const Real q3 = above ? mean - 2.0 * third : (below ? mean - third : p3);
    const auto yields = excess > Real{};
    return {yields ? q1 : t.s1, yields ? q2 : t.s2, yields ? q3 : t.s3};
  }

  template <bool Softens, class Real>
  [[gnu::always_inline]] Real sin_phi(Real /*share*/) const {
    return constant<Real>(0.0);
  }
};

void set_constants(const Material& m, double cell_size, MaterialConstants& k) {
  set_elastic_constants(m, k);
  set_strength_constants(m, cell_size, k);
  k.phi_zero = true;
  set_elasto_plastic_loops<Tresca>(k);
}

}  // namespace

namespace laws {
extern const MaterialLaw tresca = {.name = "tresca",
                                   .flows = true,
                                   .residual_strength = true,
                                   .read = read,
                                   .set_constants = set_constants,
                                   .returned = elasto_plastic_return<Tresca>};
}

}  // namespace tailrun::mpm
