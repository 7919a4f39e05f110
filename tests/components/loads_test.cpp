// SPDX-License-Identifier: LGPL-2.1-or-later
// What loads, leads and grips nodes.
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "scene/interfaces.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

const Vec3 kNone = Vec3::Zero();

TEST(ConstantForce, OneForceForAllOrOneEachOrATotal) {
  scene::Scene scene =
      read_and_init(four_nodes("<ConstantForceField name='same' indices='3 1' forces='1 2 3'/>"
                               "<ConstantForceField name='each' indices='3 1' forces='1 0 0  0 1 0'/>"
                               "<ConstantForceField name='total' indices='3 1' totalForce='4 0 -2'/>"
                               "<ConstantForceField name='all' totalForce='4 0 0'/>"));
  EXPECT_EQ(force_of(scene, "same", 7), rows({kNone, {1, 2, 3}, kNone, {1, 2, 3}}));
  EXPECT_EQ(force_of(scene, "each", 0), rows({kNone, {0, 1, 0}, kNone, {1, 0, 0}}));
  EXPECT_EQ(force_of(scene, "total", 0), rows({kNone, {2, 0, -1}, kNone, {2, 0, -1}}));
  EXPECT_EQ(force_of(scene, "all", 0), rows({{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(at<scene::ForceField>(scene, "each").loaded_nodes()[0], 1);
}

TEST(Loads, NameWhatIsMissingOrDoesNotFit) {
  expect_errors(
      four_nodes,
      {{"<ConstantForceField indices='3 1'/>",
        "ConstantForceField.forces: is not given, and totalForce neither: one of them is needed"},
       {"<ConstantForceField indices='3 1 0' forces='1 0 0  0 1 0'/>",
        "ConstantForceField.forces: 2 forces given for 3 nodes, must be one or as many"},
       {"<ConstantForceField indices='4' forces='1 0 0'/>", "ConstantForceField.indices: 4 must lie in [0, 4)"},
       {"<LinearForceField points='0' times='0 1' forces='1 0 0'/>",
        "LinearForceField.forces: 1 forces given for 2 times, must be as many"},
       {"<LinearForceField points='0'/>", "LinearForceField.times: is empty, must hold at least one time"},
       {"<PlaneForceField normal='0 0 0'/>", "PlaneForceField.normal: is zero, must have a direction"},
       {"<UniformMass/>", "UniformMass.totalMass: is not given, and vertexMass neither: one of them is needed"}});
}

TEST(LinearForce, NothingBeforeTheFirstTimeLinearBetweenAndTheLastForEver) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearForceField name='load' points='2 0' times='1 2 4' forces='0 0 0  10 0 -4  0 0 6'/>"
                 "<LinearForceField name='scaled' points='0' times='0 1' forces='1 0 0  2 0 0' force='3'/>"));
  const auto on_node = [&](double time) -> Vec3 { return force_of(scene, "load", time).row(2).transpose(); };
  EXPECT_EQ(on_node(0.99), kNone);
  EXPECT_EQ(on_node(1), kNone);
  EXPECT_EQ(on_node(1.25), Vec3(2.5, 0, -1));
  EXPECT_EQ(on_node(2), Vec3(10, 0, -4));
  EXPECT_EQ(on_node(3), Vec3(5, 0, 1));
  EXPECT_EQ(on_node(4), Vec3(0, 0, 6));
  EXPECT_EQ(on_node(1e6), Vec3(0, 0, 6));
  EXPECT_EQ(force_of(scene, "load", 2),
            rows({{10, 0, -4}, kNone, {10, 0, -4}, kNone}));  // the whole force on each point
  EXPECT_EQ(force_of(scene, "scaled", 0.5)(0, 0), 4.5);
  EXPECT_EQ(force_of(scene, "scaled", 1)(0, 0), 2) << "the factor ends with the history";
}

std::string box(const std::string& load) {
  return in_root("gravity='0 0 0'",
                 "<RegularGridTopology name='grid' n='3 2 2' max='4 1 3'/><MechanicalObject name='nodes'/>"
                 "<UniformMass vertexMass='1'/>" +
                     load);
}

TEST(SurfacePressure, ActsOnTheFacesOfABoxAtTheirPresentShape) {
  scene::Scene scene =
      read_and_init(box("<SurfacePressureForceField name='load' pressure='10' min='3.9 -1 -1' max='4.1 2 4'/>"));
  PointArray f = force_of(scene, "load", 0);
  EXPECT_TRUE(f.colwise().sum().isApprox(Eigen::RowVector3d(30, 0, 0), 1e-15));
  EXPECT_TRUE(f.row(2).isApprox(Eigen::RowVector3d(10, 0, 0), 1e-15));
  EXPECT_TRUE(f.row(5).isApprox(Eigen::RowVector3d(5, 0, 0), 1e-15));
  EXPECT_EQ(at<scene::ForceField>(scene, "load").loaded_nodes().size(), 4u);

  at<scene::MechanicalState>(scene, "nodes").positions().col(1) *= 2;  // twice the area, still in the box
  EXPECT_TRUE(force_of(scene, "load", 0).isApprox(2 * f, 1e-15));
  at<scene::MechanicalState>(scene, "nodes").positions().col(0) *= 3;  // out of the box
  EXPECT_TRUE(force_of(scene, "load", 0).isZero(0));
}

TEST(SurfacePressure, WarnsOfFacesInsideTheBody) {
  scene::Scene all = read_and_init(box("<SurfacePressureForceField/>")),
               one = read_and_init(box("<SurfacePressureForceField min='3.9 -1 -1' max='4.1 2 4'/>"));
  EXPECT_EQ(warnings_of(all),
            "test.scn:1: warning: SurfacePressureForceField: 1 of 11 quads lie between two hexahedra, and load the "
            "inside of the body\n");
  EXPECT_EQ(warnings_of(one), "");
}

TEST(SurfacePressure, TakesQuadsAndTriangles) {
  const std::string mesh =
      "<MeshTopology name='mesh' position='0 0 0  2 0 0  2 2 0  0 2 0' quads='0 1 2 3' triangles='0 1 2  0 3 2'/>"
      "<MechanicalObject name='nodes'/><UniformMass vertexMass='1'/>";
  const auto total = [&](const std::string& load) {
    scene::Scene scene = read_and_init(in_root("", mesh + load));
    return Vec3(force_of(scene, "load", 0).colwise().sum().transpose());
  };
  EXPECT_EQ(total("<SurfacePressureForceField name='load' pressure='3'/>"), Vec3(0, 0, 12));
}

TEST(Plane, PushesNoHarderThanItsLimitInAnImplicitStep) {
  scene::Scene scene = read_and_init(
      "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
      "<MechanicalObject name='nodes' position='0 0 -1' velocity='0 0 -1'/><UniformMass vertexMass='1'/>"
      "<PlaneForceField normal='0 0 1' damping='0' maxForce='0.5'/></Node>");
  scene.step();
  EXPECT_NEAR(at<scene::MechanicalState>(scene, "nodes").velocities()(0, 2), -1 + 0.01 * 0.5, 1e-14);
}

// A mass of 1 kg thrown against a wall at z = 0 with k = 500, c = 5, by the implicit scheme with K and without the
// wall's damping in the matrix.
TEST(Plane, CatchesAMassByTheDiscreteLaw) {
  scene::Scene scene = read_and_init(
      "<Node dt='0.01' gravity='0 0 -10'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
      "<MechanicalObject name='nodes' position='0 0 0.05' velocity='0 0 -1'/><UniformMass vertexMass='1'/>"
      "<PlaneForceField normal='0 0 1'/></Node>");
  const double h = 0.01, k = 500, c = 5;
  double z = 0.05, v = -1, lowest = 0;
  for (int step = 0; step < 60; ++step) {
    scene.step();
    const bool touches = z < 0;
    const double force = -10 + (touches ? -k * z + c * z * v : 0);
    v += h * (force - (touches ? h * k * v : 0)) / (1 + (touches ? h * h * k : 0));
    z += h * v;
    lowest = std::min(lowest, z);
    ASSERT_NEAR(at<scene::MechanicalState>(scene, "nodes").positions()(0, 2), z, 1e-12) << step;
  }
  EXPECT_LT(lowest, -0.02);
}

Eigen::VectorXd masses_of(scene::Scene& scene, std::string_view path) {
  PointArray f = PointArray::Zero(at<scene::MechanicalState>(scene, "nodes").num_nodes(), 3);
  at<scene::Mass>(scene, path).add_gravity(Vec3(0, 0, 1), f);
  return f.col(2);
}

TEST(Mass, UniformMassIsTheTotalSharedOrTheOneOfEachNode) {
  scene::Scene scene =
      read_and_init(four_nodes("<UniformMass name='total' totalMass='6' vertexMass='9'/>"
                               "<UniformMass name='each' vertexMass='9'/>"));
  EXPECT_EQ(masses_of(scene, "total"), Eigen::VectorXd::Constant(4, 1.5));
  EXPECT_EQ(masses_of(scene, "each"), Eigen::VectorXd::Constant(4, 9));
}

// Two boxes of .5 x 1 x 2: a node of one cell gets an eighth of its mass, a shared one two.
TEST(Mass, DiagonalMassGivesEachNodeItsEighths) {
  const auto two_cells = [](const std::string& mass) {
    return in_root("gravity='0 0 0'",
                   "<RegularGridTopology n='3 2 2' max='1 1 2'/><MechanicalObject name='nodes'/>" + mass);
  };
  scene::Scene scene =
      read_and_init(two_cells("<DiagonalMass name='density' massDensity='10'/>"
                              "<DiagonalMass name='total' totalMass='4' massDensity='10'/>"
                              "<DiagonalMass name='none'/>"
                              "<DiagonalMass name='nodal' vertexMass='1 2 3 4 5 6 7 8 9 10 11 12'/>"));
  const Eigen::VectorXd density = masses_of(scene, "density");
  ASSERT_EQ(density.size(), 12);
  for (int n = 0; n < 12; ++n) EXPECT_NEAR(density[n], n % 3 == 1 ? 2.5 : 1.25, 1e-15) << n;
  EXPECT_TRUE(masses_of(scene, "total").isApprox(density * 0.2, 1e-15));
  EXPECT_TRUE(masses_of(scene, "none").isApprox(density * 0.05, 1e-15));
  EXPECT_EQ(masses_of(scene, "nodal")[4], 5);
  EXPECT_EQ(errors_of(two_cells("<DiagonalMass vertexMass='1 2'/>")),
            "test.scn:1: error: DiagonalMass.vertexMass: 2 values given for 12 nodes, must be one or one per node");
}

// A cube of 1 m at rest, which begins twice as large.
TEST(Mass, OfVolumesAtRestOrAtFirst) {
  scene::Scene scene = read_and_init(in_root(
      "gravity='0 0 0'",
      "<RegularGridTopology n='2 2 2'/><MechanicalObject name='nodes' scale3d='2 2 2' rest_position='0 0 0 1 0 0 "
      "0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1'/><DiagonalMass name='rest' massDensity='8'/>"
      "<DiagonalMass name='first' massDensity='8' computeMassOnRest='false'/>"));
  EXPECT_TRUE(masses_of(scene, "rest").isApprox(Eigen::VectorXd::Ones(8), 1e-15));
  EXPECT_TRUE(masses_of(scene, "first").isApprox(Eigen::VectorXd::Constant(8, 8), 1e-15));
}

TEST(PartialFixed, HoldsTheChosenDirectionsAlone) {
  scene::Scene scene =
      read_and_init(four_nodes("<ConstantForceField forces='2 4 6'/>"
                               "<PartialFixedProjectiveConstraint indices='1 3' fixedDirections='1 0 1'/>"));
  scene.step();
  EXPECT_EQ(velocities(scene), rows({{1, 2, 3}, {0, 2, 0}, {1, 2, 3}, {0, 2, 0}}));

  scene::Scene all =
      read_and_init(four_nodes("<ConstantForceField forces='2 4 6'/>"
                               "<PartialFixedProjectiveConstraint fixAll='1' fixedDirections='0 0 1'/>"));
  all.step();
  EXPECT_EQ(velocities(all), rows({{1, 2, 0}, {1, 2, 0}, {1, 2, 0}, {1, 2, 0}}));
  EXPECT_EQ(errors_of(four_nodes("<PartialFixedProjectiveConstraint fixedDirections='1 0'/>")),
            "test.scn:1: error: PartialFixedProjectiveConstraint.fixedDirections: 2 numbers given, must be three");
}

TEST(Fixed, KeepsAVelocityUnlessAskedToTakeIt) {
  const auto speed = [](const std::string& constraint) {
    scene::Scene scene = read_and_init(in_root("gravity='0 0 -10'",
                                               "<MechanicalObject name='nodes' position='0 0 0' velocity='1 2 3'/>"
                                               "<UniformMass vertexMass='3'/>" +
                                                   constraint));
    scene.step();
    return PointArray(velocities(scene));
  };
  EXPECT_EQ(speed("<FixedProjectiveConstraint/>"), rows({{1, 2, 3}}));
}

TEST(Fixed, HoldsNodeZeroByDefaultOthersOrAllOnRequest) {
  const auto speeds = [](const std::string& constraint) {
    scene::Scene scene = read_and_init(four_nodes("<ConstantForceField forces='2 0 0'/>" + constraint));
    scene.step();
    return PointArray(velocities(scene));
  };
  EXPECT_EQ(speeds("<FixedProjectiveConstraint/>"), rows({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(speeds("<FixedProjectiveConstraint indices='2 1'/>"), rows({{1, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(speeds("<FixedProjectiveConstraint fixAll='true'/>"), PointArray::Zero(4, 3));
}

// h = .5. The step that begins at t ends with the movement m(t), and with the slope there; from the last key time on
// the node is free and keeps the last velocity.
TEST(LinearMovement, LagsByOneStepAndReleasesAtTheLastKey) {
  const std::string motion =
      "<LinearMovementProjectiveConstraint indices='2' keyTimes='0 1 2' movements='0 0 0  3 0 0  3 8 0'/>";
  for (const std::string solver :
       {"<SparseLDLSolver/>", "<CGLinearSolver iterations='50' tolerance='1e-14' threshold='0'/>"}) {
    scene::Scene scene =
        read_and_init("<Node gravity='0 0 0' dt='0.5'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver +
                      "<MechanicalObject name='nodes' position='1 0 0  0 2 0  0 0 3'/><UniformMass vertexMass='1'/>"
                      "<ConstantForceField forces='0 0 2'/>" +
                      motion + "</Node>");
    EXPECT_EQ(velocities(scene).row(2), Eigen::RowVector3d(3, 0, 0)) << "the first slope, before the first step";
    const Vec3 expected_x[] = {{0, 0, 3}, {1.5, 0, 3}, {3, 0, 3}, {3, 4, 3}, {3, 8, 3.5}, {3, 12, 4.5}};
    const Vec3 expected_v[] = {{3, 0, 0}, {3, 0, 0}, {0, 8, 0}, {0, 8, 0}, {0, 8, 1}, {0, 8, 2}};
    for (int k = 0; k < 6; ++k) {
      scene.step();
      EXPECT_TRUE(nodes(scene).row(2).isApprox(expected_x[k].transpose(), 1e-14)) << k;
      EXPECT_TRUE(velocities(scene).row(2).isApprox(expected_v[k].transpose(), 1e-14)) << k;
      EXPECT_DOUBLE_EQ(nodes(scene)(0, 2), 0.5 * 0.5 * 2 * (k + 1) * (k + 2) / 2) << "the others fall freely";
    }
    scene.reset();
    scene.step();
    EXPECT_TRUE(nodes(scene).row(2).isApprox(expected_x[0].transpose(), 1e-15));
  }
}

TEST(LinearMovement, WarnsOfASecondMotionOfANodeAtThatTime) {
  const auto warnings = [](const std::string& indices, const std::string& times, const std::string& partial = "") {
    scene::Scene scene = read_and_init(four_nodes(
        "<PartialLinearMovementProjectiveConstraint name='a' indices='0 2' keyTimes='0 1' movements='0 0 0  1 0 0' "
        "movedDirections='1 0 0'/><PartialLinearMovementProjectiveConstraint indices='" +
        indices + "' keyTimes='" + times + "' movements='0 0 0  2 0 0' " + partial + "/>"));
    return warnings_of(scene);
  };
  EXPECT_EQ(warnings("1 2", "0.5 2"),
            "test.scn:1: warning: PartialLinearMovementProjectiveConstraint: moves nodes that 'a' moves too at that "
            "time\n");
  EXPECT_EQ(warnings("1 3", "0.5 2") + warnings("1 2", "1 2") + warnings("1 2", "0.5 2", "movedDirections='0 1 1'"),
            "");
}

TEST(LinearMovement, BeginsWithItsFirstKey) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearMovementProjectiveConstraint indices='0' keyTimes='0.5 9.5' movements='4 5 5  13 5 5'/>"));
  scene.step();  // ends with what holds at t = 0: nothing
  EXPECT_EQ(nodes(scene).row(0), Eigen::RowVector3d(1, 0, 0));
  scene.step();
  EXPECT_EQ(nodes(scene).row(0), Eigen::RowVector3d(5, 5, 5));
  scene.step();
  EXPECT_EQ(nodes(scene).row(0), Eigen::RowVector3d(5.5, 5, 5));
  EXPECT_EQ(errors_of(four_nodes("<LinearMovementProjectiveConstraint keyTimes='0 1' movements='0 0 0'/>")),
            "test.scn:1: error: LinearMovementProjectiveConstraint.movements: 1 movements given for 2 times, must be "
            "as many");
}

// Eight steps of .1 s come to a little less than .8 s. What begins or ends at .8 s does so in the step that begins
// there, but for components of SOFA, which compare as SOFA does.
TEST(KeyTimes, AreNotLateByRounding) {
  ASSERT_LT(.1 + .1 + .1 + .1 + .1 + .1 + .1 + .1, .8);
  struct Case {
    std::string name, lines;
    bool is_of_sofa = false;
  };
  const Case cases[] = {
      {"an attribute changes",
       attribute_change("load", "totalForce", "KEY", "0 0 3") + "<ConstantForceField name='load' totalForce='0 0 1'/>"},
      {"a load around an axis begins",
       "<TangentialForceField indices='1' groupSize='1' axis='0 0 1' centre='0 0 0' times='KEY 99' forces='3 3'/>"},
      {"a grip closes", "<GraspForceField radius='5' graspTime='KEY' keyTimes='0' positions='1 1 1' stiffness='20'/>"},
      {"a grip opens", "<GraspForceField radius='5' releaseTime='KEY' keyTimes='0' positions='1 1 1' stiffness='20'/>"},
      {"a grip stops",
       "<GraspForceField radius='5' keyTimes='0 KEY' positions='0 0 0  KEY 0 0' stiffness='1e-200' damping='3'/>"},
      {"a motion ends", "<LinearMovementProjectiveConstraint indices='0' keyTimes='0 KEY' movements='0 0 0  0 0 0'/>",
       true},
      {"a load begins", "<LinearForceField points='1' times='KEY 99' forces='3 0 0  3 0 0'/>", true}};
  for (const auto& [name, lines, is_of_sofa] : cases) {
    const auto at_end = [&](const std::string& key) {
      std::string text = four_nodes(lines);
      for (std::size_t at = text.find("KEY"); at != text.npos; at = text.find("KEY")) text.replace(at, 3, key);
      text.replace(text.find("gravity='0 0 0' dt='0.5'"), 24, "gravity='0 0 -1' dt='0.1'");
      scene::Scene scene = read_and_init(text);
      run(scene, 12);
      return nodes(scene);
    };
    const PointArray at_key = at_end(".8"), before = at_end(".795"), after = at_end(".85");
    EXPECT_EQ(at_key, is_of_sofa ? after : before) << name;
    EXPECT_NE(at_key, is_of_sofa ? before : after) << name;
  }
}

TEST(PartialLinearMovement, LeavesTheOtherDirectionsFree) {
  scene::Scene scene = read_and_init(
      four_nodes("<ConstantForceField forces='0 2 4'/><PartialLinearMovementProjectiveConstraint indices='1' "
                 "keyTimes='0 10' movements='0 0 0  10 10 10' movedDirections='1 0 0'/>"));
  scene.step();
  scene.step();
  EXPECT_TRUE(nodes(scene).row(1).isApprox(Eigen::RowVector3d(0.5, 2 + 1.5, 3), 1e-15));
  EXPECT_TRUE(velocities(scene).row(1).isApprox(Eigen::RowVector3d(1, 2, 4), 1e-15));
}

using Numbers = std::vector<std::int64_t>;

/// A bar of 0.1 x 0.1 x 0.4 m, four hexahedra without lateral contraction, and a tool above its upper end; E A / L is
/// 2000 N/m.
std::string gripped_bar(const std::string& grasp) {
  return "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='1' "
         "rayleighStiffness='0.02'/><SparseLDLSolver/><RegularGridTopology n='2 2 5' max='0.1 0.1 0.4'/>"
         "<MechanicalObject name='nodes'/><UniformMass totalMass='4'/><HexahedronElastoplasticFEMForceField "
         "name='body' "
         "youngModulus='8e4' poissonRatio='0'/><FixedProjectiveConstraint indices='0-3'/>" +
         grasp + "</Node>";
}

std::string grasp(const std::string& attributes,
                  const std::string& path = "keyTimes='0 0.1' positions='.05 .05 .42  .05 .05 .46'") {
  return "<GraspForceField name='grasp' radius='0.08' " + path + " " + attributes + "/>";
}

TEST(Grasp, HoldsWhatIsNearFromItsTimeToTheOther) {
  scene::Scene scene = read_and_init(four_nodes(
      "<GraspForceField name='grasp' keyTimes='0.5 2' positions='0 0 3.5  0 3 3.5' radius='1.6' graspTime='0.5' "
      "releaseTime='1.5' stiffness='8'/>"));
  auto& instrument = at<scene::Component>(scene, "grasp");
  const auto held = [&] { return instrument.integers("grasped"); };
  scene.step();
  EXPECT_EQ(held(), Numbers{});
  EXPECT_EQ(force_of(scene, "grasp", 0.5), PointArray(PointArray::Zero(4, 3))) << "not yet closed";
  scene.step();  // from t = 0.5
  EXPECT_EQ(held(), (Numbers{2, 3}));
  EXPECT_EQ(nodes(scene).row(2), Eigen::RowVector3d(0, 0, 3));  // it closes without a pull
  // by then 1 m on, 4 N/m on each node
  EXPECT_TRUE(agrees(force_of(scene, "grasp", 1), rows({{0, 0, 0}, {0, 0, 0}, {0, 4, 0}, {0, 4, 0}}), 1e-14));
  scene.step();  // from t = 1
  EXPECT_TRUE(agrees(instrument.vector3("force"), Vec3(0, 8, 0), 1e-14));
  const PointArray v = at<scene::MechanicalState>(scene, "nodes").velocities();
  EXPECT_GT(v(2, 1), 0.1);
  run(scene, 2);  // from t = 1.5 and 2
  EXPECT_EQ(held(), Numbers{});
  EXPECT_EQ(instrument.vector3("force"), Vec3(0, 0, 0));
  EXPECT_TRUE(agrees(at<scene::MechanicalState>(scene, "nodes").velocities(), v, 1e-14));
  scene.reset();
  run(scene, 3);
  EXPECT_EQ(at<scene::MechanicalState>(scene, "nodes").velocities(), v) << "it closes again";
}

TEST(Grasp, TellsItsLoadAndIsAsBefore) {
  scene::Scene scene = read_and_init(four_nodes(
      "<GraspForceField name='grasp' keyTimes='0 2' positions='0 0 3.5  0 3 3.5' radius='1.6' stiffness='8'/>"));
  run(scene, 2);
  auto& field = at<scene::ForceField>(scene, "grasp");
  const Vec3 before = field.vector3("force");
  const PointArray x = PointArray(nodes(scene).array() + 0.25), v = PointArray::Zero(4, 3);
  PointArray load = PointArray::Ones(4, 3), force = load;
  dynamic_cast<const scene::Load&>(field).add_load(1.5, x, v, load);
  EXPECT_EQ(field.vector3("force"), before);
  field.add_force(1.5, x, v, force);
  EXPECT_EQ(load, force);
  EXPECT_NE(field.vector3("force"), before) << "which a call of add_force changes";
}

TEST(Grasp, HoldsEmbeddedPoints) {
  const std::string skin =
      "<Node name='skin'><MechanicalObject name='points' position='.02 .03 .38  .08 .07 .39  .05 .05 .1'/>"
      "<BarycentricMapping/>" +
      grasp("stiffness='3000' maxForce='20'") + "</Node>";
  scene::Scene scene = read_and_init(gripped_bar(skin));
  run(scene, 600);
  EXPECT_EQ(at<scene::Component>(scene, "skin/grasp").integers("grasped"), (Numbers{0, 1}));
  EXPECT_NEAR(at<scene::Component>(scene, "skin/grasp").vector3("force")[2], 20, 1e-3);
  // 20 N from below the points on: the same reaction at the foot
  PointArray f = PointArray::Zero(20, 3);
  at<scene::ForceField>(scene, "body").add_force(0, nodes(scene), f, f);
  EXPECT_NEAR(f.topRows(4).col(2).sum(), 20, 1e-2);
}

TEST(Grasp, ChoosesAmongTheNodesThatCanBeHeld) {
  scene::Scene scene = read_and_init(gripped_bar(grasp("indices='12-17'", "keyTimes='0' positions='.05 .05 .35'")));
  scene.step();
  EXPECT_EQ(at<scene::Component>(scene, "grasp").integers("grasped"), Numbers{});
  EXPECT_EQ(scene::format(scene.diagnostics().take_warnings().back()),
            "test.scn:1: warning: GraspForceField.radius: the grip closes on nothing: no node within 0.08 m of (0.05, "
            "0.05, 0.35) at t = 0 s");
  scene::Scene near = read_and_init(gripped_bar(grasp("indices='12-17'", "keyTimes='0' positions='.05 .05 .38'")));
  near.step();
  EXPECT_EQ(at<scene::Component>(near, "grasp").integers("grasped"), (Numbers{16, 17}));
}

}  // namespace
