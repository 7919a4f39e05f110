// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/config.h>

namespace sofa::core {

class MechanicalParams {
 public:
  SReal kFactor() const { return k_; }
  SReal bFactor() const { return b_; }
  void setKFactor(SReal k) { k_ = k; }
  void setBFactor(SReal b) { b_ = b; }

 private:
  SReal k_ = 0, b_ = 0;
};

namespace mechanicalparams {
inline SReal kFactorIncludingRayleighDamping(const MechanicalParams* params, SReal rayleigh_stiffness) {
  return params->kFactor() + params->bFactor() * rayleigh_stiffness;
}
}  // namespace mechanicalparams

}  // namespace sofa::core
