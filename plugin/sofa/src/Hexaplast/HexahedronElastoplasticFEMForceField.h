// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/GuestForceField.h>
#include <sofa/core/objectmodel/DDGNode.h>
#include <sofa/core/objectmodel/Link.h>

#include <vector>

namespace hexaplast::sofa_plugin
{

/// Hexahedral corotational finite elements that stretch, yield and stay stretched. Plastic flow happens once per time
/// step, at AnimateEndEvent. Attributes and outputs: plugin/attributes/hexaplast.hpp.
class HEXAPLAST_SOFA_API HexahedronElastoplasticFEMForceField final : public GuestForceField
{
public:
    SOFA_CLASS(HexahedronElastoplasticFEMForceField, GuestForceField);

    sofa::core::objectmodel::Data<bool> d_drawMaterialShape;  ///< draws the edges of the shape without forces
    sofa::core::objectmodel::SingleLink<HexahedronElastoplasticFEMForceField, MeshTopology,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_topology;  ///< the hexahedra

    void init() override;
    void reset() override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;
    void handleTopologyChange(sofa::core::topology::Topology* changed) override;

protected:
    HexahedronElastoplasticFEMForceField();

    MeshTopology* topology() override { return l_topology.get(); }
    void stepEnded() override;

private:
    /// Hexahedra that went in the latest step leave the topology, where that can be.
    void tearTopology();

    /// Outputs per hexahedron come in the order of the body, which keeps those that are gone: puts them in the order of
    /// the topology.
    void orderAsTheTopology();

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
