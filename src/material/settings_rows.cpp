// SPDX-License-Identifier: LGPL-2.1-or-later
#include <iterator>

#include "hexaplast/material/rows.hpp"

namespace hexaplast {

namespace {

constexpr std::string_view kBendings[] = {"blended", "assumedCorner", "vertex", "centre"};
constexpr std::string_view kVolumetrics[] = {"sample", "volumeRatio"};
constexpr std::string_view kRecoveries[] = {"none", "cluster"};
constexpr std::string_view kLaws[] = {"corotated", "neoHookean", "stableNeoHookean", "mooneyRivlin"};
constexpr std::string_view kYieldNorms[] = {"vonMises", "frobenius", "spectral"};
constexpr std::string_view kMeasures[] = {"biot", "cauchy"};
constexpr std::string_view kRestShapes[] = {"joined", "isolated"};
constexpr std::string_view kRotations[] = {"objective", "vertex", "centre", "none"};
constexpr std::string_view kFrames[] = {"bestFit", "world"};
constexpr std::string_view kAveragings[] = {"gaussNewton", "jacobi"};
constexpr std::string_view kFractures[] = {"cell", "face"};
constexpr std::string_view kPrecisions[] = {"double", "mixed"};
constexpr std::string_view kImplementations[] = {"auto", "plain"};

constexpr Row<Settings> kSettingsRows[] = {
    {.member = "bending",
     .name = "bending",
     .group = kNumerics,
     .words = kBendings,
     .help = "Strain at the quadrature points. assumedCorner: bends freely; blended: between corners and centre, stiff "
             "in bending, as published; for comparison vertex (too stiff) and centre (hourglass modes).",
     .at = kMember<&Settings::bending>},
    {.member = "blend_weight",
     .name = "blendWeight",
     .group = kNumerics,
     .range = {.min = 0, .max = 1, .exclusive_min = true, .exclusive_max = true},
     .help = "Weight of the corner for bending=\"blended\".",
     .at = kMember<&Settings::blend_weight>},
    {.member = "volumetric",
     .name = "volumetric",
     .group = kNumerics,
     .words = kVolumetrics,
     .help = "What resists a change of volume. volumeRatio: the exact volume of the hexahedron; sample: each of its "
             "quadrature points, which locks towards Poisson's ratio 0.5, as published.",
     .at = kMember<&Settings::volumetric>},
    {.member = "law",
     .name = "law",
     .group = kElasticity,
     .words = kLaws,
     .help = "Elastic law. corotated: stress is linear in the stretch, but for the pressure of "
             "volumetric=\"volumeRatio\"; the others are hyperelastic, and need restShape=\"joined\" of a body that "
             "flows. All agree at small strains.",
     .at = kMember<&Settings::law>},
    {.member = "mooney_fraction",
     .name = "mooneyFraction",
     .group = kElasticity,
     .range = {.min = 0, .max = 1},
     .help = "Fraction of the shear modulus that is the second constant of law=\"mooneyRivlin\".",
     .at = kMember<&Settings::mooney_fraction>},
    {.member = "relaxation",
     .name = "relaxation",
     .group = kElasticity,
     .range = {.min = 0, .exclusive_min = true},
     .help = "Viscoelasticity, \"g1 t1 g2 t2 ...\": resistance to shear that relaxes, at most 8 moduli, each as a "
             "fraction g of the shear modulus, with its time t in seconds. youngModulus and poissonRatio are those of "
             "slow deformation. A body that yields needs restShape=\"isolated\" with it.",
     .at = kMember<&Settings::relaxation>},
    {.member = "recovery",
     .name = "recovery",
     .group = kNumerics,
     .words = kRecoveries,
     .help = "What unfolds folded hexahedra. cluster: springs on each connected cluster of them, without force or "
             "moment in sum, and for restShape=\"isolated\" an energy of corners that have lost most of their volume; "
             "none: nothing.",
     .at = kMember<&Settings::recovery>},
    {.member = "recovery_strength",
     .name = "recoveryStrength",
     .group = kNumerics,
     .range = {.min = 0, .exclusive_min = true},
     .help = "Stiffness of the springs of recovery=\"cluster\", in terms of the shear modulus.",
     .at = kMember<&Settings::recovery_strength>},
    {.member = "recovery_from",
     .name = "recoveryFrom",
     .group = kNumerics,
     .range = {.min = 0, .max = 1, .exclusive_max = true},
     .help = "The springs act on a hexahedron whose volume at a corner is below this fraction of that at rest.",
     .at = kMember<&Settings::recovery_from>},
    {.member = "recovery_full",
     .name = "recoveryFull",
     .group = kNumerics,
     .range = {.min = -1, .max = 0},
     .help = "At and below this fraction they have their full strength; negative: at a corner that is inverted.",
     .at = kMember<&Settings::recovery_full>},
    {.member = "yield_norm",
     .name = "yieldNorm",
     .group = kYield,
     .words = kYieldNorms,
     .help = "Norm of the stress that is compared with yieldStress. vonMises is independent of pressure under "
             "law=\"corotated\".",
     .at = kMember<&Settings::yield_norm>},
    {.member = "yield_stress_measure",
     .name = "yieldStressMeasure",
     .group = kYield,
     .words = kMeasures,
     .help = "Stress that is compared with yieldStress. biot: that of the law, in the rotated frame; cauchy: true "
             "stress, advised above strains of 5 %; for restShape=\"isolated\".",
     .at = kMember<&Settings::yield_stress_measure>},
    {.member = "rest_shape",
     .name = "restShape",
     .group = kFlow,
     .words = kRestShapes,
     .help =
         "Where permanent deformation lives. isolated: in each quadrature point, with residual stress, without flow "
         "of rotation; joined: in one mesh that fits all hexahedra best, without residual stress, as published. "
         "Elastic bodies differ in recovery alone.",
     .at = kMember<&Settings::rest_shape>},
    {.member = "rotation_plasticity",
     .name = "rotationPlasticity",
     .group = kFlow,
     .words = kRotations,
     .help =
         "How rotation within a hexahedron becomes permanent, for restShape=\"joined\". objective: that of a corner "
         "relative to its hexahedron; vertex and centre: the two modes of the paper; none: only stretch flows.",
     .at = kMember<&Settings::rotation_plasticity>},
    {.member = "rotation_frame",
     .name = "rotationFrame",
     .group = kFlow,
     .words = kFrames,
     .help = "Reference of rotations for vertex and centre: the rotation of the whole body, or the axes (as in the "
             "paper: the result depends on the pose).",
     .at = kMember<&Settings::rotation_frame>},
    {.member = "averaging",
     .name = "averaging",
     .group = kNumerics,
     .words = kAveragings,
     .help = "How the rest shapes of the hexahedra are averaged to one mesh, for restShape=\"joined\". gaussNewton: a "
             "Gauss-Newton step that leaves rotations of hexahedra free; for comparison jacobi (one sweep, depends on "
             "the mesh).",
     .at = kMember<&Settings::averaging>},
    {.member = "averaging_steps",
     .name = "averagingSteps",
     .group = kNumerics,
     .range = {.min = 1, .max = 1000},
     .help = "Averaging steps per time step.",
     .at = kMember<&Settings::averaging_steps>},
    {.member = "averaging_tolerance",
     .name = "averagingTolerance",
     .group = kNumerics,
     .range = {.min = 0, .max = 0.1, .exclusive_min = true},
     .help = "Relative residual of an averaging step; the next step corrects the rest.",
     .at = kMember<&Settings::averaging_tolerance>},
    {.member = "precision",
     .name = "precision",
     .group = kNumerics,
     .words = kPrecisions,
     .help = "Precision of the stiffness product and of the vectors of CGLinearSolver and MultigridCGLinearSolver. "
             "mixed: single precision, twice as fast; positions, forces and the plastic state are double.",
     .at = kMember<&Settings::precision>},
    {.member = "implementation",
     .name = "implementation",
     .group = kNumerics,
     .words = kImplementations,
     .help = "What computes. auto: the fast kernels where they have what is asked for; plain: the paper's method in "
             "double precision and without multigrid, for comparing. It alone has other values of bending than "
             "assumedCorner, volumetric=\"sample\", restShape=\"joined\" of a body that flows, averaging=\"jacobi\", "
             "and rotationPlasticity=\"vertex\" and \"centre\".",
     .at = kMember<&Settings::implementation>},
    {.member = "volume_restitution",
     .name = "volumeRestitution",
     .group = kVolume,
     .unit = "1/s",
     .range = {.min = 0},
     .per_step = {.max = kLargestRestitutionPerStep, .exclusive_max = true},
     .recommended_per_step = kRecommendedRestitutionPerStep,
     .help =
         "Rate at which the rest shape of a hexahedron returns to its initial volume, for restShape=\"joined\": errors "
         "decay as exp(-3 c t). Times dt: below 2/3; at most 0.3 is recommended.",
     .at = kMember<&Settings::volume_restitution>},
    {.member = "inversion_threshold",
     .name = "inversionThreshold",
     .group = kVolume,
     .range = {.min = 0, .max = 1, .exclusive_max = true},
     .help = "Hexahedra whose volume at a corner is below this fraction of the initial one, or that are inverted, do "
             "not flow.",
     .at = kMember<&Settings::inversion_threshold>},
    {.member = "fracture",
     .name = "fracture",
     .group = kFracture,
     .words = kFractures,
     .help = "What becomes of a hexahedron that breaks. cell: it is removed. face: it stays, and comes apart from its "
             "neighbours along the faces that bear most tension, for restShape=\"isolated\".",
     .at = kMember<&Settings::fracture>},
};
static_assert(std::size(kSettingsRows) == num_members<Settings>(), "a member has no row");

}  // namespace

std::span<const Row<Settings>> settings_rows() { return kSettingsRows; }

}  // namespace hexaplast
