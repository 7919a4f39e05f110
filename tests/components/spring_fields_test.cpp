// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hexaplast/base/error.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::force_of;
using support::four_nodes;
using support::read_and_init;

// Nodes 0 (1, 0, 0) and 1 (0, 2, 0): sqrt(5) m apart, 2 m at rest, 10 N/m.
TEST(SpringForceField, TakesWholeSpringsOrLists) {
  const double tension = 10 * (std::sqrt(5) - 2);
  const Eigen::RowVector3d force = tension / std::sqrt(5) * Eigen::RowVector3d(-1, 2, 0);
  for (const char* springs :
       {"spring='0 1 10 0 2'", "indices1='0' indices2='1' stiffness='10' damping='0' lengths='2'"}) {
    scene::Scene scene = read_and_init(four_nodes(std::string("<SpringForceField name='s' ") + springs + "/>"));
    const PointArray f = force_of(scene, "s", 0);
    EXPECT_LT((f.row(0) - force).norm(), 1e-14) << springs;
    EXPECT_LT((f.row(1) + force).norm(), 1e-14) << springs;
    EXPECT_EQ(f.row(2).norm() + f.row(3).norm(), 0);
  }
}

/// Steps a scene until it fails, and what it has warned of by then.
std::string warnings_of(scene::Scene& scene, int steps) {
  try {
    support::run(scene, steps);
  } catch (const NumericalError&) {  // a step that cannot be solved
  }
  std::string said;
  for (const scene::Message& warning : scene.diagnostics().take_warnings()) said += warning.text;
  return said;
}

/// Nodes of 1/8 to 1 g, of which those with x <= 0 are held.
std::string body(const std::string& springs, const std::string& root = "gravity='0 0 0' dt='.01'",
                 const std::string& modulus = "3000") {
  return support::in_root(root,
                          "<RegularGridTopology n='9 5 3' min='-.04 -.02 0' max='.04 .02 .02'/>"
                          "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
                          "<HexahedronElastoplasticFEMForceField name='body' youngModulus='" +
                              modulus + "'/><FixedProjectiveConstraint indices='0-44'/>" + springs);
}
std::string spring(const std::string& damping) {
  return "<SpringForceField indices1='120' indices2='95' stiffness='5' lengths='.0360555128' damping='" + damping +
         "'/>";
}

// Damping acts by the velocities at the beginning of a step. Too much of it, as SOFA's default is for light nodes,
// makes motions grow: where they do, and nowhere else, there is a warning.
TEST(SpringForceField, WarnsWhereDampingMakesMotionsGrow) {
  const auto grows = [](const std::string& text) {
    scene::Scene scene = read_and_init(text);
    PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
    for (Eigen::Index i = 0; i < v.size(); ++i) v.data()[i] = 1e-9 * std::sin(1.0 + 3.0 * static_cast<double>(i));
    const std::string said = warnings_of(scene, 80);
    const bool is_too_much = !(v.cwiseAbs().maxCoeff() < 1e-8);
    EXPECT_EQ(said.find("SpringForceField.damping: throws nodes back harder in every step (t = ") == 0, is_too_much)
        << text << said;
    EXPECT_EQ(said.empty(), !is_too_much) << text << said;
    return is_too_much;
  };
  // 1 kg, .5 s: from 2 of h / m (2 + 4 / sqrt(65)) times the damping on
  const auto chain = [](double stiffness, double damping) {
    return four_nodes(fmt::format("<SpringForceField spring='0 1 {0} {1} 2.2360679775  1 2 {0} {1} 3.6055512755'/>",
                                  stiffness, damping));
  };
  EXPECT_FALSE(grows(chain(0, 1.55)));
  EXPECT_TRUE(grows(chain(0, 1.65)));
  for (const double stiffness : {0.0, 10.0})
    for (const double damping : {1.0, 1.55, 1.65, 10.0, 14.0}) grows(chain(stiffness, damping));

  // of a body, whose stiffness holds a node back too, but not all nodes of a layer together
  bool has_grown = false, has_not = false;
  for (const char* damping : {".02", ".05", ".1", ".15", ".2", ".3", "5"})
    for (const std::string& springs :
         {spring(damping), "<SpringForceField indices1='90-134' indices2='0-44' stiffness='0' lengths='.02' damping='" +
                               std::string(damping) + "'/>"})
      (grows(body(springs)) ? has_grown : has_not) = true;
  EXPECT_TRUE(has_grown && has_not);
}

// Whatever it is that damps, and between what.
TEST(SpringForceField, WarnsOfDampingInEverySetting) {
  const std::string weight = "gravity='0 0 -9.81' dt='.01'";
  const auto shares = [](int count, const std::string& damping, const std::string& states = "") {
    std::string springs;
    for (int k = 0; k < count; ++k)
      springs += "<SpringForceField " + states + " indices1='120' indices2='" + (states.empty() ? "95" : "0") +
                 "' stiffness='5' lengths='.01' damping='" + damping + "'/>";
    return springs;
  };
  const std::string points =
      "<Node name='points'><MechanicalObject name='points' position='.01 .01 .02  .02 .01 .02'/><BarycentricMapping/>"
      "<SpringForceField indices1='0' indices2='1' stiffness='5' lengths='.01' damping='";
  const auto other = [&](const std::string& damping) {
    return "<Node name='other'><RegularGridTopology n='2 2 2' min='.05 0 0' max='.06 .01 .01'/><MechanicalObject "
           "name='nodes'/><DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField "
           "youngModulus='3000'/></Node>" +
           shares(6, damping, "object1='@nodes' object2='@other/nodes'");
  };
  const auto with = [](std::string scene, const std::string& old, const std::string& changed) {
    EXPECT_NE(scene.find(old), std::string::npos) << old;
    return scene.replace(scene.find(old), old.size(), changed);
  };
  const auto without_inertia = [&](const std::string& damping) {
    return with(body(shares(1, damping), weight, "30"), "<EulerImplicitSolver ",
                "<EulerImplicitSolver firstOrder='1' ");
  };
  const auto softened = [&](const std::string& damping) {
    return with(body(shares(1, damping), weight, "3e6"), "<RegularGridTopology",
                "<AttributeChange component='@body' attribute='youngModulus' keyTimes='.095' values='300'/>"
                "<RegularGridTopology");
  };
  const std::pair<std::string, bool> scenes[] = {
      {body(shares(5, ".002"), weight), false},
      {body(shares(5, ".1"), weight), true},
      {body(points + ".01'/></Node>", weight), false},
      {body(points + "5'/></Node>", weight), true},
      {body(other(".0005"), weight), false},
      {body(other(".008"), weight), true},
      {without_inertia("1e-4"), false},
      {without_inertia("4"), true},
      {softened(".02"), false},
      {softened(".3"), true},
      {body("<PlaneForceField normal='0 0 1' d='.0105' stiffness='1' damping='100'/>", weight), false},
      {body("<PlaneForceField normal='0 0 1' d='.0105' stiffness='1' damping='1000'/>", weight), true},
      {with(body(shares(1, "5"), weight), "<EulerImplicitSolver name='euler'/>",
            "<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='20'/>"),
       false}};
  for (const auto& [text, warns] : scenes) {
    scene::Scene scene = read_and_init(text);
    scene.diagnostics().take_warnings();
    const std::string said = warnings_of(scene, 30);
    EXPECT_EQ(said.find("throws nodes back harder") != said.npos, warns) << text << "\n" << said;
  }
}

TEST(SpringForceField, MistakesAreNamed) {
  EXPECT_NE(errors_of(four_nodes("<SpringForceField spring='0 1 10 0'/>")).find("4 numbers given, must be groups of 5"),
            std::string::npos);
  EXPECT_NE(errors_of(four_nodes("<SpringForceField spring='0 1.5 10 0 1'/>"))
                .find("1.5 is not a node, must be a whole number from 0 to 3"),
            std::string::npos);
  EXPECT_EQ(errors_of(four_nodes("<SpringForceField spring='0 4 10 0 1'/>")),
            "test.scn:1: error: SpringForceField.spring: 4 is not a node, must be a whole number from 0 to 3");
  EXPECT_NE(errors_of(four_nodes("<SpringForceField indices1='0 1' indices2='1'/>"))
                .find("indices2: 1 nodes given for 2 of indices1, must be as many"),
            std::string::npos);
}

TEST(RestShapeSpringsForceField, PullsBackToTheRestPositions) {
  scene::Scene scene =
      read_and_init(four_nodes("<RestShapeSpringsForceField name='s' points='1 3' stiffness='10 20'/>"));
  at<scene::MechanicalState>(scene, "nodes").positions().array() += .5;
  const PointArray f = force_of(scene, "s", 0);
  EXPECT_EQ(f, support::rows({{0, 0, 0}, {-5, -5, -5}, {0, 0, 0}, {-10, -10, -10}}));
  EXPECT_NE(errors_of(four_nodes("<RestShapeSpringsForceField points='1 3' stiffness='1 2 3'/>"))
                .find("3 values given for 2 nodes, must be one or as many"),
            std::string::npos);
}

}  // namespace
