// Loading reversals: when one has happened, and what the point then remembers (pm4 manuals, sections on the initial
// back-stress ratio alpha_in and on p_zp). Purpose: a small unloading and reloading must restart neither the elastic
// stiffness nor the contraction, hence an apparent initial ratio beside the true one.
#pragma once

#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

// A reversal: the normal n of the (trial) stress points against the way that alpha has come since the last one.
inline bool reversed(const Pm4Memory& memory, Deviator alpha, Deviator n) {
  return contract(alpha - memory.alpha_in_true, n) < 0.0;
}

// One component of the apparent initial ratio after a reversal whose shear has not changed sign.
inline double apparent_component(double n, double lowest, double highest) {
  return n > 0.0 ? std::max(0.0, lowest) : std::min(0.0, highest);
}

inline void extend_record(double apparent, double alpha, double& lowest, double& highest) {
  if (apparent > 0.0) {
    lowest = std::min(lowest, alpha);
  } else {
    highest = std::max(highest, alpha);
  }
}

// The reversal at (p, alpha, z) towards normal n: updates of Boulanger & Ziotopoulou (2017) in their order.
inline void record_reversal(const Pm4PointConstants& point, double p, Deviator alpha, Deviator z, Deviator n,
                            Pm4Memory& memory) {
  memory.alpha_in_previous = deviator(memory.alpha_in);
  memory.alpha_in_true = alpha;
  memory.z_in = z;

  const double p_star = std::max(p, point.p_min);
  const double zp = norm(z) * p_star;
  if ((zp > memory.zp_max && p_star > memory.p_zp) || memory.p_zp_known == 0.0) {
    memory.zp_max = zp;
    memory.p_zp = p_star;
    memory.p_zp_known = 1.0;
  }

  const PlaneComponents a = components(alpha);
  PlaneComponents& in = memory.alpha_in;
  PlaneComponents& low = memory.alpha_in_min;
  PlaneComponents& high = memory.alpha_in_max;
  extend_record(in.xx, a.xx, low.xx, high.xx);
  extend_record(in.yy, a.yy, low.yy, high.yy);
  extend_record(in.xy, a.xy, low.xy, high.xy);

  if (alpha.xy * memory.alpha_in_previous.xy > 0.0) {
    in.xx = apparent_component(n.d, low.xx, high.xx);
    in.yy = apparent_component(-n.d, low.yy, high.yy);
    in.xy = apparent_component(n.xy, low.xy, high.xy);
  } else {
    in = a;
  }
}

}  // namespace tailrun::fem
