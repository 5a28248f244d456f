// "dimension", "scheme" and "damping" of mpm.json: what chooses the solver, with the numbers of its method.
#include <fmt/core.h>

#include "mpm_stage/scene/key_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

int read_dimension(const CaseNode& root) {
  return static_cast<int>(root.integer_or("dimension", 2, 3, 2));
}

void read_scheme(const CaseNode& root, SolverOptions& o) {
  const CaseNode scheme = root.object_or_empty("scheme");
  const std::string shape = scheme.choice_or("shape_function", {"linear", "quadratic", "cubic", "gimp"}, "quadratic");
  o.shape = shape == "linear"      ? ShapeName::linear
            : shape == "quadratic" ? ShapeName::quadratic
            : shape == "cubic"     ? ShapeName::cubic
                                   : ShapeName::gimp;
  const std::string transfer = scheme.choice_or("transfer", {"apic", "aflip", "flip", "fmpm"}, "aflip");
  o.transfer = transfer == "apic"    ? TransferName::apic
               : transfer == "aflip" ? TransferName::aflip
               : transfer == "flip"  ? TransferName::flip
                                     : TransferName::fmpm;
  if (o.transfer == TransferName::aflip) {
    const double flow_share = o.flow_transfer_damping / o.transfer_damping;
    o.transfer_damping = scheme.number_or("transfer_damping", "1", Range::between(0.0, 10.0), o.transfer_damping);
    o.flow_transfer_damping =
        scheme.number_or("flow_transfer_damping", "1", Range::between(0.0, 10.0), flow_share * o.transfer_damping);
  }
  if (o.transfer == TransferName::flip)
    o.flip_share = scheme.number_or("flip_share", "1", Range::between(0.0, 1.0), 0.99);
  if (o.transfer == TransferName::fmpm)
    o.fmpm_order = static_cast<int>(scheme.integer_or("fmpm_order", 2, 6, o.fmpm_order));
  const auto only_with = [&](const char* key, const char* name) {
    if (transfer != name) refuse_with_other_choice(scheme, key, "transfer", transfer, fmt::format("'{}'", name));
  };
  only_with("transfer_damping", "aflip");
  only_with("flow_transfer_damping", "aflip");
  only_with("flip_share", "flip");
  only_with("fmpm_order", "fmpm");
  o.volumetric_average = scheme.boolean_or("volumetric_average", true);
  if (o.volumetric_average)
    o.crowding_relief = scheme.number_or("crowding_relief", "1", Range::between(0.0, 10.0), o.crowding_relief);
  o.soil_limits_friction = scheme.boolean_or("soil_limits_friction", true);
  o.contact_reach = scheme.number_or("contact_reach", "cells", Range::between(0.0, 1.0), o.contact_reach);
  if (const auto share = scheme.number_if("surface_share", "1", Range::between(0.0, 0.2))) o.surface_share = *share;
  if (const auto cutoff = scheme.number_if("mass_cutoff", "1", Range::between(0.0, 0.1))) o.mass_cutoff = *cutoff;
  o.local_damping = root.object_or_empty("damping").number_or("local", "1", Range::between(0.0, 0.99), 0.0);
  if (o.local_damping > 0.0 && o.transfer == TransferName::fmpm)
    root.fail("damping/local",
              "does not go with scheme/transfer 'fmpm', whose velocities after the filter are not those "
              "that the damping opposes; take another transfer, or 0");
}

}  // namespace tailrun::mpm
