// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/ForceBetweenStates.h>
#include <Hexaplast/matrices.h>
#include <sofa/core/MechanicalParams.h>

namespace hexaplast::sofa_plugin
{

ForceBetweenStates::ForceBetweenStates(const Description& description, bool makesData)
    : Component(description, makesData)
{
    mstate2.set(nullptr, "");  // that of object1, where it is not given
}

void ForceBetweenStates::init()
{
    const bool leadSomewhere = attempt(*this,
                                       [&]
                                       {
                                           checkLink(mstate1, "object1");
                                           checkLink(mstate2, "object2");
                                       });
    if (!leadSomewhere) return;
    if (!mstate1) mstate1.set(getContext()->get<MechanicalState>(sofa::core::objectmodel::BaseContext::Local));
    if (!mstate2) mstate2.set(mstate1.get());
    if (mstate1) Inherit::init();
}

void ForceBetweenStates::addForce(const MechanicalParams*, DataVecDeriv& f1, DataVecDeriv& f2, const DataVecCoord& x1,
                                  const DataVecCoord& x2, const DataVecDeriv& v1, const DataVecDeriv& v2)
{
    if (!works()) return;
    auto first = sofa::helper::getWriteAccessor(f1), second = sofa::helper::getWriteAccessor(f2);
    if (first.size() < x1.getValue().size()) first.resize(x1.getValue().size());
    if (second.size() < x2.getValue().size()) second.resize(x2.getValue().size());
    attempt(*this,
            [&]
            {
                addOwnForce({view(x1.getValue()), view(x2.getValue())}, {view(v1.getValue()), view(v2.getValue())},
                            {view(first.wref()), view(second.wref())});
            });
}

void ForceBetweenStates::addOwnForce(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f)
{
    beforeForces();
    force().add_force(getContext()->getTime(), x, v, f);
}

void ForceBetweenStates::addDForce(const MechanicalParams* mparams, DataVecDeriv& df1, DataVecDeriv& df2,
                                   const DataVecDeriv& dx1, const DataVecDeriv& dx2)
{
    const double k = mparams->kFactor(), b = mparams->bFactor();
    if (!isInMatrix() || isLeftOut()) return;
    auto first = sofa::helper::getWriteAccessor(df1), second = sofa::helper::getWriteAccessor(df2);
    if (first.size() < dx1.getValue().size()) first.resize(dx1.getValue().size());
    if (second.size() < dx2.getValue().size()) second.resize(dx2.getValue().size());
    attempt(*this,
            [&] {
                addOwnProduct(b, k, {view(dx1.getValue()), view(dx2.getValue())},
                              {view(first.wref()), view(second.wref())});
            });
}

void ForceBetweenStates::addOwnProduct(double b, double k, const Pair<ConstPoints>& dx, Pair<Points> df) const
{
    force().add_stiffness_product(k + b * wholeRayleighStiffness(), dx, df);
    if (b != 0) force().add_damping_product(b, dx, df);
}

/// The nodes of the second state behind those of the first one; of one state with itself: its nodes.
template <class Add>
BlockMatrix ForceBetweenStates::blocksOf(const Add& add) const
{
    const int numFirst = static_cast<int>(mstate1->getSize());
    const int numSecond = isWithItself() ? 0 : static_cast<int>(mstate2->getSize());
    BlockMatrix blocks(numFirst + numSecond);
    add(blocks, std::array{0, isWithItself() ? 0 : numFirst});
    return blocks;
}

/// ofPair(k, l): where the derivatives of the forces on state k by what state l does are to be added.
template <class OfPair>
void ForceBetweenStates::addBlocks(const BlockMatrix& blocks, const OfPair& ofPair) const
{
    const int numFirst = static_cast<int>(mstate1->getSize());
    const std::array of = states();
    const std::array ranges = {NodeRange{0, numFirst}, NodeRange{numFirst, blocks.num_nodes() - numFirst}};
    for (std::size_t k = 0; k < (isWithItself() ? 1 : 2); ++k)
        for (std::size_t l = 0; l < (isWithItself() ? 1 : 2); ++l)
            add(blocks, ranges[k], ranges[l], ofPair(of[k], of[l]));
}

void ForceBetweenStates::buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix)
{
    if (!works()) return;
    attempt(*this,
            [&]
            {
                addBlocks(blocksOf([&](BlockMatrix& A, std::array<int, 2> first)
                                   { force().add_stiffness_blocks(matrixScale(), A, first); }),
                          [&](auto* of, auto* by)
                          { return matrix->getForceDerivativeIn(of).withRespectToPositionsIn(by); });
            });
}

void ForceBetweenStates::buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix)
{
    if (!works()) return;
    attempt(
        *this,
        [&]
        {
            addBlocks(
                blocksOf([&](BlockMatrix& A, std::array<int, 2> first) { force().add_damping_blocks(1, A, first); }),
                [&](auto* of, auto* by) { return matrix->getForceDerivativeIn(of).withRespectToVelocityIn(by); });
        });
}

SReal ForceBetweenStates::getPotentialEnergy(const MechanicalParams*, const DataVecCoord&, const DataVecCoord&) const
{
    if (works()) msg_warning(this) << "its forces have no potential energy: 0 counts";
    return 0;
}

}  // namespace hexaplast::sofa_plugin
