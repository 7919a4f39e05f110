// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/type/types.h>

namespace sofa::defaulttype {

struct Vec3Types {
  using Coord = type::Vec3;
  using Deriv = type::Vec3;
  using VecCoord = type::vector<Coord>;
  using VecDeriv = type::vector<Deriv>;
  static const char* Name() { return "Vec3d"; }
};

}  // namespace sofa::defaulttype
