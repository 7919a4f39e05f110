// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartComponent.h>
#include <Hexaplast/config.h>
#include <sofa/core/behavior/ForceField.h>

#include <array>
#include <string>

namespace hexaplast::sofa_plugin
{

/// The forces of a part on one state.
class HEXAPLAST_SOFA_API ForceOnState : public PartComponent<sofa::core::behavior::ForceField<Vec3Types>>
{
public:
    using DataTypes = Vec3Types;
    using Inherit = sofa::core::behavior::ForceField<Vec3Types>;
    using Component = PartComponent<Inherit>;
    SOFA_ABSTRACT_CLASS(ForceOnState, Component);
    using DataVecCoord = sofa::core::objectmodel::Data<Vec3Types::VecCoord>;
    using DataVecDeriv = sofa::core::objectmodel::Data<Vec3Types::VecDeriv>;
    using MechanicalParams = sofa::core::MechanicalParams;
    static std::string GetCustomTemplateName() { return Vec3Types::Name(); }

    void init() override { initPart(); }

    using Inherit::addDForce;
    using Inherit::addForce;
    using Inherit::addKToMatrix;
    using Inherit::getPotentialEnergy;

    /// Evaluate only.
    void addForce(const MechanicalParams* mparams, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    void addDForce(const MechanicalParams* mparams, DataVecDeriv& df, const DataVecDeriv& dx) override;
    void addKToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset) override;
    SReal getPotentialEnergy(const MechanicalParams* mparams, const DataVecCoord& x) const override;

    void computeBBox(const sofa::core::ExecParams* params, bool onlyVisible = false) override;

    std::array<MechanicalState*, 2> states() const override { return {mstate.get(), mstate.get()}; }

protected:
    using Component::Component;

    void initPart() override;
};

}  // namespace hexaplast::sofa_plugin
