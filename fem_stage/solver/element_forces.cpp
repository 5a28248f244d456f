#include "fem_stage/solver/element_forces.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "fem_stage/model/soft_fluid.hpp"
#include "fem_stage/solver/averaged_mass.hpp"

namespace tailrun::fem {
namespace {

// Tensor components (xx, yy, tensor shear) turned by the angle `r` (rad).
struct Plane {
  double xx, yy, xy;
};
Plane turned(Plane t, double r) {
  const double c = std::cos(2.0 * r), s = std::sin(2.0 * r), mean = 0.5 * (t.xx + t.yy), half = 0.5 * (t.xx - t.yy);
  return {mean + half * c - t.xy * s, mean - half * c + t.xy * s, half * s + t.xy * c};
}

}  // namespace

ElementForces::ElementForces(const Model& model, double damping, bool large_displacement)
    : model_(model), damping_(damping), large_(large_displacement) {
  const std::size_t count = model.count();
  bulk_.resize(count);
  shear_.resize(count);
  mobility_.assign(count, 1.0);
  hourglass_committed_.assign(2 * count, 0.0);
  hourglass_trial_.assign(2 * count, 0.0);
  hourglass_mode_.assign(2 * count, 0.0);
  hourglass_work_.assign(count, 0.0);
  strain_.assign(3 * count, 0.0);
  stress_.assign(4 * count, 0.0);
  global_stress_.assign(4 * count, 0.0);
  element_forces_.assign(12 * count, 0.0);
  if (large_) {
    rotation_.assign(count, 0.0);
    material_strain_.assign(3 * count, 0.0);
    moved_ = model.elements;
  }
}

void ElementForces::take_moduli(const MaterialPoints& points) {
  points.elastic_moduli(bulk_, shear_);
  if (softening_scale_)
    for (std::size_t e = 0; e < model_.count(); ++e) shear_[e] *= softening_scale_->factor(e);
  if (!residual_floor_) return;
  for (std::size_t e = 0; e < model_.count(); ++e) shear_[e] += residual_floor_->shear(e);
}

double ElementForces::hourglass_modulus(std::size_t e) const {
  return model_.options->hourglass_current_modulus ? shear_[e] : model_.shear_initial[e];
}

UpdateReport ElementForces::evaluate(MaterialPoints& points, std::span<const double> increment,
                                     std::span<const double> velocity, std::span<const double> pressure,
                                     std::span<const double> pressure_rate, std::span<double> residual) {
  const std::size_t count = model_.count(), nodes = model_.nodes();
  const SspQuadUp& el = elements();
  const auto* quads = model_.mesh.quads.data();
#pragma omp parallel for schedule(static)
  for (std::size_t e = 0; e < count; ++e) {
    const auto [exx, eyy, gxy, qx, qy] = centre_gradient(el, quads, increment, e);
    strain_[3 * e] = exx;
    strain_[3 * e + 1] = eyy;
    strain_[3 * e + 2] = gxy;
    if (large_) {
      const Plane local = turned({exx, eyy, 0.5 * gxy}, -rotation_[e]);
      material_strain_[3 * e] = local.xx;
      material_strain_[3 * e + 1] = local.yy;
      material_strain_[3 * e + 2] = 2.0 * local.xy;
    }
    hourglass_mode_[2 * e] = qx;
    hourglass_mode_[2 * e + 1] = qy;
    const double g = hourglass_modulus(e);
    hourglass_trial_[2 * e] =
        hourglass_committed_[2 * e] + g * (el.hourglass[3 * e] * qx + el.hourglass[3 * e + 1] * qy);
    hourglass_trial_[2 * e + 1] =
        hourglass_committed_[2 * e + 1] + g * (el.hourglass[3 * e + 1] * qx + el.hourglass[3 * e + 2] * qy);
  }

  const auto start = std::chrono::steady_clock::now();
  const std::vector<double>& strain = large_ ? material_strain_ : strain_;
  UpdateReport report = points.update(softening_scale_ ? softening_scale_->driving_strain(strain) : strain, stress_);
  if (residual_floor_) residual_floor_->update(strain, stress_);
  material_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const double fluid_density = model_.options->fluid_density, gravity = model_.options->gravity;
#pragma omp parallel for schedule(static)
  for (std::size_t e = 0; e < count; ++e) {
    double sxx = stress_[4 * e], syy = stress_[4 * e + 1], sxy = stress_[4 * e + 3];
    if (large_) {
      const Plane turned_stress = turned({sxx, syy, sxy}, rotation_[e]);
      sxx = turned_stress.xx;
      syy = turned_stress.yy;
      sxy = turned_stress.xy;
    }
    global_stress_[4 * e] = sxx;
    global_stress_[4 * e + 1] = syy;
    global_stress_[4 * e + 2] = stress_[4 * e + 2];
    global_stress_[4 * e + 3] = sxy;

    const auto [vxx, vyy, vxy, qx, qy] = centre_gradient(el, quads, velocity, e);
    double mean_pressure = 0.0, p[4], rate[4];
    for (std::size_t a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(quads[4 * e + a]);
      p[a] = pressure[node];
      rate[a] = pressure_rate[node];
      mean_pressure += 0.25 * p[a];
    }
    const double g = hourglass_modulus(e), volume = el.volume[e];
    double hx = hourglass_trial_[2 * e], hy = hourglass_trial_[2 * e + 1];
    if (damping_ > 0.0) {
      const double c11 = bulk_[e] + 4.0 / 3.0 * shear_[e], c12 = bulk_[e] - 2.0 / 3.0 * shear_[e];
      sxx += damping_ * (c11 * vxx + c12 * vyy);
      syy += damping_ * (c12 * vxx + c11 * vyy);
      sxy += damping_ * shear_[e] * vxy;
      hx += damping_ * g * (el.hourglass[3 * e] * qx + el.hourglass[3 * e + 1] * qy);
      hy += damping_ * g * (el.hourglass[3 * e + 1] * qx + el.hourglass[3 * e + 2] * qy);
    }
    mean_pressure = model_.pressure_in_stress(e, mean_pressure);
    sxx -= mean_pressure;
    syy -= mean_pressure;
    const double storage = model_.storage[e], alpha = model_.stabilisation[e];
    const double kx = mobility_[e] * model_.permeability_x[e], ky = mobility_[e] * model_.permeability_y[e];
    const double volume_rate = 0.25 * volume * (vxx + vyy);
    const double *mass = &el.mass_matrix[10 * e], *gxx = &el.gradient_xx[10 * e], *gyy = &el.gradient_yy[10 * e];
    for (int a = 0; a < 4; ++a) {
      const std::size_t i = 4 * e + static_cast<std::size_t>(a);
      const double nx = el.dndx[i], ny = el.dndy[i];
      double* f = &element_forces_[3 * i];
      f[0] = volume * (nx * sxx + ny * sxy) + el.gamma[i] * hx;
      f[1] = volume * (ny * syy + nx * sxy) + el.gamma[i] * hy;
      double flow = volume_rate + ky * fluid_density * gravity * el.gradient_y[i];
      for (int b = 0; b < 4; ++b) {
        const int ab = lower(a, b);
        flow += (storage * mass[ab] + alpha * (gxx[ab] + gyy[ab])) * rate[b] + (kx * gxx[ab] + ky * gyy[ab]) * p[b];
      }
      f[2] = flow;
    }
  }
#pragma omp parallel for schedule(static)
  for (std::size_t n = 0; n < nodes; ++n) {
    double sum[3] = {};
    for (int k = model_.adjacency_start[n]; k < model_.adjacency_start[n + 1]; ++k) {
      const double* f = &element_forces_[3 * static_cast<std::size_t>(model_.adjacency[static_cast<std::size_t>(k)])];
      for (int i = 0; i < 3; ++i) sum[i] += f[i];
    }
    std::copy_n(sum, 3, &residual[3 * n]);
  }
  return report;
}

// How far the element's frame has turned since the last commit (rad).
double ElementForces::turn_since(std::size_t e, std::span<const double> displacement,
                                 std::span<const double> increment) const {
  const auto* quads = model_.mesh.quads.data();
  if (model_.options->shake.spin == Spin::jaumann) return 0.5 * vorticity(moved_, quads, increment, e);
  // F = R U: tan(angle of R) = (F_yx - F_xy)/(F_xx + F_yy). The turn nearest to none, as angles come back after 2 pi.
  const CentreGradient g = centre_gradient(model_.elements, quads, displacement, e);
  const double angle = std::atan2(vorticity(model_.elements, quads, displacement, e), 2.0 + g.xx + g.yy);
  return std::remainder(angle - rotation_[e], 2.0 * std::numbers::pi);
}

void ElementForces::commit(MaterialPoints& points, State& state, std::span<const double> increment) {
  for (std::size_t i = 0; i < hourglass_mode_.size(); ++i)
    hourglass_work_[i / 2] += 0.5 * (hourglass_committed_[i] + hourglass_trial_[i]) * hourglass_mode_[i];
  points.commit();
  if (residual_floor_) {
    residual_floor_->commit();
    state.floor_stress.assign(residual_floor_->stress().begin(), residual_floor_->stress().end());
  }
  if (model_.options->hourglass_current_modulus) last_shear_ = shear_;
  take_moduli(points);
  if (model_.options->hourglass_current_modulus) {
    // A spring that softens lets go of its force; one that hardens keeps it. Neither makes energy.
    for (std::size_t i = 0; i < hourglass_trial_.size(); ++i)
      hourglass_trial_[i] *= std::min(1.0, shear_[i / 2] / last_shear_[i / 2]);
  }
  hourglass_committed_ = hourglass_trial_;
  state.hourglass_force = hourglass_trial_;
  state.stress = global_stress_;
  soft_fluid_mobility(model_, state.pressure, mobility_);
  if (!large_) return;
#pragma omp parallel for schedule(static)
  for (std::size_t e = 0; e < model_.count(); ++e) {
    const double spin = turn_since(e, state.displacement, increment);
    rotation_[e] += spin;
    const double hx = hourglass_committed_[2 * e], hy = hourglass_committed_[2 * e + 1];
    hourglass_committed_[2 * e] = hx * std::cos(spin) - hy * std::sin(spin);
    hourglass_committed_[2 * e + 1] = hx * std::sin(spin) + hy * std::cos(spin);
  }
  state.rotation = rotation_;
  state.turned_hourglass_force = hourglass_committed_;
  move_to(state.displacement);
}

void ElementForces::move_to(std::span<const double> displacement) {
  geometry_.assign(displacement.begin(), displacement.end());
  moved_ = build_sspquadup(model_.mesh, geometry_, model_.thickness, model_.options->hourglass_shape,
                           model_.options->pressure_points);
}

void ElementForces::use_matrix_basis(const MatrixBasis& basis) {
  bulk_ = basis.bulk;
  shear_ = basis.shear;
  mobility_ = basis.mobility;
  if (large_) move_to(basis.displacement);
}

void ElementForces::reset(const MaterialPoints& points, const State& state) {
  take_moduli(points);
  hourglass_committed_ = state.hourglass_force;
  soft_fluid_mobility(model_, state.pressure, mobility_);
  if (!large_) return;
  if (!state.rotation.empty()) rotation_ = state.rotation;
  if (!state.turned_hourglass_force.empty()) hourglass_committed_ = state.turned_hourglass_force;
  if (!state.rotation.empty() && model_.options->shake.spin == Spin::polar)
    for (std::size_t e = 0; e < model_.count(); ++e)
      if (std::abs(turn_since(e, state.displacement, {})) > 1e-6)
        throw InputError("the state's frames have turned with the other /shake/spin, 'jaumann'; go on with that");
  move_to(state.displacement);
}

void ElementForces::matrix(std::size_t e, double mass_factor, double stiffness_factor, double storage_factor,
                           double flow_factor, double scale, double local[144]) const {
  const SspQuadUp& el = elements();
  double stiffness[64];
  sspquadup_stiffness(el, e, bulk_[e], shear_[e], hourglass_modulus(e), stiffness);
  const double storage = model_.storage[e], alpha = model_.stabilisation[e];
  const double coupling = 0.25 * el.volume[e] * scale;
  for (int a = 0; a < 4; ++a) {
    const std::size_t ia = 4 * e + static_cast<std::size_t>(a);
    for (int b = 0; b < 4; ++b) {
      const std::size_t ib = 4 * e + static_cast<std::size_t>(b);
      const int ab = lower(a, b);
      double* block = &local[12 * (3 * a) + 3 * b];
      block[0] = stiffness_factor * stiffness[8 * (2 * a) + 2 * b];
      block[1] = stiffness_factor * stiffness[8 * (2 * a) + 2 * b + 1];
      block[12] = stiffness_factor * stiffness[8 * (2 * a + 1) + 2 * b];
      block[13] = stiffness_factor * stiffness[8 * (2 * a + 1) + 2 * b + 1];
      block[2] = -coupling * el.dndx[ia];
      block[14] = -coupling * el.dndy[ia];
      block[24] = -coupling * el.dndx[ib];
      block[25] = -coupling * el.dndy[ib];
      const double gxx = el.gradient_xx[10 * e + static_cast<std::size_t>(ab)],
                   gyy = el.gradient_yy[10 * e + static_cast<std::size_t>(ab)];
      const double d =
          storage_factor * (storage * el.mass_matrix[10 * e + static_cast<std::size_t>(ab)] + alpha * (gxx + gyy)) +
          mobility_[e] * flow_factor * (model_.permeability_x[e] * gxx + model_.permeability_y[e] * gyy);
      block[26] = -scale * scale * d;
    }
    const double inertia = mass_factor * model_.density[e] * model_.elements.nodal_volume[ia];
    local[12 * (3 * a) + 3 * a] += inertia;
    local[12 * (3 * a + 1) + 3 * a + 1] += inertia;
    if (model_.options->averaged_mass && mass_factor != 0.0)
      for (int b = 0; b < 4; ++b) {
        const double difference = mass_factor * averaged_mass_difference(model_, e, a, b);
        local[12 * (3 * a) + 3 * b] += difference;
        local[12 * (3 * a + 1) + 3 * b + 1] += difference;
      }
  }
}

double ElementForces::damping_power(std::size_t e, std::span<const double> velocity) const {
  if (damping_ == 0.0) return 0.0;
  const SspQuadUp& el = elements();
  const auto [vxx, vyy, vxy, qx, qy] = centre_gradient(el, model_.mesh.quads.data(), velocity, e);
  const double c11 = bulk_[e] + 4.0 / 3.0 * shear_[e], c12 = bulk_[e] - 2.0 / 3.0 * shear_[e];
  const double *f = &el.hourglass[3 * e], g = hourglass_modulus(e);
  const double power = el.volume[e] * (c11 * (vxx * vxx + vyy * vyy) + 2.0 * c12 * vxx * vyy + shear_[e] * vxy * vxy) +
                       g * (f[0] * qx * qx + 2.0 * f[1] * qx * qy + f[2] * qy * qy);
  return damping_ * power;
}

}  // namespace tailrun::fem
