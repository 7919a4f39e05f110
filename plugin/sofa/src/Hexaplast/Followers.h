// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <sofa/component/mass/DiagonalMass.h>

#include <span>
#include <utility>
#include <vector>

namespace hexaplast::sofa_plugin
{

/// What acts on the nodes of a body beside it, when joints of it open: components of ours, and those of SOFA that are
/// known to go on with nodes that split.
class HEXAPLAST_SOFA_API Followers
{
public:
    using Field = HexahedronElastoplasticFEMForceField;

    /// Before the nodes split. Throws InputError where something cannot follow, and names it.
    explicit Followers(Field& field);

    /// They have, in the state and in its topology. splitFrom: as in FollowsNodes.
    void follow(std::span<const int> splitFrom);

private:
    using DiagonalMass = sofa::component::mass::DiagonalMass<Vec3Types>;

    Field& m_field;
    std::vector<SofaComponent*> m_acting;
    std::vector<std::pair<DiagonalMass*, std::vector<double>>> m_masses;  ///< that nodes have, and of initial ones
};

}  // namespace hexaplast::sofa_plugin
