// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// SOFA's elastic tetrahedra and triangles. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kElasticAttributes[] = {
    {.name = "youngModulus",
     .type = Type::kReals,
     .initial = "5000",
     .unit = "Pa",
     .range = kPositive,
     .help = "One value, or one per element."},
    {.name = "poissonRatio",
     .type = Type::kReals,
     .initial = "0.45",
     .range = {.min = 0, .max = 0.5, .exclusive_max = true},
     .help = "One value, or one per element."},
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Stiffness-proportional damping in the system matrix alone, besides the solver's own."},
    {.name = "topology",
     .type = Type::kLink,
     .help = "The elements; default: the topology of the node, or of the nearest one above."},
};

inline constexpr Attribute kTetrahedronAttributes[] = {
    {.name = "method",
     .type = Type::kWord,
     .initial = "large",
     .words = "large polar small",
     .help =
         "The frame of a tetrahedron: `large` along its edge from corner 0 to 1 and in the plane of its corners 0, 1 "
         "and 2, `polar` by the polar decomposition of its edges from corner 0, `small` the axes of the world."},
    {.name = "updateStiffnessMatrix",
     .type = Type::kWord,
     .initial = "false",
     .words = "false 0",
     .help = "Only false here: the stiffness is that of the rest shape."},
    {.name = "plasticMaxThreshold",
     .type = Type::kReal,
     .initial = "0",
     .range = {.min = 0, .max = 0},
     .help = "Only 0 here: tetrahedra do not flow. HexahedronElastoplasticFEMForceField does."},
    ignored_attribute("plasticYieldThreshold", "Ignored here: tetrahedra do not flow."),
    ignored_attribute("plasticCreep", "Ignored here: tetrahedra do not flow."),
    ignored_attribute("computeGlobalMatrix", "Ignored here: it changes no result."),
    ignored_attribute("assembling", "Ignored here: it changes no result."),
    ignored_attribute("gatherPt", "Ignored here: for graphics processors."),
    ignored_attribute("gatherBsize", "Ignored here: for graphics processors."),
    ignored_attribute("computeVonMisesStress", "Ignored here: there are no stresses of tetrahedra."),
    visual_attribute("drawHeterogeneousTetra"),
    visual_attribute("showStressColorMap"),
    visual_attribute("showStressAlpha"),
    visual_attribute("showVonMisesStressPerNode"),
    visual_attribute("showVonMisesStressPerNodeColorMap"),
    visual_attribute("showVonMisesStressPerElement"),
    visual_attribute("showElementGapScale"),
};
inline constexpr auto kTetrahedronFEMAttributes = joined(kElasticAttributes, kTetrahedronAttributes);
inline constexpr Description kTetrahedronFEMForceField{
    .class_name = "TetrahedronFEMForceField",
    .category = "ForceField",
    .help =
        "SOFA's elastic tetrahedra, and its numbers: constant strain, one stiffness matrix and one rotation for "
        "each. Hexahedra of a topology without tetrahedra are cut into six each, as SOFA does. For comparison, and "
        "for scenes that have them: nothing flows or tears, and pictures show nothing of them.",
    .templates = kVec3Templates,
    .attributes = kTetrahedronFEMAttributes};

inline constexpr Attribute kTriangleMethod{
    .name = "method",
    .type = Type::kWord,
    .initial = "large",
    .words = "large",
    .help =
        "Only large here: each triangle has a frame along its edge from corner 0 to 1, and its strain is measured "
        "in the shape that it has now."};

inline constexpr Attribute kTriangularAttributes[] = {
    kTriangleMethod,
    ignored_attribute("hosfordExponant", "Visual: ignored here."),
    ignored_attribute("criteriaValue", "Visual: ignored here."),
    visual_attribute("showStressValue"),
    visual_attribute("showStressVector"),
    visual_attribute("showFracturableTriangles"),
    ignored_attribute("computePrincipalStress", "Ignored here: there are no stresses of triangles."),
};
inline constexpr auto kTriangularFEMAttributes = joined(kElasticAttributes, kTriangularAttributes);
inline constexpr Description kTriangularFEMForceField{
    .class_name = "TriangularFEMForceField",
    .category = "ForceField",
    .help =
        "SOFA's elastic membrane of triangles, and its numbers: plane stress, Young's modulus times thickness [N/m]. "
        "It does not resist bending. Of a grid every quad counts as two triangles.",
    .templates = kVec3Templates,
    .attributes = kTriangularFEMAttributes};

inline constexpr Attribute kTriangleAttributes[] = {
    kTriangleMethod,
    {.name = "thickness",
     .type = Type::kReal,
     .initial = "1",
     .unit = "m",
     .range = kPositive,
     .help = "Of the membrane."},
    {.name = "planeStrain",
     .type = Type::kBool,
     .initial = "false",
     .help = "Whether nothing gets thinner (plane strain), or thickness is free (plane stress)."},
};
inline constexpr auto kTriangleFEMAttributes = joined(kElasticAttributes, kTriangleAttributes);
inline constexpr Description kTriangleFEMForceField{
    .class_name = "TriangleFEMForceField",
    .category = "ForceField",
    .help =
        "SOFA's elastic membrane of triangles with a thickness, and its numbers. It does not resist bending. Quads "
        "of a topology without triangles count as two triangles each.",
    .templates = kVec3Templates,
    .attributes = kTriangleFEMAttributes};

}  // namespace hexaplast::attributes
