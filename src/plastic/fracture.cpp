// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/fracture.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/polar.hpp"

namespace hexaplast {

namespace {

Mat3 stretch_that_stays(const History& history, int element, int corner) {
  return history.plastic_inverse.empty() ? history.plastic_stretch[element][corner]
                                         : Mat3(history.plastic_inverse[element][corner].inverse());
}

}  // namespace

bool may_tear(const std::vector<Material>& materials, const Settings& settings) {
  return settings.fracture == Fracture::kFace && std::ranges::any_of(materials, [](const Material& material) {
           return can_stretch(material) && std::isfinite(std::min(material.fracture_stress, material.fracture_stretch));
         });
}

bool is_broken(const Model& model, const CornerValues& tau_before, const History& next, int element) {
  const Material& material = model.material(element);
  for (int i = 0; i < kCorners && std::isfinite(material.fracture_stress); ++i) {
    const double tau = next.yield_stress[element][i];
    if (tau > tau_before[i] && tau > material.fracture_stress) return true;
  }
  if (!std::isfinite(material.fracture_stretch)) return false;
  for (int i = 0; i < kCorners; ++i) {
    const Mat3 Fp = stretch_that_stays(next, element, i);
    if (Fp.norm() < material.fracture_stretch) continue;  // no singular value is above the norm
    if (signed_svd(Fp).d[0] > material.fracture_stretch) return true;
  }
  return false;
}

double largest_plastic_stretch(const History& history, int element, int corner) {
  return signed_svd(stretch_that_stays(history, element, corner)).d[0];
}

}  // namespace hexaplast
