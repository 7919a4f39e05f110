// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/corotated.hpp"

#include "material/law-inl.hpp"

namespace hexaplast {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

double energy_density(const Mat3& S, const Lame& k) {
  const scalar::Sym<double> stretch = scalar::symmetric_entries(S);
  const double theta = scalar::dilatation(ElasticLaw::kCorotated, stretch);
  return scalar::shape_energy(ElasticLaw::kCorotated, 0, stretch, k.mu) + 0.5 * k.lambda * theta * theta;
}

Mat3 stress(const Mat3& S, const Lame& k) {
  const scalar::Sym<double> stretch = scalar::symmetric_entries(S);
  const double pressure = k.lambda * scalar::dilatation(ElasticLaw::kCorotated, stretch);
  return to_eigen(matrix(scalar::stress(ElasticLaw::kCorotated, 0, stretch, k.mu, pressure)));
}

Mat3 stress_increment(const Mat3& R, const Mat3& dF, const Lame& k) {
  return R * to_eigen(scalar::stress_increment(scalar::entries(R.transpose() * dF), k.mu, k.lambda));
}

}  // namespace hexaplast
