// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartForceField.h>
#include <Hexaplast/matrices.h>
#include <sofa/core/MechanicalParams.h>

namespace hexaplast::sofa_plugin
{

template <class TDataTypes>
void PartForceField<TDataTypes>::init()
{
    initPart();
}

template <class TDataTypes>
void PartForceField<TDataTypes>::initPart()
{
    Inherit::init();
    if (!this->mstate)
    {
        msg_error(this) << "needs a MechanicalObject of template Vec3 before it";
        this->d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
        return;
    }
    Component::initPart();
}

template <class TDataTypes>
void PartForceField<TDataTypes>::addForce(const MechanicalParams*, DataVecDeriv& f, const DataVecCoord& x,
                                          const DataVecDeriv& v)
{
    if (!this->works()) return;
    auto forces = sofa::helper::getWriteAccessor(f);
    if (forces.size() < x.getValue().size()) forces.resize(x.getValue().size());
    attempt(
        *this, [&]
        { addPartForce(this->getContext()->getTime(), view(x.getValue()), view(v.getValue()), view(forces.wref())); });
}

template <class TDataTypes>
void PartForceField<TDataTypes>::addDForce(const MechanicalParams* mparams, DataVecDeriv& df, const DataVecDeriv& dx)
{
    const double factor =
        sofa::core::mechanicalparams::kFactorIncludingRayleighDamping(mparams, this->wholeRayleighStiffness());
    if (!this->works() || this->isLeftOut()) return;
    auto forces = sofa::helper::getWriteAccessor(df);
    if (forces.size() < dx.getValue().size()) forces.resize(dx.getValue().size());
    const double damping = mparams->bFactor();
    attempt(*this,
            [&]
            {
                addStiffnessProduct(factor, view(dx.getValue()), view(forces.wref()));
                if (damping != 0) addDampingProduct(damping, view(dx.getValue()), view(forces.wref()));
            });
}

// Nodes may have come since.
template <class TDataTypes>
void PartForceField<TDataTypes>::clear(BlockMatrix& blocks) const
{
    if (blocks.num_nodes() == numNodes())
        blocks.clear();
    else
        blocks = BlockMatrix(numNodes());
}

template <class TDataTypes>
bool PartForceField<TDataTypes>::findStiffness()
{
    clear(m_stiffness);
    return attempt(*this, [&] { addStiffnessBlocks(this->matrixScale(), m_stiffness); });
}

template <class TDataTypes>
void PartForceField<TDataTypes>::addKToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor,
                                              unsigned int& offset)
{
    if (this->works() && findStiffness()) add(m_stiffness, factor, offset, *matrix);
}

template <class TDataTypes>
void PartForceField<TDataTypes>::buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix)
{
    if (this->works() && findStiffness())
        add(m_stiffness, matrix->getForceDerivativeIn(this->mstate).withRespectToPositionsIn(this->mstate));
}

template <class TDataTypes>
void PartForceField<TDataTypes>::buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix)
{
    if (!this->works()) return;
    clear(m_damping);
    if (attempt(*this, [&] { addDampingBlocks(1, m_damping); }))
        add(m_damping, matrix->getForceDerivativeIn(this->mstate).withRespectToVelocityIn(this->mstate));
}

template <class TDataTypes>
SReal PartForceField<TDataTypes>::getPotentialEnergy(const MechanicalParams*, const DataVecCoord& x) const
{
    if (!this->works()) return 0;
    if (const auto found = energy(this->getContext()->getTime(), view(x.getValue()))) return *found;
    msg_warning(this) << "its forces have no potential energy: 0 counts";
    return 0;
}

template <class TDataTypes>
void PartForceField<TDataTypes>::computeBBox(const sofa::core::ExecParams*, bool onlyVisible)
{
    if (!this->mstate || onlyVisible) return;
    const auto x = view(this->mstate->readPositions().ref());
    if (x.rows() == 0) return;
    const Vec3 min = x.colwise().minCoeff(), max = x.colwise().maxCoeff();
    this->f_bbox.setValue(sofa::type::BoundingBox(vec3(min), vec3(max)));
}

}  // namespace hexaplast::sofa_plugin
