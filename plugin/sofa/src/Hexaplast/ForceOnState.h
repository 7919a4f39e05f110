// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartForceField.h>

#include <array>
#include <optional>

#include "parts/force.hpp"

namespace hexaplast::sofa_plugin
{

/// The forces of a part on one state.
class ForceOnState : public PartForceField<Vec3Types>
{
public:
    SOFA_ABSTRACT_CLASS(ForceOnState, PartForceField<Vec3Types>);

    bool isInMatrix() const override { return works() && force().is_in_matrix(); }
    bool addOperator(double factor, MatrixFreeSystem& system) const override
    {
        return force().add_stiffness_diagonal(factor, system.diagonal);
    }
    void addDampingDiagonal(double factor, Points diagonal) const override
    {
        force().add_damping_diagonal(factor, diagonal);
    }
    bool release(ConstPoints x, ConstPoints v) override { return force().release(x, v); }

protected:
    using PartForceField<Vec3Types>::PartForceField;

    double ownRayleighStiffness() const override { return hasPart() ? force().rayleigh_stiffness() : 0; }
    virtual parts::Force& force() = 0;
    const parts::Force& force() const { return const_cast<ForceOnState&>(*this).force(); }
    virtual void beforeForces() {}  ///< are computed

    void addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f) override
    {
        beforeForces();
        force().add_force(time, x, v, f);
    }
    void addStiffnessProduct(double factor, ConstPoints dx, Points df) const override
    {
        force().add_stiffness_product(factor, dx, df);
    }
    void addStiffnessBlocks(double factor, BlockMatrix& A) const override
    {
        force().add_stiffness_blocks(factor, A, {});
    }
    void addDampingProduct(double factor, ConstPoints dx, Points df) const override
    {
        force().add_damping_product(factor, dx, df);
    }
    void addDampingBlocks(double factor, BlockMatrix& A) const override { force().add_damping_blocks(factor, A, {}); }
    std::optional<double> energy(SReal time, ConstPoints x) const override { return force().potential_energy(time, x); }

    std::array<MechanicalState*, 2> states() const { return {this->mstate.get(), this->mstate.get()}; }
};

}  // namespace hexaplast::sofa_plugin
