// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures: the right size, the right colours at the right places, the same pixels every time.
#include <numbers>
#include <set>

#include "picture/axis.hpp"
#include "picture/bodies.hpp"
#include "picture/gallery.hpp"
#include "picture/ink.hpp"
#include "picture/png_file.hpp"
#include "support/output.hpp"
#include "support/png.hpp"

/// OSMesa keeps a few bytes of every drawing context to the end; the leak checker of sanitized builds is told.
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so"; }

namespace hexaplast {
namespace {

namespace fs = std::filesystem;
using output::Colour;
using output::Drawing;
using output::Gallery;
using output::Image;
using support::Scratch;

using Rgb = std::array<int, 3>;

Rgb pixel(const Image& image, int x, int y) {
  const std::uint8_t* at = &image.pixels[(static_cast<std::size_t>(y) * image.width + x) * 3];
  return {at[0], at[1], at[2]};
}

Rgb bytes(const Colour& colour) {
  return {static_cast<int>(std::lround(255 * colour.red)), static_cast<int>(std::lround(255 * colour.green)),
          static_cast<int>(std::lround(255 * colour.blue))};
}

int difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

std::vector<Drawing> drawings_of(const Gallery& gallery) {
  std::vector<Drawing> drawings;
  gallery.for_each_drawing([&](int, const Drawing& drawing) { drawings.push_back(drawing); });
  return drawings;
}

std::vector<Image> pictures_of(const Gallery& gallery) {
  const auto renderer = output::load_renderer();
  std::vector<Image> images;
  for (const Drawing& drawing : drawings_of(gallery)) images.push_back(renderer->render(drawing));
  return images;
}

/// A bar of 1 x 1 x 4 hexahedra, at rest and stretched by a half, plastic strain 0, 1, 2, 3 tenths.
Gallery bar_at_rest_and_stretched(const output::Staging& staging = {}) {
  static const Body body(support::block({1, 1, 4}, 0.1), {Material{}});
  Gallery gallery(body.mesh(), "bar", 2, staging);
  const std::vector<double> strain{0, 0.1, 0.2, 0.3};
  gallery.add(0, 0, body.mesh().positions(), strain);
  gallery.add(10, 0.1, support::mapped(body.mesh().positions(), Vec3(0.8, 0.8, 1.5).asDiagonal()), strain);
  return gallery;
}

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

TEST(Picture, OfAStretchedBarIsWiderByTheStretchAndFillsThePage) {
  const std::vector<Image> images = pictures_of(bar_at_rest_and_stretched());
  const auto [rest_first, rest_last] = coloured_columns(images[0]);
  const auto [first, last] = coloured_columns(images[1]);
  EXPECT_GT(last - first, 1.3 * (rest_last - rest_first));
  EXPECT_GT(first, 40);  // and both lie within the margins
  EXPECT_LT(last, 1240);
  EXPECT_GT(last - first, 900);
}

TEST(Picture, ShowsTheScaleFromZeroToTheGreatestValue) {
  const Image image = pictures_of(bar_at_rest_and_stretched())[0];
  for (const double fraction : {0.01, 0.25, 0.5, 0.75, 0.99}) {
    const int x = 410 + static_cast<int>(fraction * 460);
    EXPECT_LE(difference(pixel(image, x, 655), bytes(output::colour_of(fraction))), 2) << fraction;
  }
}

/// The fraction of the scale whose colour, under some light, is nearest to a pixel.
double fraction_at(const Rgb& pixel) {
  double best = 0, min = 1e9;
  for (int k = 0; k <= 100; ++k) {
    const Colour base = output::colour_of(k / 100.0);
    const Vec3 scale(base.red, base.green, base.blue), seen(pixel[0] / 255.0, pixel[1] / 255.0, pixel[2] / 255.0);
    const double error = (seen - scale * seen.dot(scale) / scale.squaredNorm()).norm();
    if (error < min) std::tie(min, best) = std::pair(error, k / 100.0);
  }
  return best;
}

// Strain belongs to hexahedra; what is shown at their common nodes is the mean, and in between it is blended: 0, 1/6,
// 1/2, 5/6 and 1 of the greatest at the five sections of the bar.
TEST(Picture, BlendsTheStrainOfNeighbours) {
  output::Staging staging;
  staging.shows_edges = false;
  const Image image = pictures_of(bar_at_rest_and_stretched(staging))[1];
  const auto [first, last] = coloured_columns(image);
  const auto is_coloured = [&](int x, int y) {
    const Rgb at = pixel(image, x, y);
    return std::ranges::max(at) - std::ranges::min(at) >= 22;
  };
  int num_seen = 0;
  for (int y = 90; y < 590; y += 9)
    for (int x = first; x < last; x += 9) {
      // on the rim colours are blended with those behind the body
      if (!is_coloured(x, y - 2) || !is_coloured(x, y + 2)) continue;
      ++num_seen;
      const Rgb at = pixel(image, x, y);
      const double section = 4.0 * (x - first) / (last - first);
      static constexpr std::array kFraction{0.0, 1.0 / 6, 0.5, 5.0 / 6, 1.0, 1.0};
      const int from = std::clamp(static_cast<int>(section), 0, 4);
      const double expected = kFraction[from] + (section - from) * (kFraction[from + 1] - kFraction[from]);
      EXPECT_NEAR(fraction_at(at), expected, 0.13)
          << "at " << x << ", " << y;  // the sections stand aslant in the picture
    }
  EXPECT_GT(num_seen, 1000);
}

// What faces away lies in the dark, and nearly as near as the bright face above it along the rim that the two share.
TEST(Picture, ShowsNothingAlongTheRimOfWhatFacesAway) {
  output::Staging staging;
  staging.shows_edges = false;
  staging.ghost.clear();
  const Image image = pictures_of(bar_at_rest_and_stretched(staging))[1];
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
output::EmbeddedSurface surface_of_bar() {
  output::EmbeddedSurface embedded;
  embedded.points.resize(8, 3);
  for (int k = 0; k < 4; ++k) {
    embedded.points.row(2 * k) << 0.05, 0.02, 0.05 + 0.1 * k;
    embedded.points.row(2 * k + 1) << 0.05, 0.08, 0.05 + 0.1 * k;
  }
  embedded.quads = {{0, 1, 3, 2}, {4, 5, 7, 6}};
  embedded.triangles = {{2, 3, 5}, {2, 5, 4}};
  return embedded;
}

output::Staging with_surface_of_bar() {
  output::Staging staging;
  staging.embedded_surfaces = {surface_of_bar()};
  staging.shows_hexahedra = false;
  staging.viewpoint = output::Viewpoint{.towards = Vec3(1, 0, 0), .up = {}};
  return staging;
}

/// The picture and drawing of a block of 3 x 3 x 3 cells at rest, of which that in the middle is a region, and those of
/// one side.
struct Divided {
  explicit Divided(output::Staging staging) {
    static const Body body(support::block({3, 3, 3}, 0.1), {Material{}});
    staging.shows_edges = false;
    staging.regions = {std::vector<int>(27, 0), {"core", "organ/side"}};
    for (int e = 0; e < 27; ++e) {
      Vec3 middle = Vec3::Zero();
      for (const int node : body.mesh().hexahedra()[static_cast<std::size_t>(e)])
        middle += body.mesh().positions().row(node).transpose() / kCorners;
      const Vec3 cell = (middle - body.mesh().positions().colwise().mean().transpose()) / 0.1;
      if (cell.norm() < 0.1) staging.regions.of_hexahedra[static_cast<std::size_t>(e)] = 1;
      if (cell.x() > 0.9) staging.regions.of_hexahedra[static_cast<std::size_t>(e)] = 2;
    }
    Gallery gallery(body.mesh(), "block", 2, staging);
    std::vector<double> strain(27, 0.0);
    strain[13] = 1;
    gallery.add(0, 0, body.mesh().positions(), strain);
    drawing = drawings_of(gallery)[0];
  }

  Drawing drawing;
};

std::set<std::string> words_of(const Drawing& drawing) {
  std::set<std::string> words;
  for (const Drawing::Text& text : drawing.texts) words.insert(text.words);
  return words;
}

// A piece of a block that is cut askew lies where the whole block does.
TEST(Regions, HaveTheWallsOfTheirBody) {
  Body body(support::block({3, 3, 3}, 0.1), {Material{}});
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
  output::Staging staging;
  for (const Hexahedron& corners : body.mesh().hexahedra())
    staging.regions.of_hexahedra.push_back(gather(body.mesh().positions(), corners).col(2).mean() > 0.2 ? 1 : 2);
  staging.regions.names = {"upper", "lower"};
  staging.shown_regions = {1, 2};
  output::Shapes shapes(body.mesh(), staging);
  const std::vector<double> values(static_cast<std::size_t>(body.mesh().num_nodes()), 0.0);
  const output::Moment moment =
      shapes.at(body.mesh().positions(), values, {}, {}, nullptr, output::Bodies(body).open_faces());
  std::size_t num_walls = 0;
  for (const output::Moment::Shown& part : moment.parts) {
    for (std::size_t f = 0; f < part.surface->faces().size(); ++f) num_walls += part.surface->is_wall(f) ? 1 : 0;
    for (const Eigen::Vector3f& point : part.points)
      EXPECT_TRUE(std::ranges::find(moment.body.points, point) != moment.body.points.end()) << point.transpose();
  }
  EXPECT_EQ(num_walls, 18u);
}

// Each hexahedron is in one region: no value lies between two numbers, on the surface and where it is cut.
TEST(Regions, AreFlatAndNamed) {
  output::Staging staging;
  staging.quantity = output::Quantity::kRegion;
  staging.cut = Plane{Vec3::UnitZ(), 0.12};
  const Divided block(staging);
  for (const auto& [vertices, numbers] :
       {std::pair(block.drawing.view->geometry.surface, std::set<float>{0, 1, 2}),
        std::pair(block.drawing.view->geometry.cut_faces, std::set<float>{0, 1, 2})}) {
    std::set<float> values;
    for (const output::Geometry::Vertex& vertex : vertices) values.insert(vertex.value);
    EXPECT_EQ(values, numbers);
  }
  // of the cut, the middle cell has a ninth
  double core = 0, all = 0;
  const output::Geometry::Vertices& cut = block.drawing.view->geometry.cut_faces;
  for (std::size_t v = 0; v + 2 < cut.size(); v += 3) {
    const double area = (cut[v + 1].place - cut[v].place).cross(cut[v + 2].place - cut[v].place).norm() / 2;
    all += area;
    if (cut[v].value == 1) core += area;
  }
  EXPECT_NEAR(all, 0.09, 1e-6);
  EXPECT_NEAR(core, 0.01, 1e-6);
  for (const char* name : {"core", "organ/side", "in no region"}) EXPECT_TRUE(words_of(block.drawing).contains(name));

  // cut faces have no light: their pixels are the colours themselves
  const Image image = output::load_renderer()->render(block.drawing);
  for (const int number : {0, 1, 2}) {
    int num_seen = 0;
    for (int y = 90; y < 590; ++y)
      for (int x = 0; x < image.width; ++x)
        num_seen += difference(pixel(image, x, y), bytes(output::colour_of_region(number))) <= 1;
    EXPECT_GT(num_seen, 1000) << number;
  }
}

TEST(Regions, AreSeenThroughTheBody) {
  output::Staging staging;
  staging.quantity = output::Quantity::kRegion;
  const auto middle = [&] {
    const Image image = output::load_renderer()->render(Divided(staging).drawing);
    return pixel(image, 640, 340);
  };
  const Rgb whole = middle();
  staging.shown_regions = {1};
  const Drawing within = Divided(staging).drawing;
  Eigen::AlignedBox3f box, veil;
  for (const output::Geometry::Vertex& vertex : within.view->geometry.surface) box.extend(vertex.place);
  for (const output::Geometry::Vertex& vertex : within.view->geometry.veil) veil.extend(vertex.place);
  EXPECT_LT((box.sizes() - Eigen::Vector3f::Constant(0.1f)).norm(), 1e-6);
  EXPECT_LT((veil.sizes() - Eigen::Vector3f::Constant(0.3f)).norm(), 1e-6);
  EXPECT_TRUE(within.view->geometry.ghost.empty());
  EXPECT_TRUE(words_of(within).contains("core"));
  EXPECT_FALSE(words_of(within).contains("organ/side"));
  // the core is red: through the veil still more so than the body
  const Rgb seen = middle();
  EXPECT_GT(seen[0] - seen[2], whole[0] - whole[2] + 20);

  staging.quantity = output::Quantity::kPlasticStrain;
  float max = 0;
  for (const output::Geometry::Vertex& vertex : Divided(staging).drawing.view->geometry.surface)
    max = std::max(max, vertex.value);
  EXPECT_FLOAT_EQ(max, 0.125f) << "mean over the eight cells around a corner";
}

TEST(EmbeddedSurface, IsShownInPlaceOfTheHexahedraAndFollowsThem) {
  const Body body(support::block({1, 1, 4}, 0.1), {Material{}});
  const std::vector<double> strain{0.3, 0.3, 0.3, 0.3};
  Gallery gallery(body.mesh(), "skin", 2, with_surface_of_bar());
  gallery.add(0, 0, body.mesh().positions(), strain);
  gallery.add(1, 0, support::mapped(body.mesh().positions(), Vec3(1, 1, 1.5).asDiagonal()), strain);
  gallery.add(2, 0, body.mesh().positions(), strain, std::vector<unsigned char>{1, 0, 1, 1});
  const std::vector<Image> images = pictures_of(gallery);
  const auto width = [&](int state) {
    const auto [first, last] = coloured_columns(images[state]);
    return last - first;
  };
  EXPECT_NEAR(width(1), 1.5 * width(0), 3);
  // without the second hexahedron, where the first two of the three pieces have corners, only the third is left
  EXPECT_NEAR(width(2), width(0) / 3.0, 3);
  for (const Drawing& drawing : drawings_of(gallery)) EXPECT_TRUE(drawing.view->geometry.edges.empty());
}

TEST(EmbeddedSurface, BlendsStrainByItsPlaceInTheHexahedra) {
  const Body body(support::block({1, 1, 4}, 0.1), {Material{}});
  Gallery gallery(body.mesh(), "skin", 2, with_surface_of_bar());
  gallery.add(0, 0, body.mesh().positions(), {0, 0.1, 0.2, 0.3});
  // from the middle of the first hexahedron, 1/12 of 0.3, to that of the last one, 11/12, which is the greatest shown
  const Image image = pictures_of(gallery)[0];
  const auto [first, last] = coloured_columns(image);
  const std::array ends{fraction_at(pixel(image, first + 4, 340)), fraction_at(pixel(image, last - 4, 340))};
  EXPECT_NEAR(std::min(ends[0], ends[1]), 1.0 / 11, 0.04);
  EXPECT_NEAR(std::max(ends[0], ends[1]), 1, 0.04);
  EXPECT_NEAR(fraction_at(pixel(image, (first + last) / 2, 340)), 6.0 / 11, 0.04);
}

output::BoundaryConditions touched_by(const output::Instrument& instrument) {
  output::BoundaryConditions conditions;
  conditions.instruments.push_back(instrument);
  return conditions;
}

/// The faces of a box, by the corners of hexahedra.
std::vector<Quad> faces_of_box() {
  return {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
}

PointArray corners_of_box(const Vec3& min, const Vec3& max) {
  const HexMesh mesh = support::block({1, 1, 1}, 1);
  PointArray corners(kCorners, 3);
  for (int k = 0; k < kCorners; ++k)
    corners.row(k) =
        (min + mesh.positions().row(mesh.hexahedra()[0][k]).transpose().cwiseProduct(max - min)).transpose();
  return corners;
}

// Seen from above, through the plane, there are values of the body within the surface, and metal within the instrument.
TEST(Cut, FillsClosedSurfacesAndInstruments) {
  const Body body(support::block({1, 1, 4}, 0.1), {Material{}});
  output::Instrument instrument{.place = Vec3(0.25, 0.05, 0.2), .nodes = {}, .forces = PointArray(0, 3)};
  instrument.shape_points = corners_of_box({0.2, 0, 0.05}, {0.3, 0.1, 0.35});
  for (const auto& [a, b, c, d] : faces_of_box()) {
    instrument.shape_triangles.push_back({a, b, c});
    instrument.shape_triangles.push_back({a, c, d});
  }
  const auto colour_at = [&](const Vec3& place, int num_faces) {
    output::Staging staging;
    output::EmbeddedSurface& embedded = staging.embedded_surfaces.emplace_back();
    embedded.points = corners_of_box({0.02, 0.02, 0.05}, {0.08, 0.08, 0.35});
    embedded.quads = faces_of_box();
    embedded.quads.resize(static_cast<std::size_t>(num_faces));
    staging.shows_hexahedra = false;
    staging.cut = Plane{Vec3::UnitZ(), 0.2};
    staging.viewpoint = output::Viewpoint{.towards = Vec3(0.3, 0.2, 1), .up = {}};
    Gallery gallery(body.mesh(), "cut", 2, staging);
    gallery.add(0, 0, body.mesh().positions(), {0.3, 0.3, 0.3, 0.3}, {}, touched_by(instrument));
    const Eigen::Vector2f at = drawings_of(gallery)[0].view->camera.on_page(place.cast<float>());
    return pixel(pictures_of(gallery)[0], static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  const Vec3 in_surface(0.04, 0.06, 0.2), in_tool(0.26, 0.04, 0.2);
  EXPECT_LE(difference(colour_at(in_surface, 6), bytes(output::colour_of(1))), 2);
  EXPECT_LE(difference(colour_at(in_tool, 6), bytes(output::kMetal)), 2);
  EXPECT_GT(difference(colour_at(in_surface, 5), bytes(output::colour_of(1))), 20) << "an open surface has no inside";
}

TEST(Up, IsAgainstGravity) {
  const Body body(support::block({4, 1, 1}, 0.1), {Material{}});
  const auto rises = [&](const output::Staging& staging, const Vec3& direction) {
    Gallery gallery(body.mesh(), "up", 2, staging);
    gallery.add(0, 0, body.mesh().positions(), {0, 0, 0, 0});
    const output::Camera camera = drawings_of(gallery)[0].view->camera;
    const auto at = [&](const Vec3& place) { return camera.on_page(place.cast<float>()); };
    const Eigen::Vector2f along = at(0.1 * direction) - at(Vec3::Zero());
    return -along.y() > 0.9 * along.norm();
  };
  output::Staging staging;
  EXPECT_TRUE(rises(staging, Vec3::UnitY()));
  staging.is_anatomical = true;
  EXPECT_TRUE(rises(staging, Vec3::UnitZ())) << "to the head";
  staging.gravity = Vec3(-9.81, 0, 0);
  EXPECT_TRUE(rises(staging, Vec3::UnitX())) << "though it is the long axis";
  staging.viewpoint = output::Viewpoint{.towards = Vec3(0.3, 0.2, 1), .up = {}};
  EXPECT_TRUE(rises(staging, Vec3::UnitX()));
  staging.up = Vec3(0, -1, 0);
  EXPECT_TRUE(rises(staging, -Vec3::UnitY()));
}

TEST(Up, HasAxesNamedByWhatTheyRunTo) {
  Mat3 from_above;  // x to the right, y away
  from_above << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const auto marks = output::axis_marks(from_above, true);
  EXPECT_EQ(marks[2].name, "S");  // the nearest, seen as a point
  EXPECT_EQ(marks[2].tip, Eigen::Vector2f(0, 0));
  for (const output::AxisMark& mark : marks) {
    if (mark.name == "L") {
      EXPECT_EQ(mark.tip, Eigen::Vector2f(1, 0));
    }
    if (mark.name == "P") {
      EXPECT_EQ(mark.tip, Eigen::Vector2f(0, -1));
    }
  }
  EXPECT_EQ(output::axis_marks(from_above, false)[2].name, "z");
}

TEST(Picture, LeavesTheColourBarItsStripOfPaper) {
  output::Staging staging;
  staging.ghost.clear();
  staging.viewpoint = output::Viewpoint{
      .towards = Vec3(1, 0, 0), .up = {}, .eye = output::Viewpoint::Eye{Vec3(0.2, 0.05, 0.2), Vec3(0, 0.05, 0.2), 20}};
  const Image image = pictures_of(bar_at_rest_and_stretched(staging))[0];
  EXPECT_GT(difference(pixel(image, 1200, 605), bytes(output::kPaper)), 20) << "the bar is all over the rest";
  for (const int y : {620, 660, 700}) EXPECT_EQ(pixel(image, 1200, y), bytes(output::kPaper)) << y;
}

TEST(Picture, NamesBothEndsOfItsScale) {
  using Labels = std::vector<std::pair<double, std::string>>;
  EXPECT_EQ(output::labels_of_scale(0, 0.00558, 6).rbegin()[1].second, "0.004") << "0.005 would touch 0.00558";
  EXPECT_EQ(output::labels_of_scale(0, 0.353, 6),
            (Labels{{0, "0"}, {0.1, "0.1"}, {0.2, "0.2"}, {0.1 * 3, "0.3"}, {0.353, "0.353"}}));
  EXPECT_EQ(output::labels_of_scale(0.97, 1.012, 3),
            (Labels{{0.97, "0.97"}, {0.02 * 49, "0.98"}, {0.02 * 50, "1.00"}, {1.012, "1.01"}}));
}

// An arrow is seen against any colour: paper stands around it.
TEST(Loads, AreSetOffFromTheBody) {
  const Body body(support::block({1, 1, 4}, 0.1), {Material{}});
  output::Staging staging;
  staging.ghost.clear();
  staging.shows_edges = false;
  staging.viewpoint = output::Viewpoint{.towards = Vec3(1, 0, 0), .up = {}};
  Gallery gallery(body.mesh(), "arrow", 2, staging);
  output::Instrument instrument{.place = Vec3(0.1, 0.05, 0.2), .nodes = {9}, .forces = PointArray(1, 3)};
  instrument.forces << 0, 0, 1;
  gallery.add(0, 0, body.mesh().positions(), {0.3, 0.3, 0.3, 0.3}, {}, touched_by(instrument));
  const Image image = pictures_of(gallery)[0];
  const Eigen::Vector2f middle = drawings_of(gallery)[0].view->camera.on_page({0.1f, 0.05f, 0.22f});
  int num_paper = 0;
  for (int y = -20; y <= 20; ++y)
    num_paper += difference(pixel(image, static_cast<int>(middle.x()), static_cast<int>(middle.y()) + y),
                            bytes(output::kPaper)) < 60;
  EXPECT_GE(num_paper, 2);
  EXPECT_LE(num_paper, 6);
}

TEST(Loads, AreNamedWithTheGreatestOfTheRun) {
  const HexMesh mesh = support::block({1, 1, 2}, 0.1);
  output::Staging staging;
  staging.gravity = Vec3(0, 0, -3.71);
  Gallery gallery(mesh, "loaded", 2, staging);
  output::BoundaryConditions conditions;
  for (const double force : {0.0125, 0.05}) {
    conditions.loads = PointArray::Zero(mesh.num_nodes(), 3);
    conditions.loads.row(8) << 0, force, 0;
    conditions.loads.row(9) << 3, 0, 4;  // an instrument's alone
    conditions.instruments = {{.place = Vec3(0, 0, 0.3), .nodes = {9}, .forces = PointArray(conditions.loads.row(9))}};
    gallery.add(0, 0, mesh.positions(), {0, 1}, {}, conditions);
  }
  for (const Drawing& drawing : drawings_of(gallery)) {
    std::set<std::string> words;
    for (const Drawing::Text& text : drawing.texts) words.insert(text.words);
    EXPECT_TRUE(words.contains("load, up to 50 mN per node"));
    EXPECT_TRUE(words.contains("instrument, force up to 5 N"));
    EXPECT_TRUE(words.contains("gravity 3.71 m/s²"));
  }
  gallery.add(0, 0, mesh.positions(), {0, 1});
  const std::vector<Drawing> drawings = drawings_of(gallery);
  for (const Drawing::Text& text : drawings[2].texts) {
    EXPECT_FALSE(text.words.starts_with("load,")) << "there is none in this state";
    EXPECT_FALSE(text.words.starts_with("instrument,"));
  }
}

// 9261 loaded nodes, of which no more are drawn than have room beside each other.
TEST(Loads, OfManyNodesAreThinnedOut) {
  const HexMesh mesh = support::block({20, 20, 20}, 0.01);
  Gallery gallery(mesh, "dense", 2);
  output::BoundaryConditions conditions;
  conditions.loads = PointArray::Constant(mesh.num_nodes(), 3, 1);
  const std::vector<double> values(mesh.num_elements(), 0);
  gallery.add(0, 0, mesh.positions(), values);
  EXPECT_TRUE(drawings_of(gallery)[0].view->geometry.load_arrows.empty());
  gallery.add(0, 0, mesh.positions(), values, {}, conditions);
  constexpr std::size_t kPerArrow = 3 * 80;  // vertices
  const std::size_t num_arrows = drawings_of(gallery)[1].view->geometry.load_arrows.size() / kPerArrow;
  EXPECT_GT(num_arrows, 100u);
  EXPECT_LT(num_arrows, 9261u / 2);
}

TEST(Loads, LeaveTheBodyNearlyAsLargeAsItIsWithoutThem) {
  const HexMesh mesh = support::block({2, 2, 2}, 0.1);
  const std::vector<double> values(mesh.num_elements(), 0);
  output::BoundaryConditions conditions;
  conditions.loads = PointArray::Zero(mesh.num_nodes(), 3);
  conditions.loads.row(mesh.num_nodes() - 1) << 0, 1, 0;
  const auto height = [](const output::View& view, const output::Geometry::Vertices& vertices) {
    Eigen::AlignedBox2f box;
    for (const output::Geometry::Vertex& vertex : vertices) box.extend(view.camera.on_page(vertex.place));
    return box.sizes().y();
  };
  Gallery without(mesh, "cube", 2), with(mesh, "cube", 2);
  without.add(0, 0, mesh.positions(), values);
  with.add(0, 0, mesh.positions(), values, {}, conditions);
  const auto view_of = [](const Gallery& gallery) { return *drawings_of(gallery)[0].view; };
  const output::View loaded = view_of(with), unloaded = view_of(without);
  EXPECT_GT(height(loaded, loaded.geometry.surface), 0.85f * height(unloaded, unloaded.geometry.surface));
  EXPECT_GT(height(loaded, loaded.geometry.load_arrows), 40) << "the arrow is seen all the same";
}

TEST(WithUnit, TakesThePrefixThatSuits) {
  EXPECT_EQ(output::with_unit(0, "N"), "0 N");
  EXPECT_EQ(output::with_unit(3.14159, "N"), "3.14 N");
  EXPECT_EQ(output::with_unit(0.0003124, "N"), "312 µN");
  EXPECT_EQ(output::with_unit(0.9999, "N"), "1 N");
  EXPECT_EQ(output::with_unit(0.02, "N"), "20 mN");
  EXPECT_EQ(output::with_unit(12345, "Pa"), "12.3 kPa");
}

/// A floor of 4 x 4 m, and a roof of 1 x 1 m that is 0.2 m above its middle, which is seen below it.
Drawing floor_and_roof(bool has_roof) {
  Drawing drawing{.width = 400, .height = 400, .view = {}, .triangles = {}, .lines = {}, .texts = {}};
  output::Camera camera(output::Viewpoint{.towards = Vec3(0, 0.3, 1), .up = Vec3::UnitY()});
  output::Geometry geometry;
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
          geometry.surface.push_back({place, Eigen::Vector3f::UnitY(), 0.2f});
        }
  };
  add(2, 0);
  if (has_roof) add(0.5f, 0.2f);
  camera.fit({0, 0, 400, 400});
  drawing.view = std::make_shared<output::View>(output::View{geometry, camera, 400, 400, 0, 1});
  return drawing;
}

/// Of a place [m] that is seen there.
double brightness_at(const Image& image, const Drawing& drawing, const Eigen::Vector3f& place) {
  const Eigen::Vector2f at = drawing.view->camera.on_page(place);
  const Rgb colour = pixel(image, static_cast<int>(at.x()), static_cast<int>(at.y()));
  const Rgb full = bytes(output::colour_of(0.2));
  return (colour[0] + colour[1] + colour[2]) / static_cast<double>(full[0] + full[1] + full[2]);
}

// For any number of lamps: bright in the open, never dark, and a plane does not shade itself.
TEST(Light, IsFullInTheOpenAndFailsUnderARoof) {
  const Drawing open = floor_and_roof(false), roofed = floor_and_roof(true);
  for (const output::Light& light : {output::kPictureLight, output::kWindowLight, output::Light{9, 512}}) {
    SCOPED_TRACE(light.num_lamps);
    const auto renderer = output::load_renderer(output::Backend::kAny, light);
    const Image without = renderer->render(open), with = renderer->render(roofed);
    const double full = brightness_at(without, open, {0, 0, 0});
    EXPECT_GT(full, 0.9);
    EXPECT_LE(full, 1.05);
    EXPECT_NEAR(brightness_at(without, open, {1, 0, 1}), full, 0.01);
    EXPECT_NEAR(brightness_at(without, open, {-1.5f, 0, -1.5f}), full, 0.01);
    EXPECT_NEAR(brightness_at(with, roofed, {0, 0.2f, 0}), full, 0.02) << "on the roof";
    EXPECT_NEAR(brightness_at(with, roofed, {1.8f, 0, 1.8f}), full, 0.03) << "far from it";
    const double received = brightness_at(with, roofed, {0, 0, 0}) - output::kDarkest;
    EXPECT_LT(received, (light.num_lamps == 1 ? 0.5 : 0.3) * (full - output::kDarkest))
        << "no roof keeps the even sky off";
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
  const output::Surface surface(points, {{0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}});

  EXPECT_EQ(surface.edges().size(), 10u);
  // all faces are turned to a viewer above: the creases, which are eight at the border and the one at 60 degrees
  EXPECT_EQ(surface.outline(points, {0, 1, 0}).size(), 9u);
  const auto normals = surface.corner_normals(points);
  EXPECT_LT((normals[0][3] - normals[1][0]).norm(), 1e-6f);  // at the smooth edge: 10 degrees from both faces
  EXPECT_NEAR(normals[0][3].dot(normals[0][0]), 1, 0.02);
  EXPECT_NEAR(normals[1][3].dot(normals[2][0]), std::cos(60 * degree), 0.1);
}

TEST(Picture, WithoutPlasticStrainSaysSo) {
  const Body body(support::block({1, 1, 2}, 0.1), {Material{}});
  Gallery gallery(body.mesh(), "elastic", 2);
  gallery.add(0, 0, body.mesh().positions(), {0, 0});
  const Drawing drawing = drawings_of(gallery).front();
  EXPECT_TRUE(std::ranges::any_of(
      drawing.texts, [](const Drawing::Text& text) { return text.words == "no plastic strain in this run"; }));
  EXPECT_EQ(pictures_of(gallery).front().width, 1280);
}

TEST(Picture, TakesAnyTitle) {
  const HexMesh mesh = support::block({1, 1, 2}, 0.1);
  Gallery gallery(mesh, "Zug 50 µm \xff\xc3 % {} " + std::string(300, 'W'), 2);
  gallery.add(0, 0, mesh.positions(), {0, 0});
  const Image image = pictures_of(gallery).front();
  EXPECT_EQ(image.width, 1280);
  EXPECT_EQ(image.height, 720);
}

TEST(PngFile, HoldsThePixels) {
  const Scratch scratch;
  Image image{31, 17, std::vector<std::uint8_t>(31 * 17 * 3)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i * i % 251);
  output::write_png(scratch / "some.png", image);

  const Image read = support::read_png(scratch / "some.png");
  EXPECT_EQ(read.width, 31);
  EXPECT_EQ(read.height, 17);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST(Frames, AreSpreadOverTheRunAndEndWithTheLastState) {
  const Scratch scratch;
  Body body = support::yielding_block();
  output::Recorder recorder(scratch / "run", body,
                            {.title = "frames", .num_steps = 8, .dt = 0.01, .output_every = 100, .num_frames = 4});
  support::record_stretch(recorder, body, 7);  // interrupted: the seventh step is the last
  EXPECT_EQ(recorder.finish(), std::vector<std::string>{});
  for (const char* name : {"frame_000002.png", "frame_000004.png", "frame_000006.png", "frame_000007.png"})
    EXPECT_TRUE(fs::exists(scratch / "run/frames" / name)) << name;
}

TEST(Frames, MissingRendererIsOneWarningAndNothingElseIsLost) {
  const Scratch scratch;
  Body body = support::yielding_block();
  output::Recorder recorder(scratch / "run", body, {.title = "blind", .num_steps = 3, .dt = 0.01},
                            [&] { return output::load_renderer(scratch / "nowhere"); });
  support::record_stretch(recorder, body, 3);
  const std::vector<std::string> warnings = recorder.finish();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("no pictures"), std::string::npos);
  EXPECT_NE(warnings[0].find("nowhere"), std::string::npos) << warnings[0];
  for (const char* name : {"history.csv", "mesh.pvd", "mesh_000003.vtu"})
    EXPECT_TRUE(fs::exists(scratch / "run" / name)) << name;
}

/// CIELAB of an sRGB colour, D65.
Vec3 lab(const Colour& colour) {
  const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  Mat3 to_xyz;
  to_xyz << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041;
  const Vec3 xyz = to_xyz * Vec3(linear(colour.red), linear(colour.green), linear(colour.blue));
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double x = f(xyz.x() / 0.95047), y = f(xyz.y()), z = f(xyz.z() / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

TEST(ColourMap, TakesEqualStepsAndGetsDarkerAllTheWay) {
  constexpr int kSteps = 32;
  double min = 1e9, max = 0;
  for (int k = 0; k < kSteps; ++k) {
    const Vec3 from = lab(output::colour_of(static_cast<double>(k) / kSteps));
    const Vec3 to = lab(output::colour_of((k + 1.0) / kSteps));
    EXPECT_GT(from[0], to[0] + 0.5);
    min = std::min(min, (to - from).norm());
    max = std::max(max, (to - from).norm());
  }
  EXPECT_LT(max, 1.05 * min);
  EXPECT_EQ(bytes(output::colour_of(-1)), bytes(output::colour_of(0)));
  EXPECT_EQ(bytes(output::colour_of(2)), bytes(output::colour_of(1)));
}

}  // namespace
}  // namespace hexaplast
