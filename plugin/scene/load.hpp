// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"

namespace hexaplast::scene {

/// What a force field is besides, whose forces load the body from outside: prescribed forces, pushes of obstacles,
/// pulls of instruments. Files and pictures of a run show them.
class Load {
 public:
  virtual ~Load() = default;

  /// f += those forces [N] at (x, v, time), num_nodes x 3 [m, m/s, s]. Changes nothing but f, so that it may be called
  /// between two steps.
  virtual void add_load(double time, ConstPoints x, ConstPoints v, Points f) const = 0;
};

}  // namespace hexaplast::scene
