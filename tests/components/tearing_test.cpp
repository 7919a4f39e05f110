// SPDX-License-Identifier: LGPL-2.1-or-later
// What a scene sees when hexahedra go or joints open: the other components, and the surfaces that follow a body. Which
// links a blade meets is tested in mesh/blade_test.cpp.
#include "hexaplast/body.hpp"
#include "hexaplast/plastic/flow_report.hpp"
#include "scene/scene.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// What the listeners of all scenes have heard, in the order of the calls.
std::vector<std::string> heard;

constexpr attributes::Description kListener{
    .class_name = "Listener", .category = "Test", .help = "Notes what hexahedra go."};

/// A component as a plugin has it.
class Listener final : public scene::Component {
 public:
  Listener() : Component(kListener) {}

  void hexahedra_removed(const scene::ForceField& field, std::span<const int> hexahedra) override {
    std::ostringstream line;
    line << name() << ": " << field.name() << " lost";
    for (const int e : hexahedra) {
      line << " " << e;
      EXPECT_FALSE(field.body()->alive()[e]);
    }
    heard.push_back(line.str());
  }
  void end_step(double) override { heard.push_back(std::string(name()) + ": end_step"); }
};

scene::Scene read_and_listen(const std::string& text) {
  static const bool is_known = [] {
    plugins();
    factory().add<Listener>(kListener);
    return true;
  }();
  EXPECT_TRUE(is_known);
  scene::Scene scene = read_and_init(text);
  heard.clear();
  return scene;
}

/// Three layers of two hexahedra, 0.1 m each: 0 and 1 below, 2 and 3, 4 and 5 above. They break when they are stretched
/// by half within a step.
std::string layers(const std::string& before, const std::string& after, const std::string& below = "") {
  return "<Node dt='0.01' gravity='0 0 0'>" + before +
         "<DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/><Node name='bar'>"
         "<RegularGridTopology name='grid' n='3 2 4' max='0.2 0.1 0.3'/><MechanicalObject name='nodes'/>"
         "<UniformMass totalMass='6'/><HexahedronElastoplasticFEMForceField name='flesh' youngModulus='5000' "
         "yieldStress='10' plasticFlowRate='90' hardening='0.5' fractureStress='200'/>" +
         after + below + "</Node></Node>";
}

PointArray& bar_nodes(scene::Scene& scene) { return at<scene::MechanicalState>(scene, "bar/nodes").positions(); }

/// Ends a step with one layer stretched: it breaks, and goes back to where it was.
void tear_layer(scene::Scene& scene, int layer) {
  const PointArray x = bar_nodes(scene);
  for (Eigen::Index n = 6 * (layer + 1); n < x.rows(); ++n) bar_nodes(scene)(n, 2) += 0.08;
  scene::end_step(scene.root(), 0.01);
  bar_nodes(scene) = x;
}

using Lines = std::vector<std::string>;

TEST(RemovedHexahedra, AreAnnouncedToTheWholeSceneInTheStepInWhichTheyGo) {
  scene::Scene scene = read_and_listen(
      layers("<Listener name='first'/>", "<Listener name='beside'/>", "<Node><Listener name='below'/></Node>"));
  scene::end_step(scene.root(), 0.01);
  EXPECT_EQ(heard, (Lines{"first: end_step", "beside: end_step", "below: end_step"})) << "nothing went";

  heard.clear();
  tear_layer(scene, 1);
  EXPECT_EQ(heard, (Lines{"first: end_step", "first: flesh lost 2 3", "beside: flesh lost 2 3", "below: flesh lost 2 3",
                          "beside: end_step", "below: end_step"}));
  heard.clear();
  tear_layer(scene, 1);
  EXPECT_EQ(heard.size(), 3u) << "they go once";
  heard.clear();
  tear_layer(scene, 0);
  EXPECT_EQ(heard[1], "first: flesh lost 0 1");

  heard.clear();
  at<scene::ForceField>(scene, "bar/flesh").remove_elements(std::array{5, 0, 4});  // as a host does, between two steps
  EXPECT_EQ(heard, (Lines{"first: flesh lost 5 4", "beside: flesh lost 5 4", "below: flesh lost 5 4"}));

  scene.reset();
  heard.clear();
  tear_layer(scene, 1);
  EXPECT_EQ(heard[1], "first: flesh lost 2 3") << "after reset they are there, and go again";
}

// Their values are 0, which no hexahedron that is there has.
TEST(RemovedHexahedra, DoNotCountInProbes) {
  scene::Scene scene = read_and_init(layers(
      "",
      "<Probe name='least' value='@flesh.volume' statistic='min'/><Probe name='mean' value='@flesh.volumeRatio'/>"
      "<Probe name='gone' value='@flesh.volume' indices='0 4'/>"));
  at<scene::ForceField>(scene, "bar/flesh").remove_elements(std::array{5, 0, 4});
  scene::Readings readings;
  EXPECT_NEAR(at<scene::Probe>(scene, "bar/least").read(readings), 1e-3, 1e-15);  // [m^3]
  EXPECT_NEAR(at<scene::Probe>(scene, "bar/mean").read(readings), 1, 1e-12);
  EXPECT_EQ(at<scene::Probe>(scene, "bar/gone").read(readings), 0);
}

/// Those of some cells of a state that have their hexahedra.
template <class Cell>
std::vector<Cell> left_of(const std::vector<Cell>& cells, scene::MechanicalState& state) {
  const scene::SurvivingCells surviving(state);
  std::vector<Cell> left;
  for (const Cell& cell : cells)
    if (surviving.has(cell)) left.push_back(cell);
  return left;
}

// Triangles in the lower layer, in the middle one, in both, on the face between them, on the outer face of the middle
// one from node to node, and in the upper one, a little outside.
TEST(SurvivingCells, OfASurfaceAreWhatIsLeftAndDoesNotFlyAway) {
  const std::string skin =
      "<Node name='skin'><MeshTopology name='triangles' triangles='0 1 2  3 4 5  0 1 3  6 7 8  9 10 11  12 13 14'/>"
      "<MechanicalObject name='points' position='.02 .02 .05  .08 .03 .06  .05 .08 .04  .02 .02 .15  .08 .03 .16  "
      ".05 .08 .14  .02 .02 .1  .08 .03 .1  .05 .08 .1  0 0 .1  0 0 .2  0 .1 .1  .02 .02 .301  .08 .03 .302  "
      ".05 .08 .301'/><BarycentricMapping/>"
      "<Node name='copy'><MechanicalObject name='points' position='@../points.position'/><IdentityMapping/></Node>"
      "</Node>";
  scene::Scene scene =
      read_and_init(layers("", "<ConstantForceField name='wind' indices='0-5' forces='0 0 -40'/>", skin));
  const std::vector<Triangle> all = at<scene::Topology>(scene, "bar/skin/triangles").triangles();
  auto& points = at<scene::MechanicalState>(scene, "bar/skin/points");
  auto& copy = at<scene::MechanicalState>(scene, "bar/skin/copy/points");
  const std::vector<Quad> quads{{0, 1, 4, 3}, {0, 1, 2, 6}};
  scene::end_step(scene.root(), 0.01);
  EXPECT_EQ(left_of(all, points), all);
  EXPECT_EQ(left_of(quads, copy), quads);

  tear_layer(scene, 1);
  EXPECT_EQ(left_of(all, points), (std::vector<Triangle>{all[0], all[3], all[5]}));
  EXPECT_EQ(left_of(quads, copy), (std::vector<Quad>{quads[1]})) << "through two mappings";

  tear_layer(scene, 0);
  EXPECT_EQ(left_of(all, points), (std::vector<Triangle>{all[5]}));

  // the wind takes the nodes that hold nothing any more, and the points in them; the triangle that is left stays
  const PointArray before = points.positions();
  for (int k = 0; k < 20; ++k) scene.step();
  EXPECT_GT(max_abs(points.positions().row(1) - before.row(1)), 0.3);
  EXPECT_EQ(left_of(all, points), (std::vector<Triangle>{all[5]}));
  for (const int n : all[5]) EXPECT_LT(max_abs(points.positions().row(n) - before.row(n)), 5e-3) << n;
}

// On the side faces x = 0 of the three layers: a third of the load goes with the middle one.
TEST(FaceLoads, GoWithTheFacesTheyActOn) {
  scene::Scene scene = read_and_listen(
      layers("", "<SurfacePressureForceField name='surface' pressure='6' min='-1 -1 -1' max='0.01 1 1'/>"));
  const auto total = [&](const char* name) {
    PointArray f = PointArray::Zero(24, 3);
    at<scene::ForceField>(scene, std::string("bar/") + name).add_force(0, bar_nodes(scene), PointArray::Zero(24, 3), f);
    return Vec3(f.colwise().sum().transpose());
  };
  const auto agree = [](const Vec3& found, const Vec3& expected) { return (found - expected).norm() < 1e-14; };
  const double layer = 0.1 * 0.1;  // [m^2]
  EXPECT_TRUE(agree(total("surface"), {6 * 3 * layer, 0, 0})) << total("surface");
  tear_layer(scene, 1);
  EXPECT_TRUE(agree(total("surface"), {6 * 2 * layer, 0, 0})) << total("surface");
  scene.reset();
  EXPECT_TRUE(agree(total("surface"), {6 * 3 * layer, 0, 0})) << total("surface");
}

/// A block of 4 x 4 x 4 hexahedra of 1 m that nothing holds.
std::string block(const std::string& more, const std::string& gravity = "0 0 0") {
  return in_root("gravity='" + gravity + "' dt='0.1'",
                 "<RegularGridTopology name='grid' n='5 5 5' max='4 4 4'/><MechanicalObject name='nodes'/>"
                 "<DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField name='flesh'/>" +
                     more);
}

/// From the left to the right in a second, at a height of 2.1 m.
const std::string kBlade =
    "<BladeController name='blade' points='0 -1 0  0 5 0' keyTimes='0 1' positions='-1 0 2.1  5 0 2.1'/>";
/// From the front to the back in the same time.
const std::string kOther =
    "<BladeController name='other' points='0 0 -1  0 0 5' keyTimes='0 1' positions='2.1 -1 0  2.1 5 0'"
    " orientations='0 0 0 1  0 0 0 1'/>";

std::vector<int> opened(scene::Scene& scene) {
  return {body(scene, "flesh").opened().begin(), body(scene, "flesh").opened().end()};
}
int num_pieces(const Body& body) { return connected_parts(body.mesh(), body.alive()).count; }

// A blade at rest, and a body that falls past it.
TEST(BladeController, CutsTissueThatMoves) {
  scene::Scene scene =
      read_and_init(block("<BladeController points='-1 -1 0  5 5 0' keyTimes='0' positions='0.1 0 -0.2'/>", "0 0 -10"));
  run(scene, 15);
  EXPECT_GT(opened(scene).size(), 16u);
  EXPECT_LT(nodes(scene).col(2).maxCoeff(), -0.2);
  EXPECT_EQ(num_pieces(body(scene, "flesh")), 2);
}

TEST(BladeController, CutsTheBodyOfItsLink) {
  const auto with = [&](const std::string& blade) {
    std::string bodies;
    for (const std::string name : {"left", "right"})
      bodies += replaced(replaced(block(""), "<DefaultAnimationLoop/>", ""), "<Node", "<Node name='" + name + "'");
    return "<Node dt='0.1' gravity='0 0 0'><DefaultAnimationLoop/>" + bodies +
           replaced(kBlade, "<BladeController", "<BladeController body='" + blade + "'") + "</Node>";
  };
  for (const auto& [link, cut, whole] :
       {std::tuple{"@right/flesh", "right/flesh", "left/flesh"}, {"@left", "left/flesh", "right/flesh"}}) {
    scene::Scene scene = read_and_init(with(link));
    run(scene, 10);
    EXPECT_EQ(body(scene, cut).opened().size(), 16u);
    EXPECT_EQ(body(scene, whole).opened().size(), 0u);
  }
}

TEST(BladeController, IsUndoneByResetAndGoesOnAfterACheckpoint) {
  scene::Scene scene = read_and_init(block(kBlade + kOther)), other = read_and_init(block(kBlade + kOther));
  run(scene, 5);
  go_on_in(scene, other);
  run(scene, 5);
  run(other, 5);
  EXPECT_EQ(saved(scene), saved(other));
  const std::vector<std::byte> first = saved(scene);
  scene.reset();
  EXPECT_TRUE(opened(scene).empty());
  run(scene, 10);
  EXPECT_EQ(saved(scene), first);
}

TEST(BladeController, NamesWhatItRefuses) {
  expect_errors([](const std::string& lines) { return block(lines); },
                {{"<BladeController points='0 0 0' keyTimes='0' positions='0 0 0'/>",
                  "BladeController.points: 1 given, must be at least two"},
                 {"<BladeController body='@nodes' points='0 0 0  1 0 0' keyTimes='0' positions='0 0 0'/>",
                  "BladeController.body: the link leads to MechanicalObject 'nodes', "
                  "must lead to a body of hexahedra"}});
  EXPECT_EQ(errors_of("<Node><DefaultAnimationLoop/>" + kBlade + "</Node>"),
            "test.scn:1: error: BladeController: needs a body of hexahedra in its node or above, or a link to one");

  scene::Scene scene = read_and_init(block(
      replaced(kBlade, "keyTimes='0 1' positions='-1 0 2.1  5 0", "keyTimes='0 0.1' positions='-1 0 2.1  5e12 0")));
  EXPECT_TRUE(refuses<scene::SceneError>([&] { scene.step(); }, {"must be finite and nearer than"}));
}

/// A sheet that is pulled apart at both ends until it tears, and more.
std::string torn_sheet(const std::string& more, const std::string& fracture = "face") {
  return in_root(
      "gravity='0 0 0' dt='0.01'",
      "<RegularGridTopology name='grid' n='9 5 2' max='0.16 0.08 0.02'/><MechanicalObject name='nodes'/>"
      "<DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField name='flesh' poissonRatio='0.3' "
      "yieldStress='300' plasticFlowRate='20' hardening='0.5' fractureStress='500' fracture='" +
          fracture +
          "'/><BoxROI name='left' box='-1 -1 -1 0.001 1 1'/><BoxROI name='right' box='0.159 -1 -1 1 1 1'/>"
          "<LinearMovementProjectiveConstraint indices='@left.indices' keyTimes='0 1 9' movements='0 0 0 -0.04 0 0 "
          "-0.04 0 0'/>"
          "<LinearMovementProjectiveConstraint indices='@right.indices' keyTimes='0 1 9' movements='0 0 0 0.04 0 0 "
          "0.04 0 0'/>" +
          more);
}

// A tear and a blade open joints in one call: neither sees what the other one opens. The blade passes through the sheet
// near its left end in the step in which it first tears.
TEST(FaceTearing, OpensTogetherWithABlade) {
  int step = 0;
  std::vector<int> torn;
  for (scene::Scene scene = read_and_init(torn_sheet("")); torn.empty() && step < 100; ++step) {
    scene.step();
    torn = at<scene::ForceField>(scene, "flesh").flow_report()->torn;
  }
  ASSERT_FALSE(torn.empty());
  scene::Scene scene = read_and_init(torn_sheet("<BladeController name='blade' points='0 0 -1  0 0 1' keyTimes='" +
                                                std::to_string(0.01 * (step - 1)) + " " + std::to_string(0.01 * step) +
                                                "' positions='0.02 -0.01 0  0.02 0.09 0'/>"));
  run(scene, step - 1);
  EXPECT_TRUE(opened(scene).empty());
  const long revision = body(scene, "flesh").revision();
  scene.step();
  EXPECT_EQ(body(scene, "flesh").revision(), revision + 1) << "one call";
  EXPECT_EQ(at<scene::ForceField>(scene, "flesh").flow_report()->torn, torn);
  const std::vector<int> all = opened(scene);
  EXPECT_TRUE(std::ranges::includes(all, torn));
  EXPECT_EQ(all.size(), torn.size() + 4) << "the blade meets four links";
  for (std::size_t k = 0; k < all.size(); ++k)
    EXPECT_EQ(body(scene, "flesh").crossings()[k] == 0.5, std::ranges::binary_search(torn, all[k]))
        << "joint " << all[k];
  run(scene, 60);
  EXPECT_TRUE(body(scene, "flesh").removed().empty());
  EXPECT_GT(num_pieces(body(scene, "flesh")), 2);
}

// Before the first step, and not when the first face tears.
TEST(FaceTearing, IsRefusedByWhatCannotFollow) {
  const std::string second = "<HexahedronElastoplasticFEMForceField name='second'/>";
  EXPECT_TRUE(has(
      errors_of(torn_sheet(second)),
      "is a second body on the same nodes: no joint of HexahedronElastoplasticFEMForceField 'flesh' can be opened"));
  EXPECT_EQ(errors_of(torn_sheet(second, "cell")), "");
  // a mapping that has failed is not asked
  EXPECT_FALSE(has(errors_of(torn_sheet("<Node><MechanicalObject position='0 0 0'/><BarycentricMapping "
                                        "input='@/nodes' output='@/nodes'/></Node>")),
                   "can be opened"));
}

}  // namespace
