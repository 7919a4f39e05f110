// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <set>

#include "attributes/stock.hpp"
#include "attributes/texts.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

// What a scene needs around the lines under test; these stand on line 3 and after.
std::string framed(const std::string& lines) {
  return "<Node name=\"root\" gravity=\"0 0 0\">\n"
         " <DefaultAnimationLoop/> <EulerImplicitSolver name=\"euler\"/> <CGLinearSolver/>"
         " <RegularGridTopology name=\"grid\" n=\"3 3 3\"/> <MechanicalObject name=\"nodes\"/> <UniformMass "
         "totalMass=\"1\"/>\n" +
         lines + "\n</Node>\n";
}

TEST(SceneReading, WhatIsWrongIsNamedWithItsLineAndTheNearest) {
  const std::string elsewhere = "scene with other components of SOFA runs in SOFA, with the plugin Hexaplast",
                    body = "HexahedronElastoplasticFEMForceField";
  for (const auto& [lines, message] : std::vector<std::pair<std::string, std::string>>{
           {"<DiagonalMas massDensity='1'/>",
            "DiagonalMas: unknown component\n  hint: did you mean 'DiagonalMass'? A " + elsewhere},
           {"<TotallyElse/>", "TotallyElse: unknown component\n  hint: a " + elsewhere},
           {"<DiagonalMass massDensty='1'/>",
            "DiagonalMass.massDensty: unknown attribute\n  hint: did you mean 'massDensity'?"},
           {"<RegularGridTopology position='0 0 0'/>", "RegularGridTopology.position: is computed, and cannot be set"},
           {"<MechanicalObject/>", "MechanicalObject: a second state in its node, must be one"},
           {"<Object/>", "Object.type: is not given, must be the class of a component"},
           {"<RequiredPlugin/>", "RequiredPlugin: names no plugin: needs name or pluginName"},
           {"<BoxROI template='Rigid3d'/>", "BoxROI.template: 'Rigid3d', must be one of: Vec3 Vec3d"},
           {"words", "Node 'root': holds text, must hold nodes and components"},
           {"<BoxROI><BoxROI/></BoxROI>", "BoxROI: components hold neither elements nor text"},
           {"<" + body + " topology='@nodes'/>",
            body + ".topology: the link leads to MechanicalObject 'nodes', must lead to a Topology"},
           {"<" + body + " poissonRatio='@roi.position'/><BoxROI name='roi' position='.1 .2 .7'/>",
            body + ".poissonRatio: link '@roi.position': 0.7 must lie in [0, 0.5)"}})
    EXPECT_EQ(errors_of(framed(lines)), "test.scn:3: error: " + message);
  EXPECT_EQ(errors_of(framed("\n<DiagonalMass\n massDensty='1'/>")).find("test.scn:5: "), 0u) << "of the attribute";
  EXPECT_EQ(errors_of("<BoxROI/>"), "test.scn:1: error: the root element is <BoxROI>, must be <Node>");
}

TEST(SceneReading, WhatSofaScenesSayIsAccepted) {
  for (const std::string lines :
       {"", "<Object type='BoxROI' box='0 0 0 1 1 1'/>", "<BoxROI template='Vec3'/> <BoxROI template='Vec3d'/>",
        "<RequiredPlugin name='Sofa.Component.Mass' requireAll='1' suffixMap=''/>"
        "<RequiredPlugin name='several' pluginName='Sofa.Component.Mass Hexaplast'/>",
        "<HexahedronElastoplasticFEMForceField topology='@.'/><HexahedronElastoplasticFEMForceField topology='@/'/>"
        "<HexahedronElastoplasticFEMForceField topology='@grid'/>"})
    EXPECT_EQ(errors_of(framed(lines)), "") << lines;
  EXPECT_EQ(errors_of("<Node bbox='0 0 0 1 1 1' animate='0' printLog='1' tags='x'><DefaultAnimationLoop "
                      "parallelODESolving='0' computeBoundingBox='false' bbox='' listening='1'/></Node>"),
            "");
}

TEST(SceneReading, NamesThatAreGoneSayWhatToWriteInstead) {
  EXPECT_EQ(errors_of(framed("<FixedConstraint name='old'/>\n<BoxROI position='@old.position'/>")),
            "test.scn:3: error: FixedConstraint: unknown component\n  hint: take FixedProjectiveConstraint");
  EXPECT_EQ(errors_of(framed("<RegularGridTopology nx='3'/>")),
            "test.scn:3: error: RegularGridTopology.nx: unknown attribute\n  hint: take n");
  EXPECT_EQ(errors_of(framed("<RegularGridTopology hexas='3'/>")),
            "test.scn:3: error: RegularGridTopology.hexas: unknown attribute\n  hint: take hexahedra");
  EXPECT_EQ(errors_of(framed("<OglModel triangles='@grid.triangles'/>")),
            "test.scn:3: error: OglModel.triangles: link '@grid.triangles' stops at RegularGridTopology 'grid', which "
            "has no attribute 'triangles'\n  hint: take quads");

  std::set<std::string_view> gone;
  for (const auto& [name, instead] : attributes::gone()) {
    EXPECT_TRUE(gone.insert(name).second) << name << " is there twice";
    const std::size_t dot = name.find('.');
    const std::string_view owner = name.substr(0, dot);  // empty: any
    bool is_there = owner.empty() || owner == "Node";
    for (const attributes::Description* component : support::factory().descriptions()) {
      if (!owner.empty() && owner != component->class_name) continue;
      is_there = true;
      EXPECT_EQ(std::ranges::count(component->attributes, name.substr(dot + 1), &attributes::Attribute::name), 0)
          << name;
    }
    EXPECT_EQ(is_there, dot != name.npos) << name;
  }
}

// A name that is passed over on every component is none that some component has.
TEST(SceneReading, WhatIsPassedOverHasAnEffectNowhere) {
  EXPECT_TRUE(has(errors_of(framed("<BoxROI drawBoxes='1'/><InstrumentContactForceField activated='0'/>")),
                  "test.scn:3: error: InstrumentContactForceField.activated: unknown attribute\n  hint:"));
  std::vector<const attributes::Description*> all = factory().descriptions();
  all.push_back(&attributes::kNode);
  for (const std::string_view name : scene::split_words(attributes::kPassedOver)) {
    EXPECT_TRUE(attributes::instead_of(fmt::format(".{}", name)).empty()) << name;
    for (const attributes::Description* component : all) {
      EXPECT_EQ(std::ranges::count(component->attributes, name, &attributes::Attribute::name), 0)
          << component->class_name << "." << name;
      EXPECT_TRUE(attributes::instead_of(fmt::format("{}.{}", component->class_name, name)).empty()) << name;
    }
  }
}

// What scenes need that ship with the program, in its documentation and its examples; the rest of SOFA is SOFA's.
TEST(SceneReading, TheComponentsAreTheseAndNoOthers) {
  const std::vector<std::string_view> words = scene::split_words(
      "DefaultAnimationLoop RunSettings AttributeChange Probe MaterialRegion EulerImplicitSolver StaticSolver "
      "NewtonRaphsonSolver CGLinearSolver MultigridCGLinearSolver SparseLDLSolver RegularGridTopology "
      "SparseGridTopology TubeGridTopology SheetGridTopology SpherePatchGridTopology MeshTopology "
      "HexahedronSetTopologyContainer TriangleSetTopologyContainer QuadSetTopologyContainer MeshVTKLoader "
      "MeshGmshLoader MeshOBJLoader MeshSTLLoader MechanicalObject DiagonalMass UniformMass "
      "HexahedronElastoplasticFEMForceField ConstantForceField LinearForceField TangentialForceField "
      "SurfacePressureForceField PlaneForceField GraspForceField InstrumentContactForceField "
      "TissueContactForceField RestShapeSpringsForceField SpringForceField BladeController "
      "FixedProjectiveConstraint PartialFixedProjectiveConstraint LinearMovementProjectiveConstraint "
      "PartialLinearMovementProjectiveConstraint AttachProjectiveConstraint BoxROI SphereROI PlaneROI MeshROI "
      "IndexValueMapper IndicesFromValues BarycentricMapping IdentityMapping OglModel VisualStyle "
      "InteractiveCamera "
      // accepted without effect
      "BackgroundSetting LightManager DirectionalLight DefaultVisualManagerLoop HexahedronSetTopologyModifier "
      "HexahedronSetGeometryAlgorithms QuadSetTopologyModifier QuadSetGeometryAlgorithms "
      "TriangleSetGeometryAlgorithms");
  plugins();
  std::set<std::string_view> registered;
  for (const attributes::Description* description : factory().descriptions())
    if (description->category != "Test") registered.insert(description->class_name);
  EXPECT_EQ(registered, std::set(words.begin(), words.end()));
}

TEST(SceneReading, AllErrorsAreReportedAtOnceAndAtMostTwenty) {
  std::string lines;
  for (int i = 0; i < 23; ++i) lines += "<Nonsense/>\n";
  const std::string errors = errors_of(framed(lines));
  EXPECT_TRUE(has(errors, "test.scn:3: error: Nonsense: unknown component\n"));
  EXPECT_TRUE(has(errors, "test.scn:22: error: Nonsense: unknown component\n"));
  EXPECT_FALSE(has(errors, "test.scn:23: "));
  EXPECT_TRUE(has(errors, "\n3 further errors are not shown"));
}

TEST(SceneReading, AMistakeDoesNotHideTheDanglingLinkBesideIt) {
  const std::string errors =
      errors_of(framed("<DiagonalMass massDensity='x'/>\n<FixedProjectiveConstraint indices='@no.indices'/>"));
  EXPECT_TRUE(has(errors, "test.scn:3: error: DiagonalMass.massDensity: 'x' is not a number"));
  EXPECT_TRUE(has(errors, "test.scn:4: error: FixedProjectiveConstraint.indices: link '@no.indices'"));
}

TEST(SceneReading, WhatOnlyFollowsFromAMistakeIsNotReported) {
  EXPECT_EQ(errors_of(framed("<SphereRO name='roi'/>\n<Probe value='@roi.centers'/>")),
            errors_of(framed("<SphereRO name='roi'/>")));
  const std::string body = "<HexahedronElastoplasticFEMForceField youngModulus='1 2'/>\n",
                    tool = "<InstrumentContactForceField name='tool' radius='1' keyTimes='0' positions='9 9 9'/>\n",
                    refused =
                        "test.scn:3: error: HexahedronElastoplasticFEMForceField.youngModulus: 2 values given, must "
                        "be one or 8 (one per hexahedron)";
  EXPECT_EQ(errors_of(framed(body + tool + "<Probe value='@tool.force' component='z'/>")), refused);
  EXPECT_EQ(errors_of(framed(body + "<TissueContactForceField object1='@nodes'/>")), refused);
}

TEST(SceneReading, OnlyTheRootsClockCounts) {
  scene::Scene scene =
      read_and_init("<Node dt='0.5' gravity='1 2 3'>\n<Node name='inner' dt='0.1' gravity='0 0 0'/></Node>");
  EXPECT_EQ(scene.dt(), 0.5);
  EXPECT_EQ(scene.root().children()[0]->clock().gravity, Vec3(1, 2, 3));
  const std::vector<scene::Message> warnings = scene.diagnostics().take_warnings();
  ASSERT_EQ(warnings.size(), 3u);  // and the note on the missing animation loop
  EXPECT_EQ(scene::format(warnings[0]), "test.scn:2: warning: Node.dt: is ignored: only the root's counts");
}

TEST(SceneReading, IgnoredDrawingIsNotedBookkeepingIsSilent) {
  scene::Scene scene = read_and_init(
      "<Node><LightManager size='3' whatever='@nowhere'/>\n"
      "<HexahedronSetGeometryAlgorithms template='Vec3d'/></Node>");
  std::vector<std::string> said;
  for (const scene::Message& message : scene.diagnostics().take_warnings()) said.push_back(scene::format(message));
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[1], "test.scn:1: note: LightManager: visual: ignored here");
}

// Links
// ---------------------------------------------------------------------------------------------------------------------

const std::vector<std::int64_t>& fixed_nodes(scene::Scene& scene) {
  return at<scene::ProjectiveConstraint>(scene, "fixed").integers("indices");
}

TEST(SceneLinks, LeadForwardsUpwardsAndAround) {
  const std::vector<std::int64_t> bottom = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  const std::string roi = "<BoxROI name='roi' box='0 0 0 1 1 0'/>";
  for (const char* link : {"@roi.indices", "@./roi.indices", "@/roi.indices", "@Node1/../roi.indices"}) {
    SCOPED_TRACE(link);
    scene::Scene scene = read_and_init(
        framed("<FixedProjectiveConstraint name='fixed' indices='" + std::string(link) + "'/>" + roi + "<Node/>"));
    EXPECT_EQ(fixed_nodes(scene), bottom);
  }
}

TEST(SceneLinks, ABareNameIsFoundInTheNodesAbove) {
  scene::Scene scene = read_and_init(
      framed("<BoxROI name='roi' box='0 0 0 1 1 0'/>"
             "<Node name='inner'><FixedProjectiveConstraint name='fixed' indices='@roi.indices'/></Node>"));
  EXPECT_EQ(at<scene::ProjectiveConstraint>(scene, "inner/fixed").integers("indices").size(), 9u);
}

TEST(SceneLinks, SayWhereTheyStop) {
  for (const auto& [link, message] : std::vector<std::pair<std::string, std::string>>{
           {"@../roi.indices", "stops at node '/', which has no parent"},
           {"@gird.hexahedra", "stops at node '/', which holds no 'gird'\n  hint: did you mean 'grid'?"},
           {"@grid/x.y", "stops at RegularGridTopology 'grid', which holds nothing"},
           {"@grid", "names no attribute: must be @path.attribute"},
           {"@grid.position",
            "leads to RegularGridTopology 'grid'.position (test.scn:2), which holds groups of three numbers, must hold "
            "whole numbers"},
           {"@grid.positon",
            "stops at RegularGridTopology 'grid', which has no attribute 'positon'\n  hint: did you mean 'position'?"}})
    EXPECT_EQ(errors_of(framed("<FixedProjectiveConstraint indices='" + link + "'/>")),
              "test.scn:3: error: FixedProjectiveConstraint.indices: link '" + link + "' " + message);
}

TEST(SceneLinks, ReachAttributesOfNodes) {
  scene::Scene scene = read_and_init(
      "<Node gravity='1 2 3'><Node name='in' gravity='4 5 6'><BoxROI name='up' position='@../.gravity'/>"
      "<BoxROI name='root' position='@/.gravity'/>"
      "<BoxROI name='here' position='@.gravity'/></Node></Node>");
  for (const char* name : {"in/up", "in/root"})
    EXPECT_EQ(at<scene::Engine>(scene, name).reals("position"), (std::vector<double>{1, 2, 3})) << name;
  EXPECT_EQ(at<scene::Engine>(scene, "in/here").reals("position"), (std::vector<double>{4, 5, 6}));
}

TEST(SceneLinks, AClassStandsForItsOnlyComponent) {
  const std::string roi = "<BoxROI name='roi' box='0 0 0 1 1 0'/>",
                    link = "<FixedProjectiveConstraint name='fixed' indices='@BoxROI.indices'/>";
  scene::Scene scene = read_and_init(framed(link + roi));
  EXPECT_EQ(fixed_nodes(scene).size(), 9u);
  EXPECT_EQ(
      errors_of(framed(link + roi + "<BoxROI name='other'/>")),
      "test.scn:3: error: FixedProjectiveConstraint.indices: link '@BoxROI.indices' stops at node '/', which holds 2 "
      "components of class BoxROI: give them names");
  // a name counts before a class
  scene::Scene named = read_and_init(framed(link + roi + "<BoxROI name='BoxROI' box='0 0 0 0 0 0'/>"));
  EXPECT_EQ(fixed_nodes(named).size(), 1u);
}

TEST(SceneLinks, SrcConnectsAllThatIsNotGiven) {
  const std::string grid = "<RegularGridTopology name='other' n='2 2 2' max='2 3 4'/>";
  scene::Scene scene = read_and_init(framed(grid + "<BoxROI name='all' src='@other' box='1 1 1 9 9 9'/>"
                                                   "<BoxROI name='own' src='@other' position='5 5 5  0 0 0  0 0 0  0 0 "
                                                   "0  0 0 0  0 0 0  0 0 0  0 0 0' box='1 1 1 9 9 9'/>"));
  EXPECT_EQ(at<scene::Engine>(scene, "all").integers("indices"), (std::vector<std::int64_t>{7}));
  EXPECT_EQ(at<scene::Engine>(scene, "own").integers("indices"), (std::vector<std::int64_t>{0}));

  EXPECT_EQ(errors_of(framed("<BoxROI src='@absent'/>")),
            "test.scn:3: error: BoxROI.src: link '@absent' stops at node '/', which holds no 'absent'");
  EXPECT_EQ(errors_of(framed("<RunSettings src='@grid'/>")),
            "test.scn:3: error: RunSettings.src: link '@grid' leads to RegularGridTopology 'grid', which has no "
            "attribute that belongs here");
}

TEST(SceneLinks, SrcLeavesOutWhatTheSourceWasNotGivenEvenOfALaterSource) {
  scene::Scene scene =
      read_and_init(framed("<BoxROI name='third' src='@second'/><BoxROI name='second' src='@first'/><BoxROI "
                           "name='first' box='1 1 1 9 9 9'/>"));
  auto& third = at<scene::Engine>(scene, "third");
  EXPECT_EQ(third.reals("box").size(), 6u);
  EXPECT_FALSE(third.is_given("position"));
  EXPECT_EQ(third.integers("indices"), at<scene::Engine>(scene, "first").integers("indices"));
}

TEST(SceneReading, ASecondRunSettingsHasNoEffect) {
  scene::Scene scene = read_and_init(framed("<RunSettings/>\n<Node name='below'><RunSettings name='other'/></Node>"));
  EXPECT_EQ(warnings_of(scene), "test.scn:4: warning: RunSettings: has no effect: 'RunSettings1' stands before it\n");
}

TEST(SceneLinks, CirclesAreFound) {
  EXPECT_EQ(errors_of(framed("<BoxROI name='a' box='@b.box'/>\n<BoxROI name='b' box='@a.box'/>")),
            "test.scn:3: error: BoxROI.box: link '@b.box' leads back to itself\n"
            "test.scn:4: error: BoxROI.box: link '@a.box' leads back to itself");
  EXPECT_EQ(errors_of(framed("<BoxROI name='a' hexahedra='@a.hexahedraInROI'/>")),
            "test.scn:3: error: BoxROI.hexahedraInROI: depends on itself through links");
  EXPECT_EQ(errors_of(framed("<BoxROI name='a' src='@a'/>")),
            "test.scn:3: error: BoxROI.src: link '@a' leads back to itself");
}

TEST(SceneLinks, StayLive) {
  // The body falls out of the box; the constraint follows the box, and lets go.
  scene::Scene scene = read_and_init(
      "<Node dt='1' gravity='0 0 -1'><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/>"
      "<MechanicalObject name='nodes' position='0 0 0  0 0 5'/><UniformMass vertexMass='1'/>"
      "<BoxROI name='roi' box='-1 -1 3.5 1 1 9' position='@nodes.position'/>"
      "<BoxROI name='low' box='-1 -1 -9 1 1 -0.5' position='@nodes.position'/>"
      "<FixedProjectiveConstraint name='fixed' indices='@low.indices'/></Node>");
  EXPECT_TRUE(fixed_nodes(scene).empty());
  scene.step();  // v = -1, z = -1 and 4
  EXPECT_EQ(fixed_nodes(scene), (std::vector<std::int64_t>{0}));
  scene.step();  // node 0 keeps its velocity now, node 1 goes on accelerating
  const PointArray& x = at<scene::MechanicalState>(scene, "nodes").positions();
  EXPECT_DOUBLE_EQ(x(0, 2), -2);
  EXPECT_DOUBLE_EQ(x(1, 2), 2);
}

TEST(SceneLinks, WhatCannotFollowAChangeRefusesIt) {
  scene::Scene scene = read_and_init(
      "<Node dt='1' gravity='0 0 -1'><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/>\n"
      "<MechanicalObject name='nodes' position='0 0 0'/><UniformMass vertexMass='1'/>"
      "<Node><MeshTopology position='@../nodes.position'/></Node></Node>");
  scene.step();
  try {
    scene.step();
    FAIL() << "the topology followed the position";
  } catch (const scene::SceneError& error) {
    EXPECT_STREQ(error.what(),
                 "test.scn:2: error: MeshTopology.position: follows a link to something that changes during the run, "
                 "which it cannot do");
  }
}

// Overrides
// -----------------------------------------------------------------------------------------------------------------

TEST(SceneOverride, TheLastOneCounts) {
  scene::Scene scene = read(framed(""));
  scene::override_attribute(scene, "euler.rayleighStiffness=0.5");
  scene::override_attribute(scene, "euler.rayleighMass=@euler.rayleighStiffness");
  scene::Object& euler = at<scene::Object>(scene, "euler");
  EXPECT_EQ(euler.real("rayleighMass"), 0.5);
  scene::override_attribute(scene, "euler.rayleighMass=0.25");
  EXPECT_EQ(euler.real("rayleighMass"), 0.25);
}

TEST(SceneOverride, SaysWhatIsWrong) {
  scene::Scene scene = read(framed(""));
  const auto refusal = [&](const std::string& assignment) -> std::string {
    try {
      scene::override_attribute(scene, assignment);
      return "accepted";
    } catch (const scene::OverrideError& error) {
      return error.what();
    }
  };
  const std::string absent = "stops at node '/', which holds no 'eulr'\n  hint: did you mean 'euler'?";
  for (const auto& [assignment, message] : std::vector<std::pair<std::string, std::string>>{
           {"euler", "must be PATH.attribute=VALUE; the root's own attributes are .attribute=VALUE"},
           {"eulr.rayleighMass=1", absent},
           {"euler.rayleighMas=1",
            "EulerImplicitSolver 'euler' has no attribute 'rayleighMas'\n  hint: did you mean 'rayleighMass'?"},
           {"euler.rayleighMass=-1", "EulerImplicitSolver.rayleighMass: -1 must be >= 0"},
           {"euler.name=x",
            "the name of EulerImplicitSolver 'euler' cannot be replaced: paths and links find it by that"},
           {"euler.rayleighMass=@eulr.rayleighStiffness",
            "EulerImplicitSolver.rayleighMass: link '@eulr.rayleighStiffness' " + absent},
           {".dt=@euler.name",
            "Node.dt: link '@euler.name' leads to EulerImplicitSolver 'euler'.name (test.scn:2), which holds text, "
            "must hold one number"}})
    EXPECT_EQ(refusal(assignment), "--set " + assignment + ": error: " + message);
  for (const char* assignment : {"euler.rayleighMass=1", "euler.rayleighMass=@euler.rayleighStiffness"})
    EXPECT_EQ(refusal(assignment), "accepted");
}

}  // namespace
