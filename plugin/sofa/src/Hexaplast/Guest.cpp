// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/Guest.h>
#include <sofa/component/topology/container/grid/SparseGridTopology.h>

#include "components/components.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

constexpr attributes::Description kState{
    .class_name = "MechanicalState", .category = "MechanicalState", .help = "The state of the host.", .templates = ""};
constexpr attributes::Description kTopology{
    .class_name = "Topology", .category = "Topology", .help = "The topology of the host.", .templates = ""};

using sofa::component::topology::container::grid::SparseGridTopology;

/// The hexahedra of a SOFA topology, and how full a sparse grid says they are. Their nodes are those of the state.
class Topology final : public scene::Topology
{
public:
    explicit Topology(MeshTopology& source) : scene::Topology(kTopology)
    {
        for (const auto& hexahedron : source.getHexahedra())
        {
            Hexahedron& corners = m_hexahedra.emplace_back();
            for (std::size_t a = 0; a < corners.size(); ++a) corners[a] = static_cast<int>(hexahedron[a]);
        }
        if (auto* grid = dynamic_cast<SparseGridTopology*>(&source))
            for (sofa::Index e = 0; e < m_hexahedra.size(); ++e) m_fill.push_back(grid->getStiffnessCoef(e));
    }

    const PointArray& positions() override { return m_positions; }
    const std::vector<Hexahedron>& hexahedra() override { return m_hexahedra; }
    std::span<const double> fill() override { return m_fill; }

private:
    PointArray m_positions = PointArray(0, 3);
    std::vector<Hexahedron> m_hexahedra;
    std::vector<double> m_fill;
};

}  // namespace

/// Nodes of a SOFA state, as they were when they were copied last.
class Guest::State final : public scene::MechanicalState
{
public:
    explicit State(const sofa_plugin::MechanicalState& source)
        : scene::MechanicalState(kState), m_restPositions(view(source.readRestPositions().ref()))
    {
    }

    PointArray& positions() override { return m_positions; }
    PointArray& velocities() override { return m_velocities; }
    const PointArray& rest_positions() const override { return m_restPositions; }
    void add_external_force(Points) const override {}  // SOFA's own business

private:
    PointArray m_positions, m_velocities, m_restPositions;
};

const scene::Factory& guests()
{
    static const scene::Factory factory = []
    {
        scene::Factory made;
        components::add_bodies(made);
        return made;
    }();
    return factory;
}

Guest::Guest(SofaComponent& host, const attributes::Description& description, AttributeData& attributes,
             sofa_plugin::MechanicalState* state, MeshTopology* topology)
    : m_host(host), m_attributes(attributes), m_sofaState(state)
{
    const scene::Place place = place_of(host);
    const auto introduce = [&](scene::Object& object, const std::string& name)
    { object.introduce(name, place, m_scene.diagnostics()); };
    scene::Node& root = m_scene.root();
    introduce(root, "root");
    if (state)
    {
        auto stand_in = std::make_unique<State>(*state);
        m_state = stand_in.get();
        introduce(root.add(std::move(stand_in)), state->getName());
        copy_positions();
    }
    if (topology) introduce(root.add(std::make_unique<Topology>(*topology)), topology->getName());
    m_component = &root.add(guests().make(description.class_name));
    introduce(*m_component, host.getName());

    attributes.give_all_to(*m_component);
    if (const auto* context = host.getContext())
    {
        root.find_data("dt")->give(double{context->getDt()}, place);
    }
    m_scene.init();
    pass_on_warnings();
}

void Guest::follow_attributes()
{
    m_attributes.give_to(*m_component);
    m_component->follow_inputs();
    pass_on_warnings();
}

void Guest::begin_step(double time, double dt)
{
    m_attributes.give_to(*m_component);
    m_scene.root().clock().time = time;
    m_scene.root().clock().dt = dt;
    copy_positions();
    scene::begin_step(m_scene.root());
    pass_on_warnings();
}

void Guest::end_step(double dt)
{
    copy_positions();
    scene::end_step(m_scene.root(), dt);
    m_scene.root().clock().time += dt;
    pass_on_warnings();
}

void Guest::reset()
{
    m_scene.reset();
    copy_positions();
}

void Guest::copy_positions()
{
    if (!m_state) return;
    m_state->positions() = view(m_sofaState->readPositions().ref());
    m_state->velocities() = view(m_sofaState->readVelocities().ref());
}

void Guest::pass_on_warnings()
{
    for (const scene::Message& message : m_scene.diagnostics().take_warnings()) msg_warning(&m_host) << message.text;
}

}  // namespace hexaplast::sofa_plugin
