// Boundaries and loads of fem.json as plain data.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/case_file.hpp"
#include "fem_stage/boundary/time_history.hpp"

namespace tailrun::fem {

enum class BaseKind { none, lysmer_dashpot, rigid };
enum class When { both, geostatic, shake };

// A named line of the mesh, or the node nearest to a point.
struct Place {
  std::string line;               // empty: the point
  std::array<double, 2> point{};  // m
  std::string where;              // in the case file, for messages
};

struct FixedFreedoms {
  Place place;
  bool x = false, y = false, p = false;
  When when = When::both;
};

struct HeldPressure {
  std::string line;
  std::array<double, 3> field{};  // Pa, Pa/m, Pa/m: p = field[0] + field[1] x + field[2] y
  std::string where;
};

struct Pond {
  std::vector<std::string> lines;
  double level = 0.0;  // m
  std::string where;
};

struct FreeFieldSide {
  std::string line, column_line;                                 // of the model, and of the column beside it
  double density = 0.0, shear_velocity = 0.0, p_velocity = 0.0;  // kg/m3, m/s; 0 = of the soil behind the line
  std::string where;
};

struct BoundaryOptions {
  std::string base_line;
  BaseKind base = BaseKind::none;
  double rock_density = 0.0, rock_shear_velocity = 0.0;  // kg/m3, m/s
  double rock_p_velocity = 0.0;                          // m/s; > 0: vertical dashpots too, u_y of the base is free
  bool base_tied = false;                                // one horizontal freedom for the whole base
  std::vector<std::string> tied_column_regions;          // free-field columns: nodes of equal height move together
  std::vector<std::string> periodic_lines;               // nodes of equal height on these lines are tied, p included
  std::vector<std::string> roller_lines;                 // u_x = 0 throughout
  std::vector<std::string> geostatic_roller_lines;       // u_x = 0 in the geostatic stage, reactions kept afterwards
  std::vector<FixedFreedoms> fixed;
  std::vector<HeldPressure> held_pressure;  // drained lines are those with p = 0
  std::vector<Pond> ponds;
  std::vector<FreeFieldSide> free_field;
};

struct LoadOptions {
  Place place;
  std::array<double, 2> traction{};  // Pa; N for a point
  double pressure = 0.0;             // Pa, against the outward normal
  When when = When::both;
  TimeHistory history;
};

// `node` is /boundaries; absent means no boundary at all, which the model refuses later. Throws InputError.
BoundaryOptions read_boundaries(const CaseNode& node);
// `root` is the whole case file: its "loads".
std::vector<LoadOptions> read_loads(const CaseNode& root);

}  // namespace tailrun::fem
