// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/type/types.h>

#include <algorithm>
#include <string>

namespace sofa::helper {

/// From blue to red, whatever its name.
class ColorMap {
 public:
  ColorMap(unsigned int /*size*/, const std::string& /*name*/) {}

  template <class Real>
  auto getEvaluator(Real min, Real max) const {
    return [min, max](Real value) {
      const auto fraction = static_cast<float>(std::clamp((value - min) / (max - min), Real(0), Real(1)));
      return type::RGBAColor{fraction, 0, 1 - fraction, 1};
    };
  }
};

}  // namespace sofa::helper
