// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Nodes and elements. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMechanicalObjectAttributes[] = {
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kState,
     .help = "Nodes. Those of the topology where at most one is given."},
    {.name = "velocity",
     .type = Type::kVectors3,
     .unit = "m/s",
     .access = Access::kState,
     .help = "At rest where not given."},
    {.name = "rest_position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kState,
     .help = "Undeformed nodes; the transformed positions where not given."},
    {.name = "externalForce", .type = Type::kVectors3, .unit = "N", .help = "Constant nodal forces, one per node."},
    {.name = "scale3d", .type = Type::kVector3, .initial = "1 1 1", .help = "Applied first to the positions."},
    {.name = "rotation",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "deg",
     .help = "About x, then y, then z; applied second."},
    {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
    {.name = "topology",
     .type = Type::kLink,
     .help = "Source of the nodes; the topology of the node (or of the nearest one above) where it is not given."},
    {.name = "showObject",
     .type = Type::kBool,
     .initial = "false",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
    {.name = "showObjectScale",
     .type = Type::kReal,
     .initial = "0.1",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
};
inline constexpr Description kMechanicalObject{.class_name = "MechanicalObject",
                                               .category = "MechanicalState",
                                               .help = "Positions and velocities of the nodes.",
                                               .templates = kVec3Templates,
                                               .attributes = kMechanicalObjectAttributes};

inline constexpr Attribute kRegularGridTopologyAttributes[] = {
    {.name = "n",
     .type = Type::kIntegers,
     .initial = "2 2 2",
     .range = {.least = 2, .most = 2147483646},
     .help = "Nodes (not cells) along x, y, z."},
    {.name = "min", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Lowest corner."},
    {.name = "max", .type = Type::kVector3, .initial = "1 1 1", .unit = "m", .help = "Highest corner."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .aliases = "points",
     .access = Access::kOutput,
     .help = "Nodes: i + nx (j + ny k)."},
    {.name = "hexahedra",
     .type = Type::kHexahedra,
     .aliases = "hexas",
     .access = Access::kOutput,
     .help = "Cells, x fastest."},
};
inline constexpr Description kRegularGridTopology{.class_name = "RegularGridTopology",
                                                  .category = "Topology",
                                                  .help = "A box cut into equal cells.",
                                                  .attributes = kRegularGridTopologyAttributes};

}  // namespace hexaplast::attributes
