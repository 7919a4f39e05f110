// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "support/rows.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

std::string two_hexahedra(const std::string& body, const std::string& more = "") {
  return in_root(
      "gravity='0 0 0' dt='0.02'",
      "<RegularGridTopology name='grid' n='3 2 2'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
      "<HexahedronElastoplasticFEMForceField name='body' " +
          body + "/>" + more);
}

// Whatever rows the core has.
TEST(BodyField, TakesEveryMemberOfMaterialAndSettings) {
  const auto body_of = [](scene::Scene& scene) { return at<scene::ForceField>(scene, "body").body(); };
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
      EXPECT_EQ(other.at.get(body_of(scene)->material(0)), &other == &row ? value : other.at.get({})) << other.name;
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
    EXPECT_EQ(body_of(scene)->settings(), expected) << row.name;
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
    return PointArray(at<scene::MechanicalState>(scene, "nodes").velocities());
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

}  // namespace
