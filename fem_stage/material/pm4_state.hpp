// What a material point of PM4Sand or PM4Silt remembers. Compression positive, Pa.
#pragma once

#include <type_traits>

#include "fem_stage/material/deviator.hpp"

namespace tailrun::fem {

// The quantities that the constitutive rate equations integrate.
struct Pm4Variables {
  double p = 0.0;      // in-plane mean effective stress (s_xx + s_yy)/2
  Deviator s;          // stress deviator
  Deviator alpha;      // back-stress ratio: axis of the yield cone
  Deviator z;          // fabric
  double z_cum = 0.0;  // accumulated fabric change
};

// What the last loading reversals left behind (Boulanger & Ziotopoulou 2017, section on alpha_in).
struct Pm4Memory {
  Deviator z_in;                 // fabric at the last reversal
  Deviator alpha_in_true;        // back-stress ratio at the last reversal
  Deviator alpha_in_previous;    // apparent initial ratio before the last reversal
  PlaneComponents alpha_in;      // apparent initial back-stress ratio
  PlaneComponents alpha_in_max;  // component-wise records
  PlaneComponents alpha_in_min;
  double p_zp = 0.0;        // p at the time of the largest |z| p; a guess until the first reversal sets it
  double p_zp_known = 0.0;  // 1 from the first reversal on
  double zp_max = 0.0;      // that largest |z| p
};

struct Pm4State {
  Pm4Variables v;
  Pm4Memory memory;
  double z_peak = 0.0;
  double volumetric_strain = 0.0;  // since the void ratio was last set, compression positive
  double G = 0.0;                  // elastic moduli at this state
  double K = 0.0;
  double M_b = 0.0;              // bounding ratio of the last evaluation (compatible mode); 0 before the first
  double substep_strain = 1e-5;  // strain of the last sub-step that the error control accepted; the next one's guess
};

// Constants of one point, set when it is initialised from a stress.
struct Pm4PointConstants {
  double p_min = 0.0;          // all state functions use max(p, p_min)
  double A_do = 0.0;           // dilatancy constant
  double C_eps_squared = 0.0;  // strain accumulation in cyclic mobility
  double z_max = 0.0;          // fabric limit
  double p_cs = 0.0;           // PM4Silt: critical-state pressure; PM4Sand: unused
  double offset_p = 0.0;       // stress that the model cannot carry and hands through unchanged
  Deviator offset_s;
  double initialised = 0.0;    // 1 once A_do and z_max belong to a stress
  double out_of_plane = 0.25;  // s_zz / (s_xx + s_yy), kept from the elastic stage
};

static_assert(std::is_trivially_copyable_v<Pm4State> && sizeof(Pm4State) % sizeof(double) == 0);
static_assert(std::is_trivially_copyable_v<Pm4PointConstants> && sizeof(Pm4PointConstants) % sizeof(double) == 0);

}  // namespace tailrun::fem
