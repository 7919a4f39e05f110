// SPDX-License-Identifier: LGPL-2.1-or-later
// Attributes that change during a run: when, with what effect, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hexaplast/body.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::in_root;
using support::read_and_init;
using support::run;

std::string beam(const std::string& change, const std::string& body = "youngModulus='5000' yieldStress='80 90 100'") {
  return in_root(
      "gravity='0 0 -5' dt='0.1'",
      change +
          "<RegularGridTopology name='grid' n='4 2 2' max='3 1 1'/><MechanicalObject name='nodes'/>"
          "<DiagonalMass massDensity='10'/><HexahedronElastoplasticFEMForceField name='body' poissonRatio='0.4' "
          "plasticFlowRate='1' " +
          body + "/><FixedProjectiveConstraint indices='0 4 8 12'/>");
}
std::string change(const std::string& attributes) {
  return beam("<AttributeChange component='@body' " + attributes + "/>");
}

TEST(AttributeChange, HappensAtTheFirstStepFromItsTimeOn) {
  scene::Scene scene =
      read_and_init(change("attribute='youngModulus' keyTimes='0.15 0.3 0.31' values='6000; 7000;8000'"));
  const auto modulus = [&] { return at<scene::ForceField>(scene, "body").body()->material(1).young_modulus; };
  const double expected[] = {5000, 5000, 6000, 7000, 8000, 8000};
  for (const double value : expected) {
    run(scene, 1);
    EXPECT_EQ(modulus(), value) << "in the step that ends at t = " << scene.time();
  }
  scene.reset();
  run(scene, 1);
  EXPECT_EQ(modulus(), 5000);
  run(scene, 2);
  EXPECT_EQ(modulus(), 6000) << "again";
}

// The time of a scene is a sum of steps, and some of those sums come to a little less than the time that is written.
TEST(AttributeChange, IsNotLateByRounding) {
  constexpr int kSteps = 100;
  std::string times, values;
  for (int k = 1; k <= kSteps; ++k) {
    times += fmt::format("{:.2f} ", .01 * k);
    values += fmt::format("{}{}", k == 1 ? "" : ";", 5000 + k);
  }
  std::string text = change("attribute='youngModulus' keyTimes='" + times + "' values='" + values + "'");
  text.replace(text.find("dt='0.1'"), 8, "dt='0.01'");
  scene::Scene scene = read_and_init(text);
  double sum = 0;
  int num_less = 0;
  for (int k = 0; k <= kSteps; ++k) {
    num_less += sum < std::stod(fmt::format("{:.2f}", .01 * k));
    sum += .01;
    run(scene, 1);
    EXPECT_EQ(at<scene::ForceField>(scene, "body").body()->material(1).young_modulus, 5000 + k);
  }
  EXPECT_GT(num_less, 0);
}

TEST(AttributeChange, GivesListsAndTakesValuesAway) {
  scene::Scene scene = read_and_init(change("attribute='yieldStress' keyTimes='0.1 0.2 0.3' values='1 2 3; ;70'"));
  const auto yield = [&](int e) { return at<scene::ForceField>(scene, "body").body()->material(e).yield_stress; };
  run(scene, 2);
  EXPECT_EQ(yield(2), 3);
  run(scene, 1);
  EXPECT_EQ(yield(2), Material().yield_stress);
  run(scene, 1);
  EXPECT_EQ(yield(0), 70);
  scene.reset();
  run(scene, 1);
  EXPECT_EQ(yield(2), 100);
}

// Each alone would put the fracture below the yield, on the way there and back.
TEST(AttributeChange, ThoseOfOneTimeHappenTogether) {
  const auto change_of = [](const std::string& attribute, const std::string& value) {
    return "<AttributeChange component='@body' attribute='" + attribute + "' keyTimes='0.2' values='" + value + "'/>";
  };
  scene::Scene scene = read_and_init(beam(change_of("yieldStress", "500") + change_of("fractureStress", "900"),
                                          "youngModulus='5000' yieldStress='100' fractureStress='300'"));
  const auto material = [&] { return at<scene::ForceField>(scene, "body").body()->material(1); };
  for (int round = 0; round < 2; ++round) {
    run(scene, 2);
    EXPECT_EQ(material().fracture_stress, 300);
    run(scene, 1);
    EXPECT_EQ(material().yield_stress, 500);
    EXPECT_EQ(material().fracture_stress, 900);
    scene.reset();
  }
}

/// A scene that is put down when its first change has happened goes on as one that is not.
void expect_to_go_on(const std::string& text) {
  scene::Scene straight = read_and_init(text), resumed = read_and_init(text);
  run(straight, 4);
  support::go_on_in(straight, resumed);
  EXPECT_EQ(at<scene::ForceField>(resumed, "body").reals("youngModulus"), std::vector<double>{900});
  run(straight, 4);
  run(resumed, 4);
  EXPECT_EQ(support::nodes(straight), support::nodes(resumed));
}

// The second one has not changed anything yet.
TEST(AttributeChange, ACheckpointHasTheValueThatIsThere) {
  expect_to_go_on(
      beam("<AttributeChange component='@body' attribute='youngModulus' keyTimes='0.1' values='900'/>"
           "<AttributeChange component='@body' attribute='youngModulus' keyTimes='0.9' values='7000'/>"));
}

// The number of changes of what it follows is that of its own: one.
TEST(AttributeChange, TakesThePlaceOfALink) {
  scene::Scene scene =
      read_and_init(beam("<AttributeChange component='@body' attribute='youngModulus' keyTimes='0.2' values='90000'/>"
                         "<AttributeChange component='@pull' attribute='indices' keyTimes='0.2' values='3'/>"
                         "<IndexValueMapper name='map' indices='0 1 2' value='5000'/>",
                         "youngModulus='@map.outputValues'/><BoxROI name='end' box='2.9 -1 -1 3.1 2 2'/>"
                         "<ConstantForceField name='pull' indices='@end.indices' totalForce='0 0 8'"));
  const auto modulus = [&] { return at<scene::ForceField>(scene, "body").body()->material(1).young_modulus; };
  const auto pull = [&](int node) { return support::force_of(scene, "pull", 0)(node, 2); };
  for (int round = 0; round < 2; ++round) {
    run(scene, 2);
    EXPECT_EQ(modulus(), 5000) << "round " << round;
    EXPECT_EQ(pull(3), 2) << "round " << round;
    EXPECT_EQ(pull(7), 2) << "round " << round;
    run(scene, 1);
    EXPECT_EQ(modulus(), 90000) << "round " << round;
    EXPECT_EQ(pull(3), 8) << "round " << round;
    EXPECT_EQ(pull(7), 0) << "round " << round;
    scene.reset();
    EXPECT_EQ(modulus(), 5000) << "what goes back has its effect at once";
  }
}

// A motion is that of its key times from where its nodes began, whichever attribute changes on the way, and when.
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
        EXPECT_NEAR(support::nodes(scene)(0, 0), x, 1e-12) << motion << ", step " << ++step << ", round " << round;
      }
      scene.reset();
      EXPECT_EQ(support::nodes(scene)(0, 0), places.begin()[0]) << motion;
    }
  };
  const auto change = [](const std::string& attribute, const std::string& values) {
    return "<AttributeChange component='@move' attribute='" + attribute + "' keyTimes='0.25' values='" + values + "'/>";
  };
  for (const std::string name : {"LinearMovementProjectiveConstraint", "PartialLinearMovementProjectiveConstraint"}) {
    const std::string motion = "<" + name + " name='move' indices='0' keyTimes='0 1' movements='0 0 0  1 0 0'/>";
    expect(motion, change("movements", "0 0 0  1 0 4"), {3, 3.1, 3.2, 3.3, 3.4});
    expect(motion, change("movements", "0 0 0  2 0 0"), {3, 3.1, 3.2, 3.6, 3.8});
    expect(motion, change("indices", "0 1"), {3, 3.1, 3.2, 3.3, 3.4});
  }
}

// A node that joins a motion begins where it is then, and goes on so after a checkpoint.
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
      EXPECT_NEAR(support::nodes(scene)(1, 0), x, 1e-12) << "t = " << scene.time() << ", round " << round;
    }
    EXPECT_NEAR(support::nodes(scene)(1, 1), 1.6, 1e-12) << "it was free before";
    EXPECT_NEAR(support::nodes(scene)(0, 0), 3.9 + 0.1, 1e-12) << "it goes on with its last velocity";
    scene.reset();
  }
  for (const int steps : {4, 6}) {
    scene::Scene straight = read_and_init(text);
    run(straight, steps);
    support::go_on_in(straight, resumed);
    run(straight, 3);
    run(resumed, 3);
    EXPECT_EQ(support::nodes(straight), support::nodes(resumed)) << steps;
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
           {change("attribute='youngModulus' keyTimes='2 1' values='3; 4'"), "keyTimes: 2 is followed by 1"},
           {change("attribute='youngModulus'"), "keyTimes: is empty"},
           {beam("",
                 "youngModulus='5000'/><AttributeChange component='@body' attribute='youngModulus' keyTimes='1' "
                 "values='2'"),
            "component: leads to " + body + " 'body' before it, must lead to a component behind"}})
    EXPECT_NE(errors_of(text).find("AttributeChange." + message), std::string::npos) << errors_of(text);
}

}  // namespace
