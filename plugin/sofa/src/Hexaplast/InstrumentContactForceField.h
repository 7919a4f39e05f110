// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/ContactOf.h>
#include <Hexaplast/RigidFrame.h>

#include "attributes/contact.hpp"
#include "parts/instrument.hpp"

namespace hexaplast::sofa_plugin
{

/// A rigid instrument that touches the body of its state, along its path or with a rigid frame of the scene, and is
/// drawn.
class HEXAPLAST_SOFA_API InstrumentContactForceField : public ContactOf<parts::Instrument>
{
public:
    using Inherit = ContactOf<parts::Instrument>;
    SOFA_CLASS(InstrumentContactForceField, Inherit);

    Data<bool> d_drawInstrument{initData(&d_drawInstrument, true, "drawInstrument",
                                         "Draws its shape, where visual models or force fields are shown.")};

    void draw(const sofa::core::visual::VisualParams* vparams) override;
    void computeBBox(const sofa::core::ExecParams* params, bool onlyVisible = false) override;

protected:
    InstrumentContactForceField() : Inherit(attributes::kInstrumentContactInSofa) {}

    parts::InstrumentOptions options() const override;
    void makePart() override;
    void prescribe(SReal dt) override;

private:
    Pose pose() const;  ///< of the present time

    RigidFrame<InstrumentContactForceField> m_frame{*this, helpOf("rigid"), data<int>("rigidIndex")};
};

}  // namespace hexaplast::sofa_plugin
