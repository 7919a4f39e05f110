// SPDX-License-Identifier: LGPL-2.1-or-later
// What a run writes about that which holds and loads its body, against what the scene says, and of several bodies,
// against runs of each alone.
#include "hexaplast/formats/mesh_import.hpp"
#include "record/conditions_vtu.hpp"
#include "support/command.hpp"
#include "support/compare.hpp"
#include "support/golden.hpp"

namespace {

using namespace hexaplast;
using namespace support;

class Conditions : public Command {
 protected:
  /// Runs a block of 0.2 x 0.2 x 0.4 m, 2 x 2 x 4 hexahedra, held at z = 0, under gravity, in steps of 0.01 s.
  void run(const std::string& loads, int steps = 3) {
    write("block.scn",
          "<Node name='root' gravity='0 -9.81 0' dt='0.01'>\n<DefaultAnimationLoop/><RunSettings outputEvery='1'/>"
          "<EulerImplicitSolver rayleighMass='1'/><SparseLDLSolver/>\n"
          "<RegularGridTopology name='grid' n='3 3 5' max='0.2 0.2 0.4'/><MechanicalObject name='nodes'/>"
          "<DiagonalMass massDensity='1000'/>\n<HexahedronElastoplasticFEMForceField youngModulus='5e4' "
          "poissonRatio='0.3'/>\n<FixedProjectiveConstraint indices='0-8'/>" +
              loads + "</Node>");

    succeeds("run block.scn --out run --force --frames 0 --quiet --steps " + std::to_string(steps));
  }

  ImportedState state(const std::string& name) const { return read_vtu_state(directory_ / "run" / name); }

  static PointArray vectors(const ImportedState& state, const std::string& name) {
    const auto found = std::ranges::find(state.point_data, name, &ImportedArray::name);
    EXPECT_NE(found, state.point_data.end()) << name;
    return Eigen::Map<const PointArray>(found->values.data(), state.mesh.positions.rows(), 3);
  }
  static Vec3 row(const PointArray& points, int node) { return points.row(node).transpose(); }

  PointArray load(int step) const { return vectors(state("mesh_00000" + std::to_string(step) + ".vtu"), "load"); }
};

// A prescribed node counts among them, until its path ends.
TEST_F(Conditions, FixedNodesAreThoseOfTheScene) {
  run("<LinearMovementProjectiveConstraint indices='44' keyTimes='0 0.02' movements='0 0 0  0 0 0.01'/>");
  for (const auto& [name, is_prescribed] : {std::pair{"mesh_000001.vtu", true}, {"mesh_000003.vtu", false}}) {
    const ImportedState at_end = state(name);
    const auto fixed = std::ranges::find(at_end.point_data, "fixed", &ImportedArray::name);
    ASSERT_NE(fixed, at_end.point_data.end());
    for (int node = 0; node < 45; ++node)
      EXPECT_EQ(fixed->values[node], node < 9 || (node == 44 && is_prescribed)) << name << ", node " << node;
  }
  EXPECT_TRUE(load(3).isZero(0)) << "weight is none, and neither are forces of the body itself";
  EXPECT_FALSE(is_there("run/instruments.pvd") || is_there("run/surface.pvd") || is_there("run/springs.pvd"));
}

// Steps take loads at their beginning: what led to the state after step k is the load at (k - 1) dt.
TEST_F(Conditions, LoadsAreThoseThatLedToTheState) {
  run("<ConstantForceField indices='36 40' totalForce='0 0.3 -1'/>"
      "<LinearForceField points='44' times='0 0.02' forces='0 0 0  3 0 0'/>");
  for (const auto& [step, pull] : {std::pair{0, 0.0}, {1, 0.0}, {2, 1.5}, {3, 3.0}}) {
    PointArray expected = PointArray::Zero(45, 3);
    for (const int node : {36, 40}) expected.row(node) << 0, 0.15, -0.5;
    expected.row(44) << pull, 0, 0;
    EXPECT_TRUE(agrees(load(step), expected, 1e-15)) << step;
  }
}

TEST_F(Conditions, LoadsOfWhatFollowsAreCarriedUp) {
  run("<ConstantForceField indices='40' forces='0 0 0.25'/><Node name='skin'><MechanicalObject name='points' "
      "position='0.05 0.15 0.35  0.11 0.19 0.12'/><ConstantForceField indices='0 1' forces='1 2 3  -0.5 0 4'/>"
      "<BarycentricMapping/></Node>");
  const PointArray forces = load(3), x = state("mesh_000003.vtu").mesh.positions;
  EXPECT_TRUE(agrees(Vec3(forces.colwise().sum().transpose()), Vec3(0.5, 2, 7.25), 1e-14));
  // the first point lies in the middle of the hexahedron at the corner (0, 0.2, 0.4): an eighth for each of its nodes
  for (const int node : {30, 31, 33, 34, 39, 42, 43})
    EXPECT_TRUE(agrees(row(forces, node), Vec3(0.125, 0.25, 0.375), 1e-14)) << node;
  EXPECT_TRUE(agrees(row(forces, 40), Vec3(0.125, 0.25, 0.625), 1e-14));
}

// Pressure on the end face pushes with pressure times area.
TEST_F(Conditions, PressureAndObstaclesAreLoads) {
  run("<SurfacePressureForceField pressure='50' min='-1 -1 0.39' max='1 1 0.41'/>");
  EXPECT_NEAR(load(0).colwise().sum().norm(), 50 * 0.2 * 0.2, 1e-13);

  run("<PlaneForceField normal='0 1 0' d='0.01' stiffness='200' damping='0'/>");
  const PointArray x = state("mesh_000003.vtu").mesh.positions, push = load(3);
  for (int node = 0; node < 45; ++node)
    EXPECT_TRUE(agrees(row(push, node), Vec3(0, 200 * std::max(0.0, 0.01 - x(node, 1)), 0), 1e-12)) << node;
}

// The springs of a grip pull by their stiffness times the way of the tool that the nodes have not followed, in the
// mean.
TEST_F(Conditions, PullsOfInstrumentsAreLoadsAndFilesOfTheirOwn) {
  run("<GraspForceField radius='0.01' keyTimes='0 1' positions='9 9 9  9 9 9' stiffness='5'/>"
      "<GraspForceField radius='0.12' keyTimes='0 0.02' positions='0.1 0.1 0.45  0.12 0.1 0.46' stiffness='300' "
      "releaseTime='0.025'/>"
      "<ConstantForceField indices='44' forces='0 7 0'/>",
      4);
  const ImportedState held = state("instruments_000003.vtu"), mesh = state("mesh_000003.vtu");
  const auto numbers = [&](const std::string& name) {
    return std::ranges::find(held.point_data, name, &ImportedArray::name)->values;
  };
  const std::vector<double> nodes = numbers("node");
  ASSERT_EQ(nodes.size(), 6u) << "the tool, and the nodes within 0.12 m";
  EXPECT_EQ(nodes[0], -1);
  EXPECT_EQ(numbers("id"), std::vector<double>(6, 1));
  const PointArray force = vectors(held, "force");

  PointArray rest_of_load = load(3);
  Eigen::RowVector3d way = Eigen::RowVector3d::Zero();
  const PointArray moved = vectors(mesh, "displacement");
  for (std::size_t k = 1; k < 6; ++k) {
    const int node = static_cast<int>(nodes[k]);
    EXPECT_EQ(held.mesh.positions.row(static_cast<Eigen::Index>(k)), mesh.mesh.positions.row(node));
    rest_of_load.row(node) -= force.row(static_cast<Eigen::Index>(k));
    way += moved.row(node) / 5;
  }
  const Eigen::RowVector3d tool(0.02, 0, 0.01);  // at t = 0.02, which the third step began with
  EXPECT_TRUE(agrees(PointArray(force.row(0)), PointArray(300 * (tool - way)), 1e-11));
  rest_of_load.row(44) -= Eigen::RowVector3d(0, 7, 0);
  EXPECT_TRUE(agrees(rest_of_load, PointArray(PointArray::Zero(45, 3)), 1e-13));

  EXPECT_EQ(state("instruments_000004.vtu").mesh.positions.rows(), 0) << "let go";
}

// The diagonals of the end face, one longer and one shorter than at rest, and what pulls two nodes back.
TEST_F(Conditions, SpringsAreLinesBetweenTheirEnds) {
  run("<SpringForceField spring='36 44 5 0 .5  38 42 5 0 .01'/><RestShapeSpringsForceField points='44 40' "
      "stiffness='9'/>");
  ASSERT_TRUE(is_there("run/springs.pvd"));
  const ImportedState springs = state("springs_000003.vtu");
  const PointArray x = state("mesh_000003.vtu").mesh.positions, rest = state("mesh_000000.vtu").mesh.positions;
  const std::vector<output::SpringLine> lines = output::read_springs(directory_ / "run/springs_000003.vtu");
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0].from, row(x, 36));
  EXPECT_EQ(lines[0].to, row(x, 44));
  EXPECT_TRUE(lines[0].is_slack);
  EXPECT_EQ(lines[1].from, row(x, 38));
  EXPECT_EQ(lines[1].to, row(x, 42));
  EXPECT_FALSE(lines[1].is_slack);
  for (const auto& [line, node] : {std::pair{2, 44}, {3, 40}}) {
    EXPECT_EQ(lines[line].from, row(x, node));
    EXPECT_EQ(lines[line].to, row(rest, node));
    EXPECT_GT((lines[line].to - lines[line].from).norm(), 1e-5) << "the block hangs down";
  }

  // a finished run is drawn with them
  const auto draw = [&](const std::string& name) {
    succeeds("render run --step 3 --out " + name);
    return read(name);
  };
  const std::string with = draw("with.png");
  fs::remove(directory_ / "run/springs.pvd");
  EXPECT_NE(draw("without.png"), with);
}

// A pair that is tied, one that is too far apart, and a spring to a body that tears.
TEST_F(Conditions, WhatIsReleasedOrTornOffIsNotShown) {
  const auto block = [](const std::string& name, const std::string& from, const std::string& to,
                        const std::string& more) {
    return "<Node name='" + name + "'><RegularGridTopology n='2 2 3' min='" + from + "' max='" + to +
           "'/><MechanicalObject name='nodes'/><UniformMass totalMass='.1'/><HexahedronElastoplasticFEMForceField "
           "youngModulus='3000' poissonRatio='.3'" +
           more + "/></Node>";
  };
  write("two.scn",
        "<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/><RunSettings outputEvery='1' steps='4'/><Node "
        "name='both'><EulerImplicitSolver/><CGLinearSolver iterations='200' tolerance='1e-9' threshold='1e-30'/>" +
            block("a", "0 0 0", ".1 .1 .2", " yieldStress='1' plasticFlowRate='5' hardening='.5' fractureStress='20'") +
            block("b", ".11 0 0", ".2 .1 .2", "") +
            "<AttachProjectiveConstraint object1='@a/nodes' object2='@b/nodes' indices1='1' "
            "indices2='0'/><SpringForceField object1='@a/nodes' object2='@b/nodes' "
            "spring='9 9 30 0 0'/></Node></Node>");
  succeeds("run two.scn --out run --force --frames 0 --quiet");
  EXPECT_EQ(output::read_springs(directory_ / "run/springs_000000.vtu").size(), 2u);
  const std::string removed = read("run/removed.csv");
  ASSERT_EQ(removed, "step,time,hexahedron,body\n3,0.03,1,a\n");
  EXPECT_EQ(output::read_springs(directory_ / "run/springs_000004.vtu").size(), 1u);
}

constexpr std::string_view kLiver =
    "<RegularGridTopology n='3 3 4' max='.02 .02 .03'/><MechanicalObject name='nodes'/><UniformMass totalMass='.1'/>"
    "<FixedProjectiveConstraint indices='0-8'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='3000' "
    "yieldStress='300' plasticFlowRate='5' fractureStretch='1.4'/><ConstantForceField indices='27-35' totalForce='0 0 "
    ".5'/>";
constexpr std::string_view kSac =
    "<RegularGridTopology n='2 3 2' min='.05 0 0' max='.06 .02 .01'/><MechanicalObject name='nodes'/>"
    "<UniformMass totalMass='.01'/><FixedProjectiveConstraint indices='0 1'/>"
    "<HexahedronElastoplasticFEMForceField name='body' youngModulus='1000'/>";

class SeveralBodiesRun : public Command {
 protected:
  SeveralBodiesRun() {
    const auto scene = [](const std::string& nodes) {
      return "<Node gravity='0 -1 0' dt='.01'><DefaultAnimationLoop/><RunSettings steps='60' outputEvery='20'/>"
             "<EulerImplicitSolver rayleighMass='1'/><SparseLDLSolver/>" +
             nodes + "</Node>";
    };
    const std::string liver = "<Node name='liver'>" + std::string(kLiver) + "</Node>",
                      sac = "<Node name='sac'>" + std::string(kSac) + "</Node>";
    write("both.scn", scene(liver + sac));
    write("liver.scn", scene(liver));
    write("sac.scn", scene(sac));
  }

  ImportedState state(const std::string& file) const { return read_vtu_state(directory_ / file); }
  static std::vector<double> array(const std::vector<ImportedArray>& arrays, const std::string& name) {
    const auto found = std::ranges::find(arrays, name, &ImportedArray::name);
    EXPECT_NE(found, arrays.end()) << name;
    return found == arrays.end() ? std::vector<double>() : found->values;
  }
};

TEST_F(SeveralBodiesRun, WritesThemOneBehindTheOther) {
  for (const std::string name : {"both", "liver", "sac"}) {
    succeeds("run " + name + ".scn --quiet --frames 1 --out " + name + " --final " + name + ".json");
  }
  const Json both = json("both.json"), liver = json("liver.json"), sac = json("sac.json");
  EXPECT_EQ(both["bodies"], Json::parse(R"([{"name": "liver", "first_node": 0, "nodes": 36, "first_hexahedron": 0,
      "hexahedra": 12}, {"name": "sac", "first_node": 36, "nodes": 12, "first_hexahedron": 12, "hexahedra": 2}])"));
  EXPECT_FALSE(liver.contains("bodies"));
  for (const char* list : {"positions", "velocities", "plastic_rest_positions"}) {
    Eigen::MatrixXd expected(48, 3);
    expected << matrix(liver[list]), matrix(sac[list]);
    EXPECT_LT((matrix(both[list]) - expected).cwiseAbs().maxCoeff(), 1e-12) << list;
  }
  EXPECT_EQ(both["volume_ratio"].size(), 14U);
  EXPECT_NE(both["state_hash"], liver["state_hash"]);

  // hexahedra that have gone, of the liver alone
  EXPECT_FALSE(both["removed"].empty());
  EXPECT_EQ(both["removed"], liver["removed"]);
  const std::string removed = read("both/removed.csv");
  EXPECT_TRUE(removed.starts_with("step,time,hexahedron,body\n")) << removed;
  EXPECT_TRUE(has(removed, ",liver\n"));
  EXPECT_FALSE(has(removed, ",sac\n"));

  const ImportedState first = state("both/mesh_000000.vtu"), last = state("both/mesh_000060.vtu");
  EXPECT_EQ(first.mesh.positions.rows(), 48);
  std::vector<double> body(14, 0);
  body[12] = body[13] = 1;
  EXPECT_EQ(array(first.cell_data, "body"), body);
  EXPECT_EQ(array(last.cell_data, "body").size(), 14 - both["removed"].size());
  EXPECT_EQ(array(last.cell_data, "body").back(), 1);
  const std::vector<double> fixed = array(first.point_data, "fixed");
  for (int n = 0; n < 48; ++n) EXPECT_EQ(fixed[n], n < 9 || n == 36 || n == 37) << n;
  EXPECT_TRUE(is_there("both/frames/frame_000060.png"));
  const std::string report = read("both/report.html");
  EXPECT_TRUE(has(report, "body liver"));
  EXPECT_TRUE(has(report, "body sac"));
}

TEST_F(SeveralBodiesRun, ChecksEach) {
  const Outcome checked = succeeds("check both.scn --json");
  const Json found = Json::parse(checked.out);
  EXPECT_EQ(found["nodes"], 48);
  EXPECT_EQ(found["hexahedra"], 14);
  EXPECT_EQ(found["held_nodes"], 11);
  EXPECT_TRUE(found["body"].is_null());
  ASSERT_EQ(found["bodies"].size(), 2U);
  EXPECT_EQ(found["bodies"][0]["name"], "liver");
  EXPECT_NEAR(found["bodies"][0]["mass"].get<double>(), 0.1, 1e-15);
  EXPECT_EQ(found["bodies"][1]["name"], "sac");
  EXPECT_NEAR(found["bodies"][1]["volume"].get<double>(), 0.01 * 0.02 * 0.01, 1e-15);
  EXPECT_NEAR(found["load"][1].get<double>(), -0.11, 1e-12);
  EXPECT_TRUE(has(hexaplast("check both.scn").out, "body                sac"));
}

TEST_F(SeveralBodiesRun, AreExportedAsOneMesh) {
  succeeds("mesh export both.scn -o both.vtu");
  succeeds("run both.scn --quiet --steps 1 --frames 0 --out both");
  const ImportedState exported = state("both.vtu"), ran = state("both/mesh_000000.vtu");
  EXPECT_EQ(exported.mesh.positions, ran.mesh.positions);
  EXPECT_EQ(exported.mesh.hexahedra, ran.mesh.hexahedra);
  EXPECT_EQ(array(exported.cell_data, "body"), array(ran.cell_data, "body"));
}

TEST_F(SeveralBodiesRun, AreFitted) {
  std::string scene = read("both.scn");
  scene.insert(scene.rfind("</Node>"),
               "<Probe name='sag' value='@sac/nodes.position' indices='11' component='y' change='true'/>");
  write("probed.scn", scene);
  succeeds("run probed.scn --quiet --steps 30 --frames 0 --out truth --set sac/body.youngModulus=2300");
  succeeds(
      "fit probed.scn --target truth/history.csv --compare probe_sag --out found --free "
      "sac/body.youngModulus=300:9000");
  EXPECT_NEAR(json("found/fit.json")["parameters"][0]["value"].get<double>(), 2300, 2);

  write("force.csv", "time,force\n0.1,1\n0.2,2\n");
  fails("fit both.scn --target force.csv --out none --free sac/body.youngModulus=300:9000", 3,
        "force.csv:1: error: column 'force': is that of the only body, and the scene has 2");
}

TEST_F(SeveralBodiesRun, ABenchmarkIsOfOne) {
  const Outcome refused = fails("bench --scene both.scn", 3, "`bench` takes scenes of one");
  EXPECT_TRUE(has(refused.err, "both.scn:1: error: "));
}

}  // namespace
