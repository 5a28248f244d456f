// Water above the phreatic line that shaking can push up. The pores there hold water and air as one soft fluid: the
// equations are those below the line, with the compressibility of the mixture
//
//   1/K = S_r / K_f + (1 - S_r) / p_a          (air at atmospheric pressure p_a; Verruijt 1969)
//
// Total stress feels no suction (sigma = sigma' - max(p, 0) I), and water hardly flows where there is suction: the
// permeability is a thousandth there. Without suction in the stress, soil that only dries keeps its strength; with the
// low permeability, the zone neither drains nor fills by itself.
#pragma once

#include <span>
#include <vector>

#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

inline constexpr double atmospheric_pressure = 101325.0;  // Pa
inline constexpr double suction_mobility = 1e-3;          // share of the permeability that suction leaves

// Pa: modulus of the mixture at the degree of saturation `saturation` (0 to 1).
double soft_fluid_modulus(double saturation, double fluid_modulus);

// Marks the elements whose centre lies above the phreatic line; they get the mixture's storage and need no pressure
// stabilisation, which is for water that hardly gives.
void fill_with_soft_fluid(Model& model);

// 1 for every node of an outline edge that faces up.
std::vector<char> on_ground_surface(const Mesh& mesh);

// `mobility` 1, (M): suction_mobility in elements of soft fluid whose mean pressure is not positive, 1 elsewhere.
// `pressure` Pa, (N).
void soft_fluid_mobility(const Model& model, std::span<const double> pressure, std::span<double> mobility);

}  // namespace tailrun::fem
