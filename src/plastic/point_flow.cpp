// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/point_flow.hpp"

#include <Eigen/Eigenvalues>

#include "base/tensors-inl.hpp"
#include "material/law-inl.hpp"
#include "material/stress_norm-inl.hpp"
#include "plastic/point_flow-inl.hpp"

namespace hexaplast {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

double stress_norm(const Mat3& sigma, YieldNorm norm) {
  if (norm == YieldNorm::kSpectral)
    return Eigen::SelfAdjointEigenSolver<Mat3>(sigma, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
  return scalar::stress_norm_bound(scalar::symmetric_entries(sigma), norm);
}

double hardened(double threshold, double hardening, double fraction, double value) {
  return scalar::hardened(threshold, hardening, fraction, value);
}

StretchFlow stretch_flow(const Mat3& S, const Mat3& sigma, YieldNorm norm, double yield_stress, double rate, double dt,
                         ElasticLaw law) {
  StretchFlow flow;
  flow.norm = stress_norm(sigma, norm);
  flow.fraction = scalar::flow_fraction(flow.norm, yield_stress, rate * dt, flow.norm);
  if (flow.fraction == 0) return flow;

  std::uint32_t fails = 0;  // eigenvectors do not
  const auto stretch = scalar::symmetric_entries(S);
  const auto working = scalar::dissipating(law, stretch, scalar::symmetric_entries(sigma));
  flow.increment +=
      to_eigen(scalar::stretch_increment(stretch, working, flow.fraction, flow.strain, flow.dissipated, fails));
  return flow;
}

}  // namespace hexaplast
