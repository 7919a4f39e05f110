// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/InstrumentContactForceField.h>
#include <Hexaplast/contact.h>
#include <Hexaplast/contact_drawing.h>

#include <Hexaplast/PartForceField.inl>

#include "attributes/contact.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

constexpr const Description& kContact = attributes::kInstrumentContactForceField;

}  // namespace

template <class TDataTypes>
InstrumentContactForceField<TDataTypes>::InstrumentContactForceField()
    : Inherit(kContact),
      d_shape(from_table(*this, d_shape, row(kContact, "shape"), "Instrument")),
      d_radius(from_table(*this, d_radius, row(kContact, "radius"), "Instrument")),
      d_length(from_table(*this, d_length, row(kContact, "length"), "Instrument")),
      d_size(from_table(*this, d_size, row(kContact, "size"), "Instrument")),
      d_surfacePositions(from_table(*this, d_surfacePositions, row(kContact, "surfacePositions"), "Instrument")),
      d_surfaceTriangles(from_table(*this, d_surfaceTriangles, row(kContact, "surfaceTriangles"), "Instrument")),
      d_embeddedPositions(from_table(*this, d_embeddedPositions, row(kContact, "embeddedPositions"), "Contact")),
      d_embeddedTriangles(from_table(*this, d_embeddedTriangles, row(kContact, "embeddedTriangles"), "Contact")),
      d_keyTimes(from_table(*this, d_keyTimes, row(kContact, "keyTimes"), "Path")),
      d_positions(from_table(*this, d_positions, row(kContact, "positions"), "Path")),
      d_orientations(from_table(*this, d_orientations, row(kContact, "orientations"), "Path")),
      d_contactStiffness(from_table(*this, d_contactStiffness, row(kContact, "contactStiffness"), "Contact")),
      d_tangentialStiffness(from_table(*this, d_tangentialStiffness, row(kContact, "tangentialStiffness"), "Contact")),
      d_friction(from_table(*this, d_friction, row(kContact, "friction"), "Contact")),
      d_contactDistance(from_table(*this, d_contactDistance, row(kContact, "contactDistance"), "Contact")),
      d_damping(from_table(*this, d_damping, row(kContact, "damping"), "Contact")),
      d_maxSubdivision(from_table(*this, d_maxSubdivision, row(kContact, "maxSubdivision"), "Contact")),
      d_active(from_table(*this, d_active, row(kContact, "active"), "Contact")),
      l_rigid(this->initLink("rigid", row(kContact, "rigid").help.data())),
      d_rigidIndex(from_table(*this, d_rigidIndex, row(kContact, "rigidIndex"), "Path")),
      d_force(from_table(*this, d_force, row(kContact, "force"))),
      d_torque(from_table(*this, d_torque, row(kContact, "torque"))),
      d_depth(from_table(*this, d_depth, row(kContact, "depth"))),
      d_touching(from_table(*this, d_touching, row(kContact, "touching"))),
      d_slipping(from_table(*this, d_slipping, row(kContact, "slipping"))),
      d_drawInstrument(this->initData(&d_drawInstrument, true, "drawInstrument",
                                      "Draws its shape, where visual models or force fields are shown.")),
      d_drawForceScale(this->initData(&d_drawForceScale, SReal(0), "drawForceScale",
                                      "Length of a force that is drawn [m/N]. 0: the greatest one has a tenth of the "
                                      "size of the body."))
{
    this->addAlias(&d_embeddedPositions, "skinPositions");  // the older names
    this->addAlias(&d_embeddedTriangles, "skinTriangles");
}

// Bodies and integrators may stand behind it: it is made when all of them have had their init.
template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::init()
{
    m_instrument.reset();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::bwdInit()
{
    Inherit::init();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::reinit()
{
    if (hasPart())
        Inherit::reinit();
    else
        Inherit::init();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::checkRayleighStiffness() const
{
    require_own_rayleigh_stiffness(this->rayleighStiffness.getValue(), m_ownRayleighStiffness);
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
    m_instrument.reset();
    m_bodyField = nullptr;
    BodyField& field = body_field_of(*this->mstate);
    implicit_euler_of(*this->getContext());
    m_bodyField = &field;
    checkRigid();
    m_bodyMade = m_bodyField->timesMade();
    m_instrument.emplace(options(), *m_bodyField->body());
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
    const std::string given = d_shape.given();
    const auto* shape = std::find(parts::kInstrumentShapes.begin(), parts::kInstrumentShapes.end(), given);
    if (shape == parts::kInstrumentShapes.end()) parts::check_word("shape", parts::kInstrumentShapes, given);
    parts::InstrumentOptions options{.shape = *shape,
                                     .radius = if_set(d_radius),
                                     .length = if_set(d_length),
                                     .surface_positions = view(d_surfacePositions.getValue()),
                                     .surface_triangles = triangles(d_surfaceTriangles.getValue()),
                                     .embedded_positions = view(d_embeddedPositions.getValue()),
                                     .embedded_triangles = triangles(d_embeddedTriangles.getValue()),
                                     .is_prescribed = l_rigid.get() != nullptr,
                                     .key_times = reals(d_keyTimes.getValue()),
                                     .positions = view(d_positions.getValue()),
                                     .orientations = reals(d_orientations.getValue()),
                                     .contact_stiffness = if_set(d_contactStiffness),
                                     .tangential_stiffness = if_set(d_tangentialStiffness),
                                     .friction = d_friction.getValue(),
                                     .contact_distance = d_contactDistance.getValue(),
                                     .damping = d_damping.getValue(),
                                     .max_subdivision = d_maxSubdivision.getValue(),
                                     .is_active = d_active.getValue()};
    if (d_size.isSet()) options.size = vec3(d_size.getValue());
    return options;
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::resetPart()
{
    m_instrument->reset();
    m_isAccepted = true;
    showOutputs();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::beginStep(SReal time, SReal dt)
{
    const SReal ofIntegrator = rayleigh_stiffness_of(implicit_euler_of(*this->getContext()));
    const auto x = view(this->mstate->readPositions().ref()), v = view(this->mstate->readVelocities().ref());
    if (l_rigid)
        m_instrument->begin_step(poseAfter(0), poseAfter(dt), dt, ofIntegrator, x, v);
    else
        m_instrument->begin_step(time, dt, ofIntegrator, x, v);
    m_ownRayleighStiffness = m_instrument->rayleigh_stiffness();
    this->rayleighStiffness.setValue(m_ownRayleighStiffness);
    m_isAccepted = false;
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::endStep(SReal)
{
    if (isOneSided() && !m_isWarned)
    {
        m_isWarned = true;
        msg_warning(this) << "its linear solver is not a MultigridCGLinearSolver: contacts that pull at the end of a "
                             "step are released after it only";
    }
    m_instrument->end_step(view(this->mstate->readPositions().ref()), view(this->mstate->readVelocities().ref()));
    showOutputs();
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::showOutputs()
{
    const InstrumentContact& contact = m_instrument->contact();
    d_force.setValue(vec3(contact.force()));
    d_torque.setValue(vec3(contact.torque()));
    d_depth.setValue(contact.depth());
    d_touching.setValue(contact.num_touching());
    d_slipping.setValue(contact.num_slipping());
}

template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::addPartForce(SReal, ConstPoints x, ConstPoints v, Points f)
{
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

// SOFA gives a cylinder no ends, and the caps of its capsules are those of its spheres: sides and discs here.
template <class TDataTypes>
void InstrumentContactForceField<TDataTypes>::drawShape(sofa::helper::visual::DrawTool& tool) const
{
    constexpr int kSides = 24;
    const sofa::type::RGBAColor colour(0.75F, 0.78F, 0.82F, 1.F);
    const Pose at = pose();
    const auto place = [&](const Vec3& own) { return vec3(at.to_world(own)); };
    const std::string shape = d_shape.given();
    const float radius = static_cast<float>(d_radius.getValue());
    const double half = d_length.getValue() / 2;
    const sofa::type::Vec3 ends[] = {place({0, 0, -half}), place({0, 0, half})};
    std::vector<sofa::type::Vec3> corners;
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c)
    {
        for (const Vec3& corner : {a, b, c}) corners.push_back(place(corner));
    };
    if (shape == "sphere") tool.drawSphere(place(Vec3::Zero()), radius, colour);
    if (shape == "capsule") tool.drawCapsule(ends[0], ends[1], radius, colour, kSides);
    if (shape == "cylinder")
    {
        tool.drawCylinder(ends[0], ends[1], radius, colour, kSides);
        const auto rim = [&](int i, double z)
        {
            const double angle = 2 * M_PI * i / kSides;
            return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
        };
        for (int i = 0; i < kSides; ++i)
        {
            add({0, 0, half}, rim(i, half), rim(i + 1, half));
            add({0, 0, -half}, rim(i + 1, -half), rim(i, -half));
        }
    }
    if (shape == "box")
    {
        const Vec3 extent = vec3(d_size.getValue()) / 2;
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0})
            {
                const auto corner = [&](double u, double v)
                {
                    Vec3 own;
                    own[axis] = side * extent[axis];
                    own[(axis + 1) % 3] = u * extent[(axis + 1) % 3];
                    own[(axis + 2) % 3] = side * v * extent[(axis + 2) % 3];
                    return own;
                };
                add(corner(-1, -1), corner(1, -1), corner(1, 1));
                add(corner(-1, -1), corner(1, 1), corner(-1, 1));
            }
    }
    if (shape == "surface")
        for (const auto& triangle : d_surfaceTriangles.getValue())
            add(vec3(d_surfacePositions.getValue()[triangle[0]]), vec3(d_surfacePositions.getValue()[triangle[1]]),
                vec3(d_surfacePositions.getValue()[triangle[2]]));
    if (!corners.empty()) tool.drawTriangles(corners, colour);
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
                      view(this->mstate->readVelocities().ref()), d_drawForceScale.getValue());
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
