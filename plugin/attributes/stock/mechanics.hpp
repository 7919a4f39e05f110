// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// What moves. See stock.hpp.
namespace hexaplast::attributes {

// ---- time integration, equilibrium, and the linear systems in them

inline constexpr Table kEulerImplicitSolver{
    ode_solver("EulerImplicitSolver", "Linearised implicit Euler: one linear solve per time step."),
    real("rayleighStiffness", {.initial = "0", .unit = "s", .range = kNotNegative}, "Stiffness-proportional damping."),
    real("rayleighMass", {.initial = "0", .unit = "1/s", .range = kNotNegative}, "Mass-proportional damping."),
    real("vdamping", {.initial = "0", .unit = "1/s", .range = kNotNegative},
         "Velocities decay as exp(-vdamping dt) at the end of each step, after the positions."),
    boolean("firstOrder", {.initial = "false"}, "Solves M dx/dt = f: the mass acts as a viscosity. Without damping."),
    boolean("trapezoidalScheme", {.initial = "false"},
            "Forces at the middle of the step, with half the numerical damping. As in SOFA it is of first order in "
            "time, and vibrations faster than 2 / dt (rad/s) grow, even with Rayleigh damping."),
    link("linearSolver", "Solver of the linear system; default: the nearest one."),
};

inline constexpr Table kStaticSolver{
    ode_solver("StaticSolver",
               "Static equilibrium under the loads at the beginning of each time step, then one plastic step."),
    link("newtonSolver", "Newton solver; default: the nearest one."),
    link("linearSolver", "Solver of the linear systems; default: the nearest one."),
};

inline constexpr Table kNewtonRaphsonSolver{
    Category{"NewtonRaphsonSolver"}("NewtonRaphsonSolver",
                                    "Stopping rules and line search of a StaticSolver. Norms are over all its bodies."),
    integer("maxNbIterationsNewton", {.initial = "1", .range = {.min = 1, .max = 1e9}},
            "Largest number of iterations per step."),
    real("relativeSuccessiveStoppingThreshold", {.initial = "1e-5", .range = kNotNegative},
         "Stops when |r_k| / |r_k-1| <= this value. 0 switches a threshold off."),
    real("relativeInitialStoppingThreshold", {.initial = "1e-5", .range = kNotNegative},
         "Stops when |r_k| / |r_0| <= this value."),
    real("absoluteResidualStoppingThreshold", {.initial = "1e-5", .unit = "N", .range = kNotNegative},
         "Stops when |r_k| <= this value: lower it for small loads."),
    real("relativeEstimateDifferenceThreshold", {.initial = "0", .range = kNotNegative},
         "Stops when |x_k - x_k-1| / |x_k-1| <= this value."),
    real("absoluteEstimateDifferenceThreshold", {.initial = "0", .unit = "m", .range = kNotNegative},
         "Stops when |x_k - x_k-1| <= this value."),
    integer("maxNbIterationsLineSearch", {.initial = "1", .range = {.min = 1, .max = 1e9}},
            "Step lengths tried per iteration until |r| decreases."),
    real("lineSearchCoefficient",
         {.initial = "0.5", .range = {.min = 0, .max = 1, .exclusive_min = true, .exclusive_max = true}},
         "Factor of the step length for each further try."),
};

inline constexpr std::string_view kCGTemplates =
    "GraphScattered CompressedRowSparseMatrix CompressedRowSparseMatrixd CompressedRowSparseMatrixMat3x3 "
    "CompressedRowSparseMatrixMat3x3d";
inline constexpr Table kCGLinearSolver{
    Category{"LinearSolver", kCGTemplates}("CGLinearSolver", "Conjugate gradients without assembled matrix."),
    integer("iterations", {.initial = "25", .range = {.min = 1, .max = 1e9}}, "Largest number of iterations."),
    real("tolerance", {.initial = "1e-5", .range = kNotNegative},
         "Stops when |r| / |b| <= this value. As in SOFA both are over all states: a heavy body hides the residual of "
         "a light one."),
    real("threshold", {.initial = "1e-5", .range = kNotNegative},
         "Stops when p.Ap <= this value; 0 switches it off. Tissue lies below the default: then nothing is solved, and "
         "velocities stay."),
    boolean("warmStart", {.initial = "false"}, "Begins with the solution of the step before."),
};

inline constexpr Description kSparseLDLSolver = Category{"LinearSolver", kMatrixTemplates}(
    "SparseLDLSolver", "Direct sparse factorisation by CHOLMOD, of the matrix of the present step.");

// ---- masses

inline constexpr Attribute kMassRayleigh =
    real("rayleighMass", {.initial = "0", .unit = "1/s", .range = kNotNegative},
         "Damping by this mass in the system matrix alone, besides the solver's own.");

inline constexpr Table kUniformMass{
    mass("UniformMass", "The same mass at every node."),
    real("totalMass", {.unit = "kg", .range = kPositive}, "Divided equally among all nodes."),
    real("vertexMass", {.unit = "kg", .range = kPositive}, "Of each node, unless totalMass is given."),
    kMassRayleigh,
};

inline constexpr Attribute kMassTopology = link("topology", "The hexahedra; default: the nearest topology.");

inline constexpr Table kDiagonalMass{
    mass("DiagonalMass", "Each hexahedron gives an eighth of its mass to each of its nodes."),
    real("totalMass", {.unit = "kg", .range = kPositive},
         "Of the whole body, spread by volume. Counts before massDensity, and that before vertexMass; 1 kg if none is "
         "given."),
    real("massDensity", {.unit = "kg/m^3", .range = kPositive}, "Mass per volume at rest."),
    reals("vertexMass", {.unit = "kg", .range = kNotNegative}, "One value for all nodes, or one per node."),
    boolean("computeMassOnRest", {.initial = "true"},
            "Whether volumes are those of the rest positions or of the first positions."),
    kMassRayleigh,
    kMassTopology,
};

// ---- forces

inline constexpr Table kConstantForceField{
    force_field("ConstantForceField", "Forces that never change."),
    indices("indices", "Nodes; default: all."),
    vectors3("forces", {.unit = "N"},
             "One for all nodes, or one per index. Counts before totalForce; one of the two is needed."),
    vector3("totalForce", {.initial = "0 0 0", .unit = "N"}, "Divided equally among the nodes."),
    ignored("topology"),
};

inline constexpr Table kLinearForceField{
    force_field("LinearForceField", "Forces that follow a history."),
    indices("points", "Nodes; each receives the whole force."),
    reals("times", {.unit = "s"}, "Key times, ascending."),
    vectors3("forces", {.unit = "N"},
             "Force on each node at each key time: none before the first time, linear in between, constant after the "
             "last. That at the beginning of a step counts."),
    real("force", {.initial = "1"}, "Factor of the forces, except from the last time on."),
};

inline constexpr Attribute kLoadTopology = link("topology", "The faces; default: the nearest topology.");

inline constexpr Table kSurfacePressureForceField{
    force_field("SurfacePressureForceField",
                "Pressure on faces in their current shape; a quad counts as two triangles. Faces of removed hexahedra "
                "carry no load."),
    real("pressure", {.initial = "0", .unit = "Pa"},
         "Along the normal of the order of a face's nodes: positive values pull outwards on hexahedra."),
    vector3("min", {.initial = "0 0 0", .unit = "m"},
            "Faces count while all their nodes lie in the box from here to max; if both are 0, everywhere."),
    vector3("max", {.initial = "0 0 0", .unit = "m"}, "The other corner of the box."),
    kLoadTopology,
};

inline constexpr Table kPlaneForceField{
    force_field("PlaneForceField",
                "An elastic obstacle behind a plane. A node that touches it at the beginning of a step does so to its "
                "end: one that leaves at v is held back by up to stiffness dt v."),
    vector3("normal", {.initial = "0 1 0"}, "Points away from the obstacle. Taken as it is: give a unit vector."),
    real("d", {.initial = "0", .unit = "m"}, "The plane is normal.x = d."),
    real("stiffness", {.initial = "500", .unit = "N/m", .range = kNotNegative}, "Force on a node per depth."),
    real("damping", {.initial = "5", .unit = "N s/m^2", .range = kNotNegative},
         "Force against the velocity of a node, per velocity and depth."),
    real("maxForce", {.initial = "0", .unit = "N", .range = kNotNegative},
         "Largest force on a node, which is constant then; 0: no limit."),
    kForceRayleigh,
};

// ---- springs between nodes

inline constexpr Attribute kSpringRayleigh =
    real("rayleighStiffness", {.initial = "0", .unit = "s", .range = kNotNegative},
         "Damping by their stiffness, in the system matrix alone.");
inline constexpr Table kSpringForceField{
    force_field("SpringForceField",
                "Springs between nodes of one state, or of two. As in SOFA damping, along the spring, is not part of "
                "the matrix: too much of it for masses and dt makes motions grow."),
    link("object1", "The mechanical state of the first nodes; default: that of the node."),
    link("object2",
         "That of the second nodes; default: that of the node. One time integrator moves both states. They may be "
         "mapped ones; a state that nothing moves holds its ends."),
    reals("spring",
          "In place of the lists below, five numbers for each: its two nodes, stiffness [N/m], damping [N s/m], rest "
          "length [m]."),
    indices("indices1", "First nodes, of object1."),
    indices("indices2", "Second nodes, of object2, as many."),
    reals("stiffness", {.initial = "100", .unit = "N/m", .range = kNotNegative}, "One value, or one per spring."),
    reals("damping", {.initial = "5", .unit = "N s/m", .range = kNotNegative}, "One value, or one per spring."),
    reals("lengths", {.initial = "0", .unit = "m", .range = kNotNegative}, "At rest: one value, or one per spring."),
    boolean("elongationOnly", {.initial = "false"}, "No force of springs that are shorter than at rest."),
    kSpringRayleigh,
};

inline constexpr Table kRestShapeSpringsForceField{
    force_field("RestShapeSpringsForceField",
                "Springs that pull nodes back to their rest positions, or to where nodes of another state are."),
    indices("points", "Nodes; default: all."),
    reals("stiffness", {.initial = "100", .unit = "N/m", .range = kNotNegative}, "One value, or one per node."),
    link("external_rest_shape",
         "A mechanical state to whose positions at the beginning of the step the nodes are pulled. It feels no force. "
         "Default: the rest positions."),
    indices("external_points", "Nodes of that state, as many; default: all."),
    kSpringRayleigh,
};

// ---- prescribed motion

inline constexpr Attribute kFixedIndices = indices("indices", {.initial = "0"}, "Nodes that receive no acceleration.");
inline constexpr Attribute kFixAll = boolean("fixAll", {.initial = "false"}, "Fixes every node.");
// SOFA's constraints do not have these outputs.
inline constexpr std::array kConstraintAttributes = {
    ignored("topology"),
    output(vector3("reaction", {.unit = "N"},
                   "Sum of the forces of constraints on its nodes in the last step, in the directions that are held; "
                   "jumps of a prescribed velocity come on top. Of EulerImplicitSolver only, and not in SOFA.")),
    output(vector3("reactionTorque", {.unit = "N m"}, "Moment of these forces about the origin.")),
};

inline constexpr Table kFixedProjectiveConstraint{
    projective_constraint("FixedProjectiveConstraint",
                          "Holds nodes: their acceleration is zero, so that a velocity they begin with persists."),
    kFixedIndices,
    kFixAll,
    kConstraintAttributes,
};

inline constexpr Table kPartialFixedProjectiveConstraint{
    projective_constraint("PartialFixedProjectiveConstraint", "Holds nodes in some directions."),
    kFixedIndices,
    kFixAll,
    integers("fixedDirections", {.initial = "1 1 1", .range = {.min = 0, .max = 1}},
             "1 for each of x, y, z that is held, 0 where nodes move freely."),
    kConstraintAttributes,
};

inline constexpr Attribute kMovedIndices = indices("indices", {.initial = "0"}, "Nodes that are moved.");
inline constexpr Attribute kKeyTimes = reals("keyTimes", {.initial = "0", .unit = "s"}, "Key times, ascending.");
inline constexpr Attribute kMovements =
    vectors3("movements", {.initial = "0 0 0", .unit = "m"},
             "Movement at each key time, linear in between. Nodes are free before the first time and from the last one "
             "on: to hold them, repeat the last movement at a far later time.");

inline constexpr Table kLinearMovementProjectiveConstraint{
    projective_constraint(
        "LinearMovementProjectiveConstraint",
        "Moves nodes along a history. A step from t to t + dt ends with the movement at t, as in SOFA."),
    kMovedIndices,
    kKeyTimes,
    kMovements,
    kConstraintAttributes,
};

inline constexpr Table kPartialLinearMovementProjectiveConstraint{
    projective_constraint(
        "PartialLinearMovementProjectiveConstraint",
        "Moves nodes along a history in some directions. In the others they keep their velocity (SOFA overwrites it)."),
    kMovedIndices,
    kKeyTimes,
    kMovements,
    integers("movedDirections", {.initial = "1 1 1", .range = {.min = 0, .max = 1}},
             "1 for each of x, y, z in which nodes are moved, 0 where they are free."),
    kConstraintAttributes,
};

inline constexpr Table kAttachProjectiveConstraint{
    Category{"InteractionProjectiveConstraint", kVec3Templates}(
        "AttachProjectiveConstraint",
        "Ties nodes of two mechanical states. As in SOFA, the distance of a pair is halved in every step, and both get "
        "the mean of their velocities."),
    link("object1",
         "The mechanical state that the other one follows; default: that of the node. Without twoWay it may be a "
         "mapped one."),
    link("object2",
         "The mechanical state whose nodes are tied to it; default: that of the node. One time integrator moves both."),
    indices("indices1", "Nodes of object1."),
    indices("indices2", "Nodes of object2, as many, each once."),
    boolean("twoWay", {.initial = "false"},
            "Both nodes of a pair have the mean of their accelerations, and forces pass between the states; not with "
            "direct solvers. Otherwise the second node does not accelerate, and no force passes."),
};

// ---- states that follow others

inline constexpr Attribute kMappingInput =
    link("input", "The state that is followed, or its node; default: the nearest one above this node.");
inline constexpr Attribute kMappingOutput =
    link("output", "The mapped state, or its node; default: that of this node.");

inline constexpr Table kBarycentricMapping{
    mapping("BarycentricMapping",
            "Points that move with the hexahedra they lie in, at their trilinear coordinates. SOFA's are affine: in "
            "hexahedra "
            "that are no boxes points jump at the beginning. Points outside follow the nearest hexahedron's motion to "
            "first "
            "order; a message gives their number. Forces and stiffness on points act on the hexahedra, with the same "
            "force and "
            "moment. Where hexahedra are removed, cells of the points in them count as removed; the points follow the "
            "nodes."),
    kMappingInput,
    kMappingOutput,
    link("input_topology", "The hexahedra; default: the topology of the followed state's node."),
};

inline constexpr Table kIdentityMapping{
    mapping("IdentityMapping", "A state with the same nodes as the one it follows."),
    kMappingInput,
    kMappingOutput,
};

}  // namespace hexaplast::attributes
