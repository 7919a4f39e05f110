// SPDX-License-Identifier: LGPL-2.1-or-later
#include <iterator>

#include "hexaplast/material/rows.hpp"

namespace hexaplast {

namespace {

constexpr std::string_view kGradients[] = {"blended", "vertex", "centre"};
constexpr std::string_view kYieldNorms[] = {"vonMises", "frobenius", "spectral"};
constexpr std::string_view kRotations[] = {"objective", "vertex", "centre", "none"};
constexpr std::string_view kFrames[] = {"bestFit", "world"};
constexpr std::string_view kAveragings[] = {"gaussNewton", "gaussNewtonIsolated", "localGlobal", "jacobi"};
constexpr std::string_view kPrecisions[] = {"double", "mixed"};

constexpr Row<Settings> kSettingsRows[] = {
    {.member = "gradient",
     .name = "gradient",
     .group = kNumerics,
     .words = kGradients,
     .help = "Where deformation is sampled. blended: between corners and centre, exact for affine motions of any "
             "hexahedron; vertex (too stiff) and centre (hourglass modes) for comparison.",
     .at = kMember<&Settings::gradient>},
    {.member = "yield_norm",
     .name = "yieldNorm",
     .group = kYield,
     .words = kYieldNorms,
     .help = "Norm of the stress that is compared with yieldStress. vonMises does not feel pressure.",
     .at = kMember<&Settings::yield_norm>},
    {.member = "rotation_plasticity",
     .name = "rotationPlasticity",
     .group = kFlow,
     .words = kRotations,
     .help = "How rotation within a hexahedron becomes permanent. objective: that of a corner relative to its "
             "hexahedron; vertex and centre: the paper's two ways, for comparison; none: only stretch flows.",
     .at = kMember<&Settings::rotation_plasticity>},
    {.member = "rotation_frame",
     .name = "rotationFrame",
     .group = kFlow,
     .words = kFrames,
     .help = "What the rotations of vertex and centre are measured against: the rotation of the whole body, or the "
             "axes as the paper prints it, which makes the result depend on the pose.",
     .at = kMember<&Settings::rotation_frame>},
    {.member = "averaging",
     .name = "averaging",
     .group = kNumerics,
     .words = kAveragings,
     .help = "How the rest shapes of the hexahedra become one: a Gauss-Newton step that leaves rotations of hexahedra "
             "free; for comparison gaussNewtonIsolated (leaves those of their isolated shapes free: bodies tilt), "
             "localGlobal (lags in bending and twist) and jacobi (one sweep, depends on the mesh).",
     .at = kMember<&Settings::averaging>},
    {.member = "averaging_steps",
     .name = "averagingSteps",
     .group = kNumerics,
     .range = {.least = 1, .most = 1000},
     .help = "Averaging steps per time step.",
     .at = kMember<&Settings::averaging_steps>},
    {.member = "averaging_tolerance",
     .name = "averagingTolerance",
     .group = kNumerics,
     .range = {.least = 0, .most = 0.1},
     .help = "Relative residual at which an averaging step is solved; the next one takes up what is left. 0: 1e-6, in "
             "mixed precision 1e-2.",
     .at = kMember<&Settings::averaging_tolerance>},
    {.member = "precision",
     .name = "precision",
     .group = kNumerics,
     .words = kPrecisions,
     .help = "Numbers that the stiffness product and the vectors of CGLinearSolver and MultigridCGLinearSolver are "
             "computed with. mixed: single precision, twice as fast; positions, forces and everything plastic stay "
             "double.",
     .at = kMember<&Settings::precision>},
    {.member = "volume_restitution",
     .name = "volumeRestitution",
     .group = kVolume,
     .unit = "1/s",
     .range = {.least = 0},
     .per_step = {.most = kLargestRestitutionPerStep, .without_most = true},
     .advised_per_step = kAdvisedRestitutionPerStep,
     .help = "Rate at which the rest shape is led back to its original volume: errors decay as exp(-3 c t). Times dt: "
             "below 2/3, wisely at most 0.3.",
     .at = kMember<&Settings::volume_restitution>},
    {.member = "inversion_threshold",
     .name = "inversionThreshold",
     .group = kVolume,
     .range = {.least = 0, .most = 1, .without_most = true},
     .help = "Hexahedra squeezed below this share of their volume at some corner, or turned inside out, do not flow.",
     .at = kMember<&Settings::inversion_threshold>},
};
static_assert(std::size(kSettingsRows) == num_members<Settings>(), "a member has no row");

}  // namespace

std::span<const Row<Settings>> settings_rows() { return kSettingsRows; }

}  // namespace hexaplast
