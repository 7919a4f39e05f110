// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/ForceOnState.h>
#include <Hexaplast/dependencies.h>
#include <sofa/component/topology/container/dynamic/HexahedronSetTopologyModifier.h>
#include <sofa/core/objectmodel/Link.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "parts/hexahedral_body.hpp"

namespace hexaplast::sofa_plugin
{

class BladeController;
class MaterialRegion;

/// Hexahedral corotational finite elements that stretch, yield and stay stretched. Plastic flow happens once per time
/// step, at AnimateEndEvent. Data and outputs: the rows of Material and Settings, and plugin/attributes/hexaplast.hpp.
class HEXAPLAST_SOFA_API HexahedronElastoplasticFEMForceField : public ForceOnState
{
public:
    SOFA_CLASS(HexahedronElastoplasticFEMForceField, ForceOnState);
    using Inherit = ForceOnState;
    using VecReal = sofa::type::vector<SReal>;

    Data<bool> d_drawPlasticRestShape{
        initData(&d_drawPlasticRestShape, false, "drawPlasticRestShape",
                 "Draws the edges of the plastic rest shape, which the body has without load, up to a rigid motion.")};
    sofa::core::objectmodel::SingleLink<HexahedronElastoplasticFEMForceField, MeshTopology,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_topology{initLink("topology", helpOf("topology"))};

    void bwdInit() override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;
    void handleEvent(sofa::core::objectmodel::Event* event) override;
    void handleTopologyChange(sofa::core::topology::Topology* changed) override;

    bool hasPart() const override { return m_body != nullptr; }

    /// The body; null before init and after an error.
    const Body* body() const { return m_body ? &m_body->body() : nullptr; }
    /// Whoever refers to the body keeps it by this, and looks whether it is that one still.
    std::shared_ptr<const parts::HexahedralBody> part() const { return m_body; }

    /// By which nodes and hexahedra of its topology come and go; null: it has none.
    using TopologyModifier = sofa::component::topology::container::dynamic::HexahedronSetTopologyModifier;
    TopologyModifier* modifier() const;

    /// That a blade is to be asked at the end of the present step.
    void expect(BladeController& blade);

protected:
    HexahedronElastoplasticFEMForceField();

    void initPart() override;
    void makePart() override;
    void updatePart() override;
    bool othersHaveChanged() override;
    void resetPart() override;
    void savePart(std::ostream& out) const override { m_body->body().save(out); }
    void loadPart(std::istream& in) override;
    void beginStep(SReal time, SReal dt) override;
    void endStep(SReal dt) override;
    parts::Force& forces() const override { return m_elasticity; }
    bool addStiffness(double factor, MatrixFreeSystem& system) const override
    {
        m_body->body().add_operator(factor, system);
        return true;
    }

private:
    /// Of the body, on its state.
    struct Elasticity final : parts::Force
    {
        explicit Elasticity(const std::shared_ptr<parts::HexahedralBody>& of) : body(of) {}

        void add_force(double, const Pair<ConstPoints>& x, const Pair<ConstPoints>&, Pair<Points> f) override
        {
            body->body().linearize(x.first);
            body->body().add_force(f.first);
        }
        void add_load(double, const Pair<ConstPoints>&, const Pair<ConstPoints>&, Pair<Points>) const override {}
        void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override
        {
            body->body().add_stiffness_product(factor, dx.first, df.first);
        }
        void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2>) const override
        {
            body->body().add_stiffness_blocks(factor, A);
        }
        std::optional<double> potential_energy(double, ConstPoints x) const override { return body->body().energy(x); }

        const std::shared_ptr<parts::HexahedralBody>& body;
    };

    /// Throws InputError where a region cannot be.
    parts::HexahedralBodyOptions options(const std::vector<Hexahedron>& hexahedra) const;

    /// Those of this body, in the order of the scene.
    std::vector<MaterialRegion*> regions() const;

    /// Throws InputError where its topology has changed in a way that it cannot follow.
    void requireTopology() const;

    /// Removes from the body what is gone from its topology, which has no way back.
    void followTopology();

    /// Hexahedra that went in the latest step leave the topology, where that can be.
    void tearTopology();

    /// Opens what blades and tears have opened in the step (Body::open): nodes split in the state and in the topology,
    /// and what acts on them follows. Where something cannot, the body stays as it was, and says so.
    void openJoints();

    /// The topology has the nodes and corners of the body from now on. before: corners of its hexahedra until now.
    void splitTopology(const std::vector<Hexahedron>& before, std::span<const int> splitFrom);

    /// Values per hexahedron in the order of the topology.
    std::vector<double> inTopology(const std::vector<double>& ofBody) const;
    void setOutputsDirty();

    std::shared_ptr<parts::HexahedralBody> m_body;
    mutable Elasticity m_elasticity{m_body};
    std::vector<double> m_fill;   ///< fraction of each hexahedron of a sparse grid that is full
    std::vector<int> m_original;  ///< number that each hexahedron of the topology has in the body
    std::vector<int> m_coming;    ///< of hexahedra that come again with other nodes
    std::vector<sofa::core::sptr<BladeController>> m_blades;  ///< that move in the present step
    std::vector<MaterialRegion*> m_regions;                   ///< seen last, to be compared alone
    bool m_topologyIsLost = false;
    bool m_topologyHasChanged = false;
    bool m_isSplitting = false;                       ///< the topology changes by the body
    bool m_hasFlowed = false;                         ///< in the present step
    bool m_hasAsked = false;                          ///< what acts beside it, whether it can follow
    bool m_regionsAreReady = false;                   ///< they may stand behind the body, and what they follow too
    std::vector<std::unique_ptr<Outputs>> m_outputs;  ///< each computed alone: some take an equilibrium
};

}  // namespace hexaplast::sofa_plugin
