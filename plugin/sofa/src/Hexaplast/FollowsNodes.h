// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/fields.h>

#include <span>
#include <string>

namespace hexaplast
{
class Body;
}

namespace hexaplast::sofa_plugin
{

/// A component of ours that acts on nodes, and goes on where they split: some of a state become several at one place.
class FollowsNodes
{
public:
    virtual ~FollowsNodes() = default;

    /// The nodes of a state are others than before: those of body.mesh(), copies of initial ones (body.copies()).
    /// splitFrom: of the last ones, which have come since, the one that each was split from; empty where a saved state
    /// has been taken.
    virtual void nodesChanged(const MechanicalState& state, const Body& body, std::span<const int> splitFrom) = 0;

    /// Why nodes cannot split where it acts; empty: they can.
    virtual std::string cannotFollow() const { return {}; }
};

/// The body that nodes of a state have split with; null: none has.
HEXAPLAST_SOFA_API const Body* splitBodyOf(const sofa::core::behavior::BaseMechanicalState& state);

}  // namespace hexaplast::sofa_plugin
