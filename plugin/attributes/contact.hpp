// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/path.hpp"

/// Contact, the same in every host.
namespace hexaplast::attributes {

inline constexpr std::array kContactLaw = {
    real("tangentialStiffness", {.unit = "Pa/m", .range = kNotNegative, .group = "Contact"},
         "Shear stress per displacement of tissue that sticks. Default: contactStiffness; at most 200 times the "
         "default of that."),
    real("friction", {.initial = "0", .range = kNotNegative, .group = "Contact"},
         "Tissue slips where the tangential force exceeds this times the normal force."),
    real("contactDistance", {.initial = "0", .unit = "m", .range = kNotNegative, .group = "Contact"},
         "Contact begins at this distance from the surface: at most half of the mean edge."),
    real("damping", {.initial = "0", .unit = "Pa s/m", .range = kNotNegative, .group = "Contact"},
         "Pressure per speed of approach; at most 200 times the default of contactStiffness times dt."),
};
inline constexpr std::array kContactCounts = {
    output(reals("touching", "Number of points that touch.")),
    output(reals("slipping", "How many of these slip.")),
};
inline constexpr Attribute kActive =
    boolean("active", {.initial = "true", .group = "Contact"}, "false: they pass through each other.");

inline constexpr Table kInstrumentContactForceField{
    force_field("InstrumentContactForceField",
                "A rigid instrument that moves along a path and touches the nearest body: it presses and drags by "
                "friction, and never pulls. Needs an EulerImplicitSolver."),
    one_of("shape", {.initial = "sphere", .words = "sphere capsule cylinder box surface", .group = "Instrument"},
           "Shape around the origin of the instrument's frame. Capsules and cylinders lie along z. surface: that of "
           "surfaceTriangles."),
    real("radius", {.unit = "m", .range = kPositive, .group = "Instrument"}, "Of sphere, capsule, cylinder."),
    real("length", {.unit = "m", .range = kPositive, .group = "Instrument"},
         "Of cylinder and capsule; of a capsule without its two caps."),
    vector3("size", {.unit = "m", .range = kPositive, .group = "Instrument"}, "Edges of the box."),
    vectors3("surfacePositions", {.unit = "m", .group = "Instrument"},
             "Nodes of the surface in the frame of the instrument: @loader.position."),
    indices("surfaceTriangles", {.group = "Instrument"},
            "A closed surface: groups of three nodes, counter-clockwise seen from outside."),
    vectors3("embeddedPositions", {.unit = "m", .group = "Contact"},
             "Nodes, in the initial shape, of a surface that is embedded in the body: @visual.position."),
    indices("embeddedTriangles", {.group = "Contact"},
            "Groups of three of these nodes, counter-clockwise seen from outside: the surface that is touched, in "
            "place of the faces of the hexahedra."),
    kPathAttributes,
    real("contactStiffness", {.unit = "Pa/m", .range = kPositive, .group = "Contact"},
         "Pressure per depth of penetration. Default: 30 times the greatest Young's modulus over the mean edge of the "
         "hexahedra, also when the modulus changes. At most 200 times the default; from 30 times on a "
         "MultigridCGLinearSolver needs a tolerance of 1e-8."),
    kContactLaw,
    integer("maxSubdivision", {.initial = "8", .range = {.min = 1, .max = 64}, .group = "Contact"},
            "Contact points divide edges into parts of half the instrument's smallest radius, but at most this number "
            "of parts; a warning appears if it does not suffice."),
    kActive,
    output(vector3("force", {.unit = "N"}, "Force of the body on the instrument at the end of the last step.")),
    output(vector3("torque", {.unit = "N m"}, "Torque of the body on the instrument about the origin of its frame.")),
    output(reals("depth", {.unit = "m"}, "Largest depth of the surface in the instrument.")),
    kContactCounts,
};

inline constexpr Table kInstrumentContactInSofa{kInstrumentContactForceField, kInstrumentContactForceField.rows,
                                                kFrameAttributes};

inline constexpr Table kTissueContactForceField{
    Category{"InteractionForceField", kVec3Templates}(
        "TissueContactForceField",
        "Two bodies that touch each other, or one that touches itself. Lips of a cut begin to touch where they are, "
        "and "
        "at contactDistance once they have been that far apart. Needs one EulerImplicitSolver above both."),
    link("object1", "The mechanical state of a body; default: that of the node."),
    link("object2",
         "That of the other body. Default: the same body, which touches itself, also across cuts, except within two "
         "hexahedra."),
    real("contactStiffness", {.unit = "Pa/m", .range = kPositive, .group = "Contact"},
         "Pressure per depth of penetration. Default and limits as of InstrumentContactForceField, for the body for "
         "which they are less."),
    kContactLaw,
    integer("maxSubdivision", {.initial = "8", .range = {.min = 1, .max = 64}, .group = "Contact"},
            "Contact points divide edges into parts of half the mean edge of the other surface, but at most this "
            "number of parts."),
    kActive,
    output(vector3("force", {.unit = "N"},
                   "Force on the body of object1 at the end of the last step. Of a body on itself: zero.")),
    output(reals("depth", {.unit = "m"}, "Largest depth of a surface in the other.")),
    kContactCounts,
};

}  // namespace hexaplast::attributes
