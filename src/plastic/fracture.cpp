// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/fracture.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace hexaplast {

bool is_broken(const Material& material, const CornerValues& yield_stress_before, const CornerValues& yield_stress,
               const CornerTensors* plastic_stretch) {
  for (int i = 0; i < kCorners && std::isfinite(material.fracture_stress); ++i) {
    const double tau = yield_stress[i];
    if (tau > yield_stress_before[i] && tau > material.fracture_stress) return true;
  }
  if (!std::isfinite(material.fracture_stretch)) return false;
  return std::any_of(plastic_stretch->begin(), plastic_stretch->end(), [&](const Mat3& Fp) {
    if (Fp.norm() < material.fracture_stretch) return false;  // no singular value is above the norm
    return Eigen::JacobiSVD<Mat3>(Fp).singularValues()[0] > material.fracture_stretch;
  });
}

bool is_broken(const Model& model, const History& before, const History& next, int element) {
  const Material& material = model.material(element);
  CornerTensors of_isolated;  // F^p
  const CornerTensors* stretch = next.plastic_stretch.empty() ? nullptr : &next.plastic_stretch[element];
  if (!next.plastic_inverse.empty() && std::isfinite(material.fracture_stretch)) {
    for (int i = 0; i < kCorners; ++i) of_isolated[i] = next.plastic_inverse[element][i].inverse();
    stretch = &of_isolated;
  }
  return is_broken(material, before.yield_stress[element], next.yield_stress[element], stretch);
}

}  // namespace hexaplast
