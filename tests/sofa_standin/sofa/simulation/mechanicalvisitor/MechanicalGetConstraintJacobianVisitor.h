// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/ConstraintParams.h>
#include <sofa/core/objectmodel/BaseContext.h>
#include <sofa/linearalgebra/BaseMatrix.h>

#include <functional>

namespace sofa::simulation::mechanicalvisitor {

/// Finds what a test says that the constraints of the graph are.
class MechanicalGetConstraintJacobianVisitor {
 public:
  MechanicalGetConstraintJacobianVisitor(const core::ConstraintParams*, linearalgebra::BaseMatrix* J) : J_(J) {}
  void execute(core::objectmodel::BaseContext*) {
    if (constraints()) constraints()(*J_);
  }
  static std::function<void(linearalgebra::BaseMatrix&)>& constraints() {
    static std::function<void(linearalgebra::BaseMatrix&)> of_test;
    return of_test;
  }

 private:
  linearalgebra::BaseMatrix* J_;
};

}  // namespace sofa::simulation::mechanicalvisitor
