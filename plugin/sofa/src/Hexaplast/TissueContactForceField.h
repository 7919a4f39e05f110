// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <sofa/core/behavior/MixedInteractionForceField.h>

#include "parts/tissue_contact.hpp"

namespace hexaplast::sofa_plugin
{

/// Two bodies that touch, or one that touches itself. Contacts are found at AnimateBeginEvent, anchors follow at
/// AnimateEndEvent. Stands below the integrator of both bodies. Data that change during a simulation take effect at the
/// beginning of the next step, or by reinit.
template <class TDataTypes>
class TissueContactForceField : public sofa::core::behavior::MixedInteractionForceField<TDataTypes, TDataTypes>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(TissueContactForceField, TDataTypes),
               SOFA_TEMPLATE2(sofa::core::behavior::MixedInteractionForceField, TDataTypes, TDataTypes));
    using DataTypes = TDataTypes;
    using Inherit = sofa::core::behavior::MixedInteractionForceField<TDataTypes, TDataTypes>;
    using DataVecCoord = sofa::core::objectmodel::Data<typename DataTypes::VecCoord>;
    using DataVecDeriv = sofa::core::objectmodel::Data<typename DataTypes::VecDeriv>;
    using MechanicalParams = sofa::core::MechanicalParams;

    Data<SReal> d_contactStiffness;     ///< [Pa/m] from the bodies, where not set
    Data<SReal> d_tangentialStiffness;  ///< [Pa/m] contactStiffness, where not set
    Data<SReal> d_friction;             ///< coefficient
    Data<SReal> d_contactDistance;      ///< [m] between the surfaces
    Data<SReal> d_damping;              ///< [Pa s/m]
    Data<int> d_maxSubdivision;         ///< parts of the edge of a face, at most
    Data<bool> d_active;                ///< otherwise the bodies pass through each other
    Data<sofa::type::Vec3> d_force;     ///< output [N]: on the body of object1
    Data<SReal> d_depth;                ///< output [m]: of the deepest point
    Data<int> d_touching;               ///< output: number of points that touch
    Data<int> d_slipping;               ///< output: how many of these slip
    Data<SReal> d_drawForceScale;       ///< [m/N] of forces that are drawn

    void init() override;
    void bwdInit() override;
    void reinit() override;
    void reset() override;
    void handleEvent(sofa::core::objectmodel::Event* event) override;
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
    bool works() const { return m_tissues && !is_invalid(*this); }

    /// For MultigridCGLinearSolver, as those of PartForceField; fields of the two states.
    bool isInMatrix() const { return works() && !m_tissues->contact().terms().empty(); }
    bool isOneSided() const { return !m_isAccepted && isInMatrix(); }
    bool release(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v)
    {
        return m_tissues->contact().release(x, v);
    }
    void acceptStep() { m_isAccepted = true; }
    void addOwnForce(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) const
    {
        m_tissues->add_force(x, v, f);
    }
    void addOwnProduct(double b, double k, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const;
    void leaveOutOfProducts(bool leftOut) { m_leftOut = leftOut; }

protected:
    TissueContactForceField();

private:
    using BodyField = HexahedronElastoplasticFEMForceField<TDataTypes>;

    /// Lets `call` make or change the contact by the Data.
    template <class Call>
    void acceptData(const Call& call);

    parts::TissueContactOptions options() const;
    void makeContact();
    void updateContact();  ///< by Data that have changed
    bool bodiesAreOthers() const;
    void beginStep(SReal dt);
    void endStep();
    void showOutputs();

    OfTwo<ConstPoints> positions() const;
    OfTwo<ConstPoints> velocities() const;
    bool isWithItself() const { return this->mstate1.get() == this->mstate2.get(); }

    template <class OfPair>
    void addBlocks(const BlockMatrix& blocks, const OfPair& ofPair) const;
    BlockMatrix blocksOf(bool damping) const;

    std::optional<parts::Tissues> m_tissues;
    std::optional<Inputs> m_inputs;
    std::array<BodyField*, 2> m_bodyFields = {};
    std::array<int, 2> m_bodiesMade = {};  // which of the bodies that these fields have made
    bool m_dataAreAccepted = false;
    SReal m_ownRayleighStiffness = 0;  // that takes back the integrator's
    bool m_isAccepted = true;          // nothing pulls at the end of the present step
    bool m_isWarned = false;           // of a linear solver that does not accept its steps
    bool m_leftOut = false;
};

#if !defined(HEXAPLAST_TISSUECONTACTFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API TissueContactForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
