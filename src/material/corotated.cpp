// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/corotated.hpp"

#include "material/law-inl.hpp"

namespace hexaplast {

namespace plain = HWY_NAMESPACE;  // the formulas, here of doubles

double energy_density(const Mat3& S, const Lame& k) {
  const plain::Sym<double> stretch = plain::symmetric_entries(S);
  const double theta = plain::dilatation(ElasticLaw::kCorotated, stretch);
  return plain::shape_energy(ElasticLaw::kCorotated, 0, stretch, k.mu) + 0.5 * k.lambda * theta * theta;
}

Mat3 stress(const Mat3& S, const Lame& k) {
  const plain::Sym<double> stretch = plain::symmetric_entries(S);
  const double pressure = k.lambda * plain::dilatation(ElasticLaw::kCorotated, stretch);
  return to_eigen(matrix(plain::stress(ElasticLaw::kCorotated, 0, stretch, k.mu, pressure)));
}

Mat3 stress_increment(const Mat3& R, const Mat3& dF, const Lame& k) {
  return R * to_eigen(plain::stress_increment(plain::entries(R.transpose() * dF), k.mu, k.lambda));
}

}  // namespace hexaplast
