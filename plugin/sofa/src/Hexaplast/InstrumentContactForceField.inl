// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/InstrumentContactForceField.h>
#include <Hexaplast/contact_drawing.h>

#include <Hexaplast/PartForceField.inl>

namespace hexaplast::sofa_plugin
{
// Bodies and integrators may stand behind it: it is made when all of them have had their init.
template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::init()
{
    m_instrument.reset();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::bwdInit()
{
    this->initPart();
    if (!this->works()) return;
    attempt(*this, [&] { m_instrument->look_at_start(pose(), view(this->mstate->readPositions().ref())); });
    pass_on(*this, m_instrument->take_warnings());
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::checkRigid() const
{
    if (!l_rigid) return;
    if (l_rigid->getCoordDimension() != 7 || l_rigid->getDerivDimension() != 6)
        throw parts::OptionError("rigid", fmt::format("leads to '{}', must lead to a MechanicalObject of rigid frames "
                                                      "(template Rigid3d)",
                                                      l_rigid->getName()));
    const int index = d_rigidIndex.getValue(), count = static_cast<int>(l_rigid->getSize());
    if (index < 0 || index >= count)
        throw parts::OptionError("rigid_index", fmt::format("{} must lie in [0, {})", index, count));
}

template <class TDataTypes>
Pose InstrumentContactForceField<TDataTypes>::poseAfter(SReal duration) const
{
    const std::size_t index = static_cast<std::size_t>(d_rigidIndex.getValue()), count = l_rigid->getSize();
    std::vector<SReal> x(7 * count), v(6 * count);
    l_rigid->copyToBuffer(x.data(), sofa::core::vec_id::read_access::position, static_cast<unsigned int>(x.size()));
    l_rigid->copyToBuffer(v.data(), sofa::core::vec_id::read_access::velocity, static_cast<unsigned int>(v.size()));
    const SReal *at = &x[7 * index], *speed = &v[6 * index];
    const Pose now{Vec3(at[0], at[1], at[2]), Eigen::Quaterniond(at[6], at[3], at[4], at[5]).normalized()};
    return parts::moved(now, Vec3(speed[0], speed[1], speed[2]), Vec3(speed[3], speed[4], speed[5]), duration);
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::makePart()
{
    const bool goesOn = m_instrument.has_value();
    m_instrument.reset();
    m_bodyField = nullptr;
    BodyField& field = body_field_of(*this->mstate);
    implicit_euler_of(*this->getContext());
    m_bodyField = &field;
    checkRigid();
    m_bodyMade = m_bodyField->timesMade();
    m_instrument.emplace(options(), *m_bodyField->body());
    if (goesOn) m_instrument->go_on();
    pass_on(*this, m_instrument->take_warnings());
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::updatePart()
{
    if (m_bodyMade != m_bodyField->timesMade()) return makePart();
    m_instrument->set_options(options());
    pass_on(*this, m_instrument->take_warnings());
}

template <class TDataTypes>
bool InstrumentContactForceField<TDataTypes>::othersHaveChanged()
{
    return m_bodyMade != m_bodyField->timesMade();
}

template <class TDataTypes>
parts::InstrumentOptions InstrumentContactForceField<TDataTypes>::options() const
{
    auto options = this->template readOptions<parts::InstrumentOptions>();
    options.is_prescribed = l_rigid.get() != nullptr;
    return options;
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::resetPart()
{
    m_instrument->reset();
    this->acceptStep();
    showOutputs();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::beginStep(SReal time, SReal dt)
{
    const SReal ofIntegrator = this->rayleighStiffnessOfIntegrator();
    const auto x = view(this->mstate->readPositions().ref()), v = view(this->mstate->readVelocities().ref());
    if (l_rigid)
        m_instrument->begin_step(poseAfter(0), poseAfter(dt), dt, ofIntegrator, x, v);
    else
        m_instrument->begin_step(time, dt, ofIntegrator, x, v);
    pass_on(*this, m_instrument->take_warnings());
    this->openStep(dt, m_instrument->rayleigh_stiffness());
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::endStep(SReal)
{
    this->closeStep();
    m_instrument->end_step(view(this->mstate->readPositions().ref()));
    pass_on(*this, m_instrument->take_warnings());
    showOutputs();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::showOutputs()
{
    this->showContact(m_instrument->contact());
    d_torque.setValue(vec3(m_instrument->contact().torque()));
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::addPartForce(SReal, ConstPoints x, ConstPoints v, Points f)
{
    this->followBodies(*m_instrument);
    m_instrument->add_force(x, v, f);
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::addStiffnessProduct(double factor, ConstPoints dx, Points df) const
{
    m_instrument->contact().terms().add_stiffness_product(factor, dx, df);
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::addStiffnessBlocks(double factor, BlockMatrix& A) const
{
    m_instrument->contact().terms().add_stiffness_blocks(factor, A);
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::addDampingProduct(double factor, ConstPoints dx, Points df) const
{
    m_instrument->contact().terms().add_damping_product(factor, dx, df);
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::addDampingBlocks(double factor, BlockMatrix& A) const
{
    m_instrument->contact().terms().add_damping_blocks(factor, A);
}

template <class TDataTypes>
Pose InstrumentContactForceField<TDataTypes>::pose() const
{
    return l_rigid ? poseAfter(0) : m_instrument->pose_at(this->getContext()->getTime());
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::drawShape(sofa::helper::visual::DrawTool& tool) const
{
    const parts::InstrumentShape shape = parts::shape_of(m_instrument->options());
    const PointArray points = shape.at(pose());
    std::vector<sofa::type::Vec3> corners;
    for (const Triangle& triangle : shape.triangles)
        for (const int corner : triangle) corners.push_back(vec3(Vec3(points.row(corner))));
    tool.drawTriangles(corners, sofa::type::RGBAColor(0.75F, 0.78F, 0.82F, 1.F));
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::draw(const sofa::core::visual::VisualParams* vparams)
{
    const auto& flags = vparams->displayFlags();
    const bool showsShape = d_drawInstrument.getValue() && (flags.getShowForceFields() || flags.getShowVisualModels());
    if (!this->works() || (!showsShape && !flags.getShowForceFields())) return;
    auto* tool = vparams->drawTool();
    const auto lifeCycle = tool->makeStateLifeCycle();
    if (flags.getShowWireFrame()) tool->setPolygonMode(0, true);
    tool->enableLighting();
    if (showsShape) drawShape(*tool);
    if (flags.getShowForceFields())
        draw_contacts(*tool, m_instrument->contact().terms(), view(this->mstate->readPositions().ref()),
                      view(this->mstate->readVelocities().ref()), this->d_drawForceScale.getValue());
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::computeBBox(const sofa::core::ExecParams* params, bool onlyVisible)
{
    Inherit::computeBBox(params, onlyVisible);
    if (!this->works() || onlyVisible || !d_drawInstrument.getValue()) return;
    const Vec3 reach = Vec3::Constant(m_instrument->contact().solid().reach()), centre = pose().position;
    sofa::type::BoundingBox box = this->f_bbox.getValue();
    box.include(vec3(Vec3(centre - reach)));
    box.include(vec3(Vec3(centre + reach)));
    this->f_bbox.setValue(box);
}

}  // namespace hexaplast::sofa_plugin
