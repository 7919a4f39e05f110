// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartForceField.h>
#include <sofa/core/objectmodel/DDGNode.h>
#include <sofa/core/objectmodel/Link.h>

#include <vector>

#include "parts/hexahedral_body.hpp"

namespace hexaplast::sofa_plugin
{

class MaterialRegion;

/// Hexahedral corotational finite elements that stretch, yield and stay stretched. Plastic flow happens once per time
/// step, at AnimateEndEvent. Data and outputs: the rows of Material and Settings, and plugin/attributes/hexaplast.hpp.
template <class TDataTypes>
class HexahedronElastoplasticFEMForceField : public PartForceField<TDataTypes>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(HexahedronElastoplasticFEMForceField, TDataTypes),
               SOFA_TEMPLATE(PartForceField, TDataTypes));
    using Inherit = PartForceField<TDataTypes>;
    using VecReal = sofa::type::vector<SReal>;

    Data<VecReal> d_youngModulus{fromRow(d_youngModulus, "youngModulus")};
    Data<VecReal> d_poissonRatio{fromRow(d_poissonRatio, "poissonRatio")};
    DataWord d_law{fromRow(d_law, "law")};
    Data<SReal> d_mooneyFraction{fromRow(d_mooneyFraction, "mooneyFraction")};
    Data<VecReal> d_yieldStress{fromRow(d_yieldStress, "yieldStress")};
    DataWord d_yieldNorm{fromRow(d_yieldNorm, "yieldNorm")};
    Data<SReal> d_plasticFlowRate{fromRow(d_plasticFlowRate, "plasticFlowRate")};
    Data<SReal> d_rotationYield{fromRow(d_rotationYield, "rotationYield")};
    Data<SReal> d_rotationFlowRate{fromRow(d_rotationFlowRate, "rotationFlowRate")};
    DataWord d_rotationPlasticity{fromRow(d_rotationPlasticity, "rotationPlasticity")};
    DataWord d_rotationFrame{fromRow(d_rotationFrame, "rotationFrame")};
    Data<SReal> d_hardening{fromRow(d_hardening, "hardening")};
    Data<SReal> d_volumeRestitution{fromRow(d_volumeRestitution, "volumeRestitution")};
    Data<SReal> d_inversionThreshold{fromRow(d_inversionThreshold, "inversionThreshold")};
    Data<SReal> d_fractureStress{fromRow(d_fractureStress, "fractureStress")};
    Data<SReal> d_fractureStretch{fromRow(d_fractureStretch, "fractureStretch")};
    DataWord d_bending{fromRow(d_bending, "bending")};
    Data<SReal> d_blendWeight{fromRow(d_blendWeight, "blendWeight")};
    DataWord d_volumetric{fromRow(d_volumetric, "volumetric")};
    DataWord d_recovery{fromRow(d_recovery, "recovery")};
    Data<SReal> d_recoveryStrength{fromRow(d_recoveryStrength, "recoveryStrength")};
    Data<SReal> d_recoveryFrom{fromRow(d_recoveryFrom, "recoveryFrom")};
    Data<SReal> d_recoveryFull{fromRow(d_recoveryFull, "recoveryFull")};
    DataWord d_averaging{fromRow(d_averaging, "averaging")};
    Data<int> d_averagingSteps{fromRow(d_averagingSteps, "averagingSteps")};
    Data<SReal> d_averagingTolerance{fromRow(d_averagingTolerance, "averagingTolerance")};
    DataWord d_precision{fromRow(d_precision, "precision")};

    Data<VecReal> d_plasticStrain{fromRow(d_plasticStrain, "plasticStrain")};
    Data<VecReal> d_presentYieldStress{fromRow(d_presentYieldStress, "presentYieldStress")};
    Data<VecReal> d_volumeRatio{fromRow(d_volumeRatio, "volumeRatio")};
    Data<VecReal> d_volume{fromRow(d_volume, "volume")};
    Data<VecReal> d_plasticVolume{fromRow(d_plasticVolume, "plasticVolume")};
    Data<sofa::type::vector<sofa::type::Vec3>> d_plasticRestPositions{
        fromRow(d_plasticRestPositions, "plasticRestPositions")};
    Data<sofa::type::vector<sofa::Index>> d_removed{fromRow(d_removed, "removed")};

    Data<bool> d_drawPlasticRestShape{
        this->initData(&d_drawPlasticRestShape, false, "drawPlasticRestShape",
                       "Draws the edges of the plastic rest shape, which the body has without load.")};
    sofa::core::objectmodel::SingleLink<HexahedronElastoplasticFEMForceField, MeshTopology,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_topology{this->initLink("topology", "The hexahedra; the topology of the node where it is not given.")};

    void bwdInit() override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;
    void handleTopologyChange(sofa::core::topology::Topology* changed) override;

    bool hasPart() const override { return m_body.has_value(); }
    bool describe(double factor, MatrixFreeSystem& system) const override
    {
        m_body->body().describe(factor, system);
        return true;
    }

    /// The body; null before init and after an error.
    const Body* body() const { return m_body ? &m_body->body() : nullptr; }
    int timesMade() const { return m_timesMade; }  ///< whoever refers to the body refers to that one

protected:
    HexahedronElastoplasticFEMForceField();

    void initPart() override;
    void makePart() override;
    void updatePart() override;
    bool othersHaveChanged() override;
    void resetPart() override;
    void endStep(SReal dt) override;
    void addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f) override;
    void addStiffnessProduct(double factor, ConstPoints dx, Points df) const override;
    void addStiffnessBlocks(double factor, BlockMatrix& A) const override;
    std::optional<double> energy(SReal, ConstPoints x) const override { return m_body->body().energy(x); }

private:
    template <class T>
    typename Data<T>::InitData fromRow(Data<T>& data, std::string_view name)
    {
        return this->fromTable(data, name, group_of(name).c_str());
    }

    /// Throws InputError where a region cannot be.
    parts::HexahedralBodyOptions options(const std::vector<Hexahedron>& hexahedra) const;

    /// Those of this body, in the order of the scene.
    std::vector<MaterialRegion*> regions() const;

    /// Throws InputError where its topology has changed in a way that it cannot follow.
    void requireTopology() const;

    /// Hexahedra that went in the latest step leave the topology, where that can be.
    void tearTopology();

    void computeOutputs();

    std::optional<parts::HexahedralBody> m_body;
    int m_timesMade = 0;
    std::vector<double> m_fill;   // fraction of each hexahedron of a sparse grid that is full
    std::vector<int> m_original;  // number that each hexahedron of the topology has in the body
    bool m_topologyIsLost = false;
    bool m_regionsAreReady = false;  // they may stand behind the body, and what they follow too

    /// Stands before the outputs in SOFA's graph of dependencies, so that they are computed when somebody reads them.
    class Outputs final : public sofa::core::objectmodel::DDGNode
    {
    public:
        explicit Outputs(HexahedronElastoplasticFEMForceField& owner) : m_owner(owner) {}
        void update() override
        {
            cleanDirty();
            if (m_owner.works()) m_owner.computeOutputs();
        }

    private:
        HexahedronElastoplasticFEMForceField& m_owner;
    };
    Outputs m_outputs{*this};
};

#if !defined(HEXAPLAST_HEXAHEDRONELASTOPLASTICFEMFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API HexahedronElastoplasticFEMForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
