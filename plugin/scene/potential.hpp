// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"

namespace hexaplast::scene {

/// What a force field is besides, whose forces have a potential at each moment.
class Potential {
 public:
  virtual ~Potential() = default;

  /// [J] at positions x (num_nodes x 3) and a time: the forces are minus its gradient with respect to x.
  virtual double potential_energy(double time, ConstPoints x) const = 0;
};

}  // namespace hexaplast::scene
