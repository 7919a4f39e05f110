// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/Followers.h>
#include <Hexaplast/FollowsNodes.h>
#include <Hexaplast/errors.h>
#include <sofa/component/constraint/projective/FixedProjectiveConstraint.h>
#include <sofa/component/constraint/projective/LinearMovementProjectiveConstraint.h>
#include <sofa/component/constraint/projective/PartialLinearMovementProjectiveConstraint.h>
#include <sofa/component/mapping/linear/BarycentricMapping.h>
#include <sofa/component/topology/container/dynamic/HexahedronSetTopologyContainer.h>
#include <sofa/core/CollisionModel.h>
#include <sofa/core/behavior/StateAccessor.h>
#include <sofa/core/topology/TopologicalMapping.h>

#include <algorithm>

#include "hexaplast/body.hpp"
#include "parts/spread_nodes.hpp"

namespace hexaplast::sofa_plugin
{

namespace
{

using sofa::core::behavior::BaseMechanicalState;
using FixedConstraint = sofa::component::constraint::projective::FixedProjectiveConstraint<Vec3Types>;
using MovementConstraint = sofa::component::constraint::projective::LinearMovementProjectiveConstraint<Vec3Types>;
using PartialMovementConstraint =
    sofa::component::constraint::projective::PartialLinearMovementProjectiveConstraint<Vec3Types>;
using BarycentricMapping = sofa::component::mapping::linear::BarycentricMapping<Vec3Types, Vec3Types>;
using sofa::component::topology::container::dynamic::HexahedronSetTopologyContainer;
using BodyField = HexahedronElastoplasticFEMForceField;

/// Whether what a component does refers to nodes of a state, or to its topology.
bool actsOn(SofaComponent& component, const BaseMechanicalState& state, const MeshTopology& topology)
{
    if (auto* accessor = dynamic_cast<sofa::core::behavior::StateAccessor*>(&component))
    {
        const auto& states = accessor->getMechanicalStates();
        return std::any_of(states.begin(), states.end(), [&](const auto& each) { return &*each == &state; });
    }
    if (auto* mapping = dynamic_cast<sofa::core::BaseMapping*>(&component))
    {
        const auto from = mapping->getFrom();
        return std::find(from.begin(), from.end(), &state) != from.end();
    }
    if (auto* mapping = dynamic_cast<sofa::core::topology::TopologicalMapping*>(&component))
        return mapping->getFrom() == &topology;
    return dynamic_cast<sofa::core::CollisionModel*>(&component) &&
           component.getContext()->getMechanicalState() == &state;
}

/// Of SOFA: that goes on where nodes split, with what Followers::follow does. A mapping for the eye finds its points
/// anew (TopologyBarycentricMapper::processTopologicalChanges); what it moves is not cut.
bool isKnown(SofaComponent& component)
{
    if (auto* mapping = dynamic_cast<BarycentricMapping*>(&component)) return !mapping->isMechanical();
    return dynamic_cast<sofa::component::mass::DiagonalMass<Vec3Types>*>(&component) ||
           dynamic_cast<FixedConstraint*>(&component) || dynamic_cast<MovementConstraint*>(&component) ||
           dynamic_cast<PartialMovementConstraint*>(&component);
}

std::vector<int> missingCopies(const sofa::type::vector<sofa::Index>& nodes, const NodeCopies& copies)
{
    return parts::missing_copies(wholeNumbers(nodes), copies);
}

/// Where the nodes of a constraint were at first, which it keeps of all nodes.
template <class Constraint>
void followMovement(Constraint& constraint, const NodeCopies& copies)
{
    for (const int copy : missingCopies(constraint.d_indices.getValue(), copies))
        constraint.addIndex(static_cast<sofa::Index>(copy));
    auto& first = constraint.x0;
    if (first.empty()) return;
    const std::vector<int>& initial = copies.initial();
    for (std::size_t n = first.size(); n < initial.size(); ++n)
        first.push_back(first[static_cast<std::size_t>(initial[n])]);
}

std::vector<double> massesOf(const sofa::component::mass::DiagonalMass<Vec3Types>& mass)
{
    return reals(mass.d_vertexMass.getValue());
}

BodyField* fieldOn(const BaseMechanicalState& state)
{
    for (BodyField* field : allBelow<BodyField>(*state.getContext()->getRootContext()))
        if (field->getMState() == &state && field->body()) return field;
    return nullptr;
}

}  // namespace

SharedBody bodyOn(const BaseMechanicalState& state)
{
    const BodyField* field = fieldOn(state);
    return field ? field->part() : nullptr;
}

SharedBody splitBodyOn(const BaseMechanicalState& state)
{
    const SharedBody body = bodyOn(state);
    return body && body->body().copies().is_split() ? body : nullptr;
}

void takeGivenStateOfBodyOn(const BaseMechanicalState& state)
{
    if (BodyField* field = fieldOn(state)) field->takeGivenState();
}

Followers::Followers(Field& field) : m_field(field)
{
    const auto refuse = [&](const SofaComponent& component, const std::string& why)
    {
        throw InputError(component.getClassName() + " '" + component.getPathName() + "' " + why + ": no joint of " +
                         field.getClassName() + " '" + field.getName() + "' can be opened");
    };
    auto& state = *field.getMState();
    auto& topology = *field.l_topology;
    const auto isOfTopology = [&](const auto& component)
    {
        const auto* link = component.findLink("topology");
        return link && link->getLinkedBase() == &topology;
    };
    const auto* modifier = field.modifier();
    if (!dynamic_cast<HexahedronSetTopologyContainer*>(&topology) || !modifier || isInvalid(*modifier))
        refuse(topology, "must be a HexahedronSetTopologyContainer with a HexahedronSetTopologyModifier in its node");
    if (modifier->removeIsolated.getValue()) refuse(*modifier, "would take nodes away: removeIsolated must be false");
    if (!isOfTopology(state)) refuse(state, "has its nodes from another topology, and does not see nodes that come");
    if (followsAnother(state)) refuse(state, "follows another state");
    for (SofaComponent* component : allBelow<SofaComponent>(*field.getContext()->getRootContext()))
    {
        if (component == &field || component == &state || !actsOn(*component, state, topology)) continue;
        m_acting.push_back(component);
        if (dynamic_cast<BodyField*>(component)) refuse(*component, "is a second body on the same nodes");
        if (dynamic_cast<FollowsNodes*>(component)) continue;
        if (!isKnown(*component)) refuse(*component, "does not know of nodes that split");
        auto* mass = dynamic_cast<DiagonalMass*>(component);
        if (!mass) continue;
        if (!isOfTopology(*mass)) refuse(*mass, "has its hexahedra from another topology");
        const std::vector<double> masses = massesOf(*mass);
        if (!parts::are_of_density(mass->getMassDensity(), view(state.readRestPositions().ref()), hexahedraOf(topology),
                                   masses))
            m_masses.emplace_back(mass, parts::summed(masses, field.body()->copies()));
    }
}

void Followers::follow(std::span<const int> splitFrom)
{
    const Body& body = *m_field.body();
    for (SofaComponent* component : allBelow<SofaComponent>(*m_field.getContext()->getRootContext()))
        if (auto* follower = dynamic_cast<FollowsNodes*>(component))
            attempt(*component, [&] { follower->nodesChanged(*m_field.getMState(), m_field.part(), splitFrom); });
    for (SofaComponent* component : m_acting)
    {
        if (auto* fixed = dynamic_cast<FixedConstraint*>(component))
            for (const int copy : missingCopies(fixed->d_indices.getValue(), body.copies()))
                fixed->addConstraint(static_cast<sofa::Index>(copy));
        if (auto* moved = dynamic_cast<MovementConstraint*>(component)) followMovement(*moved, body.copies());
        if (auto* moved = dynamic_cast<PartialMovementConstraint*>(component)) followMovement(*moved, body.copies());
    }
    for (const auto& [mass, ofInitial] : m_masses)
    {
        const std::vector<double> ofCopies = parts::shared_out(ofInitial, body.copies());
        mass->d_vertexMass.setValue({ofCopies.begin(), ofCopies.end()});
    }
}

}  // namespace hexaplast::sofa_plugin
