// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/embed.hpp"
#include "scene/visuals.hpp"
#include "support/compare.hpp"
#include "support/mesh_text.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

// Three hexahedra without parallel edges, held at one end, and two points in them; `inner` goes into their node.
std::string skewed(const std::string& inner, const std::string& solver = "<SparseLDLSolver/>",
                   const std::string& outer = "") {
  return "<Node dt='0.02' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver name='euler' "
         "rayleighStiffness='0.02'/>" +
         solver +
         "<MeshTopology name='mesh' hexahedra='0-7  4-11  8-15' position='0 0 0  1 0 .1  1.1 1 0  0 1 0  .1 .1 1  1 0 "
         "1.2  "
         "1.2 1 1  0 .9 1.1  0 0 2  1 .2 2  1 1 2.2  .1 1 2  0 0 3  1 0 3.1  1 1 3  -.1 1 3'/>"
         "<MechanicalObject name='nodes'/><UniformMass totalMass='16'/><FixedProjectiveConstraint indices='0-3'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='2000' poissonRatio='0.3'/>" +
         outer + "<Node name='skin'><MechanicalObject name='points' position='.5 .4 2.4  .3 .7 1.2'/>" + inner +
         "</Node></Node>";
}

PointArray after(const std::string& text, int steps) {
  scene::Scene scene = read_and_init(text);
  run(scene, steps);
  return nodes(scene);
}

TEST(BarycentricMapping, PointsStayWhereTheyAreAndFollow) {
  scene::Scene scene = read_and_init(skewed("<BarycentricMapping input='@..' output='@.'/>", "<SparseLDLSolver/>",
                                            "<ConstantForceField indices='12-15' forces='1 2 3'/>"));
  auto& points = at<scene::MechanicalState>(scene, "skin/points");
  const PointArray first = points.positions();
  const Embedding expected(nodes(scene), at<scene::Topology>(scene, "mesh").hexahedra(), first);
  EXPECT_FALSE(has(warnings_of(scene), "Mapping"));
  run(scene, 10);
  PointArray x(2, 3), v(2, 3);
  expected.apply(nodes(scene), x);
  expected.apply(velocities(scene), v);
  EXPECT_TRUE(agrees(points.positions(), x, 1e-14));
  EXPECT_TRUE(agrees(points.velocities(), v, 1e-13));
  EXPECT_GT(max_abs(x - first), 0.01);
  scene.reset();
  EXPECT_TRUE(agrees(points.positions(), first, 1e-15));
}

// Masses and stiffness of points enter the system: products against blocks, through two mappings one below the
// other.
TEST(BarycentricMapping, CarriesMassesAndStiffnessUp) {
  const std::string inner =
      "<BarycentricMapping/><UniformMass vertexMass='3'/><PlaneForceField normal='0 0 -1' d='-1.1' stiffness='400'/>"
      "<Node name='copy'><MechanicalObject position='@../points.position'/><IdentityMapping/>"
      "<RestShapeSpringsForceField stiffness='30'/><UniformMass vertexMass='1'/></Node>";
  const PointArray direct = after(skewed(inner), 20);
  const PointArray iterative =
      after(skewed(inner, "<CGLinearSolver iterations='999' tolerance='1e-14' threshold='1e-30'/>"), 20);
  EXPECT_TRUE(agrees(iterative, direct, 1e-9));
  EXPECT_GT(max_abs(direct - after(skewed("<BarycentricMapping/>"), 20)), 0.01);

  // the same in one node: masses and springs add up
  const std::string flat =
      "<BarycentricMapping/><UniformMass vertexMass='4'/><PlaneForceField normal='0 0 -1' d='-1.1' stiffness='400'/>"
      "<RestShapeSpringsForceField stiffness='30'/>";
  EXPECT_TRUE(agrees(after(skewed(flat), 20), direct, 1e-12));
}

TEST(BarycentricMapping, SaysHowManyPointsLieOutside) {
  scene::Scene scene =
      read_and_init(skewed("<Node name='far'><MechanicalObject name='far' position='.5 .5 5  .5 .5 .5  4 0 0'/>"
                           "<BarycentricMapping input='@/nodes'/></Node><BarycentricMapping/>"));
  const std::string said = warnings_of(scene);
  EXPECT_TRUE(has(said, "BarycentricMapping: 2 of 3 points lie outside the hexahedra, up to "));
  EXPECT_EQ(said.find("Mapping"), said.rfind("Mapping"));
}

TEST(Mapping, CarriesAVisualModelAndNothingElseInAStep) {
  scene::Scene scene = read_and_init(
      "<Node><EulerImplicitSolver/><CGLinearSolver/><RegularGridTopology/><MechanicalObject/><UniformMass "
      "totalMass='1'/>"
      "<Node><OglModel name='visual' position='.5 .5 .5  .6 .5 .5  .5 .6 .5' triangles='0 1 2' color='red' "
      "template='ExtVec3d'/>"
      "<BarycentricMapping input='@..' "
      "output='@visual'/></Node><Node><OglModel/></Node><Node><IdentityMapping/></Node></Node>");
  EXPECT_EQ(scene.diagnostics().take_warnings().size(), 2u);  // no loop, and a mapping to nothing: notes
  const std::vector<scene::VisualModel*> models = scene.root().all<scene::VisualModel>();
  ASSERT_EQ(models.size(), 2u);
  EXPECT_TRUE(models[0]->is_carried());
  EXPECT_EQ(models[0]->points()(1, 0), 0.6);
  EXPECT_EQ(models[0]->triangles(), (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_FALSE(models[1]->is_carried());
  EXPECT_NO_THROW(scene.step());
}

TEST(OglModel, RefusesCellsWithoutTheirPoints) {
  expect_errors(
      in_node, {{"<OglModel position='0 0 0  1 0 0' triangles='0 1 2'/>", "OglModel.triangles: 2 must lie in [0, 2)"}});
}

TEST(VisualStyle, TellsWhatItsLastWordSays) {
  const auto shown = [](const std::string& flags) {
    scene::Scene scene = read_and_init("<Node><VisualStyle displayFlags='" + flags + "'/></Node>");
    const auto* style = scene.root().local<scene::VisualStyle>();
    return std::tuple(style->shows_visual_models(), style->shows_behaviour_models(), style->shows_wireframe());
  };
  using Answers = std::tuple<std::optional<bool>, std::optional<bool>, bool>;
  EXPECT_EQ(shown("showWireframe showForceFields"), (Answers{{}, {}, true}));
  EXPECT_EQ(shown("showBehaviorModels hideVisualModels"), (Answers{false, true, false}));
  EXPECT_EQ(shown("showWireframe hideAll showVisual"), (Answers{true, false, false}));
}

std::optional<scene::Viewpoint> viewpoint(const std::string& attributes) {
  scene::Scene scene = read_and_init("<Node><InteractiveCamera " + attributes + "/></Node>");
  return scene.root().local<scene::Camera>()->viewpoint();
}

// From its position, which counts where it has a field of view; otherwise distance and detail are fitted.
TEST(InteractiveCamera, LooksFromItsPositionAtItsTarget) {
  const std::string at = "position='1 2 3' lookAt='1 1 5'";
  const std::optional<scene::Viewpoint> fitted = viewpoint(at), seen = viewpoint(at + " fieldOfView='30'");
  ASSERT_TRUE(fitted && seen && seen->eye);
  EXPECT_EQ(fitted->towards, Vec3(0, 1, -2));
  EXPECT_FALSE(fitted->up || fitted->eye);
  EXPECT_EQ(seen->eye->position, Vec3(1, 2, 3));
  EXPECT_EQ(seen->eye->looks_at, Vec3(1, 1, 5));
  EXPECT_EQ(seen->eye->field_of_view, 30);
  for (const auto& [type, is_perspective] : {std::pair("Orthographic", false), {"1", false}, {"0", true}})
    EXPECT_EQ(viewpoint(at + " fieldOfView='30' projectionType='" + type + "'")->eye->is_perspective, is_perspective);
  EXPECT_TRUE(seen->eye->is_perspective);
  EXPECT_FALSE(viewpoint("position='1 2 3' fieldOfView='45'"));
  expect_errors([](const std::string& attributes) { return in_node("<InteractiveCamera " + attributes + "/>"); },
                {{"position='1 2 3' lookAt='1 2 3'", "lookAt: is the camera's own position: must be another point"},
                 {"orientation='0 0 1'", "orientation: must be four numbers, a quaternion x y z w"},
                 {"orientation='0 0 0 0'", "orientation: is 0 0 0 0, the zero quaternion"}},
                "InteractiveCamera.");
}

// A quarter turn about x looks up along y instead of along -z, and has z at its head.
TEST(InteractiveCamera, TurnsByItsOrientation) {
  const std::string quarter = "orientation='0.70710678118654752 0 0 0.70710678118654752'";
  const std::optional<scene::Viewpoint> seen = viewpoint(quarter);
  ASSERT_TRUE(seen && seen->up);
  EXPECT_LT((seen->towards - Vec3(0, -1, 0)).norm(), 1e-15);
  EXPECT_LT((*seen->up - Vec3(0, 0, 1)).norm(), 1e-15);
  EXPECT_FALSE(seen->eye);
  const auto placed = viewpoint(quarter + " position='1 2 3' distance='4' fieldOfView='20'");
  EXPECT_LT((placed->eye->looks_at - Vec3(1, 6, 3)).norm(), 1e-14);
}

TEST(OglModel, TakesThePointsOfTheStateThatItFollows) {
  scene::Scene scene =
      read_and_init(skewed("<IdentityMapping input='@../nodes' output='@copy'/><OglModel name='copy' quads='0 1 2 3'/>"
                           "<BarycentricMapping/>"));
  EXPECT_EQ(at<scene::VisualModel>(scene, "skin/copy").points(), nodes(scene));
}

TEST(Mapping, RefusesWhatDoesNotFit) {
  expect_errors(
      [](const std::string& inner) { return skewed(inner); },
      {{"<IdentityMapping/>", "IdentityMapping: 2 nodes follow 16, must be as many"},
       {"<IdentityMapping input='@.' />", "IdentityMapping.input: is the mapped state itself: must be another one"},
       {"<BarycentricMapping/><FixedProjectiveConstraint/>",
        "FixedProjectiveConstraint: constrains a state that follows another one"},
       {"", "EulerImplicitSolver: no mass on MechanicalObject 'points' of its node and below"}});
}

}  // namespace
