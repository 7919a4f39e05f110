// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/ForceOnState.h>
#include <sofa/core/MechanicalParams.h>

namespace hexaplast::sofa_plugin
{

void ForceOnState::initPart()
{
    Inherit::init();
    if (mstate) return Component::initPart();
    msg_error(this) << "needs a MechanicalObject of template Vec3 before it";
    d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
}

void ForceOnState::addForce(const MechanicalParams*, DataVecDeriv& f, const DataVecCoord& x, const DataVecDeriv& v)
{
    if (!works()) return;
    auto added = grown(f, x);
    attempt(*this, [&] { addOwnForce(view(x.getValue()), view(v.getValue()), view(added.wref())); });
}

void ForceOnState::addDForce(const MechanicalParams* mparams, DataVecDeriv& df, const DataVecDeriv& dx)
{
    const double k = mparams->kFactor(), b = mparams->bFactor();
    if (!works() || isLeftOut()) return;
    auto added = grown(df, dx);
    attempt(*this, [&] { addOwnProduct(b, k, view(dx.getValue()), view(added.wref())); });
}

void ForceOnState::addKToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset)
{
    if (!works()) return;
    BlockMatrix blocks(static_cast<int>(mstate->getSize()));
    if (attempt(*this, [&] { forces().add_stiffness_blocks(matrixScale(), blocks, {}); }))
        add(blocks, factor, offset, *matrix);
}

SReal ForceOnState::getPotentialEnergy(const MechanicalParams*, const DataVecCoord& x) const
{
    if (!works()) return 0;
    if (const auto found = forces().potential_energy(getContext()->getTime(), view(x.getValue()))) return *found;
    msg_warning(this) << "its forces have no potential energy: 0 counts";
    return 0;
}

void ForceOnState::computeBBox(const sofa::core::ExecParams*, bool onlyVisible)
{
    if (!mstate || onlyVisible) return;
    const auto x = view(mstate->readPositions().ref());
    if (x.rows() == 0) return;
    const Vec3 min = x.colwise().minCoeff(), max = x.colwise().maxCoeff();
    f_bbox.setValue(sofa::type::BoundingBox(vec3(min), vec3(max)));
}

}  // namespace hexaplast::sofa_plugin
