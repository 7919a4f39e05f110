// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/fields.h>

#include <memory>
#include <span>

namespace hexaplast::parts
{
class HexahedralBody;
}

namespace hexaplast::sofa_plugin
{

using SharedBody = std::shared_ptr<const parts::HexahedralBody>;

/// A component of ours that acts on nodes, and goes on where they split: some of a state become several at one place.
class FollowsNodes
{
public:
    virtual ~FollowsNodes() = default;

    /// The nodes of a state are others than before: those of the body's mesh, copies of initial ones (Body::copies).
    /// Whoever refers to the copies keeps the body. splitFrom: of the last nodes, which have come since, the one that
    /// each was split from; empty where a saved state has been taken.
    virtual void nodesChanged(const MechanicalState& state, const SharedBody& body, std::span<const int> splitFrom) = 0;
};

/// The body of a field on a state; null: there is none. Then the one whose nodes have split.
HEXAPLAST_SOFA_API SharedBody bodyOn(const sofa::core::behavior::BaseMechanicalState& state);
HEXAPLAST_SOFA_API SharedBody splitBodyOn(const sofa::core::behavior::BaseMechanicalState& state);

/// Lets a body on a state take a saved state that has been given to it: its nodes may split there, which what acts on
/// them comes after.
HEXAPLAST_SOFA_API void takeGivenStateOfBodyOn(const sofa::core::behavior::BaseMechanicalState& state);

}  // namespace hexaplast::sofa_plugin
