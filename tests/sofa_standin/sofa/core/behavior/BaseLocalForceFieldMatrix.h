// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/behavior/MechanicalState.h>

#include <map>

namespace sofa::core::behavior {

/// Keeps the entries by row and column, where a test reads them.
class StiffnessMatrix {
 public:
  using Entries = std::map<std::pair<int, int>, SReal>;

  class Block {
   public:
    Block(Entries& entries, int row, int column) : entries_(entries), row_(row), column_(column) {}
    void operator+=(const type::Mat<3, 3, SReal>& block) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) entries_[{row_ + a, column_ + b}] += block(a, b);
    }

   private:
    Entries& entries_;
    int row_, column_;
  };
  class Derivative {
   public:
    explicit Derivative(Entries& entries) : entries_(entries) {}
    Derivative& withRespectToPositionsIn(BaseMechanicalState*) { return *this; }
    Derivative& withRespectToVelocityIn(BaseMechanicalState*) { return *this; }
    Block operator()(int row, int column) { return {entries_, row, column}; }

   private:
    Entries& entries_;
  };

  Derivative getForceDerivativeIn(BaseMechanicalState*) { return Derivative(entries); }

  Entries entries;
};

class DampingMatrix final : public StiffnessMatrix {};

}  // namespace sofa::core::behavior
