// What a material point of PM4Sand or PM4Silt remembers. Compression positive, Pa.
#pragma once

#include <type_traits>

#include "fem_stage/material/deviator.hpp"

namespace tailrun::fem {

// The quantities that the constitutive rate equations integrate.
template <class Real>
struct Pm4VariablesOf {
  Real p = 0.0;            // in-plane mean effective stress (s_xx + s_yy)/2
  DeviatorOf<Real> s;      // stress deviator
  DeviatorOf<Real> alpha;  // back-stress ratio: axis of the yield cone
  DeviatorOf<Real> z;      // fabric
  Real z_cum = 0.0;        // accumulated fabric change
};
using Pm4Variables = Pm4VariablesOf<double>;

// What the last loading reversals left behind (Boulanger & Ziotopoulou 2017, section on alpha_in).
template <class Real>
struct Pm4MemoryOf {
  DeviatorOf<Real> z_in;                 // fabric at the last reversal
  DeviatorOf<Real> alpha_in_true;        // back-stress ratio at the last reversal
  DeviatorOf<Real> alpha_in_previous;    // apparent initial ratio before the last reversal
  PlaneComponentsOf<Real> alpha_in;      // apparent initial back-stress ratio
  PlaneComponentsOf<Real> alpha_in_max;  // component-wise records
  PlaneComponentsOf<Real> alpha_in_min;
  Real p_zp = 0.0;        // p at the time of the largest |z| p; a guess until the first reversal sets it
  Real p_zp_known = 0.0;  // 1 from the first reversal on
  Real zp_max = 0.0;      // that largest |z| p
};
using Pm4Memory = Pm4MemoryOf<double>;

template <class Real>
struct Pm4SurfacesOf {
  Real xi = 0.0;   // relative state parameter: xi_R (sand), xi_s = xi/lambda (silt)
  Real M_b = 0.0;  // bounding ratio q/p
  Real M_d = 0.0;  // dilatancy ratio q/p
};
using Pm4Surfaces = Pm4SurfacesOf<double>;

template <class Real>
struct Pm4ModuliOf {
  Real G = 0.0;
  Real K = 0.0;
  Real M_cur = 0.0;  // q/max(p, p_min)
};
using Pm4Moduli = Pm4ModuliOf<double>;

template <class Real>
struct Pm4StateOf {
  Pm4VariablesOf<Real> v;
  Pm4MemoryOf<Real> memory;
  Real z_peak = 0.0;
  Real volumetric_strain = 0.0;  // since the void ratio was last set, compression positive
  Real G = 0.0;                  // elastic moduli at this state
  Real K = 0.0;
  Real M_b = 0.0;              // bounding ratio of the last evaluation (compatible mode); 0 before the first
  Real substep_strain = 1e-5;  // strain of the last sub-step that the error control accepted; the next one's guess
  // At this state, too: the next sub-step starts from it (plastic stage of the improved mode).
  Real M_cur = 0.0;
  Pm4SurfacesOf<Real> surfaces;

  void set(const Pm4SurfacesOf<Real>& at, const Pm4ModuliOf<Real>& moduli) {
    surfaces = at;
    G = moduli.G;
    K = moduli.K;
    M_cur = moduli.M_cur;
  }
  Pm4ModuliOf<Real> moduli() const { return {G, K, M_cur}; }
};
using Pm4State = Pm4StateOf<double>;

// Constants of one point, set when it is initialised from a stress.
template <class Real>
struct Pm4PointConstantsOf {
  Real p_min = 0.0;          // all state functions use max(p, p_min)
  Real A_do = 0.0;           // dilatancy constant
  Real C_eps_squared = 0.0;  // strain accumulation in cyclic mobility
  Real z_max = 0.0;          // fabric limit
  Real p_cs = 0.0;           // PM4Silt: critical-state pressure; PM4Sand: unused
  Real offset_p = 0.0;       // stress that the model cannot carry and hands through unchanged
  DeviatorOf<Real> offset_s;
  Real initialised = 0.0;    // 1 once A_do and z_max belong to a stress
  Real out_of_plane = 0.25;  // s_zz / (s_xx + s_yy), kept from the elastic stage
};
using Pm4PointConstants = Pm4PointConstantsOf<double>;

static_assert(std::is_trivially_copyable_v<Pm4State> && sizeof(Pm4State) % sizeof(double) == 0);
static_assert(std::is_trivially_copyable_v<Pm4PointConstants> && sizeof(Pm4PointConstants) % sizeof(double) == 0);

}  // namespace tailrun::fem
