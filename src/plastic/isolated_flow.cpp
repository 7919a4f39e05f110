// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_ONE_NUMBER
#include "plastic/isolated_flow.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tensors-inl.hpp"
#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "material/law-inl.hpp"
#include "mesh/trilinear.hpp"
#include "plastic/point_flow-inl.hpp"

namespace hexaplast {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

namespace {

void branch_stretches(const ElementSamples& samples, scalar::Sym<double> (&B)[kCorners]) {
  scalar::branch_stretches([&](int i) { return scalar::symmetric_entries(samples.polar[i].S); }, B);
}

}  // namespace

double stress_norm(const Mat3& sigma, YieldNorm norm) {
  if (norm == YieldNorm::kSpectral)
    return Eigen::SelfAdjointEigenSolver<Mat3>(sigma, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
  return scalar::stress_norm_bound(scalar::symmetric_entries(sigma), norm);
}

IsolatedStress isolated_stress(const ElementPoints& initial, const CornerTensors& plastic_inverse,
                               const ElementSamples& samples, YieldStressMeasure measure) {
  IsolatedStress found;
  const auto J_inverse = scalar::entries(centre_jacobian(initial).inverse());
  scalar::Mat<double> normals[kCorners];
  scalar::Sym<double> relieved[kCorners];
  for (int i = 0; i < kCorners; ++i) {
    normals[i] = scalar::face_normals(scalar::entries(plastic_inverse[i]), J_inverse);
    found.normals[i] = to_eigen(normals[i]);
    found.corotated[i] = samples.stress[i] - samples.pressure * Mat3::Identity();
    relieved[i] = scalar::symmetric_entries(samples.stress[i]);  //                                      eq. P7, P7t
    if (measure == YieldStressMeasure::kCauchy)
      relieved[i] =
          scalar::cauchy_stress(scalar::symmetric_entries(samples.polar[i].S),
                                scalar::symmetric_entries(found.corotated[i]), samples.pressure, samples.volume_ratio);
    found.whole[i] = to_eigen(matrix(relieved[i]));
  }
  scalar::relieve(normals, relieved);
  for (int i = 0; i < kCorners; ++i) found.relieved[i] = to_eigen(matrix(relieved[i]));
  return found;
}

IsolatedStep isolated_flow(const ElementSamples& samples, const IsolatedStress& stress,
                           const CornerTensors& plastic_inverse, double mu, const Material& material, YieldNorm norm,
                           const CornerValues& yield_stress, double dt) {
  IsolatedStep step;
  step.plastic_inverse = plastic_inverse;
  step.yield_stress = yield_stress;
  step.log_stretch.fill(Mat3::Zero());
  const double rate_dt = std::min(material.flow_rate * dt, 1 / (1 + samples.branch_moduli));  //             eq. P18
  for (int i = 0; i < kCorners; ++i) {
    step.norm[i] = stress_norm(stress.relieved[i], norm);
    step.fraction[i] = scalar::isolated_flow_fraction(step.norm[i], yield_stress[i], rate_dt);
    step.yielded = step.yielded || step.fraction[i] > 0;
    if (!std::isfinite(step.norm[i])) step.dissipated = step.norm[i];  // an overflow, which the caller refuses
  }
  if (!step.yielded) return step;

  scalar::Mat<double> normals[kCorners];
  scalar::Sym<double> M[kCorners];
  for (int i = 0; i < kCorners; ++i) {
    normals[i] = scalar::entries(stress.normals[i]);
    M[i] = {};
    if (step.fraction[i] == 0) continue;
    const scalar::LogStretches<double> log(scalar::symmetric_entries(samples.polar[i].S));
    M[i] = scalar::flow_direction(scalar::sum(along_axes(log.deviatoric, log.axes), 0.5 / mu,
                                              scalar::symmetric_entries(samples.branch_stress[i])),
                                  scalar::symmetric_entries(stress.relieved[i]),
                                  scalar::symmetric_entries(stress.whole[i]), mu, step.fraction[i]);
  }
  scalar::relieve(normals, M);  //                                                                           eq. P11
  for (int i = 0; i < kCorners; ++i) {
    step.log_stretch[i] = to_eigen(matrix(M[i]));
    step.strain[i] =
        std::sqrt(2.0 / 3) * (step.log_stretch[i] - step.log_stretch[i].trace() / 3 * Mat3::Identity()).norm();
    step.plastic_inverse[i] = to_eigen(scalar::flowed_plastic_inverse(scalar::entries(plastic_inverse[i]), M[i]));
    step.yield_stress[i] = scalar::hardened(yield_stress[i], material.hardening, step.fraction[i], step.norm[i]);
    step.dissipated +=
        samples.volume / kCorners * (samples.polar[i].S * stress.corotated[i]).cwiseProduct(step.log_stretch[i]).sum();
  }
  return step;
}

IsolatedStep isolated_step(const Model& model, int element, const ElementSamples& samples, const History& history,
                           double dt) {
  const Settings& settings = model.settings;
  IsolatedStep step;
  double min_det = std::numeric_limits<double>::infinity();
  for (const Mat3& F : samples.F) min_det = std::min(min_det, F.determinant());
  step.inverted = min_det < 0;
  step.skipped = min_det < settings.inversion_threshold;
  if (step.skipped || !can_stretch(model.material(element))) return step;
  const ElementPoints initial = gather(history.plastic_rest_positions, model.mesh.hexahedra()[element]);
  const CornerTensors& G = history.plastic_inverse[element];
  const IsolatedStress stress = isolated_stress(initial, G, samples, settings.yield_stress_measure);
  return isolated_flow(samples, stress, G, model.lame[element].mu, model.material(element), settings.yield_norm,
                       history.yield_stress[element], dt);
}

void set_isolated(int element, const IsolatedStep& step, History& history) {
  if (!step.yielded) return;
  history.plastic_inverse[element] = step.plastic_inverse;
  history.has_flowed[element] = 1;
  history.yield_stress[element] = step.yield_stress;
  for (int i = 0; i < kCorners; ++i) history.plastic_strain[element][i] += step.strain[i];
}

double relax(int e, const ElementSamples& samples, const Lame& lame, const Branches& branches, History& history) {
  double density = 0;  // [J/m^3]
  scalar::Sym<double> B[kCorners];
  branch_stretches(samples, B);
  const double w = scalar::branch_weight(lame.mu, lame.lambda, branches);
  for (int i = 0; i < kCorners; ++i) {
    auto& stretch = history.branch_stretch[e][i];
    const auto D = scalar::sum(B[i], -1.0, scalar::symmetric(stretch));
    for (std::size_t k = 0; k < branches.steps.size(); ++k) {
      const BranchStep& step = branches.steps[k];
      auto& strain = history.branch_strains_of(e)[k][i];
      const auto b = scalar::symmetric(strain);
      density += step.modulus * lame.mu *
                 (step.loss_held * scalar::product(w, b, b) + step.loss_mixed * scalar::product(w, b, D) +
                  step.loss_moved * scalar::product(w, D, D));
      strain = scalar::numbers(scalar::branch_strain(step.decay, b, step.response, D));
    }
    stretch = scalar::numbers(B[i]);
  }
  return samples.volume / kCorners * density;
}

void relieve_branches(int e, const ElementSamples& flowed, History& history) {
  scalar::Sym<double> B[kCorners];
  branch_stretches(flowed, B);
  for (int i = 0; i < kCorners; ++i) {
    auto& stretch = history.branch_stretch[e][i];
    const auto change = scalar::sum(B[i], -1.0, scalar::symmetric(stretch));
    for (CornerSymmetric& strain : history.branch_strains_of(e))
      strain[i] = scalar::numbers(scalar::sum(scalar::symmetric(strain[i]), 1.0, change));
    stretch = scalar::numbers(B[i]);
  }
}

}  // namespace hexaplast
