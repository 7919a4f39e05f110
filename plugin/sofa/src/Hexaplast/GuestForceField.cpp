// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/GuestForceField.h>
#include <sofa/core/MechanicalParams.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/linearalgebra/BaseMatrix.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <sofa/simulation/AnimateEndEvent.h>

#include "scene/potential.hpp"

namespace hexaplast::sofa_plugin
{

using sofa::core::objectmodel::ComponentState;

GuestForceField::GuestForceField(const attributes::Description& description)
    : m_description(description), m_attributes(*this, description)
{
    f_listening.setValue(true);
}

void GuestForceField::init()
{
    Inherit::init();
    m_guest.reset();
    if (!mstate)
    {
        msg_error() << "needs a MechanicalObject of template Vec3 before it";
        d_componentState.setValue(ComponentState::Invalid);
        return;
    }
    if (attempt(*this, [&] { m_guest.emplace(*this, m_description, m_attributes, mstate.get(), topology()); }))
    {
        m_stiffness = m_damping = BlockMatrix(static_cast<int>(mstate->getSize()));
        d_componentState.setValue(ComponentState::Valid);
    }
}

// What flowed stays: the guest follows its attributes as it would at the beginning of the next step.
void GuestForceField::reinit()
{
    if (!m_guest) return init();
    d_componentState.setValue(ComponentState::Valid);
    attempt(*this, [&] { m_guest->follow_attributes(); });
}

void GuestForceField::reset()
{
    if (m_guest) m_guest->reset();
}

void GuestForceField::handleEvent(sofa::core::objectmodel::Event* event)
{
    if (sofa::simulation::AnimateBeginEvent::checkEventType(event))
    {
        if (!may_step(*this) || !m_guest) return;
        const double dt = static_cast<sofa::simulation::AnimateBeginEvent*>(event)->getDt();
        attempt(*this, [&] { m_guest->begin_step(getContext()->getTime(), dt); });
    }
    else if (works() && sofa::simulation::AnimateEndEvent::checkEventType(event))
    {
        const double dt = static_cast<sofa::simulation::AnimateEndEvent*>(event)->getDt();
        if (attempt(*this, [&] { m_guest->end_step(dt); })) stepEnded();
    }
}

void GuestForceField::addForce(const MechanicalParams*, DataVecDeriv& f, const DataVecCoord& x, const DataVecDeriv& v)
{
    if (!works()) return;
    auto forces = sofa::helper::getWriteAccessor(f);
    if (forces.size() < x.getValue().size()) forces.resize(x.getValue().size());
    attempt(
        *this, [&]
        { guest()->add_force(getContext()->getTime(), view(x.getValue()), view(v.getValue()), view(forces.wref())); });
}

void GuestForceField::addDForce(const MechanicalParams* mparams, DataVecDeriv& df, const DataVecDeriv& dx)
{
    const double factor =
        sofa::core::mechanicalparams::kFactorIncludingRayleighDamping(mparams, rayleighStiffness.getValue());
    if (!works() || m_leftOut) return;
    auto forces = sofa::helper::getWriteAccessor(df);
    if (forces.size() < dx.getValue().size()) forces.resize(dx.getValue().size());
    const double damping = mparams->bFactor();
    attempt(*this,
            [&]
            {
                guest()->add_stiffness_product(factor, view(dx.getValue()), view(forces.wref()));
                if (damping != 0) guest()->add_damping_product(damping, view(dx.getValue()), view(forces.wref()));
            });
}

bool GuestForceField::findStiffness()
{
    m_stiffness.clear();
    return attempt(*this, [&] { guest()->add_stiffness_blocks(1, m_stiffness); });
}

bool GuestForceField::findDamping()
{
    m_damping.clear();
    return attempt(*this, [&] { guest()->add_damping_blocks(1, m_damping); });
}

namespace
{

void add(const BlockMatrix& blocks, SReal factor, unsigned int offset, sofa::linearalgebra::BaseMatrix& matrix)
{
    for (int row = 0; row < blocks.num_nodes(); ++row)
        for (const auto& [column, block] : blocks.row(row))
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    matrix.add(static_cast<int>(offset) + 3 * row + a, static_cast<int>(offset) + 3 * column + b,
                               factor * block(a, b));
}

template <class Derivative>
void add(const BlockMatrix& blocks, Derivative derivative)
{
    for (int row = 0; row < blocks.num_nodes(); ++row)
        for (const auto& [column, block] : blocks.row(row))
        {
            sofa::type::Mat<3, 3, SReal> entry(sofa::type::NOINIT);
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) entry(a, b) = block(a, b);
            derivative(3 * row, 3 * column) += entry;
        }
}

}  // namespace

void GuestForceField::addKToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset)
{
    if (works() && findStiffness()) add(m_stiffness, factor, offset, *matrix);
}

void GuestForceField::addBToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset)
{
    if (works() && findDamping()) add(m_damping, factor, offset, *matrix);
}

void GuestForceField::buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix)
{
    if (works() && findStiffness())
        add(m_stiffness, matrix->getForceDerivativeIn(this->mstate).withRespectToPositionsIn(this->mstate));
}

void GuestForceField::buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix)
{
    if (works() && findDamping())
        add(m_damping, matrix->getForceDerivativeIn(this->mstate).withRespectToVelocityIn(this->mstate));
}

SReal GuestForceField::getPotentialEnergy(const MechanicalParams*, const DataVecCoord& x) const
{
    if (!works()) return 0;
    if (const auto* field = dynamic_cast<const scene::Potential*>(guest()))
        return field->potential_energy(getContext()->getTime(), view(x.getValue()));
    msg_warning() << "its forces have no potential energy: 0 counts";
    return 0;
}

void GuestForceField::computeBBox(const sofa::core::ExecParams*, bool onlyVisible)
{
    if (!mstate || onlyVisible) return;
    const auto x = view(mstate->readPositions().ref());
    if (x.rows() == 0) return;
    const Vec3 least = x.colwise().minCoeff(), most = x.colwise().maxCoeff();
    f_bbox.setValue(sofa::type::BoundingBox({least[0], least[1], least[2]}, {most[0], most[1], most[2]}));
}

}  // namespace hexaplast::sofa_plugin
