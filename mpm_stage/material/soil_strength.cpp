#include "mpm_stage/material/soil_strength.hpp"

#include <fmt/core.h>

namespace tailrun::mpm {

namespace {

void read_cohesion(const CaseNode& node, Material& m) {
  // c, of phi = 0 soil its undrained strength.
  if (node.is_number("cohesion")) {
    m.cohesion = node.number("cohesion", "Pa", Range::non_negative());
    return;
  }
  // From the particles' residual_strength, or from sigma'_v0 at the hand-over by a table or a ratio.
  node.choice("cohesion", {"from_particles", "table", "ratio"});
  const std::string law = node.text("cohesion");
  m.cohesion_from_particles = law == "from_particles";
  // Least that a table or a ratio gives.
  m.minimum_cohesion = node.number_or("minimum_cohesion", "Pa", Range::non_negative(), 100.0);
  if (law == "table") {
    // Rows [sigma'_v0, c], linear in between.
    m.cohesion_table = node.table("cohesion_table", "Pa", 2);
    for (std::size_t i = 2; i < m.cohesion_table.size(); i += 2)
      if (!(m.cohesion_table[i] > m.cohesion_table[i - 2]))
        node.fail("cohesion_table", "the first column (sigma'_v0, Pa) must increase from row to row");
    if (m.cohesion_table.empty()) node.fail("cohesion_table", "needs at least one row [sigma'_v0, cohesion]");
  }
  // c / sigma'_v0.
  if (law == "ratio") m.cohesion_ratio = node.number("cohesion_ratio", "1", Range::between(0.0, 2.0));
}

}  // namespace

void read_strength(const CaseNode& node, Material& m) {
  read_cohesion(node, m);
  // Largest principal tension; none unless given.
  if (const auto cut = node.number_if("tension_cutoff", "Pa", Range::non_negative())) m.tension_cutoff = *cut;
  // K and n of tau = c + K (rate of shear)^n.
  if (const auto rate = node.object_if("rate")) {
    m.rate.consistency = rate->number("consistency", "Pa s^n", Range::non_negative());
    m.rate.exponent = rate->number_or("exponent", "1", Range::between(0.1, 2.0), 1.0);
  }
}

std::optional<CaseNode> read_softening(const CaseNode& node, Material& m) {
  const auto soft = node.object_if("softening");
  if (!soft) return soft;
  Softening& s = m.softening;
  s.active = true;
  s.shape = soft->choice_or("shape", {"linear", "exponential"}, "linear") == "linear" ? SofteningShape::linear
                                                                                      : SofteningShape::exponential;
  // Deviatoric plastic strains between which strength falls; exponential: the second is the e-folding strain.
  s.start_strain = soft->number_or("start_strain", "1", Range::non_negative(), 0.0);
  s.end_strain = soft->number("end_strain", "1", Range::positive());
  if (s.shape == SofteningShape::linear && s.end_strain <= s.start_strain)
    soft->fail("end_strain", fmt::format("must be larger than start_strain = {}", s.start_strain));
  // Width of the band that the strains belong to; 0: they hold on any grid.
  s.reference_length = soft->number_or("reference_length", "m", Range::non_negative(), 0.0);
  // Residual over peak.
  s.cohesion_ratio = soft->number_or("cohesion_ratio", "1", Range::between(0.0, 1.0), 1.0);
  return soft;
}

void set_strength_constants(const Material& m, double cell_size, MaterialConstants& k) {
  k.tension = m.tension_cutoff;
  const Softening& s = m.softening;
  k.softens = s.active;
  k.exponential = s.shape == SofteningShape::exponential;
  const double scale = s.reference_length > 0.0 ? s.reference_length / cell_size : 1.0;
  k.soften_start = s.start_strain * scale;
  k.soften_scale = (k.exponential ? s.end_strain : s.end_strain - s.start_strain) * scale;
  k.cohesion_ratio = s.active ? s.cohesion_ratio : 1.0;
  k.consistency = m.rate.consistency;
  k.exponent = m.rate.exponent;
}

}  // namespace tailrun::mpm
