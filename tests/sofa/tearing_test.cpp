// SPDX-License-Identifier: LGPL-2.1-or-later
// Hexahedra that go: SOFA takes them from the body, or the body from SOFA's topology.
#include <sofa/component/topology/container/dynamic/HexahedronSetTopologyModifier.h>

#include <algorithm>
#include <set>
#include <utility>

#include "support/sofa_adapter.hpp"

namespace hexaplast::sofa_plugin::test {
namespace {

using sofa::component::topology::container::dynamic::HexahedronSetTopologyModifier;

TEST_F(Adapter, LosesTheHexahedraThatTheHostRemoves) {
  auto& modifier = tissue.add(New<HexahedronSetTopologyModifier>::make(), "modifier");
  modifier.removeIsolated.setValue(false);
  auto& field = make_body(kPlastic);
  modifier.removeHexahedra({3});
  EXPECT_TRUE(std::ranges::equal(field.body()->removed(), std::vector<int>{3}));
  modifier.removeHexahedra({0, 3});  // the last one has taken the place of number 3
  const std::vector<unsigned char> alive{0, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 0};
  EXPECT_TRUE(std::ranges::equal(field.body()->alive(), alive));
  step(mesh.positions());
  EXPECT_EQ(value<vector<sofa::Index>>(field, "removed").size(), 3u);
  field.reset();
  EXPECT_TRUE(std::ranges::equal(field.body()->alive(), alive)) << "the topology stays torn";
  EXPECT_FALSE(field.isComponentStateInvalid()) << said();
}

TEST_F(Adapter, TearsTheTopologyOfTheHost) {
  auto& modifier = tissue.add(New<HexahedronSetTopologyModifier>::make(), "modifier");
  modifier.removeIsolated.setValue(false);
  auto& field = make_body(with(kPlastic, {{"fractureStretch", "1.001"}}));
  PointArray x = mesh.positions();
  for (int n = 0; n < x.rows(); ++n)
    if (x(n, 2) > 0.25) x(n, 2) += 0.1;  // the upper slice alone
  for (int i = 0; i < 10; ++i) step(x);
  const std::span<const int> removed = field.body()->removed();
  ASSERT_FALSE(removed.empty());
  ASSERT_LT(removed.size(), 12u);
  EXPECT_EQ(cells.getNbHexahedra(), 12u - removed.size());
  std::set<Hexahedron> left, expected;
  for (const auto& hexahedron : cells.getHexahedra()) {
    Hexahedron corners;
    for (std::size_t a = 0; a < corners.size(); ++a) corners[a] = static_cast<int>(hexahedron[a]);
    left.insert(corners);
  }
  for (int e = 0; e < mesh.num_elements(); ++e)
    if (field.body()->alive()[e]) expected.insert(mesh.hexahedra()[e]);
  EXPECT_EQ(left, expected);

  // outputs count hexahedra as the topology does
  const ElementFields fields = field.body()->fields(x);
  for (const auto& [name, values] : {std::pair{"plasticStrain", &fields.plastic_strain},
                                     {"presentYieldStress", &fields.yield_stress},
                                     {"volumeRatio", &fields.volume_ratio}}) {
    const auto output = value<vector<SReal>>(field, name);
    ASSERT_EQ(output.size(), cells.getNbHexahedra()) << name;
    for (std::size_t i = 0; i < output.size(); ++i) {
      Hexahedron corners;
      for (std::size_t a = 0; a < corners.size(); ++a) corners[a] = static_cast<int>(cells.getHexahedra()[i][a]);
      const auto& all = mesh.hexahedra();
      const double wanted = (*values)[std::find(all.begin(), all.end(), corners) - all.begin()];
      EXPECT_TRUE(output[i] == wanted || std::abs(output[i] - wanted) < 1e-13)
          << name << " " << i;  // volumes: rounding
    }
  }
}

TEST_F(Adapter, LeavesATopologyWholeThatWouldLoseNodes) {
  auto& modifier = tissue.add(New<HexahedronSetTopologyModifier>::make(), "modifier");
  auto& field = make_body(with(kPlastic, {{"fractureStretch", "1.001"}}));
  for (int i = 0; i < 10; ++i) step(stretched);
  EXPECT_FALSE(field.body()->removed().empty());
  EXPECT_EQ(cells.getNbHexahedra(), 12u);
  EXPECT_NE(said().find("removeIsolated must be false"), std::string::npos) << said();
  EXPECT_FALSE(field.isComponentStateInvalid());

  modifier.announce(cells, sofa::core::topology::TopologyChange(sofa::core::topology::POINTSREMOVED));
  EXPECT_TRUE(field.isComponentStateInvalid()) << "numbers of nodes are lost";
  field.reset();
  EXPECT_TRUE(field.isComponentStateInvalid()) << "for good";
  field.reinit();
  EXPECT_TRUE(field.isComponentStateInvalid());
  field.init();
  EXPECT_FALSE(field.isComponentStateInvalid()) << "a body of the topology as it is now";
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
