// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/rows.hpp"
#include "attributes/stock/ignored.hpp"
#include "attributes/stock/masses.hpp"

/// SOFA's elastic bodies. See stock.hpp.
namespace hexaplast::attributes {

/// The attributes that all of them have. method: with its words.
inline std::vector<Attribute> dense_hexahedra_attributes(const Attribute& method) {
  return {
      body_attribute("youngModulus"),
      body_attribute("poissonRatio"),
      method,
      {.name = "rayleighStiffness",
       .type = Type::kReal,
       .initial = "0",
       .unit = "s",
       .range = kNotNegative,
       .help = "Stiffness-proportional damping of this body in the system matrix alone, besides the solver's own."},
      {.name = "topology",
       .type = Type::kLink,
       .help = "The hexahedra; default: the topology of the node, or of the nearest one above."},
  };
}

inline const std::vector<Attribute> kHexahedronFEMAttributes = joined(
    dense_hexahedra_attributes(
        {.name = "method",
         .type = Type::kWord,
         .initial = "large",
         .words = "large polar small",
         .help = "The frame of a hexahedron: `large` along its mean edge x and in the plane of its mean edges x and y, "
                 "`polar` by the polar decomposition of its three mean edges, `small` the axes of the world."}),
    std::vector<Attribute>{
        {.name = "updateStiffnessMatrix",
         .type = Type::kWord,
         .initial = "false",
         .words = "false 0",
         .help = "Only false here: the stiffness is that of the rest shape."},
        ignored_attribute("gatherPt", "Ignored here: for graphics processors."),
        ignored_attribute("gatherBsize", "Ignored here: for graphics processors."),
        visual_attribute("drawing"),
        visual_attribute("drawPercentageOffset"),
    });
inline const Description kHexahedronFEMForceField{
    .class_name = "HexahedronFEMForceField",
    .category = "ForceField",
    .help =
        "SOFA's elastic hexahedra, and its numbers: one stiffness matrix and one rotation for each. Fields and elastic "
        "energies of a run are those of a HexahedronElastoplasticFEMForceField of the same mesh and material, which "
        "makes no force; no energy balance is kept, as these forces have no potential. "
        "HexahedronElastoplasticFEMForceField in its place bends freely, does not lock, is several times as fast, and "
        "can flow.",
    .templates = kVec3Templates,
    .attributes = kHexahedronFEMAttributes};

inline const Description kParallelHexahedronFEMForceField{
    .class_name = "ParallelHexahedronFEMForceField",
    .category = "ForceField",
    .help = "The same as HexahedronFEMForceField, which uses all threads here as well.",
    .templates = kVec3Templates,
    .attributes = kHexahedronFEMAttributes};

inline const std::vector<Attribute> kHexahedralFEMAttributes =
    joined(dense_hexahedra_attributes({.name = "method",
                                       .type = Type::kWord,
                                       .initial = "large",
                                       .words = "large polar",
                                       .help = "The frame of a hexahedron, as in HexahedronFEMForceField."}),
           std::vector<Attribute>{ignored_attribute("hexahedronInfo", "Ignored here.")});
inline const Description kHexahedralFEMForceField{
    .class_name = "HexahedralFEMForceField",
    .category = "ForceField",
    .help =
        "SOFA's elastic hexahedra for topologies that change: as HexahedronFEMForceField, with the matrix of a cube "
        "along the axes of the world, of the edges that a hexahedron has, rounded to single precision. Boxes that are "
        "no cubes get other shear stiffness than HexahedronFEMForceField gives them, and hexahedra that lie askew are "
        "wrong, both as in SOFA. Where SOFA assembles the matrix it turns it the wrong way round; here products and "
        "matrix agree.",
    .templates = kVec3Templates,
    .attributes = kHexahedralFEMAttributes};

/// What the two have that are their own mass.
inline const std::vector<Attribute> kOwnMassAttributes = {
    {.name = "density",
     .type = Type::kReal,
     .initial = "1",
     .unit = "kg/m^3",
     .range = kPositive,
     .help = "Mass per volume; the volume is the product of the edges at corner 0."},
    {.name = "lumpedMass",
     .type = Type::kBool,
     .initial = "false",
     .help = "Whether each row of the mass matrix is summed on the diagonal."},
    kMassRayleigh,
    kSeparateGravity,
    ignored_attribute("massMatrices", "Ignored here: computed."),
    ignored_attribute("totalMass", "Ignored here: computed."),
    ignored_attribute("particleMasses", "Ignored here: computed."),
    ignored_attribute("lumpedMasses", "Ignored here: computed."),
};
inline const std::vector<Attribute> kHexahedronFEMAndMassAttributes =
    joined(kHexahedronFEMAttributes, kOwnMassAttributes);
inline const Description kHexahedronFEMForceFieldAndMass{
    .class_name = "HexahedronFEMForceFieldAndMass",
    .category = "ForceField",
    .help =
        "SOFA's HexahedronFEMForceField with a mass, and its numbers: every two corners of a hexahedron have the same "
        "entry in the mass matrix, 8/27 of its mass. A body that moves as a whole has the inertia of 19 times its "
        "mass, and its weight. HexahedronFEMForceField with a DiagonalMass has the inertia of its mass.",
    .templates = kVec3Templates,
    .attributes = kHexahedronFEMAndMassAttributes};
inline const std::vector<Attribute> kHexahedralFEMAndMassAttributes =
    joined(kHexahedralFEMAttributes, kOwnMassAttributes);
inline const Description kHexahedralFEMForceFieldAndMass{
    .class_name = "HexahedralFEMForceFieldAndMass",
    .category = "ForceField",
    .help =
        "SOFA's HexahedralFEMForceField with the mass of HexahedronFEMForceFieldAndMass. Where SOFA assembles its "
        "matrices they have the diagonal alone; here products and matrix agree.",
    .templates = kVec3Templates,
    .attributes = kHexahedralFEMAndMassAttributes};

}  // namespace hexaplast::attributes
