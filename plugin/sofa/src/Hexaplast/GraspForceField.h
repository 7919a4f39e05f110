// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartForceField.h>

#include "attributes/parts.hpp"
#include "parts/grasp.hpp"

namespace hexaplast::sofa_plugin
{

/// An instrument that takes hold of the nodes around it, moves along a path and lets go. Data:
/// plugin/attributes/parts.hpp.
template <class TDataTypes>
class GraspForceField : public PartForceField<TDataTypes>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(GraspForceField, TDataTypes), SOFA_TEMPLATE(PartForceField, TDataTypes));
    using Inherit = PartForceField<TDataTypes>;

    Data<sofa::type::vector<SReal>> d_keyTimes{this->fromTable(d_keyTimes, "keyTimes", "Path")};
    Data<sofa::type::vector<sofa::type::Vec3>> d_positions{this->fromTable(d_positions, "positions", "Path")};
    Data<SReal> d_graspTime{this->fromTable(d_graspTime, "graspTime", "Path")};
    Data<SReal> d_releaseTime{this->fromTable(d_releaseTime, "releaseTime", "Path")};
    Data<SReal> d_radius{this->fromTable(d_radius, "radius", "Grip")};
    Data<sofa::type::vector<sofa::Index>> d_indices{this->fromTable(d_indices, "indices", "Grip")};
    Data<SReal> d_stiffness{this->fromTable(d_stiffness, "stiffness", "Grip")};
    Data<SReal> d_maxForce{this->fromTable(d_maxForce, "maxForce", "Grip")};
    Data<SReal> d_damping{this->fromTable(d_damping, "damping", "Grip")};
    Data<sofa::type::vector<sofa::Index>> d_grasped{this->fromTable(d_grasped, "grasped")};
    Data<sofa::type::Vec3> d_force{this->fromTable(d_force, "force")};
    Data<sofa::type::Vec3> d_torque{this->fromTable(d_torque, "torque")};

    bool hasPart() const override { return m_grasp.has_value(); }
    bool isInMatrix() const override { return m_grasp->is_closed(); }
    bool describe(double factor, MatrixFreeSystem& system) const override
    {
        return m_grasp->add_stiffness_diagonal(factor, system.diagonal);
    }
    void addDampingDiagonal(double factor, Points diagonal) const override
    {
        m_grasp->add_damping_diagonal(factor, diagonal);
    }

protected:
    GraspForceField() : Inherit(attributes::kGraspForceField) {}

    void makePart() override;
    void updatePart() override;
    void resetPart() override;
    void beginStep(SReal time, SReal dt) override;
    void endStep(SReal dt) override;

    void addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f) override;
    void addStiffnessProduct(double factor, ConstPoints dx, Points df) const override;
    void addStiffnessBlocks(double factor, BlockMatrix& A) const override;
    void addDampingProduct(double factor, ConstPoints dx, Points df) const override;
    void addDampingBlocks(double factor, BlockMatrix& A) const override;
    std::optional<double> energy(SReal time, ConstPoints x) const override { return m_grasp->energy(time, x); }

private:
    void showOutputs();

    std::optional<parts::Grasp> m_grasp;
};

#if !defined(HEXAPLAST_GRASPFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API GraspForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
