// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions of a body: which hexahedra they have, what they give, what is refused.
#include "parts/material_region.hpp"

#include <gtest/gtest.h>

#include <map>

#include "material/filling.hpp"
#include "parts/hexahedral_body.hpp"
#include "support/refused.hpp"
#include "support/rows.hpp"
#include "support/shapes.hpp"

namespace hexaplast::parts {
namespace {

using support::refused;
using Given = std::map<std::string, std::vector<double>, std::less<>>;
using Numbers = std::vector<int>;

auto from(const Given& given) {
  return [&given](const auto& row) -> std::optional<std::vector<double>> {
    const auto found = given.find(row.name);
    if (found == given.end()) return std::nullopt;
    return found->second;
  };
}

MaterialRegion region(Numbers hexahedra, const Given& given, double dt = 0.01) {
  return material_region(from(given), std::move(hexahedra), dt);
}

class RegionPart : public testing::Test {
 protected:
  const HexMesh mesh = support::distorted_block({2, 2, 3}, 0.1, 0.1, 11);
  const std::vector<Hexahedron>& all = mesh.hexahedra();

  Numbers nodes_of(const Numbers& hexahedra) const {
    Numbers nodes;
    for (const int e : hexahedra) nodes.insert(nodes.end(), all[e].begin(), all[e].end());
    return nodes;
  }
};

TEST_F(RegionPart, HasHexahedraByNodesInAnyOrderOrByNumbers) {
  const Numbers some = {7, 0, 11};
  EXPECT_EQ(region_hexahedra({}, some, all), some);
  Numbers nodes = nodes_of(some);
  EXPECT_EQ(region_hexahedra(nodes, {}, all), some);
  std::reverse(nodes.begin() + 8, nodes.begin() + 16);
  EXPECT_EQ(region_hexahedra(nodes, {}, all), some);
}

TEST_F(RegionPart, RefusesHexahedraThatCannotBe) {
  const auto by_numbers = [&](const Numbers& numbers) { return refused([&] { region_hexahedra({}, numbers, all); }); };
  const auto by_nodes = [&](const Numbers& nodes) { return refused([&] { region_hexahedra(nodes, {}, all); }); };
  EXPECT_EQ(refused([&] { region_hexahedra({}, {}, all); }),
            "hexahedra: is not given, nor is indices: one of the two is needed");
  EXPECT_EQ(refused([&] { region_hexahedra(nodes_of({1}), Numbers{1}, all); }),
            "indices: is given besides hexahedra: must be one of the two");
  EXPECT_EQ(by_numbers({}), "indices: has no hexahedron, must have at least one of the body");
  EXPECT_EQ(by_nodes({}), "hexahedra: has no hexahedron, must have at least one of the body");
  EXPECT_EQ(by_numbers({3, 12}), "indices: 12 must lie in [0, 12)");
  EXPECT_EQ(by_numbers({3, -1}), "indices: -1 must lie in [0, 12)");
  EXPECT_EQ(by_numbers({3, 5, 3}), "indices: hexahedron 3 is given twice, must be given once");
  EXPECT_EQ(by_nodes(nodes_of({4, 4})), "hexahedra: hexahedron 4 is given twice, must be given once");
  EXPECT_EQ(by_nodes({0, 1, 2}), "hexahedra: 3 numbers given, must be groups of 8");
  Numbers other = nodes_of({2, 4});
  other[9] = 1000;
  EXPECT_NE(by_nodes(other).find("are the nodes of no hexahedron of the body, must be of one"), std::string::npos)
      << by_nodes(other);
  EXPECT_NE(by_nodes(other).find(" 1000 "), std::string::npos);
}

TEST_F(RegionPart, RefusesValuesThatCannotBeAndNamesAll) {
  const auto wrong = [&](const Given& given) { return refused([&] { region({1, 2, 3}, given); }); };
  EXPECT_EQ(wrong({{"youngModulus", {1, 2}}}),
            "youngModulus: 2 values given, must be one or 3 (one per hexahedron of the region)");
  EXPECT_EQ(wrong({{"youngModulus", {}}}),
            "youngModulus: 0 values given, must be one or 3 (one per hexahedron of the region)");
  EXPECT_EQ(wrong({{"poissonRatio", {0.5}}, {"yieldStress", {1, 2, -3}}}),
            "poissonRatio: 0.5 must lie in [0, 0.5); yieldStress: -3 must be >= 0");
  EXPECT_EQ(wrong({{"plasticFlowRate", {101}}}), "plasticFlowRate: 101 times dt = 0.01 s is 1.01: must be at most 1");
}

// Whatever rows the core has.
TEST_F(RegionPart, GivesEveryMemberOfAMaterialToItsHexahedraAlone) {
  for (const Row<Material>& row : material_rows()) {
    const double before = row.at.get({}), value = support::another(row, before);
    const MaterialRegion some = region({2, 5}, {{std::string(row.name), {value}}}, 1e-6);
    std::vector<Material> materials = {Material()};
    apply(some, 12, materials);
    ASSERT_EQ(materials.size(), 12u);
    for (const Row<Material>& other : material_rows())
      for (std::size_t e = 0; e < materials.size(); ++e)
        EXPECT_EQ(other.at.get(materials[e]), &other == &row && (e == 2 || e == 5) ? value : other.at.get({}))
            << other.name << " " << e;
  }
}

TEST_F(RegionPart, LaterOnesCountMoreAndEmptySharesComeLast) {
  const Given of_body = {{"youngModulus", {5000}}, {"yieldStress", {50}}, {"hardening", {0.5}}};
  const std::vector<MaterialRegion> regions = {
      region({4, 3, 2}, {{"youngModulus", {40000, 30000, 20000}}, {"hardening", {2}}}),
      region({3, 8}, {{"youngModulus", {9000}}, {"yieldStress", {70}}})};
  std::vector<double> fill(12, 1);
  fill[3] = fill[5] = 0.5;
  const HexahedralBodyOptions options = body_options(from(of_body), 12, fill, regions);
  ASSERT_EQ(options.materials.size(), 12u);
  const auto young = [&](int e) { return options.materials[e].young_modulus; };
  EXPECT_EQ(young(4), 40000);
  EXPECT_EQ(young(2), 20000);
  EXPECT_EQ(young(8), 9000);
  EXPECT_EQ(young(0), 5000);
  EXPECT_EQ(young(5), 2500) << "half full";
  EXPECT_EQ(young(3), 4500) << "half full, of the later region";
  EXPECT_EQ(options.materials[3].yield_stress, 35);
  EXPECT_EQ(options.materials[3].hardening, 2) << "of the earlier region";
  EXPECT_EQ(options.materials[8].hardening, 0.5);
}

}  // namespace
}  // namespace hexaplast::parts
