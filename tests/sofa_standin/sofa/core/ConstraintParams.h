// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/MultiVecId.h>

namespace sofa::core {

class ConstraintParams {
 public:
  MultiVecDerivId lambda() const { return lambda_; }
  void setLambda(MultiVecDerivId id) { lambda_ = id; }

 private:
  MultiVecDerivId lambda_;
};

}  // namespace sofa::core
