// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/corotated.hpp"

#include "material/corotated-inl.hpp"

namespace hexaplast {

namespace plain = HWY_NAMESPACE;  // the formulas, here of doubles

double energy_density(const Mat3& S, const Lame& k) {
  return plain::energy_density(plain::symmetric_entries(S), k.mu, k.lambda);
}

Mat3 stress(const Mat3& S, const Lame& k) {
  return to_eigen(matrix(plain::stress(plain::symmetric_entries(S), k.mu, k.lambda)));
}

Mat3 stress_increment(const Mat3& R, const Mat3& dF, const Lame& k) {
  return R * to_eigen(plain::stress_increment(plain::entries(R.transpose() * dF), k.mu, k.lambda));
}

}  // namespace hexaplast
