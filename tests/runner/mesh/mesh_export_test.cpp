// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>

#include "hexaplast/formats/mesh_import.hpp"
#include "support/command.hpp"
#include "support/compare.hpp"
#include "support/golden.hpp"

namespace {

using namespace hexaplast;
using support::Outcome;

// Against another program, where it is installed.
class Calculix : public support::Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    if (shell("command -v ccx").code != 0) GTEST_SKIP() << "ccx is not installed";
  }

  /// Displacements [m] that ccx finds for a scene, num_nodes x 3; they have seven digits.
  PointArray displacements(const std::string& scene, int num_nodes) {
    const Outcome written =
        shell("PATH=/usr/bin:$PATH '" HEXAPLAST_SOURCE_DIR "/benchmarks/calculix/scene_deck.py' --hexaplast '" +
              std::string(HEXAPLAST_COMMAND) + "' " + scene);
    EXPECT_EQ(written.code, 0) << written.err;
    write("deck.inp", written.out);
    const Outcome outcome = shell("OMP_NUM_THREADS=1 ccx -i deck");
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    PointArray u = PointArray::Constant(num_nodes, 3, std::nan(""));
    std::istringstream lines(support::content(directory_ / "deck.dat"));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream numbers(line);
      int node = 0;
      double x = 0, y = 0, z = 0;
      if (numbers >> node >> x >> y >> z) u.row(node - 1) << x, y, z;  // of the last increment in the end
    }
    return u;
  }

  /// Displacements [m] that the command finds.
  PointArray our_displacements(const std::string& options) {
    const Outcome outcome = succeeds("run " + options + " --quiet --final final.json");
    EXPECT_EQ(outcome.err, "");
    const support::Json final = support::Json::parse(support::content(directory_ / "final.json"));
    return support::matrix(final["positions"]) - support::matrix(final["plastic_rest_positions"]);
  }
};

// Without lateral contraction a pulled bar stays a prism, and both laws agree to the square of the strain (here 1e-4).
TEST_F(Calculix, PullsABarAsFar) {
  write("bar.scn",
        "<Node name='root' gravity='0 0 0'><DefaultAnimationLoop/><RunSettings steps='1'/><StaticSolver/>"
        "<NewtonRaphsonSolver maxNbIterationsNewton='9' absoluteResidualStoppingThreshold='1e-9'/><SparseLDLSolver/>"
        "<RegularGridTopology n='3 2 2'/><MechanicalObject/><HexahedronElastoplasticFEMForceField "
        "youngModulus='1000' poissonRatio='0'/><FixedProjectiveConstraint indices='0 3 6 9'/>"
        "<ConstantForceField indices='2 5 8 11' totalForce='0.1 0 0'/></Node>");
  const PointArray theirs = displacements("bar.scn", 12), ours = our_displacements("bar.scn");
  EXPECT_NEAR(ours(2, 0), 1e-4, 1e-10);
  EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 3e-4 * 1e-4);
}

// On the same mesh, bent by more than half its length: the blended element is a little softer than C3D8, which locks.
TEST_F(Calculix, BendsTheCantileverALittleLess) {
  const std::string scene = std::string("'") + HEXAPLAST_SOURCE_DIR + "/scenes/cantilever_static.scn'";
  const PointArray theirs = displacements(scene, 525), ours = our_displacements(scene);
  const double their_tip = -theirs(20, 2) / 0.05, our_tip = -ours(20, 2) / 0.05;  // node 20: an end of the tip's edge
  EXPECT_GT(our_tip, their_tip);
  EXPECT_LT(our_tip, 1.03 * their_tip);
}

}  // namespace
