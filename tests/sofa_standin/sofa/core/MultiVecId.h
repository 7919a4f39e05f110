// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/config.h>

namespace sofa::core {

namespace behavior {
class BaseMechanicalState;
}

/// The number of a vector that a state keeps beside positions and velocities.
using VecDerivId = int;

enum class ConstVecId { kPosition, kVelocity };
namespace vec_id::read_access {
inline constexpr ConstVecId position = ConstVecId::kPosition, velocity = ConstVecId::kVelocity;
}

/// The vectors of the same number in all states of a graph.
class MultiVecDerivId {
 public:
  explicit MultiVecDerivId(VecDerivId number = 0) : number_(number) {}
  VecDerivId getId(const behavior::BaseMechanicalState*) const { return number_; }

 private:
  VecDerivId number_;
};

}  // namespace sofa::core
