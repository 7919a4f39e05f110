// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/BaseMapping.h>
#include <sofa/core/ConstraintParams.h>
#include <sofa/linearalgebra/BaseMatrix.h>
#include <sofa/linearalgebra/BaseVector.h>
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

/// The matrix, the solution and the right-hand side of the latest step.
template <class Matrix, class Vector>
class LinearSystem {
 public:
  Matrix* getSystemMatrix() { return &matrix; }
  Vector* getSolutionVector() { return &solution; }
  Vector* getRHSVector() { return &rhs; }

  Matrix matrix;
  Vector solution{0}, rhs{1};
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
  virtual void invert(Matrix&) {}
  virtual bool addJMInvJt(linearalgebra::BaseMatrix*, linearalgebra::BaseMatrix*, SReal) { return false; }
  virtual bool buildComplianceMatrix(const core::ConstraintParams*, linearalgebra::BaseMatrix*, SReal, SReal) {
    return false;
  }
  virtual void applyConstraintForce(const core::ConstraintParams*, core::MultiVecDerivId,
                                    const linearalgebra::BaseVector*) {}

  LinearSystem<Matrix, Vector>* getLinearSystem() const { return &system_; }

 private:
  mutable LinearSystem<Matrix, Vector> system_;
};

}  // namespace sofa::component::linearsolver
