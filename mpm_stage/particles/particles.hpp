// The particles of a run: a structure of arrays, kept sorted by grid block and, inside a block, by material.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "mpm_stage/particles/aligned.hpp"

namespace tailrun::mpm {

// Independent components of a symmetric tensor: (xx, yy, zz, xy) in plane strain, (xx, yy, zz, xy, yz, zx) in 3-D.
template <int Dim>
constexpr int stress_components = Dim == 2 ? 4 : 6;

template <int Dim>
struct Particles {
  using Column = AlignedVector<double>;
  std::array<Column, Dim> position;        // m
  std::array<Column, Dim> velocity;        // m/s
  std::array<Column, Dim * Dim> affine;    // 1/s, affine[i * Dim + j] = C_ij; empty for FLIP
  std::array<Column, Dim * Dim> gradient;  // 1, midpoint displacement gradient of the step, same order
  std::array<Column, stress_components<Dim>>
      stress;             // Pa, tension positive: effective if pore_pressure is in use, else total
  Column mass;            // kg
  Column volume;          // m3
  Column plastic_strain;  // 1, deviatoric: sqrt(2/3 e:e) summed over the run
  Column strength;        // Pa, cohesion (s_R for phi = 0), per particle
  Column pore_pressure;   // Pa, compression positive; empty unless a material uses it
  Column rest_volume;     // m3, at no pressure, where MaterialLaw::keeps_rest_volume; empty unless a material uses it
  AlignedVector<std::int32_t> material;
  AlignedVector<std::int32_t> side;  // 1: on the upper side of weak soil (grid/field_sides.hpp); empty if not asked for
  AlignedVector<std::int32_t> identity;  // index in the file or list that the particles came from

  std::size_t count() const { return mass.size(); }

  template <class Action>
  void for_each_column(Action action) {
    for (auto& c : position) action(c);
    for (auto& c : velocity) action(c);
    for (auto& c : affine) action(c);
    for (auto& c : gradient) action(c);
    for (auto& c : stress) action(c);
    action(mass);
    action(volume);
    action(plastic_strain);
    action(strength);
    action(pore_pressure);
    action(rest_volume);
  }

  // All columns zero, except that no memory is spent on what no feature reads.
  void resize(std::size_t n, bool with_affine, bool with_pore_pressure, bool with_rest_volume = false) {
    for_each_column([n](Column& c) { c.assign(n, 0.0); });
    if (!with_affine)
      for (auto& c : affine) Column().swap(c);
    if (!with_pore_pressure) Column().swap(pore_pressure);
    if (!with_rest_volume) Column().swap(rest_volume);
    material.assign(n, 0);
    identity.assign(n, 0);
  }
};

}  // namespace tailrun::mpm
