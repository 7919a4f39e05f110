// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/corotated.hpp"

namespace hexaplast {

double energy_density(const Mat3& S, const Lame& k) {
  const Mat3 strain = S - Mat3::Identity();
  const double trace = strain.trace();
  return k.mu * strain.squaredNorm() + 0.5 * k.lambda * trace * trace;  // eq. 11
}

Mat3 stress(const Mat3& S, const Lame& k) {
  const Mat3 strain = S - Mat3::Identity();
  return 2 * k.mu * strain + k.lambda * strain.trace() * Mat3::Identity();  // eq. 12
}

Mat3 stress_increment(const Mat3& R, const Mat3& dF, const Lame& k) {
  const Mat3 turned_back = R.transpose() * dF;
  return R * (k.mu * (turned_back + turned_back.transpose()) +
              k.lambda * turned_back.trace() * Mat3::Identity());  // eq. 14
}

}  // namespace hexaplast
