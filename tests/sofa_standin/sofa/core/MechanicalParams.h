// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/MultiVecId.h>

namespace sofa::core {

/// Factors of a system m M + b B + k K.
struct MatricesFactors {
  template <char name>
  struct Factor {
    explicit Factor(SReal given) : value(given) {}
    SReal value;
  };
  using M = Factor<'M'>;
  using B = Factor<'B'>;
  using K = Factor<'K'>;
};

class MechanicalParams {
 public:
  SReal mFactor() const { return m_; }
  SReal bFactor() const { return b_; }
  SReal kFactor() const { return k_; }
  MultiVecDerivId dx() const { return dx_; }
  void setMFactor(SReal m) { m_ = m; }
  void setBFactor(SReal b) { b_ = b; }
  void setKFactor(SReal k) { k_ = k; }
  void setDx(MultiVecDerivId dx) { dx_ = dx; }

 private:
  SReal m_ = 0, b_ = 0, k_ = 0;
  MultiVecDerivId dx_;
};

namespace mechanicalparams {
inline SReal kFactorIncludingRayleighDamping(const MechanicalParams* params, SReal rayleigh_stiffness) {
  return params->kFactor() + params->bFactor() * rayleigh_stiffness;
}
}  // namespace mechanicalparams

}  // namespace sofa::core
