// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/TangentialForceField.h>

#include <Hexaplast/PartForceField.inl>

#include "attributes/parts.hpp"

namespace hexaplast::sofa_plugin
{

template <class TDataTypes>
TangentialForceField<TDataTypes>::TangentialForceField()
    : Inherit(attributes::kTangentialForceField),
      d_indices(from_table(*this, d_indices, row(attributes::kTangentialForceField, "indices"))),
      d_groupSize(from_table(*this, d_groupSize, row(attributes::kTangentialForceField, "groupSize"))),
      d_axis(from_table(*this, d_axis, row(attributes::kTangentialForceField, "axis"))),
      d_centre(from_table(*this, d_centre, row(attributes::kTangentialForceField, "centre"))),
      d_times(from_table(*this, d_times, row(attributes::kTangentialForceField, "times"))),
      d_forces(from_table(*this, d_forces, row(attributes::kTangentialForceField, "forces")))
{
}

template <class TDataTypes>
void TangentialForceField<TDataTypes>::makePart()
{
    m_load = parts::TangentialLoad({.indices = whole_numbers(d_indices.getValue()),
                                    .group_size = d_groupSize.getValue(),
                                    .axis = vec3(d_axis.getValue()),
                                    .centre = vec3(d_centre.getValue()),
                                    .times = reals(d_times.getValue()),
                                    .forces = reals(d_forces.getValue())},
                                   this->numNodes());
}

template <class TDataTypes>
void TangentialForceField<TDataTypes>::addPartForce(SReal time, ConstPoints x, ConstPoints, Points f)
{
    m_load->add_force(time, x, f);
}

}  // namespace hexaplast::sofa_plugin
