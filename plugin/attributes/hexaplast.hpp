// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/contact.hpp"
#include "attributes/parts.hpp"
#include "attributes/rows.hpp"

/// Our own components, the same in every host.
namespace hexaplast::attributes {

/// What a body has besides what it is made of.
inline constexpr std::array kBodyAttributes = {
    kForceRayleigh,
    one_of("device", {.initial = "cpu", .words = "cpu cuda emulation"},
           "What computes the body: cuda is a graphics card, emulation its kernels on the CPU. Both need precision = "
           "mixed, and refuse what docs/gpu.md names. Cannot change during a run."),
    link("topology", "The hexahedra; default: the nearest topology."),
    output(reals("plasticStrain", "Accumulated plastic strain of each hexahedron: mean over its corners.")),
    output(reals("presentYieldStress", {.unit = "Pa"},
                 "Yield stress of each hexahedron after hardening: maximum of its corners.")),
    output(reals("stressNorm", {.unit = "Pa"},
                 "Norm of the present stress of each hexahedron, as yieldNorm says: maximum of its corners; 0 after "
                 "its removal. Without load and supports that is residual stress.")),
    output(
        reals("volumeRatio", "Volume of each hexahedron without load over its initial volume; 0 after its removal.")),
    output(reals("volume", {.unit = "m^3"}, "Present volume of each hexahedron; 0 after its removal.")),
    output(reals("plasticVolume", {.unit = "m^3"}, "Volume of each hexahedron without load; 0 after its removal.")),
    output(vectors3("plasticRestPositions", {.unit = "m"},
                    "Plastic rest positions of the nodes: where they would be without load, up to a rigid motion.")),
    output(integers("removed", "Removed hexahedra, in order of removal.")),
};
inline const std::vector<Attribute> kHexahedronElastoplasticAttributes = joined(body_attributes(), kBodyAttributes);
inline const Description kHexahedronElastoplasticFEMForceField =
    force_field("HexahedronElastoplasticFEMForceField",
                "Hexahedral corotational elastoplastic finite elements. The defaults make an elastic body.",
                kHexahedronElastoplasticAttributes);

/// Where a region is, besides what it is made of.
inline constexpr std::array kRegionPlaceAttributes = {
    hexahedra("hexahedra", {.range = kIndex}, "Its hexahedra by their nodes: @roi.hexahedraInROI."),
    indices("indices", "In place of that their numbers: @roi.hexahedronIndices."),
    link("body", "Default: the nearest one."),
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
