// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <cmath>

#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "kinematics/gradients.hpp"
#include "kinematics/sampling.hpp"
#include "material/law-inl.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"
#include "plastic/point_flow.hpp"

namespace hexaplast::plain {

namespace scalar = HWY_NAMESPACE;  // the laws, here of doubles

namespace {

Vec3 reference_coordinates(int corner) {
  const auto& sign = kCornerSign[corner];
  return {static_cast<double>(sign[0]), static_cast<double>(sign[1]), static_cast<double>(sign[2])};
}

/// lambda_f, the modulus of a sample's own dilatation [Pa].                                                    eq. E2
double free_modulus(Volumetric volumetric, const Lame& k) {
  if (volumetric == Volumetric::kSample) return k.lambda;
  return 2 * k.mu * k.lambda / (k.lambda + 2 * k.mu);
}

/// Gm of eq. P2.
Mat3 mean_of(const CornerTensors& plastic_inverse) {
  scalar::Mat<double> G[kCorners];
  for (int i = 0; i < kCorners; ++i) G[i] = scalar::entries(plastic_inverse[i]);
  return to_eigen(scalar::mean_plastic_inverse(G));
}

/// (tr S I - S)^-1, bounded where two stretches are opposite.                                                 eq. E13
Mat3 inverse_of_turning(const Mat3& S) {
  const Mat3 K = S.trace() * Mat3::Identity() - S, cof = cofactor(K);
  return cof / std::max({K.determinant(), 1e-9 * cof.trace(), 1e-30});
}

}  // namespace

// ---- assumed strain

AssumedStrain::AssumedStrain(const ElementPoints& plastic_rest, const ElementPoints& current, double weight,
                             const Mat3& mean_plastic_inverse)
    : weight_(weight),
      J_inverse_(centre_jacobian(plastic_rest).inverse()),
      mean_gradient_(mean_gradient(plastic_rest)),
      G_(mean_plastic_inverse) {
  ElementPoints h;  // columns: eta zeta, xi zeta, xi eta
  for (int a = 0; a < kCorners; ++a) {
    const Vec3 s = reference_coordinates(a);
    h.row(a) << s[1] * s[2], s[0] * s[2], s[0] * s[1];
  }
  gamma_ = (h - mean_gradient_ * plastic_rest.transpose() * h) / kCorners;  //                                  eq. E8

  const Polar mean = polar(Mat3(current.transpose() * mean_gradient_ * G_));  //                             eq. E9, P2
  R_ = mean.R;
  S_ = mean.S;
  const Mat3 j = R_ * G_.transpose() * J_inverse_.transpose();  // columns j_n
  for (int n = 0; n < 3; ++n) {
    const Vec3 j_n = j.col(n);
    const double square = j_n.squaredNorm();
    of_hourglass_[n][n].setZero();
    for (const int m : {(n + 1) % 3, (n + 2) % 3}) {
      const int l = 3 - n - m;
      const double alpha = j_n.dot(j.col(m)) / square;
      of_hourglass_[n][l] =  //                                                                                 eq. E10
          -alpha * Mat3::Identity() - (j.col(m) - alpha * j_n) * j_n.transpose() / square;
    }
  }
}

Mat3 AssumedStrain::assumed(const Mat3& q) const {
  Mat3 A;
  for (int n = 0; n < 3; ++n)
    A.col(n) = of_hourglass_[n][0] * q.col(0) + of_hourglass_[n][1] * q.col(1) + of_hourglass_[n][2] * q.col(2);
  return A;
}

Mat3 AssumedStrain::gradient(const ElementPoints& u, int sample) const {
  return weight_ * assumed(hourglass(u)) * reference_coordinates(sample).asDiagonal() * J_inverse_;
}

Mat3 AssumedStrain::on_assumed(const std::array<Mat3, kCorners>& P) const {
  Mat3 g = Mat3::Zero();
  for (int i = 0; i < kCorners; ++i)
    g += weight_ * P[i] * J_inverse_.transpose() * reference_coordinates(i).asDiagonal();
  return g;
}

Mat3 AssumedStrain::on_hourglass(const Mat3& g) const {
  Mat3 h;
  for (int l = 0; l < 3; ++l)
    h.col(l) = of_hourglass_[0][l].transpose() * g.col(0) + of_hourglass_[1][l].transpose() * g.col(1) +
               of_hourglass_[2][l].transpose() * g.col(2);
  return h;
}

ElementPoints AssumedStrain::transpose(const std::array<Mat3, kCorners>& P) const {
  return gamma_ * on_hourglass(on_assumed(P)).transpose();
}

ElementPoints AssumedStrain::turning(const std::array<Mat3, kCorners>& P, const ElementPoints& u) const {
  const Mat3 q = hourglass(u), A = assumed(q), g = on_assumed(P), h = on_hourglass(g);
  Vec3 M = Vec3::Zero();  //                                                                                    eq. E12
  for (int n = 0; n < 3; ++n) M += A.col(n).cross(g.col(n)) - q.col(n).cross(h.col(n));
  const Vec3 y = R_ * inverse_of_turning(S_) * R_.transpose() * M;  //                                          eq. E13
  ElementPoints acting;
  for (int a = 0; a < kCorners; ++a)
    acting.row(a) = y.cross(R_ * G_.transpose() * mean_gradient_.row(a).transpose()).transpose();
  return acting;
}

// ---- element

Element::Element(const ElementPoints& plastic_rest, const ElementPoints& current, const Lame& lame,
                 const Settings& settings, const CornerTensors* plastic_inverse, const Branches& branches)
    : lame_(lame), law_(settings.law), mooney_fraction_(settings.mooney_fraction), current_(current) {
  const Sampling sampling = sampling_of(settings);
  const RestOperator rest = rest_operator(plastic_rest, sampling);
  samples_.volume = rest.volume;
  for (int i = 0; i < kCorners; ++i) gradient_[i] = sample_gradient(rest, i);
  if (plastic_inverse) plastic_inverse_.assign(plastic_inverse->begin(), plastic_inverse->end());
  if (sampling.assumed == Assumed::kCorner)
    assumed_.emplace(plastic_rest, current, sampling.corner_weight,
                     plastic_inverse ? mean_of(*plastic_inverse) : Mat3(Mat3::Identity()));

  samples_.F = gradients(current);  //                                                               eq. 7, E11c, P1
  for (int i = 0; i < kCorners; ++i) {
    samples_.polar[i] = polar(samples_.F[i]);  //                                                               eq. 6
    const auto& [R, S] = samples_.polar[i];
    dilatation_[i] = scalar::dilatation(law_, scalar::symmetric_entries(S));
    along_dilatation_[i] = law_ == ElasticLaw::kCorotated ? R : cofactor(samples_.F[i]);
    mean_dilatation_ += dilatation_[i] / kCorners;
  }

  // what resists a change of volume                                                          eq. E2 to E5, E14 to E18
  const scalar::LawConstants<double> constants(law_, mooney_fraction_, lame.mu);
  free_ = free_modulus(settings.volumetric, lame);
  k0_ = constants.k0;
  own_ = constants.b0 + free_;
  if (settings.volumetric == Volumetric::kVolumeRatio) {
    const bool is_corotated = law_ == ElasticLaw::kCorotated;
    shared_ = is_corotated ? -free_ : 0;  // of the mean dilatation
    of_volume_ = is_corotated ? lame.lambda : lame.lambda - free_;
    volume_excess_ = volume(current) / rest.volume - 1;
    volume_gradient_ = hexaplast::volume_gradient(current) / rest.volume;
  }

  // the stress that yields, and the guard of the tangent, contain the pressure of the volume ratio        eq. E19, E21
  for (int i = 0; i < kCorners; ++i) {
    const auto S = scalar::symmetric_entries(samples_.polar[i].S);
    const double k = k0_ + own_ * dilatation_[i] + shared_ * mean_dilatation_ + of_volume_ * volume_excess_;
    samples_.stress[i] = to_eigen(matrix(scalar::stress(law_, mooney_fraction_, S, lame.mu, k)));
    guard_[i] = law_ == ElasticLaw::kCorotated ? 0 : scalar::tangent_guard(law_, mooney_fraction_, S, lame.mu, k);
  }
  samples_.pressure = of_volume_ * volume_excess_;
  samples_.volume_ratio = volume_excess_ + 1;
  add(branches);
}

void Element::add(const Branches& branches) {
  add_branch_stress(branches, lame_.mu, samples_);
  branch_modulus_ = lame_.mu * branches.modulus();
  for (int i = 0; i < kCorners && branches.any(); ++i) {
    const Mat3& S = samples_.polar[i].S;
    branch_stress_[i] = bounded_balance(samples_.branch_stress[i], S);
    const auto D =
        scalar::sum(scalar::deviator(scalar::symmetric_entries(S)), -1.0, scalar::symmetric((*branches.stretch)[i]));
    for (std::size_t k = 0; k < branches.steps.size(); ++k) {
      const BranchStep& step = branches.steps[k];
      const auto b = scalar::symmetric(branches.strain[k][i]);
      branch_energy_ += step.modulus * lame_.mu / kCorners *
                        (scalar::product(b, b) + 2 * step.decay * scalar::product(b, D) +
                         step.response * scalar::product(D, D));  //                                          eq. P17
    }
  }
}

std::array<Mat3, kCorners> Element::gradients(const ElementPoints& u) const {
  std::array<Mat3, kCorners> F;
  for (int i = 0; i < kCorners; ++i) {
    F[i] = u.transpose() * gradient_[i];
    if (assumed_) F[i] += assumed_->gradient(u, i);
    if (!plastic_inverse_.empty()) F[i] *= plastic_inverse_[i];
  }
  return F;
}

std::array<Mat3, kCorners> Element::on_gradients(std::array<Mat3, kCorners> P) const {
  for (std::size_t i = 0; i < plastic_inverse_.size(); ++i) P[i] *= plastic_inverse_[i].transpose();  //      eq. P4
  return P;
}

ElementPoints Element::transpose(const std::array<Mat3, kCorners>& P) const {
  ElementPoints acting = ElementPoints::Zero();
  for (int i = 0; i < kCorners; ++i) acting += gradient_[i] * P[i].transpose();
  if (assumed_) acting += assumed_->transpose(P);
  return acting;
}

double Element::energy() const {
  double density = 0;
  for (int i = 0; i < kCorners; ++i) {
    const double theta = dilatation_[i];
    const auto S = scalar::symmetric_entries(samples_.polar[i].S);
    density +=
        (scalar::shape_energy(law_, mooney_fraction_, S, lame_.mu) + (k0_ + own_ * theta / 2) * theta) / kCorners;
  }
  density += (shared_ * mean_dilatation_ * mean_dilatation_ + of_volume_ * volume_excess_ * volume_excess_) / 2;
  return samples_.volume * (density + branch_energy_);
}

ElementPoints Element::force() const {
  std::array<Mat3, kCorners> P;
  for (int i = 0; i < kCorners; ++i) {
    const auto& [R, S] = samples_.polar[i];
    const double k = k0_ + own_ * dilatation_[i] + shared_ * mean_dilatation_;
    P[i] = R * to_eigen(matrix(
                   scalar::stress(law_, mooney_fraction_, scalar::symmetric_entries(S), lame_.mu, k)));  // eq. 12, 13
    P[i] += R * branch_stress_[i];  //                                                                       eq. P14
  }
  P = on_gradients(P);
  ElementPoints acting = transpose(P) / kCorners;
  if (assumed_) acting += assumed_->turning(P, current_) / kCorners;
  if (of_volume_ != 0) acting += of_volume_ * volume_excess_ * volume_gradient_;
  return -samples_.volume * acting;
}

ElementPoints Element::force_increment(const ElementPoints& dx) const {
  const std::array<Mat3, kCorners> dF = gradients(dx);
  CornerValues t;  // increments of the dilatations
  double mean = 0;
  for (int i = 0; i < kCorners; ++i) {
    t[i] = along_dilatation_[i].cwiseProduct(dF[i]).sum();
    mean += t[i] / kCorners;
  }
  std::array<Mat3, kCorners> dP;
  for (int i = 0; i < kCorners; ++i) {
    const Mat3& R = samples_.polar[i].R;
    const Mat3 Z = R.transpose() * dF[i];
    dP[i] =
        R * lame_.mu * (Z + Z.transpose()) + (free_ * t[i] + shared_ * mean) * along_dilatation_[i] + guard_[i] * dF[i];
    dP[i] += branch_modulus_ * R * (Z + Z.transpose() - 2.0 / 3 * Z.trace() * Mat3::Identity());
  }
  ElementPoints acting = transpose(on_gradients(dP)) / kCorners;
  if (of_volume_ != 0) acting += of_volume_ * volume_gradient_.cwiseProduct(dx).sum() * volume_gradient_;
  return -samples_.volume * acting;
}

}  // namespace hexaplast::plain
