// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/fields.h>
#include <Hexaplast/table.h>
#include <sofa/core/behavior/ForceField.h>

#include <optional>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast::sofa_plugin
{

/// A force field of SOFA that is made from a part: between SOFA's calls, in its order, and those of the part. Data that
/// change during a simulation take effect at the beginning of the next step, or by reinit.
template <class TDataTypes>
class PartForceField : public sofa::core::behavior::ForceField<TDataTypes>
{
public:
    SOFA_ABSTRACT_CLASS(SOFA_TEMPLATE(PartForceField, TDataTypes),
                        SOFA_TEMPLATE(sofa::core::behavior::ForceField, TDataTypes));
    using DataTypes = TDataTypes;
    using Inherit = sofa::core::behavior::ForceField<DataTypes>;
    using VecCoord = typename DataTypes::VecCoord;
    using VecDeriv = typename DataTypes::VecDeriv;
    using DataVecCoord = sofa::core::objectmodel::Data<VecCoord>;
    using DataVecDeriv = sofa::core::objectmodel::Data<VecDeriv>;
    using MechanicalParams = sofa::core::MechanicalParams;

    void init() override;
    void reinit() override;
    void reset() override;
    void handleEvent(sofa::core::objectmodel::Event* event) override;

    using Inherit::addBToMatrix;
    using Inherit::addDForce;
    using Inherit::addForce;
    using Inherit::addKToMatrix;
    using Inherit::getPotentialEnergy;

    /// Evaluate only: nothing plastic changes.
    void addForce(const MechanicalParams* mparams, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    void addDForce(const MechanicalParams* mparams, DataVecDeriv& df, const DataVecDeriv& dx) override;
    void addKToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset) override;
    void addBToMatrix(sofa::linearalgebra::BaseMatrix* matrix, SReal factor, unsigned int& offset) override;
    void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix) override;
    void buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix) override;
    SReal getPotentialEnergy(const MechanicalParams* mparams, const DataVecCoord& x) const override;

    void computeBBox(const sofa::core::ExecParams* params, bool onlyVisible = false) override;

    /// For MultigridCGLinearSolver: whether there are derivatives at the latest forces; those with respect to positions
    /// for the kernels, where they can express them, and the diagonal of those with respect to velocities beside them.
    virtual bool isInMatrix() const { return true; }
    virtual bool describe(double /*factor*/, MatrixFreeSystem& /*system*/) const { return false; }
    virtual void addDampingDiagonal(double /*factor*/, Points /*diagonal*/) const {}

    /// For the same solver: whether the part has forces that would pull at the end of the present step. It tries an
    /// end, and is asked to let go of what pulls there, until nothing does, or for as often as it likes.
    virtual bool isOneSided() const { return false; }
    virtual bool release(ConstPoints /*x*/, ConstPoints /*v*/) { return false; }  ///< whether there was anything
    virtual void acceptStep() {}  ///< the step ends as it has been tried

    /// For the same solver, without the detour through SOFA's vectors: f += forces, df += (b B + k K) dx.
    void addOwnForce(ConstPoints x, ConstPoints v, Points f) { addPartForce(this->getContext()->getTime(), x, v, f); }
    void addOwnProduct(double b, double k, ConstPoints dx, Points df) const
    {
        addStiffnessProduct(k + b * this->rayleighStiffness.getValue(), dx, df);
        if (b != 0) addDampingProduct(b, dx, df);
    }

    /// From now on addDForce adds nothing: a solver of ours has the stiffness by other ways.
    void leaveOutOfProducts(bool leftOut) { m_leftOut = leftOut; }

    virtual bool hasPart() const = 0;

    /// Whether it has a part, and no error.
    bool works() const { return hasPart() && !is_invalid(*this); }

protected:
    /// description: of the attributes that it has as Data.
    explicit PartForceField(const Description& description);

    virtual void checkRayleighStiffness() const;  ///< OptionError where it is not allowed

    virtual void makePart() = 0;    ///< from the Data; what was there goes
    virtual void updatePart() = 0;  ///< by Data that have changed
    /// Whether Data of other components that the part is made from have changed since this was asked last.
    virtual bool othersHaveChanged() { return false; }
    virtual void resetPart() {}
    virtual void beginStep(SReal /*time*/, SReal /*dt*/) {}
    virtual void endStep(SReal /*dt*/) {}

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
    /// Lets `call` make or change the part by the Data. Where it came through the component is valid; else what is
    /// wrong with the Data is said, all at once.
    template <class Call>
    void acceptData(const Call& call);

    /// The stiffness at the latest forces into m_stiffness, df/dv into m_damping; false where that has failed, which is
    /// said.
    bool findStiffness();
    bool findDamping();

    const Description& m_description;
    std::optional<Inputs> m_inputs;
    bool m_dataAreAccepted = false;
    BlockMatrix m_stiffness, m_damping;
    bool m_leftOut = false;
};

#if !defined(HEXAPLAST_PARTFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API PartForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
