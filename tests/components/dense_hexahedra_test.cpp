// SPDX-License-Identifier: LGPL-2.1-or-later
// SOFA's elastic hexahedra in scenes. Their numbers: elastic/dense_hexahedra_test.cpp, sofa_trajectories_test.cpp.
#include "elastic/dense_hexahedra.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::in_root;
using support::read_and_init;

const std::string kFolder = HEXAPLAST_TEST_DATA "/meshes/";

/// Two by two by three boxes, sheared, and what else there is in the scene.
std::string sheared(const std::string& field, const std::string& more = "") {
  return in_root("gravity='0 -10 0' dt='0.01'",
                 "<RegularGridTopology name='grid' n='3 3 4' max='2 2.4 3.3'/><MechanicalObject name='nodes'/>"
                 "<UniformMass totalMass='9'/><FixedProjectiveConstraint indices='0-8'/>" +
                     field + more);
}

std::string elastic(const std::string& attributes = "", const std::string& class_name = "HexahedronFEMForceField") {
  return "<" + class_name + " name='body' youngModulus='300' poissonRatio='0.3' " + attributes + "/>";
}

PointArray force_when_sheared(scene::Scene& scene) {
  PointArray& x = at<scene::MechanicalState>(scene, "nodes").positions();
  x.col(0) += 0.3 * x.col(2);
  return support::force_of(scene, "body", 0);
}

TEST(HexahedronFEM, HasOneFrameAndOneMatrixEach) {
  for (const auto& [method, frame] : {std::pair{"small", ElementFrame::kWorld},
                                      {"large", ElementFrame::kMeanEdges},
                                      {"polar", ElementFrame::kPolar}}) {
    const std::string attributes = std::string("method='") + method + "'";
    for (const char* class_name : {"HexahedronFEMForceField", "ParallelHexahedronFEMForceField"}) {
      scene::Scene scene = read_and_init(sheared(elastic(attributes, class_name)));
      const PointArray found = force_when_sheared(scene);
      const auto& state = at<scene::MechanicalState>(scene, "nodes");
      const Lame constants = lame(300, 0.3);
      DenseHexahedra expected(state.rest_positions(), at<scene::Topology>(scene, "grid").hexahedra(), {&constants, 1},
                              {.frame = frame});
      PointArray f = PointArray::Zero(found.rows(), 3);
      expected.add_force(at<scene::MechanicalState>(scene, "nodes").positions(), f);
      EXPECT_EQ(found, f) << method << class_name;
    }
  }
}

TEST(HexahedronFEM, TakesRegionsAndChangesOfTheMaterial) {
  scene::Scene plain = read_and_init(sheared(elastic())),
               regional =
                   read_and_init(sheared(elastic(), "<MaterialRegion name='soft' indices='0-11' youngModulus='150'/>"));
  const PointArray f = force_when_sheared(plain);
  EXPECT_LT(support::max_abs(2 * force_when_sheared(regional) - f), 1e-11);
  scene::Data& modulus = *at<scene::ForceField>(plain, "body").find_data("youngModulus");
  modulus.read("600", {});
  at<scene::ForceField>(plain, "body").refresh();
  EXPECT_LT(support::max_abs(support::force_of(plain, "body", 0) - 2 * f), 1e-11);
}

// Cells through which the surface passes are half full; those of SOFA's count half.
TEST(HexahedronFEM, HasHalfTheStiffnessWhereAGridIsHalfFull) {
  const auto force = [](const std::string& weighted) {
    scene::Scene scene = read_and_init(
        in_root("", "<SparseGridTopology fileTopology='" + kFolder + "organ.obj' n='6 6 6' fillWeighted='" + weighted +
                        "'/><MechanicalObject name='nodes'/><UniformMass totalMass='1'/>" + elastic()));
    return force_when_sheared(scene);
  };
  const PointArray weighted = force("1"), full = force("0");
  EXPECT_LT(weighted.norm(), 0.99 * full.norm());
  EXPECT_GT(weighted.norm(), 0.49 * full.norm());
}

// Pictures and reports look at a body that makes no force.
TEST(HexahedronFEM, HasABodyOfTheSameMaterialForMeasures) {
  scene::Scene scene = read_and_init(sheared(elastic("rayleighStiffness='0.1'")));
  const auto& field = at<scene::ForceField>(scene, "body");
  ASSERT_TRUE(field.body());
  EXPECT_EQ(field.body()->material(3).young_modulus, 300);
  EXPECT_EQ(field.body()->mesh().num_elements(), 12);
  EXPECT_EQ(field.rayleigh_stiffness(), 0.1);
  auto& euler = at<scene::OdeSolver>(scene, "euler");
  euler.keep_energy_balance();
  support::run(scene, 2);
  EXPECT_FALSE(euler.energy_balance()) << "these forces have no potential";
  EXPECT_EQ(field.flow_report()->inverted, 0);
}

TEST(HexahedronFEM, LosesHexahedraAndGetsThemBack) {
  scene::Scene scene = read_and_init(sheared(elastic("method='polar'")));
  auto& field = at<scene::ForceField>(scene, "body");
  const PointArray whole = force_when_sheared(scene);
  field.remove_elements(std::vector<int>{10, 11});
  const PointArray less = support::force_of(scene, "body", 0);
  EXPECT_GT(support::max_abs(less - whole), 1);
  EXPECT_EQ(field.body()->removed().size(), 2u);
  scene.reset();
  EXPECT_EQ(force_when_sheared(scene), whole);
}

TEST(HexahedronFEM, GoesOnFromACheckpoint) {
  const std::string text = sheared(elastic("method='polar'"));
  scene::Scene first = read_and_init(text), second = read_and_init(text);
  support::run(first, 2);
  at<scene::ForceField>(first, "body").remove_elements(std::vector<int>{10});
  std::vector<std::byte> bytes;
  Archive out([&](const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  });
  first.serialize(out);
  Archive in{std::span<const std::byte>(bytes)};
  second.serialize(in);
  support::run(first, 3);
  support::run(second, 3);
  EXPECT_EQ(support::nodes(first), support::nodes(second));
}

// A balance that was kept for forces with a potential is not theirs.
TEST(HexahedronFEM, RefusesTheEnergyBalanceOfOtherForces) {
  scene::Scene ours = read_and_init(sheared(elastic("", "HexahedronElastoplasticFEMForceField"))),
               theirs = read_and_init(sheared(elastic()));
  auto& solver = at<scene::OdeSolver>(ours, "euler");
  solver.keep_energy_balance();
  support::run(ours, 1);
  std::vector<std::byte> bytes;
  Archive out([&](const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  });
  solver.serialize(out);
  Archive in{std::span<const std::byte>(bytes)};
  EXPECT_THROW(at<scene::OdeSolver>(theirs, "euler").serialize(in), InputError);
}

TEST(HexahedronFEM, RefusesOtherMethods) {
  const std::string text = sheared(elastic("method='qr'"));
  EXPECT_NE(errors_of(text).find("HexahedronFEMForceField.method: 'qr' must be large, polar or small"),
            std::string::npos)
      << errors_of(text);
  EXPECT_NE(errors_of(sheared(elastic("method='small'", "HexahedralFEMForceField"))), "");
  EXPECT_NE(errors_of(sheared(elastic("updateStiffnessMatrix='true'"))), "");
  EXPECT_NE(errors_of(sheared("<HexahedronFEMForceField youngModulus='-1'/>")), "");
}

}  // namespace
