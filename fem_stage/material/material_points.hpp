// All material points of a model: what the element loop uses. Points are grouped by constitutive model, so that no
// virtual call or allocation happens per point; updates run in parallel and give the same bits for any number of
// threads. Interface: stresses and strains tension positive, SI units, rows in the order of the points.
//
//   MaterialPoints points(materials, material_of_point);
//   points.set_stress(zeros);                      // elastic stage
//   points.start_elastic_stage(poisson_for_K0);    // gravity
//   ... points.update(strain, stress); points.commit(); ...
//   points.start_plastic_stage(true);              // shaking
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem_stage/material/material_definition.hpp"

namespace tailrun::fem {

struct UpdateReport {
  long substeps = 0;      // accepted sub-steps of all points
  int failed_point = -1;  // the first point whose increment could not be integrated, -1 if none
  std::string reason;
  double seconds = 0.0;
};

class MaterialPoints {
 public:
  // `material_of_point`: one index into `materials` per point. Throws InputError for an index out of range.
  MaterialPoints(std::vector<MaterialDefinition> materials, std::vector<int> material_of_point);
  ~MaterialPoints();
  MaterialPoints(MaterialPoints&&) noexcept;
  MaterialPoints& operator=(MaterialPoints&&) noexcept;

  std::size_t size() const;
  const std::vector<MaterialDefinition>& materials() const;
  const std::vector<int>& material_of_point() const;

  // effective_stress (n, 4): xx, yy, zz, xy in Pa. Every point forgets what it was and starts an elastic stage here.
  void set_stress(std::span<const double> effective_stress);
  // Elastic from the committed stress on, shear modulus G_0 p_A for the PM4 models. poisson_override: one number per
  // material, NaN keeps that material's own; empty keeps all.
  void start_elastic_stage(std::span<const double> poisson_override);
  // The stage goes on, and where stress is more than the model carries at rest (tension, shear beyond its strength) it
  // is brought back at once and from now on; what is out of balance then is the caller's to spread. The PM4 models'
  // compatible mode keeps such stress, as OpenSees does.
  void start_yielding_stage();
  // The models themselves from the committed stress on: void ratio at its input value, memory and fabric erased
  // (pm4 "FirstCall"), Poisson's ratio the material's own. recompute_limits: A_do and z_max (PM4Silt: the strength,
  // too) are worked out from this stress even if an earlier plastic stage had done it (OpenSees keeps the earlier
  // ones).
  void start_plastic_stage(bool recompute_limits);
  // The reconsolidation moduli of the PM4 models.
  void set_post_shaking(bool on);

  // strain_increment (n, 3): eps_xx, eps_yy, gamma_xy (engineering) since the last commit. Writes the trial effective
  // stress (n, 4). The committed state is not touched, so the call can be repeated within an equilibrium iteration.
  // In a failed point the stress is the committed one.
  UpdateReport update(std::span<const double> strain_increment, std::span<double> effective_stress);
  // Makes the trial state of the last update the committed one.
  void commit();
  // Committed effective stress (n, 4). In the OpenSees-compatible mode it can differ from the last trial stress,
  // because that mode clips to the bounding surface at commit.
  void committed_stress(std::span<double> effective_stress) const;

  // Elastic moduli of the last commit, Pa; K = 2/3 G (1 + nu)/(1 - 2 nu).
  void elastic_moduli(std::span<double> bulk, std::span<double> shear) const;
  // G_0 p_A and its K with the Poisson's ratio of the present stage.
  void initial_moduli(std::span<double> bulk, std::span<double> shear) const;
  void density(std::span<double> out) const;   // kg/m3
  void porosity(std::span<double> out) const;  // e_0/(1 + e_0)

  // Every committed internal variable, bit for bit: (n, state_size()) doubles.
  std::size_t state_size() const;
  std::vector<double> save_state() const;
  // Throws InputError when the size does not fit.
  void restore_state(std::span<const double> state);

  // Named internal variables of the committed state for output; NaN where a model does not have one.
  // All of them are ratios or counts (unit 1). Throws InputError for an unknown name.
  static const std::vector<std::string>& internal_variable_names();
  void internal_variable(std::string_view name, std::span<double> out) const;

 private:
  struct Groups;
  std::unique_ptr<Groups> groups_;
};

}  // namespace tailrun::fem
