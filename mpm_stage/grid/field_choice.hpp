// Which velocity field a particle belongs to. Soils in one field stick to each other; soils in different fields meet at
// the nodes (boundary/field_contact.hpp) and may slide on each other or part.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

constexpr int most_fields = 4;

struct FieldChoice {
  std::vector<int> of_material;  // field of each material; empty: all are in field 0
  int count = 1;                 // fields, at most most_fields
  // Particles of field 0 that lie above soil of field 1 (Particles::side) form field 2 beside the others.
  bool by_side = false;
  std::array<double, 3> up{0.0, 1.0, 0.0};

  std::vector<char> flows;  // of each field, whether any soil of it does (MaterialLaw::flows)

  bool firm(int field) const { return !flows[static_cast<std::size_t>(field)]; }
  bool several() const { return count > 1; }
  template <int Dim>
  int of(const Particles<Dim>& P, std::size_t p) const {
    if (by_side && P.side[p] != 0) return 2;
    return of_material.empty() ? 0 : of_material[static_cast<std::size_t>(P.material[p])];
  }
};

}  // namespace tailrun::mpm
