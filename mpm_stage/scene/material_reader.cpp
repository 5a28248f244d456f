// "materials" of mpm.json.
#include <fmt/format.h>

#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

void read_cohesion(const CaseNode& node, Material& m, double residual_factor) {
  if (node.is_number("cohesion")) {
    m.cohesion = node.number("cohesion", "Pa", Range::non_negative());
  } else {
    node.choice("cohesion", {"from_particles", "table", "ratio"});
    const std::string law = node.text("cohesion");
    m.cohesion_from_particles = law == "from_particles";
    m.minimum_cohesion = node.number_or("minimum_cohesion", "Pa", Range::non_negative(), 100.0);
    if (law == "table") {
      m.cohesion_table = node.table("cohesion_table", "Pa", 2);
      for (std::size_t i = 2; i < m.cohesion_table.size(); i += 2)
        if (!(m.cohesion_table[i] > m.cohesion_table[i - 2]))
          node.fail("cohesion_table", "the first column (sigma'_v0, Pa) must increase from row to row");
      if (m.cohesion_table.empty()) node.fail("cohesion_table", "needs at least one row [sigma'_v0, cohesion]");
    }
    if (law == "ratio") m.cohesion_ratio = node.number("cohesion_ratio", "1", Range::between(0.0, 2.0));
  }
  // The factor for reruns with another residual strength: on strengths of liquefied soil (phi = 0) alone.
  m.cohesion_factor = m.model == Model::tresca ? residual_factor : 1.0;
}

void read_softening(const CaseNode& node, Material& m) {
  const auto soft = node.object_if("softening");
  if (!soft) return;
  Softening& s = m.softening;
  s.active = true;
  s.shape = soft->choice_or("shape", {"linear", "exponential"}, "linear") == "linear" ? SofteningShape::linear
                                                                                      : SofteningShape::exponential;
  s.start_strain = soft->number_or("start_strain", "1", Range::non_negative(), 0.0);
  s.end_strain = soft->number("end_strain", "1", Range::positive());
  if (s.shape == SofteningShape::linear && s.end_strain <= s.start_strain)
    soft->fail("end_strain", fmt::format("must be larger than start_strain = {}", s.start_strain));
  s.reference_length = soft->number_or("reference_length", "m", Range::non_negative(), 0.0);
  s.cohesion_ratio = soft->number_or("cohesion_ratio", "1", Range::between(0.0, 1.0), 1.0);
  if (m.model == Model::mohr_coulomb)
    if (const auto phi = soft->number_if("residual_friction_angle", "deg", Range::between(0.1, m.friction_angle)))
      s.residual_friction = *phi;
}

}  // namespace

Material read_material(const std::string& name, const CaseNode& node, double residual_factor) {
  Material m;
  m.name = name;
  const std::string model =
      node.choice("model", {"linear_elastic", "mohr_coulomb", "tresca", "newtonian_fluid", "rigid"});
  m.model = model == "linear_elastic"    ? Model::linear_elastic
            : model == "mohr_coulomb"    ? Model::mohr_coulomb
            : model == "tresca"          ? Model::tresca
            : model == "newtonian_fluid" ? Model::newtonian_fluid
                                         : Model::rigid;
  if (m.model == Model::rigid) return m;
  m.average_volumetric_strain =
      node.boolean_or("average_volumetric_strain", m.model == Model::tresca || m.model == Model::newtonian_fluid);
  if (m.model == Model::newtonian_fluid) {
    m.density = node.number("density", "kg/m3", Range::positive());
    m.bulk_modulus = node.number("bulk_modulus", "Pa", Range::positive());
    m.rate.consistency = node.number_or("viscosity", "Pa s", Range::non_negative(), 0.0);
    m.allow_tension = node.boolean_or("allow_tension", false);
    return m;
  }
  m.density = node.number_or("density", "kg/m3", Range::positive(), 2000.0);
  m.youngs_modulus = node.number("youngs_modulus", "Pa", Range::positive());
  m.poisson_ratio = node.number("poisson_ratio", "1", {-0.9, 0.4999, false, false});
  const std::string pore = node.choice_or("pore_pressure", {"total", "frozen", "undrained"},
                                          m.model == Model::mohr_coulomb ? "frozen" : "total");
  m.pore_pressure = pore == "total"    ? PorePressure::total
                    : pore == "frozen" ? PorePressure::frozen
                                       : PorePressure::undrained;
  if (m.pore_pressure == PorePressure::undrained)
    m.pore_stiffness = node.number("pore_stiffness", "Pa", Range::positive());
  if (m.model == Model::linear_elastic) return m;
  if (m.model == Model::mohr_coulomb) {
    m.friction_angle = node.number("friction_angle", "deg", Range::between(0.1, 60.0));
    m.dilation_angle = node.number_or("dilation_angle", "deg", Range::between(0.0, m.friction_angle), 0.0);
  }
  read_cohesion(node, m, residual_factor);
  if (const auto cut = node.number_if("tension_cutoff", "Pa", Range::non_negative())) m.tension_cutoff = *cut;
  if (const auto rate = node.object_if("rate")) {
    m.rate.consistency = rate->number("consistency", "Pa s^n", Range::non_negative());
    m.rate.exponent = rate->number_or("exponent", "1", Range::between(0.1, 2.0), 1.0);
  }
  read_softening(node, m);
  return m;
}

}  // namespace tailrun::mpm
