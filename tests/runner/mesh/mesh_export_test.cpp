// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>

#include "support/command.hpp"
#include "support/golden.hpp"

namespace {

using namespace hexaplast::support;

// Against another program, where it is installed. Without lateral contraction a pulled bar stays a prism, and both laws
// agree to the square of the strain (here 1e-4). CalculixCantilever has large deflections.
TEST_F(Command, ABarIsPulledAsFarAsByCalculix) {
  if (shell("command -v ccx").code != 0) GTEST_SKIP() << "ccx is not installed";
  write("bar.scn",
        "<Node name='root' gravity='0 0 0'><DefaultAnimationLoop/><RunSettings steps='1'/><StaticSolver/>"
        "<NewtonRaphsonSolver maxNbIterationsNewton='9' absoluteResidualStoppingThreshold='1e-9'/><SparseLDLSolver/>"
        "<RegularGridTopology n='3 2 2'/><MechanicalObject/><HexahedronElastoplasticFEMForceField "
        "youngModulus='1000' poissonRatio='0'/><FixedProjectiveConstraint indices='0 3 6 9'/>"
        "<ConstantForceField indices='2 5 8 11' totalForce='0.1 0 0'/></Node>");
  const Outcome written = shell("PATH=/usr/bin:$PATH '" HEXAPLAST_SOURCE_DIR
                                "/benchmarks/calculix/scene_deck.py' --hexaplast '" HEXAPLAST_COMMAND "' bar.scn");
  ASSERT_EQ(written.code, 0) << written.err;
  write("deck.inp", written.out);
  ASSERT_EQ(shell("OMP_NUM_THREADS=1 ccx -i deck").code, 0);
  Eigen::MatrixXd theirs = Eigen::MatrixXd::Constant(12, 3, std::nan(""));  // displacements [m], of seven digits
  std::istringstream lines(read("deck.dat"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream numbers(line);
    int node = 0;
    double x = 0, y = 0, z = 0;
    if (numbers >> node >> x >> y >> z) theirs.row(node - 1) << x, y, z;  // of the last increment in the end
  }

  EXPECT_EQ(succeeds("run bar.scn --quiet --final final.json").err, "");
  const Json final = json("final.json");
  const Eigen::MatrixXd ours = matrix(final["positions"]) - matrix(final["plastic_rest_positions"]);
  EXPECT_NEAR(ours(2, 0), 1e-4, 1e-10);
  EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 3e-4 * 1e-4);
}

}  // namespace
