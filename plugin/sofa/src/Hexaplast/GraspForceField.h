// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartForceField.h>

#include "parts/grasp.hpp"

namespace hexaplast::sofa_plugin
{

/// An instrument that takes hold of the nodes around it, moves along a path and lets go.
template <class TDataTypes>
class GraspForceField : public PartForceField<TDataTypes>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(GraspForceField, TDataTypes), SOFA_TEMPLATE(PartForceField, TDataTypes));
    using Inherit = PartForceField<TDataTypes>;

    Data<sofa::type::vector<SReal>> d_keyTimes;              ///< [s] of the tool's path
    Data<sofa::type::vector<sofa::type::Vec3>> d_positions;  ///< [m] of the tool at each key time
    Data<SReal> d_graspTime;                                 ///< [s] when the grip closes
    Data<SReal> d_releaseTime;                               ///< [s] when it opens; never, where not set
    Data<SReal> d_radius;                                    ///< [m] within which it takes nodes
    Data<sofa::type::vector<sofa::Index>> d_indices;         ///< nodes that can be held; all, where not set
    Data<SReal> d_stiffness;                                 ///< [N/m] of the grip as a whole
    Data<SReal> d_maxForce;                                  ///< [N] of the grip as a whole; no limit, where not set
    Data<SReal> d_damping;                                   ///< [N s/m] of the grip as a whole
    Data<sofa::type::vector<sofa::Index>> d_grasped;         ///< output: nodes that it holds
    Data<sofa::type::Vec3> d_force;                          ///< output [N]: what the tool exerted
    Data<sofa::type::Vec3> d_torque;                         ///< output [N m]: its moment about the tool

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
    GraspForceField();

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
    parts::GraspOptions options() const;
    void showOutputs();

    std::optional<parts::Grasp> m_grasp;
};

#if !defined(HEXAPLAST_GRASPFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API GraspForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
