// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions of a body as components of SOFA.
#include <Hexaplast/MaterialRegion.h>

#include "hexaplast/material/rows.hpp"
#include "support/rows.hpp"
#include "support/sofa_adapter.hpp"

namespace hexaplast::sofa_plugin::test {
namespace {

class RegionAdapter : public Adapter {
 protected:
  MaterialRegion& make_region(const Attributes& attributes, const std::string& name = "region") {
    auto& region = dynamic_cast<MaterialRegion&>(make("MaterialRegion", attributes));
    region.setName(name);
    return region;
  }
  /// As SOFA does it: init of all in their order, then bwdInit.
  void init_all() {
    tissue.for_each([](BaseComponent& each) { each.init(); });
    tissue.for_each([](BaseComponent& each) { each.bwdInit(); });
  }
  Elastoplastic& body_before_init(const Attributes& attributes) {
    return dynamic_cast<Elastoplastic&>(make("HexahedronElastoplasticFEMForceField", attributes));
  }
  static bool is_invalid(const BaseComponent& component) { return component.isComponentStateInvalid(); }
};

TEST_F(RegionAdapter, GivesTheBodyItsValuesWhereverItStands) {
  make_region({{"indices", "3 4"}, {"youngModulus", "900 800"}, {"hardening", "2"}});
  auto& field = body_before_init(kPlastic);
  auto& by_nodes = make_region({{"yieldStress", "70"}, {"youngModulus", "500"}});
  auto& hexahedra = *by_nodes.d_hexahedra.beginEdit();
  for (const int e : {4, 9}) hexahedra.push_back(cells.getHexahedra()[e]);
  init_all();
  EXPECT_EQ(said(), "");
  std::vector<Material> expected(12, plastic_material());
  expected[3].young_modulus = 900;
  expected[3].hardening = expected[4].hardening = 2;
  for (const int e : {4, 9}) {
    expected[e].young_modulus = 500;
    expected[e].yield_stress = 70;
  }
  for (int e = 0; e < 12; ++e)
    for (const Row<Material>& row : material_rows())
      EXPECT_EQ(row.at.get(field.body()->material(e)), row.at.get(expected[e])) << row.name << " " << e;

  Body same(mesh, expected, plastic_settings());
  step(stretched);
  same.flow(stretched, kStep);
  EXPECT_EQ(history_of(*field.body()), history_of(same));
}

// Whatever rows the core has.
TEST_F(RegionAdapter, GivesEveryMemberOfAMaterial) {
  auto& field = body_before_init({});
  auto& region = make_region({{"indices", "5"}});
  init_all();
  for (const Row<Material>& row : material_rows()) {
    const double value = support::another(row, row.at.get({}));
    EXPECT_TRUE(region.parseField(std::string(row.name), fmt::format("{}", value)));
    region.reinit();
    EXPECT_EQ(row.at.get(field.body()->material(5)), value) << row.name << said();
    EXPECT_EQ(row.at.get(field.body()->material(4)), row.at.get({})) << row.name;
  }
}

TEST_F(RegionAdapter, ChangesTakeEffectAtTheNextStepAndWhatFlowedStays) {
  auto& field = body_before_init(kPlastic);
  auto& region = make_region({{"indices", "5"}, {"youngModulus", "900"}});
  init_all();
  step(stretched);
  const PointArray flowed = field.body()->plastic_rest_positions();
  EXPECT_NE(flowed, mesh.positions());
  region.d_youngModulus.setValue({1200});
  EXPECT_EQ(field.body()->material(5).young_modulus, 900);
  tell<AnimateBeginEvent>();
  EXPECT_EQ(field.body()->material(5).young_modulus, 1200);
  EXPECT_EQ(field.body()->plastic_rest_positions(), flowed);
  field.d_youngModulus.setValue({3000});
  tell<AnimateBeginEvent>();
  EXPECT_EQ(field.body()->material(5).young_modulus, 1200);
  EXPECT_EQ(field.body()->material(4).young_modulus, 3000);
  field.reset();
  EXPECT_EQ(field.body()->material(5).young_modulus, 1200);
}

TEST_F(RegionAdapter, WhatCannotBeIsSaidAndTheBodyStops) {
  auto& field = body_before_init(kPlastic);
  auto& region = make_region({{"indices", "5 12"}, {"youngModulus", "900"}}, "tip");
  init_all();
  EXPECT_TRUE(is_invalid(region));
  EXPECT_TRUE(is_invalid(field));
  EXPECT_FALSE(root.getAnimate());
  EXPECT_NE(said().find("/tissue/tip: error: MaterialRegion.indices: 12 must lie in [0, 12)"), std::string::npos)
      << said();
  EXPECT_NE(said().find("HexahedronElastoplasticFEMForceField: its MaterialRegion 'tip' is invalid"), std::string::npos)
      << said();
  region.d_indices.setValue({5});
  region.reinit();
  EXPECT_FALSE(is_invalid(region));
  EXPECT_FALSE(is_invalid(field));
  EXPECT_EQ(field.body()->material(5).young_modulus, 900);

  for (const auto& [attribute, text, reason] :
       {std::tuple("youngModulus", "1 2", "2 values given, must be one or 1 (one per hexahedron of the region)"),
        std::tuple("poissonRatio", "0.5", "0.5 must lie in [0, 0.5)"),
        std::tuple("indices", "5 5", "hexahedron 5 is given twice, must be given once")}) {
    sofa_standin::messages().clear();
    const std::string before = region.findData(attribute)->getValueString();
    region.parseField(attribute, text);
    region.reinit();
    EXPECT_NE(said().find(fmt::format("MaterialRegion.{}: {}", attribute, reason)), std::string::npos) << said();
    EXPECT_EQ(field.body()->material(5).young_modulus, 900);
    region.parseField(attribute, before.empty() ? "0.3" : before);
  }
}

TEST_F(RegionAdapter, NeedsABody) {
  auto& region = make_region({{"indices", "5"}});
  region.init();
  EXPECT_TRUE(is_invalid(region));
  EXPECT_NE(said().find("MaterialRegion: needs a HexahedronElastoplasticFEMForceField in its node or above"),
            std::string::npos)
      << said();
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
