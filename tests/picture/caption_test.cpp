// SPDX-License-Identifier: LGPL-2.1-or-later
// Axes, scales, units and titles, and which way is up.
#include "picture/axis.hpp"
#include "support/pictures.hpp"

namespace hexaplast {
namespace {

TEST(Up, IsAgainstGravity) {
  const HexMesh mesh = block({4, 1, 1}, 0.1);
  const auto rises = [&](const Staging& staging, const Vec3& direction) {
    const Camera camera = drawing_of(mesh, {0, 0, 0, 0}, staging).view->camera;
    const auto at = [&](const Vec3& place) { return camera.on_page(place.cast<float>()); };
    const Eigen::Vector2f along = at(0.1 * direction) - at(Vec3::Zero());
    return -along.y() > 0.9 * along.norm();
  };
  Staging staging;
  EXPECT_TRUE(rises(staging, Vec3::UnitY()));
  staging.is_anatomical = true;
  EXPECT_TRUE(rises(staging, Vec3::UnitZ())) << "to the head";
  staging.gravity = Vec3(-9.81, 0, 0);
  EXPECT_TRUE(rises(staging, Vec3::UnitX())) << "though it is the long axis";
  staging.viewpoint = Viewpoint{.towards = Vec3(0.3, 0.2, 1), .up = {}};
  EXPECT_TRUE(rises(staging, Vec3::UnitX()));
  staging.up = Vec3(0, -1, 0);
  EXPECT_TRUE(rises(staging, -Vec3::UnitY()));
}

TEST(Up, HasAxesNamedByWhatTheyRunTo) {
  Mat3 from_above;  // x to the right, y away
  from_above << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const auto marks = axis_marks(from_above, true);
  EXPECT_EQ(marks[2].name, "S");  // the nearest, seen as a point
  EXPECT_EQ(marks[2].tip, Eigen::Vector2f(0, 0));
  for (const AxisMark& mark : marks) {
    if (mark.name == "L") {
      EXPECT_EQ(mark.tip, Eigen::Vector2f(1, 0));
    }
    if (mark.name == "P") {
      EXPECT_EQ(mark.tip, Eigen::Vector2f(0, -1));
    }
  }
  EXPECT_EQ(axis_marks(from_above, false)[2].name, "z");
}

TEST(Picture, LeavesTheColourBarItsStripOfPaper) {
  Staging staging = plain_staging();
  staging.viewpoint = Viewpoint{
      .towards = Vec3(1, 0, 0), .up = {}, .eye = Viewpoint::Eye{Vec3(0.2, 0.05, 0.2), Vec3(0, 0.05, 0.2), 20}};
  const Image image = rendered(drawing_of(block({1, 1, 4}, 0.1), {0, 0.1, 0.2, 0.3}, staging));
  EXPECT_GT(difference(pixel(image, 1200, 605), bytes(kPaper)), 20) << "the bar is all over the rest";
  for (const int y : {620, 660, 700}) EXPECT_EQ(pixel(image, 1200, y), bytes(kPaper)) << y;
}

TEST(Picture, NamesBothEndsOfItsScale) {
  using Labels = std::vector<std::pair<double, std::string>>;
  EXPECT_EQ(labels_of_scale(0, 0.00558, 6).rbegin()[1].second, "0.004") << "0.005 would touch 0.00558";
  EXPECT_EQ(labels_of_scale(0, 0.353, 6),
            (Labels{{0, "0"}, {0.1, "0.1"}, {0.2, "0.2"}, {0.1 * 3, "0.3"}, {0.353, "0.353"}}));
  EXPECT_EQ(labels_of_scale(0.97, 1.012, 3),
            (Labels{{0.97, "0.97"}, {0.02 * 49, "0.98"}, {0.02 * 50, "1.00"}, {1.012, "1.01"}}));
}

TEST(WithUnit, TakesThePrefixThatSuits) {
  EXPECT_EQ(with_unit(0, "N"), "0 N");
  EXPECT_EQ(with_unit(3.14159, "N"), "3.14 N");
  EXPECT_EQ(with_unit(0.0003124, "N"), "312 µN");
  EXPECT_EQ(with_unit(0.9999, "N"), "1 N");
  EXPECT_EQ(with_unit(0.02, "N"), "20 mN");
  EXPECT_EQ(with_unit(12345, "Pa"), "12.3 kPa");
}

TEST(Picture, WithoutPlasticStrainSaysSo) {
  const Drawing drawing = drawing_of(block({1, 1, 2}, 0.1), {0, 0});
  EXPECT_TRUE(words_of(drawing).contains("no plastic strain in this run"));
  EXPECT_EQ(rendered(drawing).width, 1280);
}

TEST(Picture, TakesAnyTitle) {
  const HexMesh mesh = block({1, 1, 2}, 0.1);
  Gallery gallery(mesh, "Zug 50 µm \xff\xc3 % {} " + std::string(300, 'W'), 2);
  gallery.add(0, 0, mesh.positions(), {0, 0});
  const Image image = rendered(drawings_of(gallery).front());
  EXPECT_EQ(image.width, 1280);
  EXPECT_EQ(image.height, 720);
}

}  // namespace
}  // namespace hexaplast
