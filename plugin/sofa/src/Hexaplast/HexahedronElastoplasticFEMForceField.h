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

    Data<VecReal> d_youngModulus;      ///< [Pa] one, or one per hexahedron
    Data<VecReal> d_poissonRatio;      ///< one, or one per hexahedron
    DataWord d_law;                    ///< how stress follows from stretch
    Data<SReal> d_mooneyFraction;      ///< of the second constant of mooneyRivlin
    Data<VecReal> d_yieldStress;       ///< [Pa] one, or one per hexahedron; it never yields where not set
    DataWord d_yieldNorm;              ///< norm of the stress that is compared with yieldStress
    Data<SReal> d_plasticFlowRate;     ///< [1/s] of stretch in excess of yield
    Data<SReal> d_rotationYield;       ///< [rad] at which rotation begins to flow
    Data<SReal> d_rotationFlowRate;    ///< [1/s] of rotation in excess of rotationYield
    DataWord d_rotationPlasticity;     ///< how rotation becomes permanent
    DataWord d_rotationFrame;          ///< what rotations are measured against
    Data<SReal> d_hardening;           ///< growth of the yield limits with the flow
    Data<SReal> d_volumeRestitution;   ///< [1/s] at which volume is restored
    Data<SReal> d_inversionThreshold;  ///< fraction of its volume below which a hexahedron does not flow
    Data<SReal> d_fractureStress;      ///< [Pa] it does not tear by stress where not set
    Data<SReal> d_fractureStretch;     ///< it does not tear by stretch where not set
    DataWord d_bending;                ///< strain of the samples
    Data<SReal> d_blendWeight;         ///< of the corner in samples of blended
    DataWord d_volumetric;             ///< what resists a change of volume
    DataWord d_recovery;               ///< what unfolds folded hexahedra
    Data<SReal> d_recoveryStrength;    ///< of its springs
    Data<SReal> d_recoveryFrom;        ///< volume ratio at a corner where they begin
    Data<SReal> d_recoveryFull;        ///< and where they have their full strength
    DataWord d_averaging;              ///< how rest shapes become one
    Data<int> d_averagingSteps;        ///< per time step
    Data<SReal> d_averagingTolerance;  ///< on the relative residual of an averaging step
    DataWord d_precision;              ///< of stiffness products

    Data<VecReal> d_plasticStrain;                                      ///< output, of each hexahedron
    Data<VecReal> d_presentYieldStress;                                 ///< output [Pa], of each hexahedron
    Data<VecReal> d_volumeRatio;                                        ///< output, of each hexahedron
    Data<VecReal> d_volume;                                             ///< output, of each hexahedron [m^3]
    Data<VecReal> d_plasticVolume;                                      ///< output, of each hexahedron [m^3]
    Data<sofa::type::vector<sofa::type::Vec3>> d_plasticRestPositions;  ///< output [m]: of the nodes
    Data<sofa::type::vector<sofa::Index>> d_removed;                    ///< output: hexahedra that are gone

    Data<bool> d_drawPlasticRestShape;  ///< draws the edges of the shape without forces
    sofa::core::objectmodel::SingleLink<HexahedronElastoplasticFEMForceField, MeshTopology,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_topology;  ///< the hexahedra

    void init() override;
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
    auto fromRow(Data<T>& data, std::string_view name);

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
