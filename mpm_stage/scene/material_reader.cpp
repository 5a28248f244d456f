// "materials" of mpm.json: each entry names a law ("model"), which reads the others of its keys (material/).
#include "mpm_stage/material/material_list.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

Material read_material(const std::string& name, const CaseNode& node, double residual_factor) {
  Material m;
  m.name = name;
  m.law = &law_named(node.choice("model", law_names()));
  m.law->read(node, m);
  // The factor for reruns with another residual strength: on strengths of liquefied soil (phi = 0) alone.
  m.cohesion_factor = m.law->residual_strength ? residual_factor : 1.0;
  return m;
}

}  // namespace tailrun::mpm
