// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/MechanicalParams.h>
#include <sofa/core/behavior/MechanicalState.h>

namespace sofa::linearalgebra {
class BaseMatrix;
}

namespace sofa::core::behavior {

class StiffnessMatrix;
class DampingMatrix;

class BaseForceField : public objectmodel::BaseComponent {
 public:
  virtual void buildStiffnessMatrix(StiffnessMatrix*) = 0;
  virtual void buildDampingMatrix(DampingMatrix*) = 0;
  virtual void addMBKdx(const MechanicalParams* params, MultiVecDerivId df) = 0;

  objectmodel::Data<SReal> rayleighStiffness{
      initData(&rayleighStiffness, 0, "rayleighStiffness", "Damping proportional to the stiffness.")};
};

template <class TDataTypes>
class ForceField : public BaseForceField {
 public:
  using DataTypes = TDataTypes;
  using DataVecCoord = objectmodel::Data<typename DataTypes::VecCoord>;
  using DataVecDeriv = objectmodel::Data<typename DataTypes::VecDeriv>;

  void init() override {
    if (!mstate) mstate.set(getContext()->template get<MechanicalState<DataTypes>>());
  }
  MechanicalState<DataTypes>* getMState() const { return mstate.get(); }

  void addMBKdx(const MechanicalParams* params, MultiVecDerivId df) override {
    if (params->kFactor() == 0 && params->bFactor() == 0) return;
    addDForce(params, *mstate->write(df.getId(mstate)), *mstate->read(params->dx().getId(mstate)));
  }

  virtual void addForce(const MechanicalParams*, DataVecDeriv& f, const DataVecCoord& x, const DataVecDeriv& v) = 0;
  virtual void addDForce(const MechanicalParams*, DataVecDeriv& df, const DataVecDeriv& dx) = 0;
  virtual void addKToMatrix(linearalgebra::BaseMatrix*, SReal factor, unsigned int& offset) = 0;
  virtual void addBToMatrix(linearalgebra::BaseMatrix*, SReal /*factor*/, unsigned int& /*offset*/) {}
  virtual SReal getPotentialEnergy(const MechanicalParams*, const DataVecCoord& x) const = 0;

 protected:
  objectmodel::SingleLink<ForceField, MechanicalState<DataTypes>, objectmodel::BaseLink::FLAG_STRONGLINK> mstate;
};

}  // namespace sofa::core::behavior
