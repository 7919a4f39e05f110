// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/InstrumentContactForceField.h>
#include <sofa/core/visual/VisualParams.h>

#include <Hexaplast/PartForceField.inl>

#include "parts/instrument_shape.hpp"

namespace hexaplast::sofa_plugin
{

void InstrumentContactForceField::checkRigid() const
{
    checkLink(l_rigid, "rigid");
    if (!l_rigid) return;
    if (l_rigid->getCoordDimension() != 7 || l_rigid->getDerivDimension() != 6)
        throw parts::OptionError("rigid", "leads to '" + l_rigid->getName() +
                                              "', must lead to a MechanicalObject of rigid frames (template Rigid3d)");
    const int index = d_rigidIndex.getValue(), count = static_cast<int>(l_rigid->getSize());
    if (index < 0 || index >= count)
        throw parts::OptionError("rigid_index",
                                 std::to_string(index) + " must lie in [0, " + std::to_string(count) + ")");
}

Pose InstrumentContactForceField::poseAfter(SReal duration) const
{
    const std::size_t index = static_cast<std::size_t>(d_rigidIndex.getValue()), count = l_rigid->getSize();
    std::vector<SReal> x(7 * count), v(6 * count);
    l_rigid->copyToBuffer(x.data(), sofa::core::vec_id::read_access::position, static_cast<unsigned int>(x.size()));
    l_rigid->copyToBuffer(v.data(), sofa::core::vec_id::read_access::velocity, static_cast<unsigned int>(v.size()));
    const SReal *at = &x[7 * index], *speed = &v[6 * index];
    const Pose now{Vec3(at[0], at[1], at[2]), Eigen::Quaterniond(at[6], at[3], at[4], at[5]).normalized()};
    return parts::moved(now, Vec3(speed[0], speed[1], speed[2]), Vec3(speed[3], speed[4], speed[5]), duration);
}

parts::InstrumentOptions InstrumentContactForceField::options() const
{
    checkRigid();
    parts::InstrumentOptions options = Inherit::options();
    options.is_prescribed = l_rigid.get() != nullptr;
    return options;
}

void InstrumentContactForceField::makePart()
{
    const bool goesOn = hasPart();
    Inherit::makePart();
    if (goesOn) m_part->go_on();
}

void InstrumentContactForceField::prescribe(SReal dt)
{
    checkRigid();
    if (l_rigid) m_part->prescribe(poseAfter(0), poseAfter(dt));
}

Pose InstrumentContactForceField::pose() const
{
    return l_rigid ? poseAfter(0) : m_part->pose_at(getContext()->getTime());
}

void InstrumentContactForceField::draw(const sofa::core::visual::VisualParams* vparams)
{
    const auto& flags = vparams->displayFlags();
    const bool showsShape = d_drawInstrument.getValue() && (flags.getShowForceFields() || flags.getShowVisualModels());
    if (!works() || (!showsShape && !flags.getShowForceFields())) return;
    auto* tool = vparams->drawTool();
    const auto lifeCycle = tool->makeStateLifeCycle();
    if (flags.getShowWireFrame()) tool->setPolygonMode(0, true);
    tool->enableLighting();
    if (showsShape)
    {
        const parts::InstrumentShape shape = parts::shape_of(m_part->options());
        const PointArray points = shape.at(pose());
        std::vector<sofa::type::Vec3> corners;
        for (const Triangle& triangle : shape.triangles)
            for (const int corner : triangle) corners.push_back(vec3(Vec3(points.row(corner))));
        tool->drawTriangles(corners, sofa::type::RGBAColor(0.75F, 0.78F, 0.82F, 1.F));
    }
    if (flags.getShowForceFields()) drawContacts(*tool);
}

void InstrumentContactForceField::computeBBox(const sofa::core::ExecParams* params, bool onlyVisible)
{
    Inherit::computeBBox(params, onlyVisible);
    if (!works() || onlyVisible || !d_drawInstrument.getValue()) return;
    const Vec3 reach = Vec3::Constant(m_part->contact().solid().reach()), centre = pose().position;
    sofa::type::BoundingBox box = f_bbox.getValue();
    box.include(vec3(Vec3(centre - reach)));
    box.include(vec3(Vec3(centre + reach)));
    f_bbox.setValue(box);
}

}  // namespace hexaplast::sofa_plugin
