// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/Guest.h>
#include <Hexaplast/config.h>
#include <sofa/core/behavior/ForceField.h>

#include <optional>

#include "hexaplast/base/block_matrix.hpp"

namespace hexaplast::sofa_plugin
{

/// A force field of SOFA whose forces and stiffness are those of one of ours.
class HEXAPLAST_SOFA_API GuestForceField : public sofa::core::behavior::ForceField<DataTypes>
{
public:
    SOFA_ABSTRACT_CLASS(GuestForceField, SOFA_TEMPLATE(sofa::core::behavior::ForceField, DataTypes));
    using Inherit = sofa::core::behavior::ForceField<DataTypes>;
    using MechanicalParams = sofa::core::MechanicalParams;

    /// What scenes give as template.
    static std::string GetCustomTemplateName() { return DataTypes::Name(); }

    void init() override;
    void reinit() override;
    void reset() override;
    void handleEvent(sofa::core::objectmodel::Event* event) override;

    using Inherit::addBToMatrix;
    using Inherit::addDForce;
    using Inherit::addForce;
    using Inherit::addKToMatrix;
    using Inherit::getPotentialEnergy;

    /// Evaluate only: nothing plastic changes.
    void addForce(const MechanicalParams* mparams, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    void addDForce(const MechanicalParams* mparams, DataVecDeriv& df, const DataVecDeriv& dx) override;
    void addKToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset) override;
    void addBToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset) override;
    void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix) override;
    void buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix) override;
    SReal getPotentialEnergy(const MechanicalParams* mparams, const DataVecCoord& x) const override;

    void computeBBox(const sofa::core::ExecParams* params, bool onlyVisible = false) override;

    /// The force field of ours, for those of our components that look inside; null before init and after an error.
    scene::ForceField* guest() const { return m_guest ? &m_guest->as<scene::ForceField>() : nullptr; }

    /// From now on addDForce adds nothing: a solver of ours has the stiffness by other ways.
    void leaveOutOfProducts(bool leftOut) { m_leftOut = leftOut; }

protected:
    explicit GuestForceField(const attributes::Description& description);

    virtual MeshTopology* topology() { return nullptr; }
    virtual void stepEnded() {}

    bool works() const { return m_guest && !is_invalid(*this); }
    AttributeData& attributes() { return m_attributes; }

private:
    /// The stiffness at the latest forces into m_stiffness, df/dv into m_damping; false where that has failed, which is
    /// said.
    bool findStiffness();
    bool findDamping();

    const attributes::Description& m_description;
    AttributeData m_attributes;
    mutable std::optional<Guest> m_guest;
    BlockMatrix m_stiffness, m_damping;
    bool m_leftOut = false;
};

}  // namespace hexaplast::sofa_plugin
