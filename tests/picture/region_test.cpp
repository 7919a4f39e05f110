// SPDX-License-Identifier: LGPL-2.1-or-later
// Named regions of a body: flat colours, walls where they are cut, seen through the others.
#include "picture/bodies.hpp"
#include "support/pictures.hpp"

namespace hexaplast {
namespace {

/// A block of 3 x 3 x 3 cells at rest, of which that in the middle is a region, and those of one side.
Drawing divided(Staging staging) {
  staging.shows_edges = false;
  staging.regions = {std::vector<int>(27, 0), {"core", "organ/side"}};
  for (int e = 2; e < 27; e += 3) staging.regions.of_hexahedra[e] = 2;
  std::vector<double> strain(27, 0.0);
  strain[13] = staging.regions.of_hexahedra[13] = 1;
  return drawing_of(block({3, 3, 3}, 0.1), strain, staging);
}

// A piece of a block that is cut askew lies where the whole block does.
TEST(Regions, HaveTheWallsOfTheirBody) {
  Body body(block({3, 3, 3}, 0.1), {Material{}});
  const PointArray& X = body.initial_mesh().positions();
  std::vector<int> joints;
  std::vector<double> crossings;
  for (int joint = 0; joint < body.joints().num_faces(); ++joint) {
    const std::span<const int> at = body.joints().nodes(joint);
    const PointArray nodes = X(std::vector<int>(at.begin(), at.end()), Eigen::all);
    if ((nodes.col(2).array() - 0.2).abs().maxCoeff() > 1e-9) continue;
    joints.push_back(joint);
    crossings.push_back(0.1 + 2 * nodes.col(0).mean());
  }
  body.open(joints, crossings);
  Staging staging;
  for (const Hexahedron& corners : body.mesh().hexahedra())
    staging.regions.of_hexahedra.push_back(gather(body.mesh().positions(), corners).col(2).mean() > 0.2 ? 1 : 2);
  staging.regions.names = {"upper", "lower"};
  staging.shown_regions = {1, 2};
  Shapes shapes(body.mesh(), staging);
  const std::vector<double> values(static_cast<std::size_t>(body.mesh().num_nodes()), 0.0);
  const Moment moment = shapes.at(body.mesh().positions(), values, {}, {}, nullptr, Bodies(body).open_faces());
  std::size_t num_walls = 0;
  for (const Moment::Shown& part : moment.parts) {
    for (std::size_t f = 0; f < part.surface->faces().size(); ++f) num_walls += part.surface->is_wall(f) ? 1 : 0;
    for (const Eigen::Vector3f& point : part.points)
      EXPECT_TRUE(std::ranges::find(moment.body.points, point) != moment.body.points.end()) << point.transpose();
  }
  EXPECT_EQ(num_walls, 18u);
}

// Each hexahedron is in one region: no value lies between two numbers, on the surface and where it is cut.
TEST(Regions, AreFlatAndNamed) {
  Staging staging;
  staging.quantity = Quantity::kRegion;
  staging.cut = Plane{Vec3::UnitZ(), 0.12};
  const Drawing drawing = divided(staging);
  const Geometry& geometry = drawing.view->geometry;
  for (const Geometry::Vertices& vertices : {geometry.surface, geometry.cut_faces}) {
    std::set<float> values;
    for (const Geometry::Vertex& vertex : vertices) values.insert(vertex.value);
    EXPECT_EQ(values, (std::set<float>{0, 1, 2}));
  }
  // of the cut, the middle cell has a ninth
  double core = 0, all = 0;
  const Geometry::Vertices& cut = geometry.cut_faces;
  for (std::size_t v = 0; v + 2 < cut.size(); v += 3) {
    const double area = (cut[v + 1].place - cut[v].place).cross(cut[v + 2].place - cut[v].place).norm() / 2;
    all += area;
    if (cut[v].value == 1) core += area;
  }
  EXPECT_NEAR(all, 0.09, 1e-6);
  EXPECT_NEAR(core, 0.01, 1e-6);
  for (const char* name : {"core", "organ/side", "in no region"}) EXPECT_TRUE(words_of(drawing).contains(name));

  // cut faces have no light: their pixels are the colours themselves
  const Image image = rendered(drawing);
  for (const int number : {0, 1, 2}) {
    int num_seen = 0;
    for (int y = 90; y < 590; ++y)
      for (int x = 0; x < image.width; ++x)
        num_seen += difference(pixel(image, x, y), bytes(colour_of_region(number))) <= 1;
    EXPECT_GT(num_seen, 1000) << number;
  }
}

TEST(Regions, AreSeenThroughTheBody) {
  Staging staging;
  staging.quantity = Quantity::kRegion;
  const auto middle = [&] { return pixel(rendered(divided(staging)), 640, 340); };
  const Rgb whole = middle();
  staging.shown_regions = {1};
  const Drawing within = divided(staging);
  Eigen::AlignedBox3f box, veil;
  for (const Geometry::Vertex& vertex : within.view->geometry.surface) box.extend(vertex.place);
  for (const Geometry::Vertex& vertex : within.view->geometry.veil) veil.extend(vertex.place);
  EXPECT_LT((box.sizes() - Eigen::Vector3f::Constant(0.1f)).norm(), 1e-6);
  EXPECT_LT((veil.sizes() - Eigen::Vector3f::Constant(0.3f)).norm(), 1e-6);
  EXPECT_TRUE(within.view->geometry.ghost.empty());
  EXPECT_TRUE(words_of(within).contains("core"));
  EXPECT_FALSE(words_of(within).contains("organ/side"));
  // the core is red: through the veil still more so than the body
  const Rgb seen = middle();
  EXPECT_GT(seen[0] - seen[2], whole[0] - whole[2] + 20);

  staging.quantity = Quantity::kPlasticStrain;
  float max = 0;
  const Drawing strained = divided(staging);
  for (const Geometry::Vertex& vertex : strained.view->geometry.surface) max = std::max(max, vertex.value);
  EXPECT_FLOAT_EQ(max, 0.125f) << "mean over the eight cells around a corner";
}

}  // namespace
}  // namespace hexaplast
