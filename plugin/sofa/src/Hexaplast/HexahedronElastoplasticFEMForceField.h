// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/Guest.h>
#include <Hexaplast/PartForceField.h>
#include <sofa/core/objectmodel/DDGNode.h>
#include <sofa/core/objectmodel/Link.h>

#include <vector>

namespace hexaplast::sofa_plugin
{

/// Hexahedral corotational finite elements that stretch, yield and stay stretched. Plastic flow happens once per time
/// step, at AnimateEndEvent. Attributes and outputs: plugin/attributes/hexaplast.hpp.
class HEXAPLAST_SOFA_API HexahedronElastoplasticFEMForceField final : public PartForceField<Vec3Types>
{
public:
    SOFA_CLASS(HexahedronElastoplasticFEMForceField, SOFA_TEMPLATE(PartForceField, Vec3Types));
    using Inherit = PartForceField<Vec3Types>;

    /// What scenes give as template.
    static std::string GetCustomTemplateName() { return Vec3Types::Name(); }

    sofa::core::objectmodel::Data<bool> d_drawMaterialShape;  ///< draws the edges of the shape without forces
    sofa::core::objectmodel::SingleLink<HexahedronElastoplasticFEMForceField, MeshTopology,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_topology;  ///< the hexahedra

    void init() override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;
    void handleTopologyChange(sofa::core::topology::Topology* changed) override;

    bool hasPart() const override { return m_guest.has_value(); }
    bool describe(double factor, MatrixFreeSystem& system) const override { return guest().describe(factor, system); }

    /// The body; null before init and after an error.
    const Body* body() const { return m_guest ? guest().body() : nullptr; }

protected:
    HexahedronElastoplasticFEMForceField();

    void makePart() override;
    void updatePart() override { m_guest->follow_attributes(); }
    void resetPart() override;
    void beginStep(SReal time, SReal dt) override { m_guest->begin_step(time, dt); }
    void endStep(SReal dt) override;
    void addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f) override { guest().add_force(time, x, v, f); }
    void addStiffnessProduct(double factor, ConstPoints dx, Points df) const override
    {
        guest().add_stiffness_product(factor, dx, df);
    }
    void addStiffnessBlocks(double factor, BlockMatrix& A) const override { guest().add_stiffness_blocks(factor, A); }
    std::optional<double> energy(SReal time, ConstPoints x) const override;

private:
    scene::ForceField& guest() const { return m_guest->as<scene::ForceField>(); }

    /// Hexahedra that went in the latest step leave the topology, where that can be.
    void tearTopology();

    /// Outputs per hexahedron come in the order of the body, which keeps those that are gone: puts them in the order of
    /// the topology.
    void orderAsTheTopology();

    AttributeData m_attributes;
    mutable std::optional<Guest> m_guest;
    std::vector<int> m_original;  // number that each hexahedron of the topology has in the body

    /// Stands before the outputs in SOFA's graph of dependencies, so that they are computed when somebody reads them.
    class Outputs final : public sofa::core::objectmodel::DDGNode
    {
    public:
        explicit Outputs(HexahedronElastoplasticFEMForceField& owner) : m_owner(owner) {}
        void update() override;

    private:
        HexahedronElastoplasticFEMForceField& m_owner;
    };
    Outputs m_outputs{*this};
};

}  // namespace hexaplast::sofa_plugin
