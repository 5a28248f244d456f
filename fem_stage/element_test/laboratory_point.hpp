// One material point in a laboratory apparatus: strains that the apparatus imposes, and one that it leaves free until a
// stress condition holds (constant vertical stress, or constant total stress over an undrained pore fluid).
// Compression positive for normal stresses and strains; shear stress and engineering shear strain positive together.
// Pa.
#pragma once

#include <functional>

#include "fem_stage/material/material_points.hpp"

namespace tailrun::fem {

struct LaboratoryStress {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  double mean() const { return 0.5 * (xx + yy); }
};

struct LaboratoryStrain {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;  // engineering
  double volumetric() const { return xx + yy; }
};

class LaboratoryPoint {
 public:
  // Starts the model itself from the stress (no elastic stage). `out_of_plane`: effective s_zz, Pa.
  LaboratoryPoint(const MaterialDefinition& material, const LaboratoryStress& start, double out_of_plane);

  // Stress after a strain increment since the last commit; repeatable. Throws ComputationError when the model fails.
  LaboratoryStress trial(const LaboratoryStrain& increment);
  // Accepts the last trial.
  void commit();

  // Finds the free strain component x so that residual(trial(increment_of(x))) = 0 within `tolerance` (Pa), starting
  // from the slope `stiffness` (Pa, of the residual), and leaves that as the trial. Returns the increment; throws
  // ComputationError when no bracket or no root is found.
  LaboratoryStrain solve(const std::function<LaboratoryStrain(double)>& increment_of,
                         const std::function<double(const LaboratoryStress&, const LaboratoryStrain&)>& residual,
                         double stiffness, double tolerance);

  const LaboratoryStress& stress() const { return committed_; }
  const LaboratoryStrain& strain() const { return strain_; }
  double bulk() const;  // elastic moduli of the last commit, Pa
  double shear() const;
  long updates() const { return updates_; }
  long substeps() const { return substeps_; }

 private:
  MaterialPoints point_;
  LaboratoryStress committed_;
  LaboratoryStress trial_;
  LaboratoryStrain strain_;
  LaboratoryStrain increment_;
  double last_free_ = 0.0;  // the free strain of the last step: the next one's first guess
  long updates_ = 0;
  long substeps_ = 0;
};

}  // namespace tailrun::fem
