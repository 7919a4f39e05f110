// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/InstrumentContactForceField.h>

namespace hexaplast::sofa_plugin
{

parts::InstrumentOptions InstrumentContactForceField::options() const
{
    m_frame.check();
    parts::InstrumentOptions options = Inherit::options();
    options.is_prescribed = m_frame.isGiven();
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
    m_frame.check();
    if (m_frame.isGiven()) m_part->prescribe(m_frame.after(0), m_frame.after(dt));
}

Pose InstrumentContactForceField::pose() const
{
    return m_frame.isGiven() ? m_frame.after(0) : m_part->pose_at(getContext()->getTime());
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
    if (showsShape) drawShape(*tool, parts::shape_of(m_part->options()), pose());
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
