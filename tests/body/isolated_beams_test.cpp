// SPDX-License-Identifier: LGPL-2.1-or-later
// Bodies beyond yield, with isolated rest shapes, against beam theory, the theory of tubes, and an independent program.
#include "support/beyond_yield.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

// A strip bent by 1.4 times the load of first yield comes to rest, and springs back but for the part that residual
// stress holds.
TEST(IsolatedBeams, ACantileverBeyondYieldComesToRestAndKeepsResidualStress) {
  const BentCantilever found = bend({.cells = {8, 1, 6}, .load = 1.4004});
  EXPECT_NEAR(found.loaded, 2.2115e-3, 0.01 * 2.2115e-3);
  EXPECT_NEAR(found.released, 0.1182e-3, 0.01 * 0.1182e-3);
  EXPECT_LE(found.creep, 1e-6);
  EXPECT_GT(found.residual_energy, 1e-8) << "[J]";
}

// Two quadrature points across a plate of one cell have 2/sqrt(3) times the limit moment; eight that keep their volumes
// lock.
TEST(IsolatedBeams, APlateOneCellThickHasALimitMoment) {
  EXPECT_NEAR(limit_moment(1, true, 0.45), 2 / std::sqrt(3.0), 0.005);
  EXPECT_NEAR(limit_moment(4, true, 0.45), 1, 0.005);
}

TEST(IsolatedBeams, AStripBentToAndFroFollowsTheLoopOfABeam) { EXPECT_LE(loop_of(bend_to_and_fro(8)).rms, 0.01); }

TEST(IsolatedBeams, ATubeBeyondYieldKeepsTheHoopStressOfTheory) {
  const ExpandedTube tube = expand_tube(8), exact = tube_in_theory(8);
  EXPECT_NEAR(tube.outer_displacement, exact.outer_displacement, 0.01 * exact.outer_displacement);
  EXPECT_LT(tube.hoop.front(), -0.5);
  EXPECT_LE(rms(tube.hoop, exact.hoop), 0.005);
}

// A patch pulled out of a block by its own edge folds the hexahedra about it, but for the corner energy.
TEST(IsolatedBeams, APatchThatIsPulledOutFoldsNoHexahedron) {
  const std::vector<PulledPatch> rows = pull_patch(0.01, 0.024), folded = pull_patch(0.01, 0.024, RecoveryMode::kNone);
  const Json reference = calculix("beyond_yield")["patch"][1];  // C3D8I of the same size
  const double at_4_mm = reference["force"][1];
  EXPECT_NEAR(rows[1].force, at_4_mm, 0.06 * at_4_mm);
  for (const PulledPatch& row : rows) EXPECT_GT(row.least_corner, 0.1);
  EXPECT_LT(folded.back().least_corner, -0.4);
  EXPECT_LT(rows.back().force, rows[3].force) << "[N] at 24 and 8 mm";
}

}  // namespace
}  // namespace hexaplast
