// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/config.h>

namespace sofa::linearalgebra {

class BaseVector {
 public:
  virtual ~BaseVector() = default;
  virtual SReal element(long i) const = 0;
};

}  // namespace sofa::linearalgebra
