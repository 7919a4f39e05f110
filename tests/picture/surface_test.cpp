// SPDX-License-Identifier: LGPL-2.1-or-later
// Surfaces: those embedded in a body, what a cut fills, smoothness, light, and the rim of what faces away.
#include "picture/lamps.hpp"
#include "support/pictures.hpp"

namespace hexaplast {
namespace {

/// First and last column with a colour of the map among the rows of the body: neither paper nor ink nor grey.
std::pair<int, int> coloured_columns(const Image& image) {
  int first = image.width, last = -1;
  for (int y = 90; y < 590; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rgb at = pixel(image, x, y);
      if (std::ranges::max(at) - std::ranges::min(at) < 22) continue;
      if (x > 1140 && y < 150) continue;  // the axes
      first = std::min(first, x);
      last = std::max(last, x);
    }
  return {first, last};
}

// What faces away lies in the dark, and nearly as near as the bright face above it along the rim that the two share.
TEST(Picture, ShowsNothingAlongTheRimOfWhatFacesAway) {
  const HexMesh bar = block({1, 1, 4}, 0.1);
  const HexMesh stretched(mapped(bar.positions(), Vec3(0.8, 0.8, 1.5).asDiagonal()), bar.hexahedra());
  const Image image = rendered(drawing_of(stretched, {0, 0.1, 0.2, 0.3}, plain_staging()));
  const auto sum = [&](int x, int y) {
    const Rgb at = pixel(image, x, y);
    return at[0] + at[1] + at[2];
  };
  const auto [first, last] = coloured_columns(image);
  for (int x = first + 80; x < last - 80; ++x) {
    int y = 90;
    while (sum(x, y) > 3 * 252) ++y;
    for (int k = 0; k < 4; ++k) ASSERT_GT(sum(x, y + k), sum(x, y + 6) - 12) << "at " << x << ", " << y + k;
  }
}

/// A square of two triangles in the middle plane of a bar of 1 x 1 x 4 hexahedra, from z = 0.05 to z = 0.35, cut into
/// three pieces along the bar.
EmbeddedSurface surface_of_bar() {
  EmbeddedSurface embedded;
  embedded.points.resize(8, 3);
  for (int k = 0; k < 4; ++k) {
    embedded.points.row(2 * k) << 0.05, 0.02, 0.05 + 0.1 * k;
    embedded.points.row(2 * k + 1) << 0.05, 0.08, 0.05 + 0.1 * k;
  }
  embedded.quads = {{0, 1, 3, 2}, {4, 5, 7, 6}};
  embedded.triangles = {{2, 3, 5}, {2, 5, 4}};
  return embedded;
}

Staging with_surface_of_bar() {
  Staging staging;
  staging.embedded_surfaces = {surface_of_bar()};
  staging.shows_hexahedra = false;
  staging.viewpoint = Viewpoint{.towards = Vec3(1, 0, 0), .up = {}};
  return staging;
}

TEST(EmbeddedSurface, IsShownInPlaceOfTheHexahedraAndFollowsThem) {
  const HexMesh mesh = block({1, 1, 4}, 0.1);
  const std::vector<double> strain{0.3, 0.3, 0.3, 0.3};
  Gallery gallery(mesh, "skin", 2, with_surface_of_bar());
  gallery.add(0, 0, mesh.positions(), strain);
  gallery.add(1, 0, mapped(mesh.positions(), Vec3(1, 1, 1.5).asDiagonal()), strain);
  gallery.add(2, 0, mesh.positions(), strain, std::vector<unsigned char>{1, 0, 1, 1});
  const std::vector<Drawing> drawings = drawings_of(gallery);
  const auto width = [&](int state) {
    const auto [first, last] = coloured_columns(rendered(drawings[state]));
    return last - first;
  };
  EXPECT_NEAR(width(1), 1.5 * width(0), 3);
  // without the second hexahedron, where the first two of the three pieces have corners, only the third is left
  EXPECT_NEAR(width(2), width(0) / 3.0, 3);
  for (const Drawing& drawing : drawings) EXPECT_TRUE(drawing.view->geometry.edges.empty());
}

/// The faces of a box, by the corners of hexahedra.
std::vector<Quad> faces_of_box() {
  return {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
}

PointArray corners_of_box(const Vec3& min, const Vec3& max) {
  const HexMesh mesh = block({1, 1, 1}, 1);
  PointArray corners(kCorners, 3);
  for (int k = 0; k < kCorners; ++k)
    corners.row(k) =
        (min + mesh.positions().row(mesh.hexahedra()[0][k]).transpose().cwiseProduct(max - min)).transpose();
  return corners;
}

// Seen from above, through the plane, there are values of the body within the surface, and metal within the instrument.
TEST(Cut, FillsClosedSurfacesAndInstruments) {
  BoundaryConditions touched;
  Instrument& instrument = touched.instruments.emplace_back(
      Instrument{.place = Vec3(0.25, 0.05, 0.2), .nodes = {}, .forces = PointArray(0, 3)});
  instrument.shape_points = corners_of_box({0.2, 0, 0.05}, {0.3, 0.1, 0.35});
  for (const auto& [a, b, c, d] : faces_of_box()) {
    instrument.shape_triangles.push_back({a, b, c});
    instrument.shape_triangles.push_back({a, c, d});
  }
  const auto colour_at = [&](const Vec3& place, int num_faces) {
    Staging staging;
    EmbeddedSurface& embedded = staging.embedded_surfaces.emplace_back();
    embedded.points = corners_of_box({0.02, 0.02, 0.05}, {0.08, 0.08, 0.35});
    embedded.quads = faces_of_box();
    embedded.quads.resize(static_cast<std::size_t>(num_faces));
    staging.shows_hexahedra = false;
    staging.cut = Plane{Vec3::UnitZ(), 0.2};
    staging.viewpoint = Viewpoint{.towards = Vec3(0.3, 0.2, 1), .up = {}};
    const Drawing drawing = drawing_of(block({1, 1, 4}, 0.1), {0.3, 0.3, 0.3, 0.3}, staging, touched);
    const Eigen::Vector2f at = drawing.view->camera.on_page(place.cast<float>());
    return pixel(rendered(drawing), static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  const Vec3 in_surface(0.04, 0.06, 0.2), in_tool(0.26, 0.04, 0.2);
  EXPECT_LE(difference(colour_at(in_surface, 6), bytes(colour_of(1))), 2);
  EXPECT_LE(difference(colour_at(in_tool, 6), bytes(kMetal)), 2);
  EXPECT_GT(difference(colour_at(in_surface, 5), bytes(colour_of(1))), 20) << "an open surface has no inside";
}

/// A floor of 4 x 4 m, and a roof of 1 x 1 m that is 0.2 m above its middle, which is seen below it.
Drawing floor_and_roof(bool has_roof) {
  Drawing drawing{.width = 400, .height = 400, .view = {}, .triangles = {}, .lines = {}, .texts = {}};
  Camera camera(Viewpoint{.towards = Vec3(0, 0.3, 1), .up = Vec3::UnitY()});
  Geometry geometry;
  // in squares of 0.1 m, at whose corners the light of many lamps is found
  const auto add = [&](float half, float level) {
    constexpr float kSide = 0.1f;
    const auto at = [&](int i, int j) {
      return Eigen::Vector3f(kSide * static_cast<float>(i) - half, level, kSide * static_cast<float>(j) - half);
    };
    const int count = static_cast<int>(std::lround(2 * half / kSide));
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < count; ++j)
        for (const Eigen::Vector3f& place :
             {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)}) {
          camera.see({&place, 1});
          geometry.surface.add({{place, Eigen::Vector3f::UnitY(), 0.2f}});
        }
  };
  add(2, 0);
  if (has_roof) add(0.5f, 0.2f);
  camera.fit({0, 0, 400, 400});
  light_up(geometry, camera);
  drawing.view = std::make_shared<View>(View{geometry, camera, 400, 400, 0, 1});
  return drawing;
}

/// Of a place [m] that is seen there.
double brightness_at(const Image& image, const Drawing& drawing, const Eigen::Vector3f& place) {
  const Eigen::Vector2f at = drawing.view->camera.on_page(place);
  const Rgb colour = pixel(image, static_cast<int>(at.x()), static_cast<int>(at.y()));
  const Rgb full = bytes(colour_of(0.2));
  return (colour[0] + colour[1] + colour[2]) / static_cast<double>(full[0] + full[1] + full[2]);
}

// By many lamps and by one: bright in the open, never dark, and a plane does not shade itself.
TEST(Light, IsFullInTheOpenAndFailsUnderARoof) {
  const Drawing open = floor_and_roof(false), roofed = floor_and_roof(true);
  for (const Light light : {Light::kVertices, Light::kLamp}) {
    SCOPED_TRACE(light == Light::kLamp);
    const auto renderer = load_renderer(Backend::kAny, light);
    const Image without = renderer->render(open), with = renderer->render(roofed);
    const double full = brightness_at(without, open, {0, 0, 0});
    EXPECT_GT(full, 0.9);
    EXPECT_LE(full, 1.05);
    EXPECT_NEAR(brightness_at(without, open, {1, 0, 1}), full, 0.01);
    EXPECT_NEAR(brightness_at(without, open, {-1.5f, 0, -1.5f}), full, 0.01);
    EXPECT_NEAR(brightness_at(with, roofed, {0, 0.2f, 0}), full, 0.02) << "on the roof";
    EXPECT_NEAR(brightness_at(with, roofed, {1.8f, 0, 1.8f}), full, 0.03) << "far from it";
    const double received = brightness_at(with, roofed, {0, 0, 0}) - kDarkest;
    EXPECT_LT(received, (light == Light::kLamp ? 0.5 : 0.3) * (full - kDarkest)) << "no roof keeps the even sky off";
    EXPECT_GE(received, -0.01);
  }
}

TEST(Surface, IsSmoothExceptAtCreases) {
  // a ridge of three faces, two of which meet at 20 degrees and two at 60
  const auto place = [](double angle, double length) {
    return Eigen::Vector3f(static_cast<float>(length * std::cos(angle)), static_cast<float>(length * std::sin(angle)),
                           0);
  };
  const double degree = std::numbers::pi / 180;
  std::vector<Eigen::Vector3f> line{{0, 0, 0}};
  for (const double angle : {0.0, 20 * degree, 80 * degree}) line.push_back(line.back() + place(angle, 1));
  std::vector<Eigen::Vector3f> points = line;
  for (const Eigen::Vector3f& point : line) points.push_back(point + Eigen::Vector3f(0, 0, 1));
  const Surface surface(points, {{0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}});

  EXPECT_EQ(surface.edges().size(), 10u);
  // all faces are turned to a viewer above: the creases, which are eight at the border and the one at 60 degrees
  EXPECT_EQ(surface.outline(points, {0, 1, 0}).size(), 9u);
  const auto normals = surface.group_normals(points);
  const auto normal = [&](int face, int corner) { return normals[surface.groups()[face][corner]]; };
  EXPECT_LT((normal(0, 3) - normal(1, 0)).norm(), 1e-6f);  // at the smooth edge: 10 degrees from both faces
  EXPECT_NEAR(normal(0, 3).dot(normal(0, 0)), 1, 0.02);
  EXPECT_NEAR(normal(1, 3).dot(normal(2, 0)), std::cos(60 * degree), 0.1);
}

}  // namespace
}  // namespace hexaplast
