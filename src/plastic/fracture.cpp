// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/fracture.hpp"

#include <cmath>

#include "kinematics/polar.hpp"

namespace hexaplast {

bool is_broken(const Model& model, const History& before, const History& next, int element) {
  const Material& material = model.material(element);
  for (int i = 0; i < kCorners && std::isfinite(material.fracture_stress); ++i) {
    const double tau = next.yield_stress[element][i];
    if (tau > before.yield_stress[element][i] && tau > material.fracture_stress) return true;
  }
  if (!std::isfinite(material.fracture_stretch)) return false;
  for (int i = 0; i < kCorners; ++i) {
    const Mat3 Fp = next.plastic_inverse.empty() ? next.plastic_stretch[element][i]
                                                 : Mat3(next.plastic_inverse[element][i].inverse());
    if (Fp.norm() < material.fracture_stretch) continue;  // no singular value is above the norm
    if (signed_svd(Fp).d[0] > material.fracture_stretch) return true;
  }
  return false;
}

}  // namespace hexaplast
