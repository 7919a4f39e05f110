// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/GraspForceField.h>

#include <Hexaplast/PartForceField.inl>

namespace hexaplast::sofa_plugin
{

template <class TDataTypes>
void GraspForceField<TDataTypes>::makePart()
{
    m_grasp.reset();
    m_grasp.emplace(this->template readOptions<parts::GraspOptions>(), this->numNodes());
}

template <class TDataTypes>
void GraspForceField<TDataTypes>::updatePart()
{
    m_grasp->set_options(this->template readOptions<parts::GraspOptions>());
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
