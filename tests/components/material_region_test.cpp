// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions of a body in scenes: the values that its hexahedra get, whatever the order, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "scene/region.hpp"
#include "support/rows.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// A row of four hexahedra along x, of 1 m each.
std::string row_of_four(const std::string& body, const std::string& behind = "", const std::string& before = "") {
  return in_root("gravity='0 0 0' dt='0.02'",
                 "<RegularGridTopology name='grid' n='5 2 2' max='4 1 1'/><MechanicalObject name='nodes'/>"
                 "<DiagonalMass massDensity='1000'/>" +
                     before + "<HexahedronElastoplasticFEMForceField name='body' " + body + "/>" + behind +
                     "<FixedProjectiveConstraint indices='0 5 10 15'/>");
}

std::vector<double> moduli(scene::Scene& scene) {
  const Body* body = at<scene::ForceField>(scene, "body").body();
  std::vector<double> values;
  for (int e = 0; e < body->mesh().num_elements(); ++e) values.push_back(body->material(e).young_modulus);
  return values;
}
std::vector<double> moduli_of(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  return moduli(scene);
}
using Values = std::vector<double>;

const std::string kBox = "<BoxROI name='roi' box='0.9 -1 -1  3.1 2 2'/>";

TEST(MaterialRegion, TakesTheHexahedraOfAnROIWhereverItStands) {
  const Values expected = {5000, 300, 300, 5000};
  const std::string by_nodes = "<MaterialRegion hexahedra='@roi.hexahedraInROI' youngModulus='300'/>";
  const std::string by_numbers = "<MaterialRegion indices='@roi.hexahedronIndices' youngModulus='300'/>";
  EXPECT_EQ(moduli_of(row_of_four("", kBox + by_nodes)), expected);
  EXPECT_EQ(moduli_of(row_of_four("", by_nodes + kBox)), expected);
  EXPECT_EQ(moduli_of(row_of_four("", kBox, by_nodes)), expected);
  EXPECT_EQ(moduli_of(row_of_four("", by_numbers, kBox)), expected);
  EXPECT_EQ(moduli_of(row_of_four("", "", by_numbers + kBox)), expected);
  EXPECT_EQ(moduli_of(row_of_four("", "<Node name='below'>" + by_nodes + "</Node>", kBox)), expected)
      << "the nearest body above";
  EXPECT_EQ(moduli_of(row_of_four("",
                                  "<MaterialRegion hexahedra='2 3 8 7 12 13 18 17  16 6 1 11 17 7 12 2' "
                                  "youngModulus='300'/>")),
            expected)
      << "nodes in any order";

  std::string bar = row_of_four("", kBox);
  bar.replace(bar.find("<DefaultAnimationLoop/>"), 23, "").replace(0, 5, "<Node name='bar'");
  scene::Scene scene = read_and_init("<Node><DefaultAnimationLoop/>" + bar +
                                     "<MaterialRegion body='@bar/body' indices='2' youngModulus='9'/></Node>");
  EXPECT_EQ(at<scene::ForceField>(scene, "bar/body").body()->material(2).young_modulus, 9) << "by its link";
}

TEST(MaterialRegion, LaterOnesCountMoreThanEarlierOnes) {
  const std::string first = "<MaterialRegion indices='0 1 2' youngModulus='100 200 300' hardening='0.5'/>";
  const std::string second = "<MaterialRegion indices='2 1' youngModulus='7000 8000'/>";
  EXPECT_EQ(moduli_of(row_of_four("youngModulus='1 2 3 4'", first + second)), (Values{100, 8000, 7000, 4}));
  EXPECT_EQ(moduli_of(row_of_four("youngModulus='1 2 3 4'", second + first)), (Values{100, 200, 300, 4}));
  EXPECT_EQ(moduli_of(row_of_four("youngModulus='1 2 3 4'", second, first)), (Values{100, 8000, 7000, 4}));
  EXPECT_EQ(moduli_of(row_of_four("youngModulus='1 2 3 4'", first, second)), (Values{100, 200, 300, 4}));
  scene::Scene scene = read_and_init(row_of_four("hardening='0.1'", first + second));
  const Body& body = *at<scene::ForceField>(scene, "body").body();
  EXPECT_EQ(body.material(1).hardening, 0.5);
  EXPECT_EQ(body.material(3).hardening, 0.1);
}

// Whatever rows the core has.
TEST(MaterialRegion, GivesEveryMemberOfAMaterial) {
  for (const Row<Material>& row : material_rows()) {
    const double value = another(row, row.at.get({}));
    scene::Scene scene =
        read_and_init(row_of_four(row.name == "rotationFlowRate" ? "restShape='joined'" : "",
                                  fmt::format("<MaterialRegion indices='2' {}='{}'/>", row.name, value)));
    const Body& body = *at<scene::ForceField>(scene, "body").body();
    for (const Row<Material>& other : material_rows())
      for (const int e : {1, 2})
        EXPECT_EQ(other.at.get(body.material(e)), &other == &row && e == 2 ? value : other.at.get({})) << other.name;
  }
}

// Hexahedra that the surface passes through are half full.
TEST(MaterialRegion, IsScaledWhereHexahedraArePartlyFilled) {
  const auto scene_of = [](const std::string& body, const std::string& more) {
    return in_root("", "<SparseGridTopology name='grid' fileTopology='" HEXAPLAST_TEST_DATA
                       "/meshes/organ.obj' n='4 4 6'/><MechanicalObject name='nodes'/><DiagonalMass/>"
                       "<HexahedronElastoplasticFEMForceField name='body' youngModulus='" +
                           body + "'/>" + more);
  };
  const Values full = moduli_of(scene_of("3000", ""));
  ASSERT_NE(std::ranges::min(full), std::ranges::max(full));
  EXPECT_EQ(
      moduli_of(scene_of("1", fmt::format("<MaterialRegion indices='0-{}' youngModulus='3000'/>", full.size() - 1))),
      full);
}

TEST(MaterialRegion, MayChangeDuringARunAndWhatFlowedStays) {
  scene::Scene scene =
      read_and_init(row_of_four("youngModulus='1000' yieldStress='5' plasticFlowRate='5'", kBox,
                                "<MaterialRegion name='region' hexahedra='@roi.hexahedraInROI' youngModulus='2000'/>"));
  auto& field = at<scene::ForceField>(scene, "body");
  auto& region = at<scene::MaterialRegion>(scene, "region");
  at<scene::MechanicalState>(scene, "nodes").positions().col(0) *= 1.3;
  scene.step();
  const double strain = field.reals("plasticStrain")[1];
  EXPECT_GT(strain, 0);
  region.find_data("youngModulus")->set(Values{3000, 4000}, {});
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{1000, 3000, 4000, 1000}));
  EXPECT_GE(field.reals("plasticStrain")[1], strain);
  at<scene::Engine>(scene, "roi").find_data("box")->set(Values{-1, -1, -1, 2.1, 2, 2}, {});
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{3000, 4000, 1000, 1000})) << "the ROI may change too";
  field.find_data("youngModulus")->set(Values{800}, {});
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{3000, 4000, 800, 800})) << "regions stay over their body";
  scene.reset();
  EXPECT_EQ(moduli(scene), (Values{3000, 4000, 800, 800}));
  region.find_data("youngModulus")->unset();
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{800, 800, 800, 800}));
  region.find_data("youngModulus")->set(Values{1, 2, 3}, {});
  EXPECT_THROW(scene.step(), scene::SceneError);
}

TEST(MaterialRegion, RefusesWhatCannotBe) {
  const std::string none = "has no hexahedron, must have at least one of the body", first = "0 1 6 5 10 11 16 15",
                    region = "MaterialRegion.";
  expect_errors(
      [](const std::string& attributes) {
        return row_of_four("", "<BoxROI name='roi' box='0 0 0 0.5 1 1'/><MaterialRegion " + attributes + "/>");
      },
      {{"youngModulus='1'", region + "hexahedra: is not given, nor is indices: one of the two is needed"},
       {"hexahedra='" + first + "' indices='0'",
        region + "indices: is given besides hexahedra: must be one of the two"},
       {"indices=''", region + "indices: " + none},
       {"hexahedra='@roi.hexahedraInROI'", region + "hexahedra: " + none},
       {"indices='0 4'", region + "indices: 4 must lie in [0, 4)"},
       {"indices='0 1 0'", region + "indices: hexahedron 0 is given twice, must be given once"},
       {"hexahedra='" + first + " " + first + "'",
        region + "hexahedra: hexahedron 0 is given twice, must be given once"},
       {"hexahedra='0 1 2'", region + "hexahedra: 3 numbers given, must be groups of 8"},
       {"hexahedra='0 1 6 5 10 11 16 14'",
        region + "hexahedra: 0 1 6 5 10 11 16 14 are the nodes of no hexahedron of the body, must be of one"},
       {"indices='0 1' youngModulus='1 2 3'",
        region + "youngModulus: 3 values given, must be one or 2 (one per hexahedron of the region)"},
       {"indices='0 1' hardening='1 2'", region + "hardening: 2 values given, must be one"},
       {"indices='0 1' plasticFlowRate='51'",
        region + "plasticFlowRate: 51 times dt = 0.02 s is 1.02: must be at most 1"},
       {"indices='0' body='@grid'",
        region + "body: the link leads to RegularGridTopology 'grid', must lead to a body of hexahedra"}});
  expect_errors(four_nodes, {{"<MaterialRegion indices='0'/>",
                              "MaterialRegion: needs a body of hexahedra in its node or above, or a link to one"}});
}

TEST(MaterialRegion, AllThatIsWrongIsSaidOnce) {
  const std::string two = "<MaterialRegion indices='9'/>\n<MaterialRegion indices='0' youngModulus='1 2'/>";
  const std::string expected =
      "test.scn:1: error: MaterialRegion.indices: 9 must lie in [0, 4)\n"
      "test.scn:2: error: MaterialRegion.youngModulus: 2 values given, must be one or 1 (one per hexahedron of the "
      "region)";
  EXPECT_EQ(errors_of(row_of_four("", two)), expected);
  EXPECT_EQ(errors_of(row_of_four("", "", two)), expected);
}

TEST(MaterialRegion, WarnsWhereItGivesNothing) {
  scene::Scene scene = read_and_init(row_of_four("", "<MaterialRegion indices='1'/>"));
  EXPECT_TRUE(warnings_of(scene).ends_with(
      "test.scn:1: warning: MaterialRegion: gives its hexahedra no value: it has no effect\n"));
}

TEST(IndexValueMapper, GivesValuesToABody) {
  const std::string mapper =
      "<IndexValueMapper name='mapper' inputValues='1 2 3 4' indices='@roi.hexahedronIndices' value='70'/>";
  EXPECT_EQ(moduli_of(row_of_four("youngModulus='@mapper.outputValues'", kBox, mapper)), (Values{1, 70, 70, 4}));
  EXPECT_EQ(moduli_of(row_of_four("youngModulus='@mapper.outputValues'", mapper + kBox)), (Values{1, 70, 70, 4}));
}

}  // namespace
