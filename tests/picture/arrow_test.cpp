// SPDX-License-Identifier: LGPL-2.1-or-later
// Arrows of loads and instruments, and what the page says of them.
#include "support/pictures.hpp"

namespace hexaplast {
namespace {

TEST(Loads, AreNamedWithTheGreatestOfTheRun) {
  const HexMesh mesh = block({1, 1, 2}, 0.1);
  Staging staging;
  staging.gravity = Vec3(0, 0, -3.71);
  Gallery gallery(mesh, "loaded", 2, staging);
  BoundaryConditions conditions;
  for (const double force : {0.0125, 0.05}) {
    conditions.loads = PointArray::Zero(mesh.num_nodes(), 3);
    conditions.loads.row(8) << 0, force, 0;
    conditions.loads.row(9) << 3, 0, 4;  // an instrument's alone
    conditions.instruments = {{.place = Vec3(0, 0, 0.3), .nodes = {9}, .forces = PointArray(conditions.loads.row(9))}};
    gallery.add(0, 0, mesh.positions(), {0, 1}, {}, conditions);
  }
  for (const Drawing& drawing : drawings_of(gallery)) {
    const std::set<std::string> words = words_of(drawing);
    EXPECT_TRUE(words.contains("load, up to 50 mN per node"));
    EXPECT_TRUE(words.contains("instrument, force up to 5 N"));
    EXPECT_TRUE(words.contains("gravity 3.71 m/s²"));
  }
  gallery.add(0, 0, mesh.positions(), {0, 1});
  for (const std::string& words : words_of(drawings_of(gallery)[2]))
    EXPECT_FALSE(words.starts_with("load,") || words.starts_with("instrument,")) << "there is none in this state";
}

// 9261 loaded nodes, of which no more are drawn than have room beside each other.
TEST(Loads, OfManyNodesAreThinnedOut) {
  const HexMesh mesh = block({20, 20, 20}, 0.01);
  const std::vector<double> values(mesh.num_elements(), 0);
  EXPECT_TRUE(drawing_of(mesh, values).view->geometry.load_arrows.empty());
  BoundaryConditions conditions;
  conditions.loads = PointArray::Constant(mesh.num_nodes(), 3, 1);
  constexpr std::size_t kPerArrow = 3 * 80;  // vertices
  const std::size_t num_arrows = drawing_of(mesh, values, {}, conditions).view->geometry.load_arrows.size() / kPerArrow;
  EXPECT_GT(num_arrows, 100u);
  EXPECT_LT(num_arrows, 9261u / 2);
}

TEST(Loads, LeaveTheBodyNearlyAsLargeAsItIsWithoutThem) {
  const HexMesh mesh = block({2, 2, 2}, 0.1);
  const std::vector<double> values(mesh.num_elements(), 0);
  BoundaryConditions conditions;
  conditions.loads = PointArray::Zero(mesh.num_nodes(), 3);
  conditions.loads.row(mesh.num_nodes() - 1) << 0, 1, 0;
  const auto height = [](const View& view, const Geometry::Vertices& vertices) {
    Eigen::AlignedBox2f box;
    for (const Geometry::Vertex& vertex : vertices) box.extend(view.camera.on_page(vertex.place));
    return box.sizes().y();
  };
  const View loaded = *drawing_of(mesh, values, {}, conditions).view, unloaded = *drawing_of(mesh, values).view;
  EXPECT_GT(height(loaded, loaded.geometry.surface), 0.85f * height(unloaded, unloaded.geometry.surface));
  EXPECT_GT(height(loaded, loaded.geometry.load_arrows), 40) << "the arrow is seen all the same";
}

}  // namespace
}  // namespace hexaplast
