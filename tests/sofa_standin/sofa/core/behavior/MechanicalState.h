// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/MultiVecId.h>
#include <sofa/core/objectmodel/BaseComponent.h>
#include <sofa/defaulttype/VecTypes.h>

#include <map>

namespace sofa::core::behavior {

class BaseMechanicalState : public objectmodel::BaseComponent {
 public:
  virtual Size getSize() const = 0;
  virtual Size getCoordDimension() const { return 3; }
  virtual Size getDerivDimension() const { return 3; }
  virtual void copyToBuffer(SReal* /*to*/, ConstVecId /*from*/, unsigned int /*count*/) const {}
};

/// Keeps the nodes itself, as SOFA's MechanicalObject does.
template <class DataTypes>
class MechanicalState : public BaseMechanicalState {
 public:
  SOFA_CLASS(MechanicalState, BaseMechanicalState);
  using VecCoord = typename DataTypes::VecCoord;
  using VecDeriv = typename DataTypes::VecDeriv;

  Size getSize() const override { return static_cast<Size>(position_.getValue().size()); }
  helper::ReadAccessor<VecCoord> readPositions() const { return helper::ReadAccessor<VecCoord>(position_); }
  helper::ReadAccessor<VecCoord> readRestPositions() const { return helper::ReadAccessor<VecCoord>(rest_position_); }
  helper::ReadAccessor<VecDeriv> readVelocities() const { return helper::ReadAccessor<VecDeriv>(velocity_); }
  helper::WriteAccessor<VecCoord> writePositions() { return helper::getWriteAccessor(position_); }
  helper::WriteAccessor<VecCoord> writeRestPositions() { return helper::getWriteAccessor(rest_position_); }
  helper::WriteAccessor<VecDeriv> writeVelocities() { return helper::getWriteAccessor(velocity_); }

  /// The vector of some number, of zeros when it is new.
  const objectmodel::Data<VecDeriv>* read(VecDerivId id) { return write(id); }
  objectmodel::Data<VecDeriv>* write(VecDerivId id) {
    auto& vector = vectors_[id];
    vector.beginEdit()->resize(getSize());
    return &vector;
  }

 private:
  objectmodel::Data<VecCoord> position_, rest_position_;
  objectmodel::Data<VecDeriv> velocity_;
  std::map<VecDerivId, objectmodel::Data<VecDeriv>> vectors_;
};

}  // namespace sofa::core::behavior
