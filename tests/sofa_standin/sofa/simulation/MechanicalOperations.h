// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/behavior/BaseProjectiveConstraintSet.h>
#include <sofa/core/behavior/ForceField.h>
#include <sofa/core/behavior/MechanicalState.h>

namespace sofa::simulation::common {

/// Calls the force fields and constraints at a node and below, one after the other. Mappings are not followed.
class MechanicalOperations {
 public:
  using State = core::behavior::MechanicalState<defaulttype::Vec3Types>;

  MechanicalOperations(const core::MechanicalParams& params, core::objectmodel::BaseContext* context)
      : params_(params), context_(context) {}

  void propagateDxAndResetDf(core::MultiVecDerivId dx, core::MultiVecDerivId df) {
    params_.setDx(dx);
    std::vector<State*> states;
    context_->get<State>(&states, core::objectmodel::BaseContext::SearchDown);
    for (State* state : states) state->write(df.getId(state))->beginEdit()->assign(state->getSize(), {});
  }

  void addMBKdx(core::MultiVecDerivId df, core::MatricesFactors::M m, core::MatricesFactors::B b,
                core::MatricesFactors::K k, bool /*clear*/) {
    params_.setMFactor(m.value);
    params_.setBFactor(b.value);
    params_.setKFactor(k.value);
    for_each<core::behavior::BaseForceField>([&](auto& field) { field.addMBKdx(&params_, df); });
  }

  void projectResponse(core::MultiVecDerivId dx) {
    for_each<core::behavior::BaseProjectiveConstraintSet>([&](auto& set) { set.projectResponse(&params_, dx); });
  }

 private:
  template <class T, class Call>
  void for_each(const Call& call) {
    std::vector<T*> found;
    context_->get<T>(&found, core::objectmodel::BaseContext::SearchDown);
    for (T* each : found) call(*each);
  }

  core::MechanicalParams params_;
  core::objectmodel::BaseContext* context_;
};

}  // namespace sofa::simulation::common
