// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

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

/// Whether small motions grow in a scene that is at rest.
bool grows(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
  for (Eigen::Index i = 0; i < v.size(); ++i) v.data()[i] = 1e-9 * std::sin(1.0 + 3.0 * static_cast<double>(i));
  try {
    support::run(scene, 80);
  } catch (const std::exception&) {
    return true;
  }
  return v.cwiseAbs().maxCoeff() > 1e-8;
}

std::string warnings_of(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  std::string said;
  for (const scene::Message& warning : scene.diagnostics().take_warnings()) said += warning.text;
  return said;
}

// Damping acts by the velocities at the beginning of a step. Too much of it, as SOFA's default is for light nodes,
// makes motions grow: what warns is what grows.
TEST(SpringForceField, WarnsOfDampingThatThrowsNodesBack) {
  const auto chain = [](double stiffness, double damping) {
    return four_nodes(fmt::format("<SpringForceField spring='0 1 {0} {1} 2.2360679775  1 2 {0} {1} 3.6055512755'/>",
                                  stiffness, damping));
  };
  // 1 kg, .5 s: 2 of h / m (2 + 4 / sqrt(65)) times the damping
  EXPECT_EQ(warnings_of(chain(0, 1.55)), "");
  EXPECT_EQ(
      warnings_of(chain(0, 1.65)),
      "SpringForceField.spring: springs damp node 1 of 'nodes' with 3.3 N s/m: they throw it back harder in every "
      "step, as damping acts by the velocities at the beginning of a step");
  for (const double stiffness : {0.0, 10.0})
    for (const double damping : {1.0, 1.55, 1.65, 10.0, 14.0})
      EXPECT_EQ(grows(chain(stiffness, damping)), !warnings_of(chain(stiffness, damping)).empty())
          << stiffness << " " << damping;
  EXPECT_NE(warnings_of(four_nodes("<SpringForceField stiffness='0' indices1='0' indices2='1'/>"))
                .find("SpringForceField.damping: springs damp node "),
            std::string::npos);

  // of a body, whose stiffness holds a node back too, but not all nodes of a layer together; nodes of 1/8 to 1 g
  const auto body = [](const std::string& springs) {
    return support::in_root("gravity='0 0 0' dt='.01'",
                            "<RegularGridTopology n='9 5 3' min='-.04 -.02 0' max='.04 .02 .02'/>"
                            "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
                            "<HexahedronElastoplasticFEMForceField youngModulus='3000'/>"
                            "<FixedProjectiveConstraint indices='0-44'/><SpringForceField " +
                                springs + "/>");
  };
  const std::string one = "indices1='120' indices2='95' stiffness='5' lengths='.0360555128' damping='",
                    layer = "indices1='90-134' indices2='0-44' stiffness='0' lengths='.02' damping='";
  bool has_grown = false, has_not = false;
  for (const std::string& springs : {one, layer})
    for (const char* damping : {".02", ".05", ".1", ".15", ".2", ".3", "5"}) {
      const std::string text = body(springs + damping + "'");
      const bool is_too_much = grows(text);
      EXPECT_EQ(!warnings_of(text).empty(), is_too_much) << springs << damping;
      (is_too_much ? has_grown : has_not) = true;
    }
  EXPECT_TRUE(has_grown && has_not);
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
