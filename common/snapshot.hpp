// The snapshot file: the state of fem_stage at one time, all that transfer_tool needs. A valid static VTKHDF v1
// UnstructuredGrid of quadrilaterals in the undeformed geometry; docs/formats.md describes it field by field.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/ponded_water.hpp"
#include "common/provenance.hpp"

namespace tailrun {

constexpr int snapshot_format_version = 1;

// A named line of the mesh (gmsh physical group of dimension 1): pairs of nodes.
struct MeshLine {
  std::string name;
  std::vector<std::int64_t> edges;  // (n, 2)
};

// N nodes, M elements (quadrilaterals, counter-clockwise). (n, k) arrays are row-major. Stresses are (M, 4): xx, yy,
// zz, xy, Pa, tension positive. Pore pressures compression positive. Displacements count from the start of shaking.
struct Snapshot {
  double time = 0.0;                      // s since the start of the motion; the geostatic state has 0
  std::array<double, 2> base_velocity{};  // m/s, mean of the base nodes
  double gravity = 9.81;                  // m/s2
  double fluid_density = 1000.0;          // kg/m3
  std::vector<std::string> region_names;  // region_id indexes this; gmsh physical groups of dimension 2
  std::vector<MeshLine> lines;
  std::vector<double> phreatic_line;  // m, (k, 2) polyline, empty when there is none
  std::vector<PondedLines> ponds;

  std::vector<double> position;              // m, (N, 2), undeformed
  std::vector<double> displacement;          // m, (N, 2)
  std::vector<double> velocity;              // m/s, (N, 2), absolute
  std::vector<double> acceleration;          // m/s2, (N, 2), absolute
  std::vector<double> pore_pressure;         // Pa, (N)
  std::vector<double> excess_pore_pressure;  // Pa, (N): pore_pressure minus its geostatic value

  std::vector<std::int64_t> quads;                        // (M, 4)
  std::vector<std::int32_t> region_id;                    // (M)
  std::vector<double> thickness;                          // m, (M)
  std::vector<double> density;                            // kg/m3, total, (M)
  std::vector<double> porosity;                           // 1, (M)
  std::vector<double> effective_stress;                   // Pa, (M, 4)
  std::vector<double> total_stress;                       // Pa, (M, 4)
  std::vector<double> initial_effective_stress;           // Pa, (M, 4), geostatic
  std::vector<double> initial_vertical_effective_stress;  // Pa, (M), compression positive: sigma'_v0
  std::vector<double> initial_pore_pressure;              // Pa, (M), mean of the nodes
  std::vector<double> depth;                              // m, (M), centre below the initial ground surface
  // r_u = excess pore pressure (element mean) / max(sigma'_v0, 5 kPa); 0 where the soil is not saturated
  std::vector<double> excess_pore_pressure_ratio;      // 1, (M)
  std::vector<double> max_excess_pore_pressure_ratio;  // 1, (M), largest so far
  std::vector<double> effective_stress_ratio;          // 1, (M): 1 - sigma'_v / sigma'_v0
  std::vector<double> shear_strain;                    // 1, (M): sqrt((exx - eyy)^2 + gxy^2) since the start of shaking
  std::vector<double> scaled_jacobian;                 // 1, (M), of the deformed mesh

  std::size_t nodes() const { return position.size() / 2; }
  std::size_t elements() const { return region_id.size(); }
};

// Throws ComputationError when it cannot be written, std::logic_error when array lengths disagree. `also` may add
// groups of the writing program's own (its restart state) before the file takes its final name.
void write_snapshot(const std::filesystem::path& path, const Snapshot& snapshot, const Provenance& provenance,
                    const std::function<void(Hdf5Writer&)>& also = {});

// Throws InputError: missing or truncated file, other format or version, a dataset missing or of the wrong shape,
// values that are not finite, node numbers out of range.
Snapshot read_snapshot(const std::filesystem::path& path);

}  // namespace tailrun
