// SPDX-License-Identifier: LGPL-2.1-or-later
#include <nlohmann/json.hpp>
#include <regex>

#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

// Two cubes of 0.5 m, held at x = 0 and pulled at x = 1; total mass 2 kg.
std::string bar(const std::string& constraint, const std::string& material = "") {
  return "<Node gravity='0 0 0'>\n<DefaultAnimationLoop/><RunSettings steps='100'/><EulerImplicitSolver/>"
         "<SparseLDLSolver/>\n<RegularGridTopology n='3 2 2' max='1 .5 .5'/><MechanicalObject/><DiagonalMass "
         "totalMass='2'/>\n<HexahedronElastoplasticFEMForceField name='body' youngModulus='2000' poissonRatio='0' " +
         material + "/>\n" + constraint +
         "<LinearForceField points='2 5' times='0 0.5 0.9' forces='0 0 0  3 0 0  1 0 0'/></Node>";
}

const std::string kHeld = "<FixedProjectiveConstraint indices='0 3 6'/>";

TEST_F(Command, CheckSaysWhatASceneMeans) {
  write("bar.scn", bar(kHeld, "yieldStress='100' plasticFlowRate='2' restShape='joined' volumeRestitution='3'"));
  const Outcome json = succeeds("check bar.scn --json");
  EXPECT_EQ(json.err, "");
  const Json found = Json::parse(json.out);
  EXPECT_EQ(found["nodes"], 12);
  EXPECT_EQ(found["hexahedra"], 2);
  EXPECT_EQ(found["held_nodes"], 3);
  EXPECT_EQ(found["partly_held_nodes"], 0);
  EXPECT_EQ(found["loaded_nodes"], 2);
  EXPECT_NEAR(found["load"][0], 6, 1e-9);  // two nodes at the greatest force, t = 0.5 s
  EXPECT_NEAR(found["load_time"], 0.5, 1e-9);
  EXPECT_EQ(found["steps"], 100);
  EXPECT_EQ(found["warnings"], Json::array());
  EXPECT_GT(found["memory_bytes"], 1e6);
  const Json& body = found["body"];
  EXPECT_NEAR(body["mass"], 2, 1e-12);
  EXPECT_NEAR(body["density"], 8, 1e-12);
  EXPECT_NEAR(body["least_scaled_jacobian"], 1, 1e-12);
  EXPECT_NEAR(body["wave_speed"], std::sqrt(2000 / 8.0), 1e-9);  // nu = 0: E = lambda + 2 mu
  EXPECT_NEAR(body["yield_strain"], 0.05, 1e-12);
  EXPECT_NEAR(body["flow_per_step"], 0.02, 1e-12);
  EXPECT_NEAR(body["restitution_per_step"], 0.03, 1e-12);

  const Outcome text = succeeds("check bar.scn");
  for (const char* part : {"bar: can run", "12, of which 3 are fixed", "stress 100 Pa, strain 0.05", "flow 0.02",
                           "2 kg, 8 kg/m^3", "on 2 nodes, together (6, 0, 0) N at t = 0.5 s", "100 of 0.01 s"})
    EXPECT_TRUE(has(text.out, part));
}

// The loader skips all cells of the file: what it says explains why the topology has no hexahedra.
TEST_F(Command, WarningsStandBeforeTheErrorsThatTheyExplain) {
  write("second_order.msh", content(HEXAPLAST_TEST_DATA "/meshes/second_order.msh"));
  write("bar.scn",
        "<Node><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>\n<MeshGmshLoader name='l' "
        "filename='second_order.msh'/><MeshTopology src='@l'/><MechanicalObject/><UniformMass totalMass='1'/>\n"
        "<HexahedronElastoplasticFEMForceField/></Node>");
  for (const char* verb : {"check", "run"}) {
    const Outcome outcome = hexaplast(verb + std::string(" bar.scn"));
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err,
              "bar.scn:2: warning: MeshGmshLoader.filename: 1 cells are skipped: neither edges, triangles, quads nor "
              "hexahedra of first order: 1 hexahedra of 20 nodes (Gmsh type 17)\n"
              "bar.scn:3: error: HexahedronElastoplasticFEMForceField: its topology has no hexahedra\n");
  }
}

TEST_F(Command, CheckShowsRotationFlowOfABodyThatNeverYields) {
  write("bar.scn", bar(kHeld, "restShape='joined' rotationYield='0.15' rotationFlowRate='3'"));
  const Outcome text = hexaplast("check bar.scn");
  for (const char* part : {"yield               never", "rotation yield      0.15 rad", "rotation flow 0.03"})
    EXPECT_TRUE(has(text.out, part));
  EXPECT_EQ(Json::parse(hexaplast("check bar.scn --json").out)["body"]["rotation_yield"], 0.15);

  const Outcome never = hexaplast("check bar.scn --set body.rotationFlowRate=0");
  EXPECT_TRUE(has(never.out, "rotation yield      never"));
  EXPECT_FALSE(has(never.out, "rates times dt"));
}

TEST_F(Command, CheckAndRunWarnOfAMeshInMillimetres) {
  write("bar.scn", replaced(bar(kHeld), "max='1 .5 .5'", "max='100 50 50'"));
  const std::string warning =
      "bar.scn:4: warning: HexahedronElastoplasticFEMForceField: the body is 100 m long: are its coordinates in "
      "millimetres? They are read as metres\n";
  EXPECT_TRUE(has(succeeds("check bar.scn").err, warning));
  EXPECT_TRUE(has(succeeds("run bar.scn --steps 1").err, warning));
  const Json found = Json::parse(hexaplast("check bar.scn --json").out);
  EXPECT_EQ(std::ranges::count_if(
                found["warnings"],
                [](const Json& said) { return said.get<std::string>().find("millimetres") != std::string::npos; }),
            1);
}

// The second cube's corner at (1, .5, .5) is pushed behind the plane of its three neighbours.
TEST_F(Command, CheckAndRunWarnOfCornersThatAreInsideOut) {
  write("bent.scn",
        replaced(
            bar(kHeld), "<RegularGridTopology n='3 2 2' max='1 .5 .5'/>",
            "<MeshTopology position='0 0 0 .5 0 0 1 0 0 0 .5 0 .5 .5 0 1 .5 0 0 0 .5 .5 0 .5 1 0 .5 0 .5 .5 .5 .5 .5 "
            ".8 .3 .3' hexahedra='0 1 4 3 6 7 10 9 1 2 5 4 7 8 11 10'/>"));
  const std::string warning =
      "bent.scn:4: warning: HexahedronElastoplasticFEMForceField: 1 of the hexahedra is inverted at a corner; the "
      "worst is hexahedron 1: its scaled Jacobian is ";
  const auto count = [&](const std::string& text) {
    int number = 0;
    for (std::size_t at = text.find(warning); at != text.npos; at = text.find(warning, at + 1)) ++number;
    return number;
  };
  const Outcome check = succeeds("check bent.scn"), run = hexaplast("run bent.scn --steps 1 --out bent --summary sum");
  EXPECT_EQ(count(check.err), 1) << check.err;
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(count(run.err), 1) << run.err;
  EXPECT_EQ(count(read("bent/report.html")), 1);
  const Json found = Json::parse(hexaplast("check bent.scn --json").out);
  EXPECT_EQ(found["body"]["inside_out"], 1);
  EXPECT_EQ(found["warnings"].size(), 1u);
  EXPECT_LT(json("sum")["least_scaled_jacobian"], 0);
}

TEST_F(Command, CheckAndRunNameTheRegionsOfTheBody) {
  std::string scene = bar(kHeld, "yieldStress='90' plasticFlowRate='1'");
  scene.insert(scene.rfind("</Node>"),
               "<MaterialRegion name='hard' indices='1' youngModulus='8000' yieldStress='300'/><Node name='inner'>"
               "<MaterialRegion name='all' indices='0 1' yieldStress='80 100' hardening='0.5'/></Node>");
  write("bar.scn", scene);
  const std::string hard = "1 hexahedron, youngModulus 8000 Pa, yieldStress 300 Pa",
                    all = "2 hexahedra, yieldStress 80 to 100 Pa, hardening 0.5";
  const std::string checked = hexaplast("check bar.scn").out;
  EXPECT_TRUE(has(checked, "  region              hard: " + hard + "\n"));
  EXPECT_TRUE(has(checked, "  region              inner/all: " + all + "\n"));
  const Json regions = Json::parse(hexaplast("check bar.scn --json --set inner/all.hardening=2").out)["regions"];
  EXPECT_EQ(regions, Json::parse(R"([
    {"path": "hard", "hexahedra": 1, "values": {"youngModulus": [8000.0, 8000.0], "yieldStress": [300.0, 300.0]}},
    {"path": "inner/all", "hexahedra": 2, "values": {"yieldStress": [80.0, 100.0], "hardening": [2.0, 2.0]}}])"));

  const Outcome ran = succeeds("run bar.scn --steps 1 --out results --frames 0");
  EXPECT_TRUE(has(ran.out, "  region hard         " + hard + "\n"));
  EXPECT_TRUE(has(read("results/report.html"), all));
}

TEST_F(Command, CheckTakesNoStep) {
  write("bar.scn", bar(kHeld));
  succeeds("check bar.scn --set LinearForceField1.forces='1e308 0 0 1e308 0 0 1e308 0 0'");
}

// The row of a matrix is 0 for a node that no cell has.
TEST_F(Command, CheckFindsTheNodeForWhichNoStepCanBeSolved) {
  write("node.scn",
        "<Node dt='.01' gravity='9.81 0 0'>\n<DefaultAnimationLoop/><EulerImplicitSolver/>\n<SparseLDLSolver/>"
        "<MeshTopology hexahedra='0-7' position='0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1  1 1 1.5'/>"
        "<MechanicalObject/><DiagonalMass massDensity='100'/><HexahedronElastoplasticFEMForceField youngModulus='1e5'/>"
        "<FixedProjectiveConstraint indices='0 3 4 7'/></Node>");
  const std::string why = "Cholesky: the matrix is not positive definite (node 8 of 9 has no positive pivot along ";
  const Outcome checked = fails("check node.scn", 3, why);
  EXPECT_TRUE(checked.err.starts_with("node.scn:3: error: SparseLDLSolver")) << checked.err;
  EXPECT_EQ(checked.out, "");
  fails("run node.scn --steps 1", 4, why);
}

TEST_F(Command, CheckWarnsOfUnwiseChoices) {
  write("bar.scn", bar(""));
  const Outcome unsupported = succeeds("check bar.scn");
  EXPECT_EQ(unsupported.err, "bar.scn: warning: no node is fixed, and the loads do not balance: the body moves away\n");
  // what hangs on another state may stay
  const auto weight = [](const std::string& name) {
    return "<Node name='" + name + "'><MechanicalObject position='0 0 0'/><UniformMass totalMass='1'/>";
  };
  for (const std::string spring : {"", "<SpringForceField object1='@a' object2='@b/point' spring='0 0 1 0 1'/>"}) {
    write("joined.scn", "<Node gravity='0 0 -1'><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/>" +
                            spring + weight("a") + "<FixedProjectiveConstraint indices='0'/></Node>" + weight("b") +
                            "<Node name='point'><MechanicalObject position='0 0 0'/><IdentityMapping/></Node></Node>"
                            "</Node>");
    EXPECT_EQ(hexaplast("check joined.scn").err.find("moves away") == std::string::npos, !spring.empty());
  }
  write("held.scn", bar(kHeld));
  EXPECT_EQ(hexaplast("check held.scn --set body.poissonRatio=0.495 --set body.volumetric=sample").err,
            "held.scn: warning: poissonRatio = 0.495: above 0.49 hexahedra lock in bending unless volumetric is "
            "volumeRatio\n");
}

// Of cubes of 0.5 m with E / density = 250 m^2/s^2 and nu = 0: 2 sqrt(250) / 0.5 rad/s.
TEST_F(Command, CheckAndRunWarnOfVibrationsThatGrow) {
  const std::string published = "bending='blended' volumetric='sample'";
  write("bar.scn", std::regex_replace(bar(kHeld, published), std::regex("<EulerImplicitSolver"),
                                      "<EulerImplicitSolver rayleighStiffness='0.1' trapezoidalScheme='true'"));
  const std::string warning =
      "bar.scn:2: warning: EulerImplicitSolver.trapezoidalScheme: vibrations of up to 63.2 rad/s times dt = 0.04 s is "
      "2.53";
  for (const char* command : {"check bar.scn", "run bar.scn --steps 1"}) {
    EXPECT_EQ(hexaplast(command + std::string(" --set .dt=0.03")).err, "");
    const Outcome outcome = succeeds(command + std::string(" --set .dt=0.04"));
    EXPECT_EQ(outcome.err.find(warning), 0u) << outcome.err;
  }
}

// What else there is to say is FractureAdvice.
TEST_F(Command, CheckAndRunWarnOfFractureThatNeverComes) {
  write("bar.scn", bar(kHeld, "restShape='joined' rotationFlowRate='2' fractureStress='400'"));
  for (const char* command : {"check bar.scn", "run bar.scn --steps 1"}) {
    const Outcome elastic = succeeds(command);
    EXPECT_TRUE(has(elastic.err, "warning: HexahedronElastoplasticFEMForceField"));
    EXPECT_TRUE(has(elastic.err, "fractureStress has no effect: without yieldStress"));
  }
  expect_refused({{"check bar.scn --set body.plasticFlowRate=2 --set body.hardening=.1 --set body.yieldStress=500", 3,
                   "fractureStress = 400: must lie in [500, inf] Pa"}});
}

}  // namespace
