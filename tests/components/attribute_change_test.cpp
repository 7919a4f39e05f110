// SPDX-License-Identifier: LGPL-2.1-or-later
// Attributes of a body, and attributes that change during a run: when, with what effect, and what is refused.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "support/rows.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

std::string beam(const std::string& change, const std::string& body = "youngModulus='5000' yieldStress='80 90 100'") {
  return in_root("gravity='0 0 -5' dt='0.1'",
                 change +
                     "<RegularGridTopology name='grid' n='4 2 2' max='3 1 1'/><MechanicalObject name='nodes'/>"
                     "<DiagonalMass massDensity='10'/><HexahedronElastoplasticFEMForceField name='body' "
                     "poissonRatio='0.4' plasticFlowRate='1' " +
                     body + "/><FixedProjectiveConstraint indices='0 4 8 12'/>");
}
std::string change(const std::string& attributes) {
  return beam("<AttributeChange component='@body' " + attributes + "/>");
}
// Two changes within a step: the later one counts. An empty list takes the value away.
TEST(AttributeChange, HappensAtTheFirstStepFromItsTimeOn) {
  scene::Scene scene =
      read_and_init(change("attribute='yieldStress' keyTimes='0.15 0.3 0.41 0.43' values='1 2 3; ;50;70'"));
  for (int round = 0; round < 2; ++round) {
    for (const double value : {100., 100., 3., Material().yield_stress, Material().yield_stress, 70., 70.}) {
      run(scene, 1);
      EXPECT_EQ(body(scene).material(2).yield_stress, value) << "in the step that ends at t = " << scene.time();
    }
    scene.reset();
  }
}

TEST(AttributeChange, OneEmptyValueTakesTheValueAway) {
  scene::Scene scene = read_and_init(change("attribute='yieldStress' keyTimes='0.1' values=''"));
  run(scene, 1);
  EXPECT_EQ(body(scene).material(2).yield_stress, 100);
  run(scene, 1);
  EXPECT_EQ(body(scene).material(2).yield_stress, Material().yield_stress);
}

// Each alone would put the fracture below the yield, on the way there and back.
TEST(AttributeChange, ThoseOfOneTimeHappenTogether) {
  scene::Scene scene = read_and_init(beam(
      attribute_change("body", "yieldStress", "0.2", "500") + attribute_change("body", "fractureStress", "0.2", "900"),
      "youngModulus='5000' yieldStress='100' fractureStress='300'"));
  const auto material = [&] { return body(scene).material(1); };
  for (int round = 0; round < 2; ++round) {
    run(scene, 2);
    EXPECT_EQ(material().fracture_stress, 300);
    run(scene, 1);
    EXPECT_EQ(material().yield_stress, 500);
    EXPECT_EQ(material().fracture_stress, 900);
    scene.reset();
  }
}

// The number of changes of what it follows is that of its own: one.
TEST(AttributeChange, TakesThePlaceOfALink) {
  scene::Scene scene = read_and_init(beam(attribute_change("pull", "indices", "0.2", "3"),
                                          "youngModulus='5000'/><BoxROI name='end' box='2.9 -1 -1 3.1 2 2'/>"
                                          "<ConstantForceField name='pull' indices='@end.indices' totalForce='0 0 8'"));
  const auto pull = [&](int node) { return force_of(scene, "pull", 0)(node, 2); };
  for (int round = 0; round < 2; ++round) {
    run(scene, 2);
    EXPECT_EQ(pull(3), 2) << "round " << round;
    EXPECT_EQ(pull(7), 2) << "round " << round;
    run(scene, 1);
    EXPECT_EQ(pull(3), 8) << "round " << round;
    EXPECT_EQ(pull(7), 0) << "round " << round;
    scene.reset();
    EXPECT_EQ(pull(7), 2) << "what goes back has its effect at once";
  }
}

TEST(AttributeChange, APrescribedMotionGoesOnFromItsBeginning) {
  const auto expect = [](const std::string& motion, const std::string& changes, std::initializer_list<double> places) {
    scene::Scene scene =
        read_and_init(in_root("gravity='0 0 0' dt='0.1'", changes +
                                                              "<MechanicalObject name='nodes' position='3 1 0  5 1 0'/>"
                                                              "<UniformMass vertexMass='1'/>" +
                                                              motion));
    for (int round = 0; round < 2; ++round) {
      int step = 0;
      for (const double x : places) {
        run(scene, 1);
        EXPECT_NEAR(nodes(scene)(0, 0), x, 1e-12) << motion << ", step " << ++step << ", round " << round;
      }
      scene.reset();
      EXPECT_EQ(nodes(scene)(0, 0), places.begin()[0]) << motion;
    }
  };
  const auto change = [](const std::string& attribute, const std::string& values) {
    return attribute_change("move", attribute, "0.25", values);
  };
  for (const std::string name : {"LinearMovementProjectiveConstraint", "PartialLinearMovementProjectiveConstraint"}) {
    const std::string motion = "<" + name + " name='move' indices='0' keyTimes='0 1' movements='0 0 0  1 0 0'/>";
    expect(motion, change("movements", "0 0 0  1 0 4"), {3, 3.1, 3.2, 3.3, 3.4});
    expect(motion, change("movements", "0 0 0  2 0 0"), {3, 3.1, 3.2, 3.6, 3.8});
    expect(motion, change("indices", "0 1"), {3, 3.1, 3.2, 3.3, 3.4});
  }
}

TEST(AttributeChange, ANodeThatJoinsAMotionBeginsWhereItIs) {
  const std::string text =
      in_root("gravity='0 0 0' dt='0.1'",
              "<AttributeChange component='@move' attribute='indices' keyTimes='0.25 0.55' values='0 1; 1'/>"
              "<MechanicalObject name='nodes' position='3 1 0  5 1 0' velocity='0 0 0  0 2 0'/>"
              "<UniformMass vertexMass='1'/><LinearMovementProjectiveConstraint name='move' indices='0' "
              "keyTimes='0 1' movements='.4 0 0  1.4 0 0'/>");
  scene::Scene scene = read_and_init(text), resumed = read_and_init(text);
  for (int round = 0; round < 2; ++round) {
    for (const double x : {5.0, 5.0, 5.0, 5.1, 5.2, 5.3, 5.4}) {
      run(scene, 1);
      EXPECT_NEAR(nodes(scene)(1, 0), x, 1e-12) << "t = " << scene.time() << ", round " << round;
    }
    EXPECT_NEAR(nodes(scene)(1, 1), 1.6, 1e-12) << "it was free before";
    EXPECT_NEAR(nodes(scene)(0, 0), 3.9 + 0.1, 1e-12) << "it goes on with its last velocity";
    scene.reset();
  }
  for (const int steps : {4, 6}) {
    scene::Scene straight = read_and_init(text);
    run(straight, steps);
    go_on_in(straight, resumed);
    run(straight, 3);
    run(resumed, 3);
    EXPECT_EQ(nodes(straight), nodes(resumed)) << steps;
  }
}

TEST(AttributeChange, RefusesWhatItCannotChange) {
  const std::string body = "HexahedronElastoplasticFEMForceField";
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {beam("<AttributeChange attribute='youngModulus'/>"), "component: is not given, must lead to a component"},
           {beam("<AttributeChange component='@/' attribute='dt'/>"), "component: "},
           {beam("<AttributeChange component='@grid' attribute='max' keyTimes='1' values='1 2 3'/>"),
            "component: leads to RegularGridTopology 'grid', which reads its attributes once, when the scene begins"},
           {beam("<AttributeChange component='@nodes' attribute='translation' keyTimes='1' values='1 2 3'/>"),
            "component: leads to MechanicalObject 'nodes', which reads its attributes once"},
           {change("attribute='youngsModulus' keyTimes='1' values='2'"),
            "attribute: " + body + " 'body' has no attribute 'youngsModulus' that may change"},
           {change("attribute='topology' keyTimes='1' values='@grid'"), "attribute: "},
           {change("attribute='plasticStrain' keyTimes='1' values='2'"), "attribute: "},
           {change("attribute='poissonRatio' keyTimes='1 2' values='0.3; 0.7'"),
            "values: " + body + ".poissonRatio: 0.7 must lie in [0, 0.5)"},
           {change("attribute='youngModulus' keyTimes='1 2' values='3'"), "values: 1 values given for 2 times"},
           {change("attribute='youngModulus' keyTimes='1'"), "values: is not given"},
           {change("attribute='youngModulus' keyTimes='2 1' values='3; 4'"), "keyTimes: 2 is followed by 1"},
           {change("attribute='youngModulus'"), "keyTimes: is empty"},
           {beam("",
                 "youngModulus='5000'/><AttributeChange component='@body' attribute='youngModulus' keyTimes='1' "
                 "values='2'"),
            "component: leads to " + body + " 'body' before it, must lead to a component behind"}})
    EXPECT_TRUE(has(errors_of(text), "AttributeChange." + message));
}

std::string two_hexahedra(const std::string& body, const std::string& more = "") {
  return in_root(
      "gravity='0 0 0' dt='0.02'",
      "<RegularGridTopology name='grid' n='3 2 2'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
      "<HexahedronElastoplasticFEMForceField name='body' " +
          body + "/>" + more);
}

TEST(BodyField, TakesEveryMemberOfMaterialAndSettings) {
  const auto text_of = [](const auto& row, const std::vector<double>& values) {
    return row.at.type == MemberType::kWord ? std::string(row.words[static_cast<std::size_t>(values[0])])
                                            : fmt::format("{}", fmt::join(values, " "));
  };
  for (const Row<Material>& row : material_rows()) {
    const double value = another(row, row.at.get({}));
    const std::string others = row.name == "rotationFlowRate" ? "restShape='joined' " : "";
    scene::Scene scene =
        read_and_init(two_hexahedra(fmt::format("{}{}='{}'", others, row.name, text_of(row, {value}))));
    for (const Row<Material>& other : material_rows())
      EXPECT_EQ(other.at.get(body(scene).material(0)), &other == &row ? value : other.at.get({})) << other.name;
  }
  for (const Row<Settings>& row : settings_rows()) {
    // which has every other option
    const bool is_plain = row.name != "implementation" && row.name != "precision" && row.name != "fracture";
    Settings expected;
    std::string others = is_plain ? "implementation='plain' " : "";
    if (is_plain) expected.implementation = Implementation::kPlain;
    support::change(row, expected);
    scene::Scene scene =
        read_and_init(two_hexahedra(fmt::format("{}{}='{}'", others, row.name, text_of(row, row.values(expected)))));
    EXPECT_EQ(body(scene).settings(), expected) << row.name;
  }
}

TEST(BodyField, ShowsItsPlasticState) {
  scene::Scene scene =
      read_and_init(two_hexahedra("youngModulus='1000' yieldStress='5' plasticFlowRate='5' hardening='1'"));
  auto& field = at<scene::ForceField>(scene, "body");
  at<scene::MechanicalState>(scene, "nodes").positions().col(0) *= 1.3;
  scene.step();
  EXPECT_GT(field.reals("plasticStrain")[1], 0);
  EXPECT_GT(field.reals("presentYieldStress")[0], 5);
  EXPECT_NEAR(field.reals("volumeRatio")[0], 1, 1e-3);
  EXPECT_EQ(PointArray(field.vectors3("plasticRestPositions")), field.body()->plastic_rest_positions());
  EXPECT_NE(field.body()->plastic_rest_positions(), field.body()->mesh().positions());
  EXPECT_TRUE(field.integers("removed").empty());
  field.remove_elements(std::vector<int>{1});
  EXPECT_EQ(field.integers("removed"), std::vector<std::int64_t>{1});
  EXPECT_EQ(field.reals("volumeRatio")[1], 0);
  scene.reset();
  EXPECT_EQ(field.body()->plastic_rest_positions(), field.body()->mesh().positions());
}

// Its time step is that of the scene, and no setting changes during a run.
TEST(BodyField, RelaxesAfterAJumpByTheTimeStepOfTheScene) {
  scene::Scene scene = read_and_init(two_hexahedra("youngModulus='1000' relaxation='2 0.1'",
                                                   "<FixedProjectiveConstraint indices='0 1 2 3 4 5 6 7 8 9 10 11'/>"));
  auto& field = at<scene::ForceField>(scene, "body");
  PointArray& x = at<scene::MechanicalState>(scene, "nodes").positions();
  const double slow_energy = [&] {
    Body slow(field.body()->mesh(), field.body()->materials());
    x.col(0) *= 1.01;
    return slow.energy(x);
  }();
  scene.step();
  const double first = field.body()->energy(x) - slow_energy;
  for (int n = 0; n < 5; ++n) scene.step();
  EXPECT_NEAR((field.body()->energy(x) - slow_energy) / first, std::exp(-2 * 5 * 0.02 / 0.1), 1e-8);

  EXPECT_THROW(field.find_data("removed")->set(std::vector<std::int64_t>{1}, {}), InputError);
  field.find_data("relaxation")->set(std::vector<double>{1, 0.1}, {});
  EXPECT_THROW(scene.step(), scene::SceneError);
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
    return PointArray(velocities(scene));
  };
  const PointArray by_solver = first_velocities("0.3", "0");
  EXPECT_TRUE(first_velocities("0", "0.3").isApprox(by_solver, 1e-12));
  EXPECT_FALSE(first_velocities("0", "0").isApprox(by_solver, 1e-2));
}

TEST(BodyField, StandsBehindItsState) {
  EXPECT_EQ(errors_of(in_root("",
                              "<RegularGridTopology/><HexahedronElastoplasticFEMForceField/><MechanicalObject "
                              "name='nodes'/><UniformMass totalMass='1'/>")),
            "test.scn:1: error: HexahedronElastoplasticFEMForceField: needs its MechanicalState ('nodes') before it in "
            "the scene");
}

TEST(NodeOfSeveral, IsInitialisedBeforeThoseBelow) {
  const std::string constraint =
      "<AttachProjectiveConstraint object1='@/a/nodes' object2='@/w/points' indices1='@/a/pick.indices' indices2='0'/>";
  const auto scene = [](const std::string& above, const std::string& behind) {
    return "<Node><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/>" + above +
           "<Node name='a'>\n<RegularGridTopology n='3 3 3' max='1 1 1'/><MechanicalObject name='nodes'/>"
           "<UniformMass totalMass='1'/>\n<BoxROI name='pick' box='.9 .9 .9 2 2 2'/></Node>"
           "<Node name='w'><MechanicalObject name='points' position='1 1 1'/><UniformMass totalMass='1'/></Node>" +
           behind + "</Node>";
  };
  EXPECT_NE(errors_of(scene(constraint, ""))
                .find("test.scn:3: error: BoxROI: is asked for by a component of a node "
                      "above, which comes before its MechanicalState ('nodes')"),
            std::string::npos)
      << errors_of(scene(constraint, ""));
  EXPECT_EQ(errors_of(scene("", "<Node>" + constraint + "</Node>")), "");
}

}  // namespace
