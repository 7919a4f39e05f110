// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/behavior/ForceField.h>

namespace sofa::core::behavior {

template <class TDataTypes1, class TDataTypes2>
class MixedInteractionForceField : public BaseForceField {
 public:
  using DataTypes = TDataTypes1;
  using DataVecCoord1 = objectmodel::Data<typename TDataTypes1::VecCoord>;
  using DataVecCoord2 = objectmodel::Data<typename TDataTypes2::VecCoord>;
  using DataVecDeriv1 = objectmodel::Data<typename TDataTypes1::VecDeriv>;
  using DataVecDeriv2 = objectmodel::Data<typename TDataTypes2::VecDeriv>;

  MechanicalState<TDataTypes1>* getMState1() const { return mstate1.get(); }
  MechanicalState<TDataTypes2>* getMState2() const { return mstate2.get(); }

  void addMBKdx(const MechanicalParams* params, MultiVecDerivId df) override {
    if (params->kFactor() == 0 && params->bFactor() == 0) return;
    addDForce(params, *mstate1->write(df.getId(mstate1)), *mstate2->write(df.getId(mstate2)),
              *mstate1->read(params->dx().getId(mstate1)), *mstate2->read(params->dx().getId(mstate2)));
  }

  virtual void addForce(const MechanicalParams*, DataVecDeriv1& f1, DataVecDeriv2& f2, const DataVecCoord1& x1,
                        const DataVecCoord2& x2, const DataVecDeriv1& v1, const DataVecDeriv2& v2) = 0;
  virtual void addDForce(const MechanicalParams*, DataVecDeriv1& df1, DataVecDeriv2& df2, const DataVecDeriv1& dx1,
                         const DataVecDeriv2& dx2) = 0;
  virtual SReal getPotentialEnergy(const MechanicalParams*, const DataVecCoord1& x1, const DataVecCoord2& x2) const = 0;

  // as if they were protected and set by a scene
  objectmodel::SingleLink<MixedInteractionForceField, MechanicalState<TDataTypes1>,
                          objectmodel::BaseLink::FLAG_STRONGLINK>
      mstate1;
  objectmodel::SingleLink<MixedInteractionForceField, MechanicalState<TDataTypes2>,
                          objectmodel::BaseLink::FLAG_STRONGLINK>
      mstate2;
};

}  // namespace sofa::core::behavior
