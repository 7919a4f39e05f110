// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes whose bodies have joints opened in a run: what acts on nodes goes on, acts on them as before in sum, and is as
// at first after reset.
#include <random>

#include "hexaplast/body.hpp"
#include "record/recorder.hpp"
#include "scene/parts.hpp"
#include "scene/scene.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// What acts on the nodes of a state but bodies and contacts, by name.
struct Acting {
  std::string name;
  PointArray forces, product;  // [N] forces, and those per velocity by products of x and v
};

/// At the present positions and velocities.
std::vector<Acting> acting_on(scene::Scene& scene, scene::MechanicalState& state) {
  std::vector<Acting> all;
  const PointArray &x = state.positions(), &v = state.velocities();
  const PointArray none = PointArray::Zero(x.rows(), 3);
  for (scene::Mass* mass : scene::masses_of(scene.root(), state)) {
    Acting& acts = all.emplace_back(std::string(mass->name()), none, none);
    mass->add_gravity(Vec3(1, 2, 3), acts.forces);
    mass->add_product(1, v, acts.product);
  }
  for (scene::ForceField* field : scene.root().all<scene::ForceField>()) {
    if (!scene::acts_on(*field, state) || field->is_body() || field->is_one_sided()) continue;
    Acting& acts = all.emplace_back(std::string(field->name()), none, none);
    field->add_force(scene.time(), x, v, acts.forces);
    field->add_stiffness_product(1, x, acts.product);
    field->add_damping_product(1, v, acts.product);
  }
  return all;
}

/// The rows of all copies of a node together.
PointArray together(const PointArray& field, const NodeCopies& copies) {
  PointArray sum = PointArray::Zero(copies.num_initial(), 3);
  for (int n = 0; n < copies.num_nodes(); ++n) sum.row(copies.initial()[n]) += field.row(n);
  return sum;
}

/// As `before`, on the nodes that there were.
void expect_same(const std::vector<Acting>& before, const std::vector<Acting>& after, const NodeCopies& were,
                 const NodeCopies& are) {
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t k = 0; k < before.size(); ++k)
    for (PointArray Acting::*field : {&Acting::forces, &Acting::product}) {
      const PointArray one = together(before[k].*field, were), other = together(after[k].*field, are);
      EXPECT_LE((one - other).cwiseAbs().maxCoeff(), 1e-12 * one.cwiseAbs().maxCoeff()) << before[k].name;
    }
}

std::vector<int> some_joints(const Body& body, double fraction, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> some;
  for (int joint = 0; joint < body.joints().count(); ++joint)
    if (static_cast<double>(random()) < fraction * static_cast<double>(std::mt19937::max())) some.push_back(joint);
  return some;
}

std::string hash_of(scene::Scene& scene) {
  const std::vector<scene::MechanicalState*> states = scene::moving_states(scene);
  std::vector<output::Bodies::Entry> entries;
  for (const scene::SceneBody& of : scene::bodies_of(scene))
    entries.push_back({.name = of.name, .body = of.field->body()});
  PointArray x, v;
  return output::state_hash(0, scene::positions_of(states, x), scene::velocities_of(states, v), entries);
}

/// Opens joints of a body; what acts on its nodes is the same in sum.
void open(scene::Scene& scene, const scene::SceneBody& of, std::span<const int> joints) {
  const NodeCopies were = of.field->body()->copies();
  const std::vector<Acting> before = acting_on(scene, *of.state);
  scene.open(*of.field, joints);
  EXPECT_EQ(of.state->num_nodes(), of.field->body()->mesh().num_nodes());
  expect_same(before, acting_on(scene, *of.state), were, of.field->body()->copies());
}

struct OpenedScene {
  const char* name;
  int before;             ///< steps
  double fraction = 0.5;  ///< of the joints that open; in equilibria nothing may fall off
};

void PrintTo(const OpenedScene& scene, std::ostream* out) { *out << scene.name; }

class ShippedSceneWithOpenedJoints : public testing::TestWithParam<OpenedScene> {};

// A scene that is read has never split: it is what one is compared with that has been reset, or goes on.
TEST_P(ShippedSceneWithOpenedJoints, GoesOnAndIsAsAtFirstAfterReset) {
  scene::Scene scene = shipped(GetParam().name), other = shipped(GetParam().name);
  const std::string first = hash_of(scene);
  run(scene, GetParam().before);
  const std::string undisturbed = hash_of(scene);
  const scene::SceneBody of = scene::bodies_of(scene).front();
  const Body& body = *of.field->body();
  for (const unsigned seed : {1u, 2u}) {
    open(scene, of, some_joints(body, GetParam().fraction, seed));
    EXPECT_TRUE(body.copies().is_split());
    run(scene, 1);
  }
  go_on_in(scene, other);
  EXPECT_EQ(hash_of(other), hash_of(scene));
  for (scene::Scene* one : {&scene, &other}) run(*one, 1);
  EXPECT_EQ(hash_of(other), hash_of(scene)) << "it goes on with the same bits";

  scene.reset();
  EXPECT_EQ(hash_of(scene), first);
  run(scene, GetParam().before);
  EXPECT_EQ(hash_of(scene), undisturbed) << "nothing is left of the joints";
  go_on_in(scene, other);
  for (scene::Scene* one : {&scene, &other}) run(*one, 1);
  EXPECT_EQ(hash_of(other), hash_of(scene)) << "a state without open joints is read where some are";
}

INSTANTIATE_TEST_SUITE_P(All, ShippedSceneWithOpenedJoints,
                         testing::Values(OpenedScene{"bar_stretch_high", 3}, OpenedScene{"bar_stretch_face", 3},
                                         OpenedScene{"bar_twist_low", 3}, OpenedScene{"cantilever_static", 1, 0.1},
                                         OpenedScene{"fatty_tissue", 3}, OpenedScene{"forceps_fat", 3},
                                         OpenedScene{"ligament", 3}, OpenedScene{"liver_cage", 3},
                                         OpenedScene{"liver_tumour", 2}, OpenedScene{"peritoneum_tear", 3},
                                         OpenedScene{"pressed_ring", 3, 0.1}, OpenedScene{"probe_liver", 3},
                                         OpenedScene{"slope", 3}, OpenedScene{"springback", 3, 0.1},
                                         OpenedScene{"two_organs", 3}, OpenedScene{"vessel_mobilise", 3}),
                         [](const auto& test) { return std::string(test.param.name); });

/// A bar of 3 x 2 x 2 hexahedra under all that can act on nodes. Joints across the planes x = 0.1 and 0.2 cut it
/// through.
std::string bar(const std::string& solver, const std::string& more = "") {
  return "<Node dt='0.01' gravity='0 -9.81 1'><DefaultAnimationLoop/><EulerImplicitSolver name='euler' "
         "rayleighStiffness='0.01'/>" +
         solver +
         "<Node name='bar'><RegularGridTopology name='grid' n='4 3 3' max='0.3 0.2 0.2'/>"
         "<MechanicalObject name='nodes'/><DiagonalMass name='mass' massDensity='1000'/>"
         "<HexahedronElastoplasticFEMForceField name='flesh' youngModulus='5000' yieldStress='50' "
         "plasticFlowRate='20'/>"
         "<FixedProjectiveConstraint name='fixed' indices='0 1 4 5'/>"
         "<PartialFixedProjectiveConstraint name='partly' indices='2 6 10' fixedDirections='0 1 0'/>"
         "<LinearMovementProjectiveConstraint name='moved' indices='25 26 29' keyTimes='0 1' movements='0 0 0 0.05 0 "
         "0'/>" +
         more + "</Node></Node>";
}
const std::string kForces =
    "<ConstantForceField name='pull' indices='13 14 17' totalForce='1 2 3'/>"
    "<LinearForceField name='ramp' points='18 21' times='0 1' forces='0 0 0 1 1 0'/>"
    "<TangentialForceField name='turn' indices='13 14 17 18' groupSize='2' axis='1 0 0' times='0 1' forces='1 2' "
    "centre='0 0.05 0.05'/>"
    "<SurfacePressureForceField name='press' pressure='100'/>"
    "<PlaneForceField name='plane' normal='0 1 0' d='0.05' stiffness='300' damping='2'/>"
    "<RestShapeSpringsForceField name='anchor' points='17 18' stiffness='200 300'/>"
    "<SpringForceField name='springs' spring='13 34 100 1 0.05 14 22 50 0 0.1'/>"
    "<GraspForceField name='grip' keyTimes='0 1' positions='0.15 0.1 0.1 0.2 0.1 0.2' radius='0.12' stiffness='100' "
    "maxForce='4' damping='1'/>";

const char* const kDirect = "<SparseLDLSolver/>";
const char* const kMultigrid = "<MultigridCGLinearSolver name='cg'/>";

/// Joints across a plane.
std::vector<int> across(const Body& body, int axis, double at) {
  std::vector<int> joints;
  for (int joint = 0; joint < body.joints().count(); ++joint) {
    const std::span<const int> nodes = body.joints().nodes(joint);
    // initial nodes keep their numbers
    if (std::ranges::all_of(nodes, [&](int n) { return std::abs(body.mesh().positions()(n, axis) - at) < 1e-9; }))
      joints.push_back(joint);
  }
  return joints;
}

TEST(OpenedJoints, AreRefusedByWhatCannotFollow) {
  scene::Scene scene =
      read_and_init(bar(kDirect, "<HexahedronElastoplasticFEMForceField name='other' youngModulus='1'/>"));
  auto& field = at<scene::ForceField>(scene, "bar/flesh");
  EXPECT_EQ(error_of<scene::SceneError>([&] {
              scene.open(field, std::array{0, 1, 2, 3});
            }),
            "test.scn:1: error: HexahedronElastoplasticFEMForceField: is a second body on the same nodes: no joint of "
            "HexahedronElastoplasticFEMForceField 'flesh' can be opened");
  EXPECT_TRUE(field.body()->opened().empty());
  EXPECT_FALSE(field.body()->copies().is_split());
  run(scene, 1);
}

class OpenedBar : public testing::TestWithParam<const char*> {};

TEST_P(OpenedBar, HasTheSameForcesReactionsMassAndMomentum) {
  scene::Scene scene = read_and_init(bar(GetParam(), kForces + "<Probe name='of_fixed' value='@fixed.reaction'/>"
                                                               "<Probe name='of_moved' value='@moved.reaction'/>"));
  run(scene, 5);
  const scene::SceneBody of = scene::bodies_of(scene).front();
  const auto reactions = [&] {
    scene::Readings readings;
    return std::array{at<scene::Probe>(scene, "bar/of_fixed").read(readings),
                      at<scene::Probe>(scene, "bar/of_moved").read(readings)};
  };
  reactions();
  run(scene, 1);
  const std::array before = reactions();
  EXPECT_GT(before[0], 0.1);
  EXPECT_GT(before[1], 0.1);
  open(scene, of, across(*of.field->body(), 0, 0.1));
  EXPECT_EQ(of.state->num_nodes(), 36 + 9);
  EXPECT_EQ(reactions(), before);
  open(scene, of, some_joints(*of.field->body(), 1, 0));
  EXPECT_EQ(of.state->num_nodes(), 12 * 8);
  EXPECT_EQ(reactions(), before);
  run(scene, 5);
  EXPECT_TRUE(of.state->positions().allFinite());
  for (const int node : of.field->body()->copies().of(5))
    EXPECT_EQ(of.state->positions().row(node), of.field->body()->mesh().positions().row(5)) << "it stays fixed";
}

/// What follows the bar, point by point or node by node, with forces and masses of its own; and a tool that holds a
/// node.
const std::string kFollowers =
    "<Node name='skin'><MechanicalObject name='points' position='0.15 0.15 0.1  0.05 0.1 0.2  0.25 0.05 0.21'/>"
    "<BarycentricMapping/><ConstantForceField name='on_points' forces='1 0 0'/></Node>"
    "<Node name='same'><MechanicalObject name='nodes' position='@../nodes.position'/><IdentityMapping/>"
    "<UniformMass name='extra' totalMass='1'/><ConstantForceField name='on_same' indices='13 22' totalForce='0 1 0'/>"
    "</Node><Node name='tool'><MechanicalObject name='tip' position='0.3 0.1 0.2'/><UniformMass totalMass='0.1'/>"
    "<FixedProjectiveConstraint indices='0'/></Node><AttachProjectiveConstraint name='tie' object1='@tool/tip' "
    "object2='@nodes' indices1='0' indices2='31' twoWay='0'/>"
    "<Probe name='rise' value='@nodes.position' component='y' change='1' indices='13'/>"
    "<Probe name='at' value='@nodes.position' points='0.15 0.15 0.1' component='y'/>";

TEST_P(OpenedBar, IsFollowedByWhatFollowsIt) {
  scene::Scene scene = read_and_init(bar(GetParam(), kForces + kFollowers));
  const scene::SceneBody of = scene::bodies_of(scene).front();
  auto& points = at<scene::MechanicalState>(scene, "bar/skin/points");
  auto& same = at<scene::MechanicalState>(scene, "bar/same/nodes");
  const auto probe = [&](const char* name) {
    scene::Readings readings;
    return at<scene::Probe>(scene, std::string("bar/") + name).read(readings);
  };
  run(scene, 5);
  const PointArray before = points.positions();
  const std::vector<Acting> acts = acting_on(scene, same);
  const std::array probes = {probe("rise"), probe("at")};
  const NodeCopies were = of.field->body()->copies();
  open(scene, of, across(*of.field->body(), 1, 0.1));
  expect_same(acts, acting_on(scene, same), were, of.field->body()->copies());
  EXPECT_EQ(same.positions(), of.state->positions());
  EXPECT_EQ(probe("rise"), probes[0]);
  EXPECT_NEAR(probe("at"), probes[1], 1e-15);
  for (const scene::Mapping* mapping : scene.root().all<scene::Mapping>()) {
    PointArray below = PointArray::Zero(mapping->output()->num_nodes(), 3);
    mapping->apply(of.state->positions(), below);
    EXPECT_LE((below - mapping->output()->positions()).cwiseAbs().maxCoeff(), 1e-15);
  }
  run(scene, 20);
  EXPECT_EQ(same.positions(), of.state->positions());
  const NodeCopies& copies = of.field->body()->copies();
  ASSERT_EQ(copies.of(31).size(), 2u);
  for (const int copy : copies.of(31))
    EXPECT_LT((of.state->positions().row(copy) - Vec3(0.3, 0.1, 0.2).transpose()).norm(), 1e-3);
  const PointArray& x = of.state->positions();
  EXPECT_GT((x.row(copies.of(22)[1]) - x.row(22)).norm(), 1e-4) << "the bar is open";
}

TEST_P(OpenedBar, GoesOnFromACheckpointWithTheSameBits) {
  const auto make = [] { return read_and_init(bar(GetParam(), kForces + kFollowers)); };
  scene::Scene scene = make(), other = make();
  const scene::SceneBody of = scene::bodies_of(scene).front();
  run(other, 2);
  other.open(*scene::bodies_of(other).front().field, across(*of.field->body(), 0, 0.2));  // which is forgotten
  run(other, 1);
  for (const double x : {0.1, 0.2}) {
    run(scene, 3);
    scene.open(*of.field, across(*of.field->body(), 0, x));
    go_on_in(scene, other);
    EXPECT_EQ(saved(other), saved(scene));
    for (scene::Scene* one : {&scene, &other}) run(*one, 2);
    EXPECT_EQ(hash_of(other), hash_of(scene));
  }
  const auto before = saved(scene);  // as undo has it
  scene.open(*of.field, across(*of.field->body(), 1, 0.1));
  run(scene, 1);
  read_from(before, scene);
  EXPECT_EQ(hash_of(scene), hash_of(other));
  for (scene::Scene* one : {&scene, &other}) run(*one, 2);
  EXPECT_EQ(hash_of(other), hash_of(scene));
}

/// The force of a contact, whose bodies may be cut under it: planes across an axis, one for each of them.
Vec3 force_of_contact(const std::string& text, const std::string& contact, int steps, int axis,
                      const std::vector<double>& planes) {
  scene::Scene scene = read_and_init(text);
  run(scene, steps);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const scene::SceneBody of = scene::bodies_of(scene)[k];
    scene.open(*of.field, across(*of.field->body(), axis, planes[k]));
  }
  run(scene, 2);
  return at<scene::Component>(scene, contact).vector3("force");
}

// A ball is pushed along a block: nodes under it that split have the friction and the side of those that they were.
TEST(OpenedJoints, LeaveContactsWhereTheyAre) {
  const std::string text =
      "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='.5'/>"
      "<MultigridCGLinearSolver tolerance='1e-8'/><RegularGridTopology n='7 7 4' max='.06 .06 .03'/>"
      "<MechanicalObject name='nodes'/><UniformMass totalMass='.1'/><FixedProjectiveConstraint indices='0-48'/>"
      "<HexahedronElastoplasticFEMForceField name='flesh' youngModulus='5000'/>"
      "<InstrumentContactForceField name='ball' radius='.01' friction='2' keyTimes='0 .1 .3' "
      "positions='.03 .03 .041  .03 .03 .036  .034 .03 .036'/></Node>";
  const Vec3 whole = force_of_contact(text, "ball", 20, 1, {}), opened = force_of_contact(text, "ball", 20, 1, {0.1});
  EXPECT_LT(whole.x(), -0.1 * whole.norm()) << "it sticks";
  EXPECT_LT((opened - whole).norm(), 0.1 * whole.norm());
  EXPECT_NEAR(opened.x(), whole.x(), 0.1 * std::abs(whole.x()));
}

// Bodies that lie on each other: the lower one is cut through under the other one.
TEST(OpenedJoints, LeaveContactsOfTwoBodiesWhereTheyAre) {
  const auto block = [](const std::string& name, const std::string& grid) {
    return "<Node name='" + name + "'><RegularGridTopology " + grid +
           "/><MechanicalObject name='nodes'/><UniformMass totalMass='.02'/>"
           "<HexahedronElastoplasticFEMForceField name='flesh' youngModulus='10000'/>";
  };
  const std::string text =
      "<Node dt='0.005' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='.1' "
      "rayleighStiffness='.01'/><SparseLDLSolver/><TissueContactForceField name='contact' object1='@lower/nodes' "
      "object2='@upper/nodes' friction='0.5'/>" +
      block("lower", "n='5 5 3' max='.04 .04 .02'") + "<FixedProjectiveConstraint indices='0-24'/></Node>" +
      block("upper", "n='3 3 3' min='.0113 .013 .02' max='.0313 .033 .04'") + "</Node></Node>";
  const Vec3 whole = force_of_contact(text, "contact", 50, 0, {}),
             opened = force_of_contact(text, "contact", 50, 0, {0.02, 0.0213});
  EXPECT_NEAR(whole.norm(), 0.02 * 9.81, 0.05);
  EXPECT_LT((opened - whole).norm(), 0.05 * whole.norm());
}

INSTANTIATE_TEST_SUITE_P(Solvers, OpenedBar, testing::Values(kDirect, kMultigrid),
                         [](const auto& test) { return test.param == kDirect ? "direct" : "multigrid"; });

}  // namespace
