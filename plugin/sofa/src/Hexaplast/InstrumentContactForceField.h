// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/PartForceField.h>
#include <sofa/core/visual/VisualParams.h>

#include "parts/instrument.hpp"

namespace hexaplast::sofa_plugin
{

/// A rigid instrument that moves along a path and touches the body of its state. Contacts are found at
/// AnimateBeginEvent, anchors follow at AnimateEndEvent.
template <class TDataTypes>
class InstrumentContactForceField : public PartForceField<TDataTypes>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(InstrumentContactForceField, TDataTypes), SOFA_TEMPLATE(PartForceField, TDataTypes));
    using Inherit = PartForceField<TDataTypes>;
    using VecReal = sofa::type::vector<SReal>;
    using VecVec3 = sofa::type::vector<sofa::type::Vec3>;

    DataWord d_shape;                  ///< sphere, capsule, cylinder, box or surface
    Data<SReal> d_radius;              ///< [m] of sphere, capsule, cylinder
    Data<SReal> d_length;              ///< [m] of capsule, cylinder
    Data<sofa::type::Vec3> d_size;     ///< [m] edges of the box
    Data<VecVec3> d_surfacePositions;  ///< [m] of surface
    Data<MeshTopology::SeqTriangles> d_surfaceTriangles;
    Data<VecVec3> d_embeddedPositions;                     ///< [m] of the embedded surface that is touched
    Data<MeshTopology::SeqTriangles> d_embeddedTriangles;  ///< the faces of the hexahedra are touched, where not set
    Data<VecReal> d_keyTimes;                              ///< [s] of the path
    Data<VecVec3> d_positions;                             ///< [m] at each key time
    Data<VecReal> d_orientations;                          ///< quaternions x y z w at each key time
    Data<SReal> d_contactStiffness;                        ///< [Pa/m] from the body, where not set
    Data<SReal> d_tangentialStiffness;                     ///< [Pa/m] contactStiffness, where not set
    Data<SReal> d_friction;                                ///< coefficient
    Data<SReal> d_contactDistance;                         ///< [m] from the shape
    Data<SReal> d_damping;                                 ///< [Pa s/m]
    Data<int> d_maxSubdivision;                            ///< parts of the edge of a face, at most
    Data<bool> d_active;                                   ///< otherwise it passes through the body
    sofa::core::objectmodel::SingleLink<InstrumentContactForceField, sofa::core::behavior::BaseMechanicalState,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_rigid;                      ///< frames, one of which prescribes its motion in place of the path
    Data<int> d_rigidIndex;           ///< which of them
    Data<sofa::type::Vec3> d_force;   ///< output [N]: of the body on the instrument
    Data<sofa::type::Vec3> d_torque;  ///< output [N m]: about the origin of its frame
    Data<SReal> d_depth;              ///< output [m]: of the deepest point
    Data<int> d_touching;             ///< output: number of points that touch
    Data<int> d_slipping;             ///< output: how many of these slip
    Data<bool> d_drawInstrument;      ///< draws its shape
    Data<SReal> d_drawForceScale;     ///< [m/N] of forces that are drawn

    void init() override;
    void bwdInit() override;
    void reinit() override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;
    void computeBBox(const sofa::core::ExecParams* params, bool onlyVisible = false) override;

    bool hasPart() const override { return m_instrument.has_value(); }
    bool isInMatrix() const override { return !m_instrument->contact().terms().empty(); }
    bool isOneSided() const override { return !m_isAccepted && isInMatrix(); }
    bool release(ConstPoints x, ConstPoints v) override { return m_instrument->contact().release(x, v); }
    void acceptStep() override { m_isAccepted = true; }

    const parts::Instrument* instrument() const { return hasPart() ? &*m_instrument : nullptr; }

protected:
    InstrumentContactForceField();

    void checkRayleighStiffness() const override;
    void makePart() override;
    void updatePart() override;
    bool othersHaveChanged() override;
    void resetPart() override;
    void beginStep(SReal time, SReal dt) override;
    void endStep(SReal dt) override;

    void addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f) override;
    void addStiffnessProduct(double factor, ConstPoints dx, Points df) const override;
    void addStiffnessBlocks(double factor, BlockMatrix& A) const override;
    void addDampingProduct(double factor, ConstPoints dx, Points df) const override;
    void addDampingBlocks(double factor, BlockMatrix& A) const override;

private:
    using BodyField = HexahedronElastoplasticFEMForceField<TDataTypes>;

    parts::InstrumentOptions options() const;
    void checkRigid() const;
    Pose poseAfter(
        SReal duration) const;  ///< of the frame that prescribes the motion, if it keeps its velocity so long
    Pose pose() const;          ///< of the present time
    void drawShape(sofa::helper::visual::DrawTool& tool) const;
    void showOutputs();

    std::optional<parts::Instrument> m_instrument;
    BodyField* m_bodyField = nullptr;  // whose body it touches
    int m_bodyMade = 0;                // which of the bodies that this field has made
    SReal m_ownRayleighStiffness = 0;  // that takes back the integrator's
    bool m_isAccepted = true;          // nothing pulls at the end of the present step
    bool m_isWarned = false;           // of a linear solver that does not accept its steps
};

#if !defined(HEXAPLAST_INSTRUMENTCONTACTFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API InstrumentContactForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
