// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartComponent.h>
#include <Hexaplast/config.h>
#include <sofa/core/behavior/MixedInteractionForceField.h>

#include <array>

namespace hexaplast::sofa_plugin
{

/// The forces of a part between two states, or within one. Stands below the integrator of both.
class HEXAPLAST_SOFA_API ForceBetweenStates
    : public PartComponent<sofa::core::behavior::MixedInteractionForceField<Vec3Types, Vec3Types>>
{
public:
    using DataTypes = Vec3Types;
    using Inherit = sofa::core::behavior::MixedInteractionForceField<Vec3Types, Vec3Types>;
    using Component = PartComponent<Inherit>;
    SOFA_ABSTRACT_CLASS(ForceBetweenStates, Component);
    using DataVecCoord = sofa::core::objectmodel::Data<Vec3Types::VecCoord>;
    using DataVecDeriv = sofa::core::objectmodel::Data<Vec3Types::VecDeriv>;
    using MechanicalParams = sofa::core::MechanicalParams;

    void init() override;

    using Inherit::addDForce;
    using Inherit::addForce;
    using Inherit::getPotentialEnergy;

    /// Evaluate only.
    void addForce(const MechanicalParams* mparams, DataVecDeriv& f1, DataVecDeriv& f2, const DataVecCoord& x1,
                  const DataVecCoord& x2, const DataVecDeriv& v1, const DataVecDeriv& v2) override;
    void addDForce(const MechanicalParams* mparams, DataVecDeriv& df1, DataVecDeriv& df2, const DataVecDeriv& dx1,
                   const DataVecDeriv& dx2) override;
    SReal getPotentialEnergy(const MechanicalParams* mparams, const DataVecCoord& x1,
                             const DataVecCoord& x2) const override;

    std::array<MechanicalState*, 2> states() const override { return {mstate1.get(), mstate2.get()}; }

protected:
    ForceBetweenStates(const Description& description, bool makesData);
};

}  // namespace hexaplast::sofa_plugin
