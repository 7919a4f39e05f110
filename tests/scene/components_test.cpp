// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "support/rows.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::force_of;
using support::four_nodes;
using support::in_root;
using support::read_and_init;
using support::rows;

const Vec3 kNone = Vec3::Zero();

// Loads
// ---------------------------------------------------------------------------------------------------------------------

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

TEST(ConstantForce, NeedsAForce) {
  EXPECT_EQ(
      errors_of(four_nodes("<ConstantForceField indices='3 1'/>")),
      "test.scn:1: error: ConstantForceField.forces: is not given, and totalForce neither: one of them is needed");
  EXPECT_EQ(errors_of(four_nodes("<ConstantForceField indices='3 1 0' forces='1 0 0  0 1 0'/>")),
            "test.scn:1: error: ConstantForceField.forces: 2 forces given for 3 nodes, must be one or as many");
  EXPECT_EQ(errors_of(four_nodes("<ConstantForceField indices='4' forces='1 0 0'/>")),
            "test.scn:1: error: ConstantForceField.indices: 4 must lie in [0, 4)");
}

TEST(LinearForce, NothingBeforeTheFirstTimeLinearBetweenAndTheLastForEver) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearForceField name='load' points='2 0' times='1 2 4' forces='0 0 0  10 0 -4  0 0 6'/>"));
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
}

TEST(LinearForce, TheFactorEndsWithTheHistory) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearForceField name='load' points='0' times='0 1' forces='1 0 0  2 0 0' force='3'/>"));
  EXPECT_EQ(force_of(scene, "load", 0.5)(0, 0), 4.5);
  EXPECT_EQ(force_of(scene, "load", 1)(0, 0), 2);
}

TEST(LinearForce, NeedsAscendingTimesWithOneForceEach) {
  EXPECT_EQ(errors_of(four_nodes("<LinearForceField points='0' times='0 1 1' forces='1 0 0  2 0 0  3 0 0'/>")),
            "test.scn:1: error: LinearForceField.times: 1 is followed by 1, must be ascending");
  EXPECT_EQ(errors_of(four_nodes("<LinearForceField points='0' times='0 1' forces='1 0 0'/>")),
            "test.scn:1: error: LinearForceField.forces: 1 forces given for 2 times, must be as many");
  EXPECT_EQ(errors_of(four_nodes("<LinearForceField points='0'/>")),
            "test.scn:1: error: LinearForceField.times: is empty, must hold at least one time");
}

// Nodes (1,0,0), (0,2,0): each turns around z at its own radius, with the same force.
TEST(TangentialForce, ActsAroundTheAxisAndDoesNotGrowWithTheRadius) {
  scene::Scene scene = read_and_init(four_nodes(
      "<TangentialForceField name='twist' indices='0 1' axis='0 0 -5' centre='0 0 9' times='0 1' forces='4 8'/>"));
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({{0, -4, 0}, {4, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_TRUE(force_of(scene, "twist", 0.5).isApprox(rows({{0, -6, 0}, {6, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_TRUE(force_of(scene, "twist", 2).isApprox(rows({{0, -8, 0}, {8, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_EQ(force_of(scene, "twist", -1e-9), rows({kNone, kNone, kNone, kNone}));
}

// The mean of (1,0,0) and (0,2,0) lies at (.5, 1): its tangent is (-1, .5)/|.|, shared by the two nodes.
TEST(TangentialForce, AGroupSharesTheForceOfItsCentre) {
  scene::Scene scene = read_and_init(four_nodes(
      "<TangentialForceField name='twist' indices='0 1' groupSize='2' axis='0 0 1' times='0' forces='20'/>"));
  const Vec3 share = 10 * Vec3(-1, 0.5, 0).normalized();
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({share, share, kNone, kNone}), 1e-14));
}

TEST(TangentialForce, TurnsWithTheBody) {
  scene::Scene scene =
      read_and_init(four_nodes("<TangentialForceField name='twist' indices='0' axis='0 0 1' times='0' forces='1'/>"));
  at<scene::MechanicalState>(scene, "nodes").positions().row(0) << -0.6, 0.8, 5;
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({{-0.8, -0.6, 0}, kNone, kNone, kNone}), 1e-14));
}

TEST(TangentialForce, RefusesHalfGroupsAndAnAxisWithoutDirection) {
  EXPECT_EQ(errors_of(four_nodes("<TangentialForceField indices='0 1 2' groupSize='2' times='0' forces='1'/>")),
            "test.scn:1: error: TangentialForceField.indices: 3 nodes do not form groups of 2");
  EXPECT_EQ(errors_of(four_nodes("<TangentialForceField indices='0' axis='0 0 0' times='0' forces='1'/>")),
            "test.scn:1: error: TangentialForceField.axis: is zero, must have a direction");
}

// Masses
// --------------------------------------------------------------------------------------------------------------------

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
  EXPECT_EQ(errors_of(four_nodes("<UniformMass/>")),
            "test.scn:1: error: UniformMass.totalMass: is not given, and vertexMass neither: one of them is needed");
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
            "test.scn:1: error: DiagonalMass.vertexMass: 2 values given for 12 nodes");
}

TEST(Mass, MovesWithItsEnergy) {
  scene::Scene scene = read_and_init(in_root("gravity='0 0 0'",
                                             "<MechanicalObject name='nodes' position='0 0 0  1 1 1' "
                                             "velocity='3 0 4  0 1 0'/><UniformMass vertexMass='2'/>"));
  EXPECT_DOUBLE_EQ(at<scene::OdeSolver>(scene, "euler").kinetic_energy(), 26);
}

// Time step
// -----------------------------------------------------------------------------------------------------------------

double fall_speed(const std::string& solver, const std::string& mass) {
  scene::Scene scene = read_and_init(
      "<Node dt='0.5' gravity='0 0 -10'><DefaultAnimationLoop/>" + solver +
      "<SparseLDLSolver/><MechanicalObject name='nodes' position='0 0 7' velocity='0 0 2'/>" + mass + "</Node>");
  scene.step();
  const auto& state = at<scene::MechanicalState>(scene, "nodes");
  auto& moving = const_cast<scene::MechanicalState&>(state);
  EXPECT_DOUBLE_EQ(moving.positions()(0, 2), 7 + 0.5 * moving.velocities()(0, 2));
  return moving.velocities()(0, 2);
}

// v' = (v + h g) / (1 + h rM) with the solver's damping; v' = v + h g / (1 + h m) with the mass's own.
TEST(TimeStep, AFreeMassFallsByTheDiscreteLaw) {
  const std::string mass = "<UniformMass vertexMass='3'/>";
  EXPECT_DOUBLE_EQ(fall_speed("<EulerImplicitSolver/>", mass), 2 - 5);
  EXPECT_DOUBLE_EQ(fall_speed("<EulerImplicitSolver rayleighMass='0.4'/>", mass), (2 - 5) / 1.2);
  EXPECT_DOUBLE_EQ(fall_speed("<EulerImplicitSolver/>", "<UniformMass vertexMass='3' rayleighMass='0.4'/>"),
                   2 - 5 / 1.2);
}

TEST(TimeStep, ForcesAreThoseOfItsBeginning) {
  // The load begins at t = .5: the first step (from 0 to .5) does not feel it, the second does.
  scene::Scene scene = read_and_init(four_nodes("<LinearForceField points='0' times='0.5' forces='0 6 0'/>"));
  const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
  scene.step();
  EXPECT_EQ(v, PointArray::Zero(4, 3));
  scene.step();
  EXPECT_EQ(v(0, 1), 3);
  EXPECT_EQ(scene.time(), 1);
}

TEST(TimeStep, ConstantNodalForcesOfTheStateAct) {
  scene::Scene scene =
      read_and_init(in_root("gravity='0 0 0' dt='1'",
                            "<MechanicalObject name='nodes' position='0 0 0  1 0 0' externalForce='0 0 0  0 3 "
                            "0'/><UniformMass vertexMass='2'/>"));
  scene.step();
  const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
  EXPECT_TRUE(v.isApprox(rows({kNone, {0, 1.5, 0}}), 1e-15)) << v;
}

TEST(TimeStep, ResetReturnsToTheBeginning) {
  scene::Scene scene = read_and_init(four_nodes("<ConstantForceField forces='1 0 2'/>"));
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  const PointArray first = state.positions();
  for (int i = 0; i < 3; ++i) scene.step();
  const PointArray third = state.positions();
  scene.reset();
  EXPECT_EQ(scene.time(), 0);
  EXPECT_EQ(state.positions(), first);
  for (int i = 0; i < 3; ++i) scene.step();
  EXPECT_EQ(state.positions(), third);
}

TEST(FixedConstraint, ZeroesTheAccelerationAndKeepsAVelocity) {
  scene::Scene scene = read_and_init(
      in_root("gravity='0 0 -10' dt='0.5'",
              "<MechanicalObject name='nodes' position='0 0 0  1 0 0  2 0 0' velocity='0 1 0  0 1 0  0 1 0'/>"
              "<UniformMass vertexMass='3'/><FixedProjectiveConstraint indices='2 1'/>"));
  scene.step();
  const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
  EXPECT_TRUE(v.isApprox(rows({{0, 1, -5}, {0, 1, 0}, {0, 1, 0}}), 1e-15)) << v;
}

TEST(FixedConstraint, HoldsNodeZeroByDefaultAndAllOnRequest) {
  const auto speeds = [](const std::string& constraint) {
    scene::Scene scene = read_and_init(four_nodes("<ConstantForceField forces='2 0 0'/>" + constraint));
    scene.step();
    return PointArray(at<scene::MechanicalState>(scene, "nodes").velocities());
  };
  EXPECT_EQ(speeds("<FixedProjectiveConstraint/>"), rows({kNone, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(speeds("<FixedProjectiveConstraint fixAll='true'/>"), PointArray::Zero(4, 3));
}

// Geometry
// ------------------------------------------------------------------------------------------------------------------

TEST(Grid, NumbersItsNodesWithXFastest) {
  scene::Scene scene =
      read_and_init("<Node><RegularGridTopology name='grid' n='2 3 4' min='1 0 0' max='2 4 9'/></Node>");
  auto& grid = at<scene::Topology>(scene, "grid");
  ASSERT_EQ(grid.positions().rows(), 24);
  EXPECT_EQ(grid.positions().row(1 + 2 * (2 + 3 * 1)), Eigen::RowVector3d(2, 4, 3));
  EXPECT_EQ(grid.hexahedra().size(), 6u);
  EXPECT_EQ(grid.hexahedra()[1], (Hexahedron{2, 3, 5, 4, 8, 9, 11, 10}));
  EXPECT_EQ(grid.integers("hexahedra").size(), 48u);
  EXPECT_EQ(errors_of("<Node><RegularGridTopology n='2 2'/></Node>"),
            "test.scn:1: error: RegularGridTopology.n: 2 numbers given, must be three");
  EXPECT_EQ(errors_of("<Node><RegularGridTopology min='0 1 0'/></Node>"),
            "test.scn:1: error: RegularGridTopology.max: must be greater than min in every direction");
}

TEST(State, IsScaledThenTurnedThenMoved) {
  scene::Scene scene = read_and_init(in_root(
      "",
      "<MechanicalObject name='nodes' position='1 2 3  0 0 0' scale3d='2 1 1' rotation='90 0 90' translation='10 0 0'/>"
      "<UniformMass totalMass='1'/>"));
  // (1,2,3) -> (2,2,3) -> about x (2,-3,2) -> about z (3,2,2) -> (13,2,2)
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  EXPECT_TRUE(state.positions().isApprox(rows({{13, 2, 2}, {10, 0, 0}}), 1e-14));
  EXPECT_EQ(state.rest_positions(), state.positions());
}

TEST(State, FieldsHaveOneRowPerNode) {
  EXPECT_EQ(errors_of(in_root(
                "", "<MechanicalObject position='0 0 0  1 0 0' velocity='1 0 0'/><UniformMass totalMass='1'/>")),
            "test.scn:1: error: MechanicalObject.velocity: 1 vectors given for 2 nodes");
  EXPECT_EQ(errors_of(in_root("", "<MechanicalObject/><UniformMass totalMass='1'/>")),
            "test.scn:1: error: MechanicalObject: has no nodes: needs position or a topology");
}

TEST(State, WithoutASolverNothingWouldMoveIt) {
  EXPECT_EQ(errors_of("<Node><MechanicalObject position='0 0 0  1 0 0'/></Node>"),
            "test.scn:1: error: MechanicalObject: nothing moves it: needs an OdeSolver in its node or above");
}

TEST(BoxROI, CountsItsBorderAsInsideAndSwapsItsCorners) {
  scene::Scene scene =
      read_and_init(four_nodes("<BoxROI name='exact' box='1 0 0 1 0 0'/><BoxROI name='swapped' box='1 2 0  -1 -1 0'/>"
                               "<BoxROI name='two' box='0 0 3 0 0 3  -2 -2 4 0 0 5'/>"));
  using Indices = std::vector<std::int64_t>;
  EXPECT_EQ(at<scene::Engine>(scene, "exact").integers("indices"), (Indices{0}));
  EXPECT_EQ(at<scene::Engine>(scene, "swapped").integers("indices"), (Indices{0, 1}));
  EXPECT_EQ(at<scene::Engine>(scene, "swapped").integers("indicesOut"), (Indices{2, 3}));
  EXPECT_EQ(at<scene::Engine>(scene, "two").integers("indices"), (Indices{2, 3}));
  EXPECT_EQ(at<scene::Engine>(scene, "two").reals("pointsInROI"), (std::vector<double>{0, 0, 3, -1, -1, 4}));
}

TEST(BoxROI, TakesHexahedraByAllNodesOrByCentre) {
  scene::Scene scene = read_and_init(
      in_root("",
              "<RegularGridTopology n='4 2 2' max='3 1 1'/><MechanicalObject/><UniformMass totalMass='1'/>"
              "<BoxROI name='strict' box='0 0 0 2.6 1 1'/>"
              "<BoxROI name='centre' box='0 0 0 2.6 1 1' strict='false'/>"));
  EXPECT_EQ(at<scene::Engine>(scene, "strict").integers("hexahedronIndices"), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(at<scene::Engine>(scene, "centre").integers("hexahedronIndices"), (std::vector<std::int64_t>{0, 1, 2}));
}

TEST(BoxROI, WarnsWhenItHoldsNothing) {
  scene::Scene scene = read_and_init(four_nodes("<BoxROI box='8 8 8 9 9 9'/>"));
  const std::vector<scene::Message> warnings = scene.diagnostics().take_warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(scene::format(warnings[0]), "test.scn:1: warning: BoxROI: holds no point");
}

// Bodies
// --------------------------------------------------------------------------------------------------------------------

std::string cube(const std::string& body, const std::string& more = "") {
  return in_root(
      "gravity='0 0 0' dt='0.02'",
      "<RegularGridTopology name='grid' n='3 2 2'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
      "<HexahedronElastoplasticFEMForceField name='body' " +
          body + "/>" + more);
}

TEST(BodyField, HandsItsAttributesToTheBody) {
  scene::Scene scene = read_and_init(
      cube("youngModulus='1000 2000' poissonRatio='0.3' yieldStress='50 70' yieldNorm='spectral' plasticFlowRate='2' "
           "rotationYield='0.1' rotationFlowRate='1.5' rotationPlasticity='none' hardening='0.3' volumeRestitution='4' "
           "inversionThreshold='0.2'"));
  const Body* body = at<scene::ForceField>(scene, "body").body();
  ASSERT_TRUE(body);
  const Model& model = body->state().model;
  ASSERT_EQ(model.materials.size(), 2u);
  const Material& second = model.materials[1];
  EXPECT_EQ(model.materials[0].young_modulus, 1000);
  EXPECT_EQ(second.young_modulus, 2000);
  EXPECT_EQ(second.poisson_ratio, 0.3);
  EXPECT_EQ(model.materials[0].yield_stress, 50);
  EXPECT_EQ(second.yield_stress, 70);
  EXPECT_EQ(second.flow_rate, 2);
  EXPECT_EQ(second.rotation_yield, 0.1);
  EXPECT_EQ(second.rotation_flow_rate, 1.5);
  EXPECT_EQ(second.hardening, 0.3);
  EXPECT_EQ(model.settings.yield_norm, YieldNorm::kSpectral);
  EXPECT_EQ(model.settings.rotation_plasticity, RotationPlasticity::kNone);
  EXPECT_EQ(model.settings.volume_restitution, 4);
  EXPECT_EQ(model.settings.inversion_threshold, 0.2);
}

// Whatever rows the core has.
TEST(BodyField, TakesEveryMemberOfMaterialAndSettings) {
  const auto body_of = [](scene::Scene& scene) { return at<scene::ForceField>(scene, "body").body(); };
  const auto text_of = [](const auto& row, double value) {
    const auto place = static_cast<std::size_t>(value);
    return row.at.type == MemberType::kWord ? std::string(row.words[place]) : fmt::format("{}", value);
  };
  for (const Row<Material>& row : material_rows()) {
    const double value = support::another(row, row.at.get({}));
    scene::Scene scene = read_and_init(cube(fmt::format("{}='{}'", row.name, text_of(row, value))));
    for (const Row<Material>& other : material_rows())
      EXPECT_EQ(other.at.get(body_of(scene)->material(0)), &other == &row ? value : other.at.get({})) << other.name;
  }
  for (const Row<Settings>& row : settings_rows()) {
    Settings expected;
    row.at.set(expected, support::another(row, row.at.get({})));
    scene::Scene scene = read_and_init(cube(fmt::format("{}='{}'", row.name, text_of(row, row.at.get(expected)))));
    EXPECT_EQ(body_of(scene)->settings(), expected) << row.name;
  }
}

TEST(BodyField, ShowsItsPlasticState) {
  scene::Scene scene = read_and_init(cube("youngModulus='1000' yieldStress='5' plasticFlowRate='5' hardening='1'"));
  auto& field = at<scene::ForceField>(scene, "body");
  at<scene::MechanicalState>(scene, "nodes").positions().col(0) *= 1.3;
  scene.step();
  const History& history = field.body()->state().history;
  EXPECT_GT(field.reals("plasticStrain")[1], 0);
  EXPECT_GT(field.reals("presentYieldStress")[0], 5);
  EXPECT_NEAR(field.reals("volumeRatio")[0], 1, 1e-3);
  EXPECT_EQ(PointArray(field.vectors3("materialPositions")), history.material);
  EXPECT_TRUE(field.integers("removed").empty());
  field.remove_elements(std::vector<int>{1});
  EXPECT_EQ(field.integers("removed"), std::vector<std::int64_t>{1});
  EXPECT_EQ(field.reals("volumeRatio")[1], 0);
}

TEST(BodyField, MayBecomeOfAnotherMaterialDuringTheRun) {
  scene::Scene scene = read_and_init(cube("youngModulus='1000' yieldStress='5' plasticFlowRate='5'"));
  auto& field = at<scene::ForceField>(scene, "body");
  at<scene::MechanicalState>(scene, "nodes").positions().col(0) *= 1.3;
  scene.step();
  const double strain = field.reals("plasticStrain")[0];
  field.find_data("youngModulus")->give(std::vector<double>{1000, 3000}, {});
  scene.step();
  EXPECT_EQ(field.body()->material(1).young_modulus, 3000);
  EXPECT_GE(field.reals("plasticStrain")[0], strain);

  EXPECT_THROW(field.find_data("youngModulus")->give(std::vector<double>{-1}, {}), InputError);
  EXPECT_THROW(field.find_data("removed")->give(std::vector<std::int64_t>{1}, {}), InputError);
  field.find_data("gradient")->give(std::string("vertex"), {});
  EXPECT_THROW(scene.step(), scene::SceneError);
}

TEST(BodyField, IsElasticByDefault) {
  scene::Scene scene = read_and_init(
      cube("", "<ConstantForceField indices='2' forces='0 90 0'/><FixedProjectiveConstraint indices='0 3 6 9'/>"));
  const auto& field = at<scene::ForceField>(scene, "body");
  for (int i = 0; i < 50; ++i) {
    scene.step();
    EXPECT_EQ(field.flow_report()->yielded, 0);
  }
  EXPECT_EQ(field.body()->plastic_rest_positions(), field.body()->mesh().positions());
}

TEST(BodyField, FlowsOnceAtTheEndOfEachStep) {
  scene::Scene scene = read_and_init(
      cube("yieldStress='10' plasticFlowRate='2'",
           "<ConstantForceField indices='2 5 8 11' forces='60 0 0'/><FixedProjectiveConstraint indices='0 3 6 9'/>"));
  const auto& field = at<scene::ForceField>(scene, "body");
  const long before = field.body()->state().history.version;
  force_of(scene, "body", 0);
  EXPECT_EQ(field.body()->state().history.version, before);
  for (int i = 0; i < 60; ++i) scene.step();
  EXPECT_GT(field.body()->state().history.version, before);
  EXPECT_EQ(field.flow_report()->yielded, 2);
  EXPECT_GT(field.body()->plastic_rest_positions().col(0).maxCoeff(), 1.01);

  scene.reset();
  EXPECT_EQ(field.body()->plastic_rest_positions(), field.body()->mesh().positions());
}

// The object's own damping enters the system matrix alone: A = M - h(h + s) K against M - h(h + r) K; the right-hand
// side of a body at rest does not see either, so that one step from rest is the same.
TEST(BodyField, OwnStiffnessDampingEntersTheMatrixAlone) {
  const auto first_velocities = [](const std::string& solver_damping, const std::string& own_damping) {
    scene::Scene scene = read_and_init(
        "<Node gravity='0 0 0' dt='0.02'><DefaultAnimationLoop/><EulerImplicitSolver rayleighStiffness='" +
        solver_damping +
        "'/><SparseLDLSolver/><RegularGridTopology n='3 2 2'/><MechanicalObject name='nodes'/><DiagonalMass "
        "massDensity='1000'/>"
        "<HexahedronElastoplasticFEMForceField rayleighStiffness='" +
        own_damping +
        "'/><ConstantForceField indices='2' forces='0 90 0'/><FixedProjectiveConstraint indices='0 3 6 9'/></Node>");
    scene.step();
    return PointArray(at<scene::MechanicalState>(scene, "nodes").velocities());
  };
  const PointArray by_solver = first_velocities("0.3", "0");
  EXPECT_TRUE(first_velocities("0", "0.3").isApprox(by_solver, 1e-12));
  EXPECT_FALSE(first_velocities("0", "0").isApprox(by_solver, 1e-2));
}

TEST(BodyField, RefusesWrongCountsAndUnstableRates) {
  const std::string field = "test.scn:1: error: HexahedronElastoplasticFEMForceField";
  EXPECT_EQ(errors_of(cube("youngModulus='1 2 3'")),
            field + ".youngModulus: 3 values given, must be one or 2 (one per hexahedron)");
  EXPECT_EQ(errors_of(cube("poissonRatio=''")),
            field + ".poissonRatio: 0 values given, must be one or 2 (one per hexahedron)");
  EXPECT_EQ(errors_of(cube("yieldStress='1 2 3'")),
            field + ".yieldStress: 3 values given, must be one or 2 (one per hexahedron)");
  EXPECT_NE(errors_of(cube("plasticFlowRate='51'")).find(field), std::string::npos);
  EXPECT_NE(errors_of(cube("volumeRestitution='34'")).find(field), std::string::npos);
}

TEST(BodyField, WarnsOfUnwiseRates) {
  scene::Scene scene = read_and_init(cube("plasticFlowRate='5' volumeRestitution='20'"));
  EXPECT_EQ(scene.diagnostics().take_warnings().size(), 2u);
}

TEST(BodyField, StandsBehindItsState) {
  EXPECT_EQ(errors_of(in_root("",
                              "<RegularGridTopology/><HexahedronElastoplasticFEMForceField/><MechanicalObject "
                              "name='nodes'/><UniformMass totalMass='1'/>")),
            "test.scn:1: error: HexahedronElastoplasticFEMForceField: needs its MechanicalState ('nodes') before it in "
            "the scene");
}

// Statics
// -------------------------------------------------------------------------------------------------------------------

// A bar of 1 x 1 x 1 m in two slices along x, held at x = 0; Young's modulus 1000 Pa, no lateral contraction.
std::string static_bar(const std::string& solver, const std::string& more, const std::string& material = "") {
  return "<Node gravity='10 0 0' dt='0.02'><DefaultAnimationLoop/><StaticSolver name='statics'/>" + solver +
         "<SparseLDLSolver/><RegularGridTopology n='3 2 2'/><MechanicalObject name='nodes' velocity='" +
         [] {
           std::string velocities;
           for (int n = 0; n < 12; ++n) velocities += " 0 0 1";
           return velocities;
         }() +
         "'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='1000' poissonRatio='0' " + material +
         "/><FixedProjectiveConstraint indices='0 3 6 9'/>" + more + "</Node>";
}
const std::string kNewton = "<NewtonRaphsonSolver maxNbIterationsNewton='50' maxNbIterationsLineSearch='8'/>";
const std::string kPull = "<ConstantForceField indices='2 5 8 11' totalForce='100 0 0'/>";

TEST(Statics, APulledBarGrowsByForceOverStiffness) {
  scene::Scene scene = read_and_init(static_bar(kNewton, kPull));
  EXPECT_TRUE(scene.diagnostics().take_warnings().empty());
  const SolveReport report = scene.step();
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.residual, 1e-5);
  EXPECT_GE(report.iterations, 1);
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  for (const int n : {2, 5, 8, 11}) EXPECT_NEAR(state.positions()(n, 0), 1.1, 1e-12);
  for (const int n : {1, 4, 7, 10}) EXPECT_NEAR(state.positions()(n, 0), 0.55, 1e-12);
  EXPECT_EQ(state.velocities(), PointArray::Zero(12, 3));
}

// Of 10 kg/m^3 and 10 m/s^2: the upper slice carries three quarters of 100 N, the lower one a quarter.
TEST(Statics, AHangingBarGrowsByItsWeight) {
  scene::Scene scene = read_and_init(static_bar(kNewton, "<DiagonalMass massDensity='10'/>"));
  scene.step();
  const PointArray& x = at<scene::MechanicalState>(scene, "nodes").positions();
  EXPECT_NEAR(x(1, 0), 0.5375, 1e-12);
  EXPECT_NEAR(x(2, 0), 1.05, 1e-12);
}

TEST(Statics, EquilibriumStaysEquilibrium) {
  scene::Scene scene = read_and_init(static_bar(kNewton, kPull));
  scene.step();
  const SolveReport report = scene.step();
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(report.residual, 0);
}

// Stretch 1.1 and stress 100 Pa in equilibrium, yield stress 50 Pa: gamma = 2 x 0.02 x (100 - 50) / 100 = 0.02, and of
// the stretch's logarithm the part without change of volume flows.
TEST(Statics, FlowFollowsEquilibrium) {
  scene::Scene scene =
      read_and_init(static_bar(kNewton, kPull, "yieldStress='50' plasticFlowRate='2' rotationPlasticity='none'"));
  scene.step();
  const PointArray& material = at<scene::ForceField>(scene, "body").body()->plastic_rest_positions();
  EXPECT_NEAR(material(2, 0) - material(0, 0), std::pow(1.1, 0.02 * 2 / 3), 1e-9);
}

TEST(Statics, WithoutNewtonRaphsonSolverOneIterationWithAWarning) {
  scene::Scene scene = read_and_init(
      static_bar("", "<ConstantForceField indices='2 5 8 11' totalForce='0 0 100'/>"));  // a bend: rotations change
  const std::vector<scene::Message> warnings = scene.diagnostics().take_warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(scene::format(warnings[0]),
            "test.scn:1: warning: StaticSolver.newtonSolver: no NewtonRaphsonSolver in its node or above: takes one "
            "with default settings, a single iteration per step");
  const SolveReport report = scene.step();
  EXPECT_FALSE(report.converged);
  EXPECT_GT(report.residual, 1e-5);
}

TEST(Statics, AFollowedLinkCountsBeforeTheNearest) {
  const std::string two =
      "<NewtonRaphsonSolver name='one'/><NewtonRaphsonSolver name='many' maxNbIterationsNewton='99' "
      "maxNbIterationsLineSearch='8'/>";
  const auto converges = [&](const std::string& link) {
    std::string text = static_bar(two, "<ConstantForceField indices='2 5 8 11' totalForce='0 0 100'/>");
    text.insert(text.find("name='statics'"), link);
    scene::Scene scene = read_and_init(text);
    return scene.step().converged;
  };
  EXPECT_FALSE(converges(""));
  EXPECT_TRUE(converges("newtonSolver='@many' "));
}

TEST(Statics, WhatFloatsHasNoEquilibrium) {
  std::string text = static_bar(kNewton, kPull);
  const std::string held = "<FixedProjectiveConstraint indices='0 3 6 9'/>";
  text.erase(text.find(held), held.size());
  scene::Scene scene = read_and_init(text);
  EXPECT_THROW(scene.step(), NumericalError);
}

TEST(Solvers, DirectAndIterativeAgree) {
  const auto positions = [](const std::string& solver) {
    scene::Scene scene = read_and_init(
        "<Node dt='0.02'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver +
        "<RegularGridTopology n='3 2 2'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='100'/>"
        "<HexahedronElastoplasticFEMForceField/><FixedProjectiveConstraint indices='0 3 6 9'/></Node>");
    for (int i = 0; i < 10; ++i) scene.step();
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  const PointArray direct = positions("<SparseLDLSolver/>");
  EXPECT_LT((positions("<CGLinearSolver iterations='500' tolerance='1e-14' threshold='1e-40'/>") - direct).norm(),
            1e-10);
  EXPECT_GT((direct - PointArray(PointArray::Zero(12, 3))).norm(), 1);
}

TEST(Solvers, OneStateAndAMassAreNeeded) {
  EXPECT_EQ(errors_of(in_root("", "<MechanicalObject position='0 0 0'/>")),
            "test.scn:1: error: EulerImplicitSolver: no mass in its node or below, must be at least one");
  EXPECT_EQ(
      errors_of("<Node><EulerImplicitSolver/><MechanicalObject position='0 0 0'/><UniformMass totalMass='1'/></Node>"),
      "test.scn:1: error: EulerImplicitSolver: needs a LinearSolver in its node or above");
}

// What is not simulated
// ------------------------------------------------------------------------------------------------------------------

TEST(Ignored, DrawingIsNotedBookkeepingIsSilent) {
  scene::Scene scene = read_and_init(
      "<Node><LineAxis size='3' whatever='@nowhere'/>\n"
      "<HexahedronSetGeometryAlgorithms template='Vec3d'/></Node>");
  std::vector<std::string> said;
  for (const scene::Message& message : scene.diagnostics().take_warnings()) said.push_back(scene::format(message));
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[1], "test.scn:1: note: LineAxis: visual: ignored here");
}

}  // namespace
