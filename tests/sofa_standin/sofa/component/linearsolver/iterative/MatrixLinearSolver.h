// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/BaseMapping.h>
#include <sofa/simulation/MechanicalOperations.h>

namespace sofa::component::linearsolver {

class GraphScatteredVector {
 public:
  explicit GraphScatteredVector(core::VecDerivId number) : id_(number) {}
  core::MultiVecDerivId id() const { return id_; }
  operator core::MultiVecDerivId() const { return id_; }

 private:
  core::MultiVecDerivId id_;
};

struct GraphScatteredMatrix {
  core::MechanicalParams mparams;
  simulation::common::MechanicalOperations* parent = nullptr;
};

template <class Matrix, class Vector>
class MatrixLinearSolver : public core::objectmodel::BaseComponent {
 public:
  /// Makes vectors to work with, and brings the matrix to where its products are made, for as long as it lives.
  class TempVectorContainer {
   public:
    TempVectorContainer(MatrixLinearSolver* solver, const core::ExecParams*, Matrix& A, Vector&, Vector&)
        : operations_(A.mparams, solver->getContext()) {
      A.parent = &operations_;
    }
    Vector* createTempVector() { return new Vector(next_++); }

   private:
    simulation::common::MechanicalOperations operations_;
    core::VecDerivId next_ = 100;
  };

  virtual void solve(Matrix& A, Vector& x, Vector& b) = 0;
};

}  // namespace sofa::component::linearsolver
