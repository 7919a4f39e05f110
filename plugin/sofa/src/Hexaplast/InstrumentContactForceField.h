// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/contact.h>
#include <sofa/core/visual/VisualParams.h>

#include "attributes/contact.hpp"
#include "parts/instrument_shape.hpp"

namespace hexaplast::sofa_plugin
{

/// A rigid instrument that moves along a path and touches the body of its state. Contacts are found at
/// AnimateBeginEvent, anchors follow at AnimateEndEvent.
template <class TDataTypes>
class InstrumentContactForceField : public ContactComponent<PartForceField<TDataTypes>>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(InstrumentContactForceField, TDataTypes),
               SOFA_TEMPLATE(ContactComponent, PartForceField<TDataTypes>));
    using Inherit = ContactComponent<PartForceField<TDataTypes>>;
    using VecReal = sofa::type::vector<SReal>;
    using VecVec3 = sofa::type::vector<sofa::type::Vec3>;

    DataWord d_shape{this->fromTable(d_shape, "shape", "Instrument")};
    Data<SReal> d_radius{this->fromTable(d_radius, "radius", "Instrument")};
    Data<SReal> d_length{this->fromTable(d_length, "length", "Instrument")};
    Data<sofa::type::Vec3> d_size{this->fromTable(d_size, "size", "Instrument")};
    Data<VecVec3> d_surfacePositions{this->fromTable(d_surfacePositions, "surfacePositions", "Instrument")};
    Data<MeshTopology::SeqTriangles> d_surfaceTriangles{
        this->fromTable(d_surfaceTriangles, "surfaceTriangles", "Instrument")};
    Data<VecVec3> d_embeddedPositions{this->fromTable(d_embeddedPositions, "embeddedPositions", "Contact")};
    Data<MeshTopology::SeqTriangles> d_embeddedTriangles{
        this->fromTable(d_embeddedTriangles, "embeddedTriangles", "Contact")};
    Data<VecReal> d_keyTimes{this->fromTable(d_keyTimes, "keyTimes", "Path")};
    Data<VecVec3> d_positions{this->fromTable(d_positions, "positions", "Path")};
    Data<VecReal> d_orientations{this->fromTable(d_orientations, "orientations", "Path")};
    sofa::core::objectmodel::SingleLink<InstrumentContactForceField, sofa::core::behavior::BaseMechanicalState,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_rigid{this->initLink(
            "rigid", this->helpOf("rigid"))};  ///< frames, one of which prescribes its motion in place of the path
    Data<int> d_rigidIndex{this->fromTable(d_rigidIndex, "rigidIndex", "Path")};
    Data<sofa::type::Vec3> d_torque{this->fromTable(d_torque, "torque")};
    Data<bool> d_drawInstrument{this->initData(&d_drawInstrument, true, "drawInstrument",
                                               "Draws its shape, where visual models or force fields are shown.")};

    void init() override;
    void bwdInit() override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;
    void computeBBox(const sofa::core::ExecParams* params, bool onlyVisible = false) override;

    bool hasPart() const override { return m_instrument.has_value(); }
    bool isInMatrix() const override { return !m_instrument->contact().terms().empty(); }
    bool release(ConstPoints x, ConstPoints v) override { return m_instrument->contact().release(x, v); }

    const parts::Instrument* instrument() const { return hasPart() ? &*m_instrument : nullptr; }

protected:
    InstrumentContactForceField() : Inherit(attributes::kInstrumentContactInSofa) {}

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
};

#if !defined(HEXAPLAST_INSTRUMENTCONTACTFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API InstrumentContactForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
