// Starting from another code's state: CSV tables of mesh and results become a snapshot that `transfer_tool run` takes.
#pragma once

#include <filesystem>

#include "common/case_file.hpp"
#include "common/provenance.hpp"
#include "common/snapshot.hpp"

namespace tailrun::transfer {

// Reads import.json:
//   time                     s, since the start of the motion
//   nodes                    CSV: node, x, y[, lines]; `lines` holds names of boundary lines, separated by '|'
//   quads                    CSV: element, n1, n2, n3, n4, region[, thickness]; counter-clockwise
//   node_state               CSV: node[, ux, uy, vx, vy, ax, ay], p
//   element_state            CSV: element, sxx, syy, sxy[, szz, gamma]; effective stress
//   initial_node_state,      the same tables before shaking; without them the state itself counts as the initial one
//   initial_element_state
//   normal_stress            "compression_positive" (default) or "tension_positive"; the sign of sxy is that of the
//                            shear strain gamma_xy either way
//   regions                  {"tailings": {"density": 1870, "porosity": 0.41}, ...}
//   base_line                name of the line whose mean velocity is the base's (default "base"; absent: at rest)
//   phreatic_line, gravity, fluid_density
// Columns may carry units (x_m, p_kPa); without one they are SI. Where szz is missing it is the mean of sxx and syy,
// the intermediate principal stress that a plane-strain sand model without szz implies (p = (sxx + syy)/2).
// r_u = (mean nodal p - its initial value)/max(sigma'_v0, 5 kPa), 0 where the initial p is under 0.3 kPa.
// Adds the files read to `provenance`. Throws InputError.
Snapshot import_tables(const CaseFile& file, Provenance& provenance);

}  // namespace tailrun::transfer
