// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/config.h>

namespace sofa::linearalgebra {

class BaseMatrix {
 public:
  virtual ~BaseMatrix() = default;
  virtual void add(int row, int column, SReal value) = 0;
  virtual long rowSize() const { return 0; }
  virtual long colSize() const { return 0; }
};

}  // namespace sofa::linearalgebra
