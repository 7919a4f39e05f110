// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>
#include <map>

#include "support/command.hpp"
#include "support/compare.hpp"
#include "support/golden.hpp"

namespace {

using namespace hexaplast;
using support::Outcome;

class MeshExport : public support::Command {
 protected:
  std::string exported(const std::string& options) {
    const Outcome outcome = hexaplast("mesh export " + options + " --format inp -o deck.inp");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return support::content(directory_ / "deck.inp");
  }
};

// Two hexahedra of different stiffness along x, held at x = 0, pulled along x by a load that comes and goes; node 4 (at
// the middle) carries its weight alone.
const std::string kStaticBar =
    "<Node name='root' gravity='0 -10 0' dt='0.5'>\n<DefaultAnimationLoop/><RunSettings steps='9'/><StaticSolver/>"
    "<NewtonRaphsonSolver/><SparseLDLSolver/>\n<RegularGridTopology n='3 2 2' max='2 1 1'/><MechanicalObject/>"
    "<DiagonalMass vertexMass='0 0 0 0 0.25 0 0 0 0 0 0 0'/>\n<HexahedronElastoplasticFEMForceField name='material' "
    "youngModulus='1000 2000' poissonRatio='0.25'/><FixedProjectiveConstraint indices='0 3 6 9'/>\n<LinearForceField "
    "points='2' times='0 1 3 4' forces='0 0 0  1.5 0 0  1.5 0 0  0 0 0'/></Node>";

TEST_F(MeshExport, WritesTheDeckThatCalculixRuns) {
  write("bar.scn", kStaticBar);
  EXPECT_EQ(exported("bar.scn"),
            "*HEADING\nbar\n"
            "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0\n4, 0, 1, 0\n5, 1, 1, 0\n6, 2, 1, 0\n"
            "7, 0, 0, 1\n8, 1, 0, 1\n9, 2, 0, 1\n10, 0, 1, 1\n11, 1, 1, 1\n12, 2, 1, 1\n"
            "*ELEMENT, TYPE=C3D8, ELSET=BODY\n1, 1, 2, 5, 4, 7, 8, 11, 10\n2, 2, 3, 6, 5, 8, 9, 12, 11\n"
            "*ELSET, ELSET=MATERIAL1\n1\n*MATERIAL, NAME=MATERIAL1\n*ELASTIC\n1000, 0.25\n"
            "*SOLID SECTION, ELSET=MATERIAL1, MATERIAL=MATERIAL1\n"
            "*ELSET, ELSET=MATERIAL2\n2\n*MATERIAL, NAME=MATERIAL2\n*ELASTIC\n2000, 0.25\n"
            "*SOLID SECTION, ELSET=MATERIAL2, MATERIAL=MATERIAL2\n"
            "*NSET, NSET=FIXED\n1, 4, 7, 10\n*BOUNDARY\nFIXED, 1, 3\n"
            "*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1\n"
            "** Loads at t = 1 s on the undeformed body\n*CLOAD\n3, 1, 1.5\n5, 2, -2.5\n"
            "*NODE PRINT, NSET=ALL\nU\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n");
}

TEST_F(MeshExport, LoadsAreThoseOfTheTimeAskedFor) {
  write("bar.scn", kStaticBar);
  EXPECT_NE(exported("bar.scn --time 0.5").find("*CLOAD\n3, 1, 0.75\n"), std::string::npos);
  EXPECT_EQ(exported("bar.scn --time 4 --set root.gravity='0 0 0'").find("*CLOAD"), std::string::npos);
}

// Of two blocks: what joins them, what touches them and what holds them elastically. Prescribed forces are in it.
TEST_F(MeshExport, WarnsOfWhatTheDeckLeavesOut) {
  const auto block = [](const std::string& name, const std::string& rest) {
    return "<Node name='" + name +
           "'><RegularGridTopology n='2 2 2' max='1 1 1'/><MechanicalObject name='state'/>"
           "<UniformMass totalMass='1'/><HexahedronElastoplasticFEMForceField youngModulus='1000'/>" +
           rest + "</Node>";
  };
  write("two.scn",
        "<Node><DefaultAnimationLoop/><RunSettings steps='1'/><EulerImplicitSolver/><CGLinearSolver/>\n" +
            block("a",
                  "<ConstantForceField indices='0' forces='1 0 0'/>\n<RestShapeSpringsForceField name='anchor' "
                  "points='0'/>\n<InstrumentContactForceField name='probe' shape='sphere' radius='.1' keyTimes='0' "
                  "positions='5 5 5'/>") +
            block("b", "") +
            "\n<SpringForceField name='ligament' object1='@a' object2='@b' spring='0 1 5 0 1'/>\n"
            "<AttachProjectiveConstraint name='tie' object1='@a' object2='@b' indices1='1' indices2='1'/>\n"
            "<TissueContactForceField name='touch' object1='@a' object2='@b'/></Node>");
  const Outcome outcome = hexaplast("mesh export two.scn --format inp -o two.inp");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string end = "' is not in the deck, which has hexahedra, held nodes and prescribed loads\n";
  for (const char* what : {":3: warning: RestShapeSpringsForceField: 'anchor",
                           ":4: warning: InstrumentContactForceField: "
                           "'probe",
                           ":5: warning: SpringForceField: 'ligament",
                           ":6: warning: AttachProjectiveConstraint: "
                           "'tie",
                           ":7: warning: TissueContactForceField: 'touch"}) {
    const std::string warning = std::string("two.scn") + what + end;
    EXPECT_NE(outcome.err.find(warning), std::string::npos) << warning << outcome.err;
  }
  EXPECT_EQ(outcome.err.find("ConstantForceField"), std::string::npos) << outcome.err;
  EXPECT_EQ(hexaplast("mesh export two.scn --format vtu -o two.vtu").err.find("is not in the deck"), std::string::npos);
}

TEST_F(MeshExport, WritesTheMeshForParaView) {
  write("bar.scn", kStaticBar);
  EXPECT_EQ(hexaplast("mesh export bar.scn --format vtu -o bar.vtu").code, 0);
  EXPECT_EQ(support::content(directory_ / "bar.vtu").rfind("<?xml", 0), 0u);
}

TEST_F(MeshExport, RefusesWhatItCannotDo) {
  write("bar.scn", kStaticBar);
  write("free.scn",
        "<Node><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/>"
        "<MechanicalObject position='0 0 0'/><UniformMass totalMass='1'/></Node>");
  EXPECT_EQ(hexaplast("mesh").code, 2);
  EXPECT_EQ(hexaplast("mesh export bar.scn -o bar.stl --format stl").code, 2);
  EXPECT_EQ(hexaplast("mesh export bar.scn --format inp").code, 2);
  EXPECT_EQ(hexaplast("mesh export bar.scn --format inp -o nowhere/bar.inp").code, 5);
  const Outcome bodiless = hexaplast("mesh export free.scn --format inp -o free.inp");
  EXPECT_EQ(bodiless.code, 3);
  EXPECT_NE(bodiless.err.find("no body in the scene: there is nothing to export"), std::string::npos);
}

// The program that wrote the deck against the one that reads it, where the latter is installed.
class Calculix : public MeshExport {
 protected:
  void SetUp() override {
    MeshExport::SetUp();
    if (shell("command -v ccx").code != 0) GTEST_SKIP() << "ccx is not installed";
  }

  /// Displacements [m] that ccx finds for deck.inp, num_nodes x 3; they have seven digits.
  PointArray displacements(int num_nodes) {
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
    const Outcome outcome = hexaplast("run " + options + " --quiet --final final.json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    const support::Json final = support::Json::parse(support::content(directory_ / "final.json"));
    return support::matrix(final["positions"]) - support::matrix(final["material_positions"]);
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
  exported("bar.scn");
  const PointArray theirs = displacements(12), ours = our_displacements("bar.scn");
  EXPECT_NEAR(ours(2, 0), 1e-4, 1e-10);
  EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 3e-4 * 1e-4);
}

// On the same mesh, bent by more than half its length: the blended element is a little softer than C3D8, which locks.
TEST_F(Calculix, BendsTheCantileverALittleLess) {
  const std::string scene = std::string("'") + HEXAPLAST_SOURCE_DIR + "/scenes/cantilever_static.scn'";
  exported(scene);
  const PointArray theirs = displacements(525), ours = our_displacements(scene);
  const double their_tip = -theirs(20, 2) / 0.05, our_tip = -ours(20, 2) / 0.05;  // node 20: an end of the tip's edge
  EXPECT_GT(our_tip, their_tip);
  EXPECT_LT(our_tip, 1.03 * their_tip);
}

}  // namespace
