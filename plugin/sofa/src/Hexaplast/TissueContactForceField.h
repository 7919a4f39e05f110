// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/contact.h>
#include <sofa/core/behavior/MixedInteractionForceField.h>

#include "parts/tissue_contact.hpp"

namespace hexaplast::sofa_plugin
{

/// Two bodies that touch, or one that touches itself. Contacts are found at AnimateBeginEvent, anchors follow at
/// AnimateEndEvent. Stands below the integrator of both bodies.
template <class TDataTypes>
class TissueContactForceField
    : public ContactComponent<PartComponent<sofa::core::behavior::MixedInteractionForceField<TDataTypes, TDataTypes>>>
{
public:
    using DataTypes = TDataTypes;
    using Inherit = sofa::core::behavior::MixedInteractionForceField<TDataTypes, TDataTypes>;
    using Component = ContactComponent<PartComponent<Inherit>>;
    SOFA_CLASS(SOFA_TEMPLATE(TissueContactForceField, TDataTypes), Component);
    using DataVecCoord = sofa::core::objectmodel::Data<typename DataTypes::VecCoord>;
    using DataVecDeriv = sofa::core::objectmodel::Data<typename DataTypes::VecDeriv>;
    using MechanicalParams = sofa::core::MechanicalParams;

    void init() override;
    void bwdInit() override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;

    using Inherit::addDForce;
    using Inherit::addForce;
    using Inherit::getPotentialEnergy;

    /// Evaluate only.
    void addForce(const MechanicalParams* mparams, DataVecDeriv& f1, DataVecDeriv& f2, const DataVecCoord& x1,
                  const DataVecCoord& x2, const DataVecDeriv& v1, const DataVecDeriv& v2) override;
    void addDForce(const MechanicalParams* mparams, DataVecDeriv& df1, DataVecDeriv& df2, const DataVecDeriv& dx1,
                   const DataVecDeriv& dx2) override;
    void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix) override;
    void buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix) override;
    SReal getPotentialEnergy(const MechanicalParams* mparams, const DataVecCoord& x1,
                             const DataVecCoord& x2) const override;

    /// The contacts; null before bwdInit and after an error.
    const parts::Tissues* tissues() const { return m_tissues ? &*m_tissues : nullptr; }

    bool hasPart() const override { return m_tissues.has_value(); }

    /// For MultigridCGLinearSolver, as those of PartForceField; fields of the two states.
    bool isInMatrix() const override { return this->works() && !m_tissues->contact().terms().empty(); }
    bool release(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v)
    {
        return m_tissues->contact().release(x, v);
    }
    void addOwnForce(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) const
    {
        m_tissues->add_force(x, v, f);
    }
    void addOwnProduct(double b, double k, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const;

protected:
    TissueContactForceField();

    void makePart() override;
    void updatePart() override;
    bool othersHaveChanged() override;  ///< whether the bodies are others
    void resetPart() override;
    void beginStep(SReal time, SReal dt) override;
    void endStep(SReal dt) override;

private:
    OfTwo<ConstPoints> positions() const;
    OfTwo<ConstPoints> velocities() const;
    void warnOfSamePair();  ///< once, of another active contact between the same bodies that was there before
    bool isWithItself() const { return this->mstate1.get() == this->mstate2.get(); }

    template <class OfPair>
    void addBlocks(const BlockMatrix& blocks, const OfPair& ofPair) const;
    BlockMatrix blocksOf(bool damping) const;

    std::optional<parts::Tissues> m_tissues;
    std::array<BodyField*, 2> m_bodyFields = {};
    bool m_hasWarnedOfPair = false;
    std::array<int, 2> m_bodiesMade = {};  // which of the bodies that these fields have made
};

#if !defined(HEXAPLAST_TISSUECONTACTFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API TissueContactForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
