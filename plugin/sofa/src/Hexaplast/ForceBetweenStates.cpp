// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/ForceBetweenStates.h>
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
    auto first = grown(f1, x1), second = grown(f2, x2);
    attempt(*this,
            [&]
            {
                addOwnForce({view(x1.getValue()), view(x2.getValue())}, {view(v1.getValue()), view(v2.getValue())},
                            {view(first.wref()), view(second.wref())});
            });
}

void ForceBetweenStates::addDForce(const MechanicalParams* mparams, DataVecDeriv& df1, DataVecDeriv& df2,
                                   const DataVecDeriv& dx1, const DataVecDeriv& dx2)
{
    const double k = mparams->kFactor(), b = mparams->bFactor();
    if (!isInMatrix() || isLeftOut()) return;
    auto first = grown(df1, dx1), second = grown(df2, dx2);
    attempt(*this,
            [&] {
                addOwnProduct(b, k, {view(dx1.getValue()), view(dx2.getValue())},
                              {view(first.wref()), view(second.wref())});
            });
}

SReal ForceBetweenStates::getPotentialEnergy(const MechanicalParams*, const DataVecCoord&, const DataVecCoord&) const
{
    if (works()) msg_warning(this) << "its forces have no potential energy: 0 counts";
    return 0;
}

}  // namespace hexaplast::sofa_plugin
