// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/TissueContactForceField.h>
#include <Hexaplast/contact_drawing.h>
#include <Hexaplast/matrices.h>
#include <sofa/core/MechanicalParams.h>

#include <algorithm>

#include "attributes/contact.hpp"

namespace hexaplast::sofa_plugin
{

template <class TDataTypes>
TissueContactForceField<TDataTypes>::TissueContactForceField() : Component(attributes::kTissueContactForceField)
{
    this->mstate2.set(nullptr, "");  // that of object1, where it is not given
}

// Bodies and integrators may stand behind it: it is made when all of them have had their init.
template <class TDataTypes>
void TissueContactForceField<TDataTypes>::init()
{
    m_tissues.reset();
    using sofa::core::objectmodel::BaseContext;
    if (!this->mstate1) this->mstate1.set(this->getContext()->template get<MechanicalState>(BaseContext::Local));
    if (!this->mstate2) this->mstate2.set(this->mstate1.get());
    if (this->mstate1) Inherit::init();
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::bwdInit()
{
    Inherit::bwdInit();
    this->initPart();
    if (!this->works()) return;
    attempt(*this, [&] { m_tissues->look_at_start(positions()); });
    pass_on(*this, m_tissues->take_warnings());
    warnOfSamePair();
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::warnOfSamePair()
{
    if (m_hasWarnedOfPair || !this->d_active.getValue()) return;
    std::vector<TissueContactForceField*> all;
    this->getContext()->getRootContext()->template get<TissueContactForceField>(
        &all, sofa::core::objectmodel::BaseContext::SearchDown);
    const std::array own = {this->mstate1.get(), this->mstate2.get()};
    for (const TissueContactForceField* other : all)
    {
        const std::array states = {other->mstate1.get(), other->mstate2.get()};
        if (other == this || !other->works() || other->m_hasWarnedOfPair || !other->d_active.getValue() ||
            !std::is_permutation(own.begin(), own.end(), states.begin()))
            continue;
        m_hasWarnedOfPair = true;
        pass_on(*this, {parts::same_pair(other->getName())});
        return;
    }
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::makePart()
{
    m_tissues.reset();
    m_bodyFields = {};
    const std::array states = {this->mstate1.get(), this->mstate2.get()};
    if (!states[0] || !states[1])
        throw InputError("needs object1, and object2 where it is another one: the MechanicalObjects of two bodies");
    std::array<BodyField*, 2> fields = {};
    const auto& integrator = implicit_euler_of(*this->getContext());
    for (std::size_t k = 0; k < 2; ++k)
    {
        fields[k] = &body_field_of(*states[k]);
        if (states[k]->getContext()->template get<sofa::core::behavior::OdeSolver>() != &integrator)
            throw parts::OptionError(
                k == 0 ? "object1" : "object2",
                fmt::format("leads to '{}', which another integrator moves: bodies that touch need "
                            "one EulerImplicitSolver and one linear solver in a node above both, "
                            "and the contact stands below it",
                            states[k]->getPathName()));
    }
    m_bodyFields = fields;
    for (std::size_t k = 0; k < 2; ++k) m_bodiesMade[k] = m_bodyFields[k]->timesMade();
    m_tissues.emplace(this->template readOptions<parts::ContactOptions>(), *m_bodyFields[0]->body(),
                      *m_bodyFields[1]->body());
    this->acceptStep();
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::updatePart()
{
    if (othersHaveChanged()) return makePart();
    m_tissues->set_options(this->template readOptions<parts::ContactOptions>());
    warnOfSamePair();
}

template <class TDataTypes>
bool TissueContactForceField<TDataTypes>::othersHaveChanged()
{
    return m_bodiesMade[0] != m_bodyFields[0]->timesMade() || m_bodiesMade[1] != m_bodyFields[1]->timesMade();
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::resetPart()
{
    if (othersHaveChanged()) return makePart();
    m_tissues->reset();
    this->acceptStep();
    this->showContact(m_tissues->contact());
}

template <class TDataTypes>
OfTwo<ConstPoints> TissueContactForceField<TDataTypes>::positions() const
{
    return {view(this->mstate1->readPositions().ref()), view(this->mstate2->readPositions().ref())};
}

template <class TDataTypes>
OfTwo<ConstPoints> TissueContactForceField<TDataTypes>::velocities() const
{
    return {view(this->mstate1->readVelocities().ref()), view(this->mstate2->readVelocities().ref())};
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::beginStep(SReal, SReal dt)
{
    m_tissues->begin_step(dt, this->rayleighStiffnessOfIntegrator(), positions(), velocities());
    pass_on(*this, m_tissues->take_warnings());
    this->openStep(dt, m_tissues->rayleigh_stiffness());
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::endStep(SReal)
{
    this->closeStep();
    m_tissues->end_step(positions());
    this->showContact(m_tissues->contact());
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::addForce(const MechanicalParams*, DataVecDeriv& f1, DataVecDeriv& f2,
                                                   const DataVecCoord& x1, const DataVecCoord& x2,
                                                   const DataVecDeriv& v1, const DataVecDeriv& v2)
{
    if (!this->works()) return;
    auto first = sofa::helper::getWriteAccessor(f1), second = sofa::helper::getWriteAccessor(f2);
    if (first.size() < x1.getValue().size()) first.resize(x1.getValue().size());
    if (second.size() < x2.getValue().size()) second.resize(x2.getValue().size());
    attempt(*this,
            [&]
            {
                this->followBodies(*m_tissues);
                addOwnForce({view(x1.getValue()), view(x2.getValue())}, {view(v1.getValue()), view(v2.getValue())},
                            {view(first.wref()), view(second.wref())});
            });
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::addDForce(const MechanicalParams* mparams, DataVecDeriv& df1,
                                                    DataVecDeriv& df2, const DataVecDeriv& dx1, const DataVecDeriv& dx2)
{
    const double k = mparams->kFactor(), b = mparams->bFactor();
    if (!isInMatrix() || this->isLeftOut()) return;
    auto first = sofa::helper::getWriteAccessor(df1), second = sofa::helper::getWriteAccessor(df2);
    if (first.size() < dx1.getValue().size()) first.resize(dx1.getValue().size());
    if (second.size() < dx2.getValue().size()) second.resize(dx2.getValue().size());
    attempt(*this,
            [&] {
                addOwnProduct(b, k, {view(dx1.getValue()), view(dx2.getValue())},
                              {view(first.wref()), view(second.wref())});
            });
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::addOwnProduct(double b, double k, const OfTwo<ConstPoints>& dx,
                                                        OfTwo<Points> df) const
{
    const ContactTerms& terms = m_tissues->contact().terms();
    terms.add_stiffness_product(k + b * this->rayleighStiffness.getValue(), dx, df);
    if (b != 0) terms.add_damping_product(b, dx, df);
}

/// The nodes of the second body behind those of the first one; of one body with itself: its nodes.
template <class TDataTypes>
BlockMatrix TissueContactForceField<TDataTypes>::blocksOf(bool damping) const
{
    const int num_first = static_cast<int>(this->mstate1->getSize());
    const int num_second = isWithItself() ? 0 : static_cast<int>(this->mstate2->getSize());
    const std::array first_nodes = {0, isWithItself() ? 0 : num_first};
    BlockMatrix blocks(num_first + num_second);
    const ContactTerms& terms = m_tissues->contact().terms();
    if (damping)
        terms.add_damping_blocks(1, blocks, first_nodes);
    else
        terms.add_stiffness_blocks(1, blocks, first_nodes);
    return blocks;
}

/// ofPair(k, l): where the derivatives of the forces on state k by what state l does are to be added.
template <class TDataTypes>
template <class OfPair>
void TissueContactForceField<TDataTypes>::addBlocks(const BlockMatrix& blocks, const OfPair& ofPair) const
{
    const int num_first = static_cast<int>(this->mstate1->getSize());
    const std::array states = {this->mstate1.get(), this->mstate2.get()};
    const std::array ranges = {NodeRange{0, num_first}, NodeRange{num_first, blocks.num_nodes() - num_first}};
    for (std::size_t k = 0; k < (isWithItself() ? 1 : 2); ++k)
        for (std::size_t l = 0; l < (isWithItself() ? 1 : 2); ++l)
            add(blocks, ranges[k], ranges[l], ofPair(states[k], states[l]));
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix)
{
    if (!this->works()) return;
    attempt(*this,
            [&]
            {
                addBlocks(blocksOf(false), [&](auto* of, auto* by)
                          { return matrix->getForceDerivativeIn(of).withRespectToPositionsIn(by); });
            });
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix)
{
    if (!this->works() || this->d_damping.getValue() == 0) return;
    attempt(*this,
            [&]
            {
                addBlocks(blocksOf(true), [&](auto* of, auto* by)
                          { return matrix->getForceDerivativeIn(of).withRespectToVelocityIn(by); });
            });
}

template <class TDataTypes>
SReal TissueContactForceField<TDataTypes>::getPotentialEnergy(const MechanicalParams*, const DataVecCoord&,
                                                              const DataVecCoord&) const
{
    if (this->works()) msg_warning(this) << "its forces have no potential energy: 0 counts";
    return 0;
}

template <class TDataTypes>
void TissueContactForceField<TDataTypes>::draw(const sofa::core::visual::VisualParams* vparams)
{
    if (!this->works() || !vparams->displayFlags().getShowForceFields()) return;
    auto* tool = vparams->drawTool();
    const auto lifeCycle = tool->makeStateLifeCycle();
    draw_contacts(*tool, m_tissues->contact().terms(), positions(), velocities(), this->d_drawForceScale.getValue());
}

}  // namespace hexaplast::sofa_plugin
