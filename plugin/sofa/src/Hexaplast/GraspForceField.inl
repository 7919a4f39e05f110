// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/GraspForceField.h>

#include <Hexaplast/PartForceField.inl>

#include "attributes/parts.hpp"

namespace hexaplast::sofa_plugin
{

template <class TDataTypes>
GraspForceField<TDataTypes>::GraspForceField()
    : Inherit(attributes::kGraspForceField),
      d_keyTimes(from_table(*this, d_keyTimes, row(attributes::kGraspForceField, "keyTimes"), "Path")),
      d_positions(from_table(*this, d_positions, row(attributes::kGraspForceField, "positions"), "Path")),
      d_graspTime(from_table(*this, d_graspTime, row(attributes::kGraspForceField, "graspTime"), "Path")),
      d_releaseTime(from_table(*this, d_releaseTime, row(attributes::kGraspForceField, "releaseTime"), "Path")),
      d_radius(from_table(*this, d_radius, row(attributes::kGraspForceField, "radius"), "Grip")),
      d_indices(from_table(*this, d_indices, row(attributes::kGraspForceField, "indices"), "Grip")),
      d_stiffness(from_table(*this, d_stiffness, row(attributes::kGraspForceField, "stiffness"), "Grip")),
      d_maxForce(from_table(*this, d_maxForce, row(attributes::kGraspForceField, "maxForce"), "Grip")),
      d_damping(from_table(*this, d_damping, row(attributes::kGraspForceField, "damping"), "Grip")),
      d_grasped(from_table(*this, d_grasped, row(attributes::kGraspForceField, "grasped"))),
      d_force(from_table(*this, d_force, row(attributes::kGraspForceField, "force"))),
      d_torque(from_table(*this, d_torque, row(attributes::kGraspForceField, "torque")))
{
}

template <class TDataTypes>
parts::GraspOptions GraspForceField<TDataTypes>::options() const
{
    parts::GraspOptions options{.key_times = reals(d_keyTimes.getValue()),
                                .positions = view(d_positions.getValue()),
                                .grasp_time = d_graspTime.getValue(),
                                .release_time = if_set(d_releaseTime),
                                .radius = if_set(d_radius),
                                .stiffness = d_stiffness.getValue(),
                                .max_force = if_set(d_maxForce),
                                .damping = d_damping.getValue()};
    if (d_indices.isSet()) options.indices = whole_numbers(d_indices.getValue());
    return options;
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::makePart()
{
    m_grasp.reset();
    m_grasp.emplace(options(), this->numNodes());
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::updatePart()
{
    m_grasp->set_options(options());
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::resetPart()
{
    m_grasp->reset();
    showOutputs();
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::beginStep(SReal time, SReal)
{
    pass_on(*this, m_grasp->begin_step(time, view(this->mstate->readPositions().ref())));
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::endStep(SReal)
{
    showOutputs();
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::showOutputs()
{
    const std::span<const int> held = m_grasp->held_nodes();
    d_grasped.beginWriteOnly()->assign(held.begin(), held.end());
    d_grasped.endEdit();
    d_force.setValue(vec3(m_grasp->force()));
    d_torque.setValue(vec3(m_grasp->torque()));
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f)
{
    m_grasp->add_force(time, x, v, f);
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::addStiffnessProduct(double factor, ConstPoints dx, Points df) const
{
    m_grasp->add_stiffness_product(factor, dx, df);
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::addStiffnessBlocks(double factor, BlockMatrix& A) const
{
    m_grasp->add_stiffness_blocks(factor, A);
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::addDampingProduct(double factor, ConstPoints dx, Points df) const
{
    m_grasp->add_damping_product(factor, dx, df);
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::addDampingBlocks(double factor, BlockMatrix& A) const
{
    m_grasp->add_damping_blocks(factor, A);
}

}  // namespace hexaplast::sofa_plugin
