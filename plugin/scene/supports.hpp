// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/interfaces.hpp"

namespace hexaplast::scene {

/// What a time integrator is besides, that can tell the forces of constraints.
class Supports {
 public:
  virtual ~Supports() = default;

  /// Keeps them from now on. It changes nothing in the motion, and costs a step about two products.
  virtual void keep_support_forces() = 0;

  /// [N] on each node of an independent state that it moves, in the latest step: by which constraints held nodes or
  /// prescribed them; zero on free degrees of freedom. No rows before the first step.
  virtual PointArray support_forces(const MechanicalState& state) = 0;
};

}  // namespace hexaplast::scene
