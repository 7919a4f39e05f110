// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartComponent.h>
#include <Hexaplast/config.h>
#include <Hexaplast/fields.h>
#include <sofa/core/behavior/ForceField.h>

#include <optional>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast::sofa_plugin
{

/// A part whose forces act on one state.
template <class TDataTypes>
class PartForceField : public PartComponent<sofa::core::behavior::ForceField<TDataTypes>>
{
public:
    SOFA_ABSTRACT_CLASS(SOFA_TEMPLATE(PartForceField, TDataTypes),
                        SOFA_TEMPLATE(PartComponent, sofa::core::behavior::ForceField<TDataTypes>));
    using DataTypes = TDataTypes;
    using Inherit = sofa::core::behavior::ForceField<DataTypes>;
    using Component = PartComponent<Inherit>;
    using VecCoord = typename DataTypes::VecCoord;
    using VecDeriv = typename DataTypes::VecDeriv;
    using DataVecCoord = sofa::core::objectmodel::Data<VecCoord>;
    using DataVecDeriv = sofa::core::objectmodel::Data<VecDeriv>;
    using MechanicalParams = sofa::core::MechanicalParams;

    void init() override;

    using Inherit::addDForce;
    using Inherit::addForce;
    using Inherit::addKToMatrix;
    using Inherit::getPotentialEnergy;

    /// Evaluate only: nothing plastic changes.
    void addForce(const MechanicalParams* mparams, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    void addDForce(const MechanicalParams* mparams, DataVecDeriv& df, const DataVecDeriv& dx) override;
    void addKToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset) override;
    void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix) override;
    void buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix) override;
    SReal getPotentialEnergy(const MechanicalParams* mparams, const DataVecCoord& x) const override;

    void computeBBox(const sofa::core::ExecParams* params, bool onlyVisible = false) override;

    /// For MultigridCGLinearSolver: derivatives with respect to positions for the kernels, where they can express them,
    /// and the diagonal of those with respect to velocities beside them.
    virtual bool addOperator(double /*factor*/, MatrixFreeSystem& /*system*/) const { return false; }
    virtual void addDampingDiagonal(double /*factor*/, Points /*diagonal*/) const {}

    /// For the same solver: lets go of what pulls at these ends of a step. Whether there was anything.
    virtual bool release(ConstPoints /*x*/, ConstPoints /*v*/) { return false; }

    /// For the same solver, without the detour through SOFA's vectors: f += forces, df += (b B + k K) dx.
    void addOwnForce(ConstPoints x, ConstPoints v, Points f) { addPartForce(this->getContext()->getTime(), x, v, f); }
    void addOwnProduct(double b, double k, ConstPoints dx, Points df) const
    {
        addStiffnessProduct(k + b * this->wholeRayleighStiffness(), dx, df);
        if (b != 0) addDampingProduct(b, dx, df);
    }

protected:
    using Component::Component;

    void initPart() override;

    /// f += forces at x, v; fixes the positions that the derivatives refer to. df += factor df/dx dx and factor df/dv
    /// dx, and their blocks.
    virtual void addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f) = 0;
    virtual void addStiffnessProduct(double /*factor*/, ConstPoints /*dx*/, Points /*df*/) const {}
    virtual void addStiffnessBlocks(double /*factor*/, BlockMatrix& /*A*/) const {}
    virtual void addDampingProduct(double /*factor*/, ConstPoints /*dx*/, Points /*df*/) const {}
    virtual void addDampingBlocks(double /*factor*/, BlockMatrix& /*A*/) const {}
    virtual std::optional<double> energy(SReal /*time*/, ConstPoints /*x*/) const { return std::nullopt; }

    int numNodes() const { return static_cast<int>(this->mstate->getSize()); }

private:
    /// The stiffness at the latest forces into m_stiffness; false where that has failed, which is said.
    bool findStiffness();
    void clear(BlockMatrix& blocks) const;

    BlockMatrix m_stiffness, m_damping;
};

#if !defined(HEXAPLAST_PARTFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API PartForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
