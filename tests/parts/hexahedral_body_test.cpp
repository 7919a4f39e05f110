// SPDX-License-Identifier: LGPL-2.1-or-later
// The part around a body: options by the rows of Material and Settings, refusals, warnings, and what its steps did.
#include "parts/hexahedral_body.hpp"

#include <gtest/gtest.h>

#include <map>

#include "support/refused.hpp"
#include "support/shapes.hpp"

namespace hexaplast::parts {
namespace {

using support::refused;
using Given = std::map<std::string, std::vector<double>, std::less<>>;

HexahedralBodyOptions options(const Given& given, std::size_t num_hexahedra = 12, std::span<const double> fill = {}) {
  return body_options(
      [&](const auto& row) -> std::optional<std::vector<double>> {
        const auto found = given.find(row.name);
        if (found == given.end()) return std::nullopt;
        return found->second;
      },
      num_hexahedra, fill);
}

std::string refused_options(const Given& given) {
  return refused([&] { options(given); });
}

class BodyPart : public testing::Test {
 protected:
  static constexpr double kStep = 0.02;  // [s]
  HexahedralBody made(const Given& given) const {
    return HexahedralBody(mesh.positions(), mesh.hexahedra(), options(given), kStep);
  }

  const HexMesh mesh = support::distorted_block({2, 2, 3}, 0.1, 0.1, 11);
  const PointArray stretched = mesh.positions() * Eigen::Vector3d(0.9, 0.95, 1.3).asDiagonal();
  const Given plastic{{"youngModulus", {7000}}, {"yieldStress", {100}},
                      {"plasticFlowRate", {2}}, {"restShape", {0}},  // joined
                      {"averaging", {1}},                            // jacobi, which
                      {"implementation", {1}}};                      // plain alone has
};

TEST(BodyOptions, AreReadRowByRow) {
  const HexahedralBodyOptions none = options({});
  ASSERT_EQ(none.materials.size(), 1u);
  for (const Row<Material>& row : material_rows())
    EXPECT_EQ(row.at.get(none.materials[0]), row.at.get(Material())) << row.name;
  EXPECT_EQ(none.settings, Settings());

  std::vector<double> young(12, 5000);
  young[3] = 9000;
  const HexahedralBodyOptions some = options({{"youngModulus", young}, {"hardening", {0.5}}, {"averagingSteps", {3}}});
  ASSERT_EQ(some.materials.size(), 12u);
  EXPECT_EQ(some.materials[3].young_modulus, 9000);
  EXPECT_EQ(some.materials[3].hardening, 0.5);
  EXPECT_EQ(some.settings.averaging_steps, 3);

  std::vector<double> fill(12, 1);
  fill[5] = 0.5;
  const HexahedralBodyOptions half =
      options({{"youngModulus", {6000}}, {"yieldStress", {100}}, {"fractureStress", {120}}}, 12, fill);
  ASSERT_EQ(half.materials.size(), 12u);
  EXPECT_EQ(half.materials[4].young_modulus, 6000);
  EXPECT_EQ(half.materials[5].young_modulus, 3000);
  EXPECT_EQ(half.materials[5].yield_stress, 50);
  EXPECT_EQ(half.materials[5].fracture_stress, 60);
}

TEST(BodyOptions, ThatAreWrongAreNamed) {
  EXPECT_EQ(refused_options({{"youngModulus", {1, 2}}}),
            "youngModulus: 2 values given, must be one or 12 (one per hexahedron)");
  EXPECT_EQ(refused_options({{"youngModulus", {}}}),
            "youngModulus: 0 values given, must be one or 12 (one per hexahedron)");
  EXPECT_EQ(refused_options({{"poissonRatio", {0.5}}}), "poissonRatio: 0.5 must lie in [0, 0.5)");
  EXPECT_EQ(refused_options({{"fractureStretch", {1}}}), "fractureStretch: 1 must be > 1");
  EXPECT_EQ(refused_options({{"averagingSteps", {0}}}), "averagingSteps: 0 must lie in [1, 1000]");
  EXPECT_EQ(refused_options({{"averagingSteps", {0}}, {"youngModulus", {1, -2}}, {"plasticFlowRate", {-1}}}),
            "averagingSteps: 0 must lie in [1, 1000]; youngModulus: -2 must be > 0; plasticFlowRate: -1 must be >= 0");
  EXPECT_THROW(options({{"youngModulus", {}}}, 0), OptionError) << "of no hexahedra there is no value either";
}

TEST_F(BodyPart, FlowsAsTheBodyDoes) {
  HexahedralBody part = made(plastic);
  EXPECT_TRUE(part.take_warnings().empty());
  const HexahedralBodyOptions same = options(plastic);
  Body body(mesh, same.materials, same.settings);
  part.end_step(stretched, kStep);
  const FlowReport report = body.flow(stretched, kStep);
  EXPECT_EQ(part.body().plastic_rest_positions(), body.plastic_rest_positions());
  EXPECT_NE(part.body().plastic_rest_positions(), mesh.positions());
  EXPECT_EQ(part.report().yielded, report.yielded);
  EXPECT_GT(report.yielded, 0);
  part.reset();
  EXPECT_EQ(part.body().plastic_rest_positions(), mesh.positions());
  EXPECT_EQ(part.report().yielded, 0);
}

TEST_F(BodyPart, TakesAnotherMaterialAndNoOtherSettings) {
  HexahedralBody part = made(plastic);
  part.end_step(stretched, kStep);
  const PointArray flowed = part.body().plastic_rest_positions();
  Given other = plastic;
  other["youngModulus"] = {9000};
  part.set_options(options(other), kStep);
  EXPECT_EQ(part.body().materials()[0].young_modulus, 9000);
  EXPECT_EQ(part.body().plastic_rest_positions(), flowed);
  other["averaging"] = {0};
  other["volumeRestitution"] = {2};
  EXPECT_EQ(refused([&] { part.set_options(options(other), kStep); }),
            "averaging: cannot change during a run, only members of the material can; "
            "volumeRestitution: cannot change during a run, only members of the material can");
  EXPECT_EQ(part.body().materials()[0].young_modulus, 9000);
}

TEST_F(BodyPart, WarnsOfRatesAndRefusesStepsThatAreTooLong) {
  Given fast = plastic;
  fast["plasticFlowRate"] = {4};  // 0.08 per step, wisely at most 0.05
  HexahedralBody part = made(fast);
  const std::vector<Remark> warnings = part.take_warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].text.find("plasticFlowRate"), std::string::npos) << warnings[0].text;
  EXPECT_TRUE(part.take_warnings().empty()) << "once";
  const auto num_warnings = [&](const Given& given) { return made(given).take_warnings().size(); };
  EXPECT_EQ(
      num_warnings({{"restShape", {0}}, {"yieldStress", {9}}, {"plasticFlowRate", {5}}, {"volumeRestitution", {20}}}),
      2u);
  EXPECT_EQ(num_warnings({{"restShape", {0}}, {"plasticFlowRate", {500}}, {"volumeRestitution", {700}}}), 0u)
      << "nothing flows";
  EXPECT_THROW(part.end_step(stretched, 1), InputError);
  EXPECT_EQ(part.body().plastic_rest_positions(), mesh.positions());
}

TEST_F(BodyPart, TellsOnceWhichHexahedraHaveGone) {
  HexahedralBody part = made(plastic);
  EXPECT_TRUE(part.take_removed().empty());
  part.body().remove(std::vector{3, 5});
  EXPECT_TRUE(std::ranges::equal(part.take_removed(), std::vector{3, 5}));
  EXPECT_TRUE(part.take_removed().empty());
  part.body().remove(std::vector{3, 7});
  EXPECT_TRUE(std::ranges::equal(part.take_removed(), std::vector{7}));
}

}  // namespace
}  // namespace hexaplast::parts
