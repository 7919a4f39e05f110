// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/behavior/ForceField.h>

namespace sofa::core::behavior {

class BaseMass {
 public:
  virtual ~BaseMass() = default;
  virtual bool isDiagonal() const = 0;

  objectmodel::Data<SReal> rayleighMass{"Damping proportional to the mass."};
};

template <class DataTypes>
class Mass : public ForceField<DataTypes>, public BaseMass {
 public:
  using Inherit = ForceField<DataTypes>;
  using typename Inherit::DataVecCoord;
  using typename Inherit::DataVecDeriv;

  virtual void addMDx(const MechanicalParams*, DataVecDeriv& f, const DataVecDeriv& dx, SReal factor) = 0;

  void addMBKdx(const MechanicalParams* params, MultiVecDerivId df) override {
    auto* state = this->getMState();
    if (params->mFactor() != 0)
      addMDx(params, *state->write(df.getId(state)), *state->read(params->dx().getId(state)), params->mFactor());
  }

  void addForce(const MechanicalParams*, DataVecDeriv&, const DataVecCoord&, const DataVecDeriv&) override {}
  void addDForce(const MechanicalParams*, DataVecDeriv&, const DataVecDeriv&) override {}
  void addKToMatrix(linearalgebra::BaseMatrix*, SReal, unsigned int&) override {}
  void buildStiffnessMatrix(StiffnessMatrix*) override {}
  void buildDampingMatrix(DampingMatrix*) override {}
  SReal getPotentialEnergy(const MechanicalParams*, const DataVecCoord&) const override { return 0; }
};

}  // namespace sofa::core::behavior
