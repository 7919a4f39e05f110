// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/TangentialForceField.h>

#include <Hexaplast/PartForceField.inl>

namespace hexaplast::sofa_plugin
{

template <class TDataTypes>
void TangentialForceField<TDataTypes>::makePart()
{
    m_load = parts::TangentialLoad(this->template readOptions<parts::TangentialLoadOptions>(), this->numNodes());
}

template <class TDataTypes>
void TangentialForceField<TDataTypes>::addPartForce(SReal time, ConstPoints x, ConstPoints, Points f)
{
    m_load->add_force(time, x, f);
}

}  // namespace hexaplast::sofa_plugin
