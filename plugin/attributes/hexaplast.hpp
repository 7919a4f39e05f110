// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/contact.hpp"
#include "attributes/parts.hpp"
#include "attributes/rows.hpp"

/// Our own components, the same in every host.
namespace hexaplast::attributes {

/// What a body has besides what it is made of.
inline constexpr Attribute kBodyAttributes[] = {
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Stiffness-proportional damping in the system matrix alone, besides the solver's own."},
    {.name = "topology", .type = Type::kLink, .help = "The hexahedra; default: the nearest topology."},
    {.name = "plasticStrain",
     .type = Type::kReals,
     .access = Access::kOutput,
     .help = "Accumulated plastic strain of each hexahedron: mean over its corners."},
    {.name = "presentYieldStress",
     .type = Type::kReals,
     .unit = "Pa",
     .access = Access::kOutput,
     .help = "Yield stress of each hexahedron after hardening: maximum of its corners."},
    {.name = "stressNorm",
     .type = Type::kReals,
     .unit = "Pa",
     .access = Access::kOutput,
     .help = "Norm of the present stress of each hexahedron, as yieldNorm says: maximum of its corners; 0 after its "
             "removal. Without load and supports that is residual stress."},
    {.name = "volumeRatio",
     .type = Type::kReals,
     .access = Access::kOutput,
     .help = "Volume of each hexahedron without load over its initial volume; 0 after its removal."},
    {.name = "volume",
     .type = Type::kReals,
     .unit = "m^3",
     .access = Access::kOutput,
     .help = "Present volume of each hexahedron; 0 after its removal."},
    {.name = "plasticVolume",
     .type = Type::kReals,
     .unit = "m^3",
     .access = Access::kOutput,
     .help = "Volume of each hexahedron without load; 0 after its removal."},
    {.name = "plasticRestPositions",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Plastic rest positions of the nodes: where they would be without load, up to a rigid motion."},
    {.name = "removed",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "Removed hexahedra, in order of removal."},
};
inline const std::vector<Attribute> kHexahedronElastoplasticAttributes = joined(body_attributes(), kBodyAttributes);
inline const Description kHexahedronElastoplasticFEMForceField{
    .class_name = "HexahedronElastoplasticFEMForceField",
    .category = "ForceField",
    .help = "Hexahedral corotational elastoplastic finite elements. The defaults make an elastic body.",
    .templates = kVec3Templates,
    .attributes = kHexahedronElastoplasticAttributes};

/// Where a region is, besides what it is made of.
inline constexpr Attribute kRegionPlaceAttributes[] = {
    {.name = "hexahedra",
     .type = Type::kHexahedra,
     .range = kIndex,
     .help = "Its hexahedra by their nodes: @roi.hexahedraInROI."},
    {.name = "indices",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "In place of that their numbers: @roi.hexahedronIndices."},
    {.name = "body", .type = Type::kLink, .help = "Default: the nearest one."},
};
inline const std::vector<Attribute> kMaterialRegionAttributes = joined(kRegionPlaceAttributes, region_attributes());
inline const Description kMaterialRegion{
    .class_name = "MaterialRegion",
    .category = "MaterialRegion",
    .help =
        "Gives some hexahedra of a body values of their own. A value that is not given is that of the body; of "
        "overlapping regions the last one in the scene counts. It may stand before or behind its body. Values may "
        "change during a run. Lists have one value per hexahedron of the region.",
    .attributes = kMaterialRegionAttributes};

}  // namespace hexaplast::attributes
