// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/errors.h>
#include <Hexaplast/table.h>
#include <sofa/core/behavior/BaseMechanicalState.h>
#include <sofa/core/objectmodel/Link.h>
#include <sofa/core/visual/VisualParams.h>

#include <string>
#include <vector>

#include "parts/instrument.hpp"
#include "parts/instrument_shape.hpp"

namespace hexaplast::sofa_plugin
{

/// An instrument or a blade, as it is where it lies at `pose`.
inline void drawShape(sofa::helper::visual::DrawTool& tool, const parts::InstrumentShape& shape, const Pose& pose)
{
    const PointArray points = shape.at(pose);
    std::vector<sofa::type::Vec3> corners;
    for (const Triangle& triangle : shape.triangles)
        for (const int corner : triangle) corners.push_back(vec3(Vec3(points.row(corner))));
    tool.drawTriangles(corners, sofa::type::RGBAColor(0.75F, 0.78F, 0.82F, 1.F));
}

/// A frame of a rigid state, which prescribes a motion in place of a path, as a link and a Data of TOwner.
template <class TOwner>
class RigidFrame
{
public:
    RigidFrame(TOwner& owner, const char* help, const Data<int>& index)
        : m_owner(owner), l_rigid(owner.initLink("rigid", help)), d_index(index)
    {
    }

    bool isGiven() const { return l_rigid.get() != nullptr; }

    /// Throws OptionError where the link leads to no such frame of the scene.
    void check() const
    {
        if (!l_rigid && !l_rigid.getLinkedPath().empty())
            throw parts::OptionError("rigid", "'" + l_rigid.getLinkedPath() + "' leads to nothing");
        if (!l_rigid) return;
        requireInScene(m_owner, "rigid", *l_rigid);
        if (l_rigid->getCoordDimension() != 7 || l_rigid->getDerivDimension() != 6)
            throw parts::OptionError("rigid",
                                     "leads to '" + l_rigid->getName() +
                                         "', must lead to a MechanicalObject of rigid frames (template Rigid3d)");
        const int count = static_cast<int>(l_rigid->getSize());
        if (d_index.getValue() < 0 || d_index.getValue() >= count)
            throw parts::OptionError(
                "rigid_index", std::to_string(d_index.getValue()) + " must lie in [0, " + std::to_string(count) + ")");
    }

    /// Where it gets to, if it keeps its velocity for so long [s].
    Pose after(SReal duration) const
    {
        const std::size_t index = static_cast<std::size_t>(d_index.getValue()), count = l_rigid->getSize();
        if (index >= count) return {};  // it is said when the next step begins
        std::vector<SReal> x(7 * count), v(6 * count);
        l_rigid->copyToBuffer(x.data(), sofa::core::vec_id::read_access::position, static_cast<unsigned int>(x.size()));
        l_rigid->copyToBuffer(v.data(), sofa::core::vec_id::read_access::velocity, static_cast<unsigned int>(v.size()));
        const SReal *at = &x[7 * index], *speed = &v[6 * index];
        const Pose now{Vec3(at[0], at[1], at[2]), Eigen::Quaterniond(at[6], at[3], at[4], at[5]).normalized()};
        return parts::moved(now, Vec3(speed[0], speed[1], speed[2]), Vec3(speed[3], speed[4], speed[5]), duration);
    }

private:
    const TOwner& m_owner;
    sofa::core::objectmodel::SingleLink<TOwner, sofa::core::behavior::BaseMechanicalState,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_rigid;
    const Data<int>& d_index;
};

}  // namespace hexaplast::sofa_plugin
