// SPDX-License-Identifier: LGPL-2.1-or-later
// The numbers of the solvers that no theory gives, each with what it was fitted to or bounded by, where that is on
// record.
#pragma once

namespace hexaplast {

// ---------------------------------------------------------------------------- multigrid cycle: theory.md section 9.5

/// Degree of the Chebyshev polynomial before and after a coarse correction. To 1 %: 2.1 iterations at 5 kPa and 7.9 at
/// 500 kPa; with 1 3.7 and 12.4.
constexpr int kSmoothing = 2;
/// What the smoother reduces, from this fraction of the spectrum's upper end on.
constexpr double kSmoothedFraction = 0.07;
/// The same on the coarsest mesh, in place of a direct solution.
constexpr int kCoarsestDegree = 10;
constexpr double kCoarsestFraction = 0.02;

/// Steps of Lanczos for the spectrum's upper end. Six saw it too late on 4 of 84 small regular grids (5x4x5, 5x4x6,
/// 5x5x6).
constexpr int kMinLanczosSteps = 6, kMaxLanczosSteps = 14;
/// They end where one adds less than this factor to the largest eigenvalue.
constexpr double kLanczosGrowth = 1.02;
/// Eigenvalue of a mesh in which single elements stand out, whose coarse meshes take all steps: 23 of 480 runs of
/// jittered bars had an indefinite cycle before, 7 with it. Regular meshes have up to 6.2.
constexpr double kIrregular = 8;
/// Of a Lanczos vector: what is left below it is rounding of single precision.
constexpr double kRangeEnds = 1e-5;
/// Lanczos comes from below: by a tenth at most, but where eigenvalues lie close.
constexpr double kSafety = 1.15;

/// Solves that one estimate serves, and the change of stiffness and of mass that it bears: bodies that flow by a few
/// hundredths per step change the eigenvalue by less than kSafety allows for in as many.
constexpr int kMaxSolvesOfRadii = 8;
constexpr double kMaxChangeOfRadii = 0.1;
/// It serves no longer where a solve takes so many times the iterations of the first one.
constexpr double kMaxGrowthOfIterations = 1.25;

// -------------------------------------------------------------------------------------------- terms beside the bodies

/// D of a node that has none, of the trace of its block.
constexpr double kFractionOfBlock = 1e-3;
/// Stiffness over D from which on a direction is rigid: a cycle and rigid directions beside it are then as good as both
/// at once to about a hundredth, and the rounding of single precision is less than a thousandth of D. Beyond it the
/// cycle's rounding made it unsymmetric (2e-5 to 5e-5).
constexpr double kRigid = 1e4;

// ----------------------------------------------------------------------------------------------- conjugate gradients

/// Ratio of stiffness and the rest of a node's diagonal at which Jacobi and multigrid cost the same. Jacobi needs about
/// 4 c dt / h iterations for one per cent, multigrid three that cost as much as twelve: they break even near
/// c dt / h = 4, and the ratio is about (1.6 c dt / h)^2.
constexpr double kBreakEven = 40;

/// p.Ap / p.Mp below which p.Ap is rounding, of the greatest. Rigid motions fall to 1e-32 and 1e-14; bars of 50 to 200
/// hexahedra, with layers 10,000 times as soft, keep above 1e-8.
constexpr double kDoubleRounding = 1e-13, kSingleRounding = 1e-10;
/// Curvature of the wrong sign, of the greatest: products in single precision make no more of it.
constexpr double kNegative = 1e-5;
/// p.Ap / p.Mp that M^-1 A has at least somewhere: a diagonal has 1, a cycle is made for 1 at the upper end.
constexpr double kOfPreconditioned = 0.1;

/// Of |b|: residuals of a body among several that are rounding of forces that cancel.
constexpr double kNothingInDouble = 1e-10, kNothingInSingle = 1e-8;

// --------------------------------------------------------------------------------------------------- mixed precision

/// Single precision with half-precision coefficients answers to about 2e-4; below this tolerance answers are
/// corrections.
constexpr double kSingleSuffices = 1e-3;
/// Relative residual of each correction. With it 12,800 hexahedra took 42 ms to 1e-6, in double precision 58.
constexpr double kCorrection = 3e-3;
constexpr int kMaxCorrections = 50;
/// Of the tolerance: rounding that may have hidden that it was not reached.
constexpr double kDoubt = 0.1;
/// What coefficients in half precision, which enter a product twice, leave out of a residual: two rounding units.
/// Bodies that are badly distorted leave out more, up to 5.8e-3 beside contacts.
constexpr double kHalfLeavesOut = 0x1p-10;

// --------------------------------------------------------------------------------------------------- Newton's method

/// The initial residual may itself be no more than rounding, which the next ones exceed by a little.
constexpr double kOfInitial = 2;

// ----------------------------------------------------------------------------------- compliance: theory.md section 6.7

constexpr int kMaxIterationsPerRow = 1000;
/// The square of the residual of a row beside the tolerance asked for: W of bars, plates and blocks of 5 kPa to 5 MPa
/// is as exact as the tolerance then, by the diagonal to four times it. 1e-4 leaves as much as kRegularised.
constexpr double kSquareOfResidual = 2.5, kMostResidual = 0.05, kLeastResidual = 1e-4;
/// Of the mean of the diagonal, for rows that depend on one another.
constexpr double kRegularised = 1e-8;
/// Of the energy norm of a start, that a solution adds to it.
constexpr double kNegligible = 0.03;

}  // namespace hexaplast
