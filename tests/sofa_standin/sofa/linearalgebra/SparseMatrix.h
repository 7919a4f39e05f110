// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/linearalgebra/BaseMatrix.h>

#include <map>

namespace sofa::linearalgebra {

template <class Real>
class SparseMatrix final : public BaseMatrix {
 public:
  using Index = long;
  using Line = std::map<Index, Real>;

  void resize(Index rows, Index columns) {
    lines_.clear();
    rows_ = rows;
    columns_ = columns;
  }
  Index rowSize() const override { return rows_; }
  Index colSize() const override { return columns_; }
  void add(int row, int column, SReal value) override { lines_[row][column] += value; }

  auto begin() const { return lines_.begin(); }
  auto end() const { return lines_.end(); }

 private:
  std::map<Index, Line> lines_;
  Index rows_ = 0, columns_ = 0;
};

}  // namespace sofa::linearalgebra
