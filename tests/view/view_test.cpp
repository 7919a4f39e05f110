// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "picture/ink.hpp"
#include "support/compare.hpp"
#include "support/shapes.hpp"
#include "view/camera.hpp"
#include "view/figure.hpp"
#include "view/shown_scene.hpp"
#include "view/trace.hpp"

namespace hexaplast::view {
namespace {

const Eigen::AlignedBox3d kBox(Vec3(-1, 2, 3), Vec3(2, 4, 4));

Camera turned_camera() {
  Camera camera(Vec3::UnitY(), Vec3(1, 0.4, 2));
  camera.resize(1000, 600);
  camera.fit(kBox);
  camera.orbit(130, -45);
  camera.pan(40, 25);
  camera.zoom(2);
  return camera;
}

TEST(Camera, TheRayThroughAPixelMeetsWhatIsSeenThere) {
  const Camera camera = turned_camera();
  const Vec3 place(0.4, 3.3, 3.2);
  const Eigen::Vector2d pixel = camera.pixel_of(place);
  const Ray ray = camera.ray(pixel.x(), pixel.y());
  EXPECT_NEAR((place - ray.origin).cross(ray.direction.normalized()).norm(), 0, 1e-12);
  EXPECT_TRUE(support::agrees(camera.at_depth_of(place, pixel.x(), pixel.y()), place, 1e-12));

  // what is dragged stays in the plane that faces the viewer, and goes as far as the mouse
  const Vec3 dragged = camera.at_depth_of(place, pixel.x() + 30, pixel.y() - 40);
  EXPECT_NEAR((dragged - place).norm(), 50 * camera.metres_per_pixel(place), 1e-12);
  EXPECT_TRUE(support::agrees(camera.pixel_of(dragged), Eigen::Vector2d(pixel + Eigen::Vector2d(30, -40)), 1e-9));
  EXPECT_NEAR((dragged - place).dot((camera.eye() - camera.target()).normalized()), 0, 1e-12);
}

// What is drawn lies where the mouse meets it.
TEST(Camera, ClipCoordinatesAreThoseOfThePixels) {
  const Camera camera = turned_camera();
  const Eigen::Matrix4d clip = camera.fitted_to(kBox).clip(1000, 600);
  for (const Vec3& place : {Vec3(0.4, 3.3, 3.2), Vec3(-1, 2, 3), Vec3(2, 4, 4)}) {
    const Eigen::Vector3d seen = (clip * place.homogeneous()).hnormalized();
    const Eigen::Vector2d pixel = camera.pixel_of(place);
    EXPECT_NEAR(500 + 500 * seen.x(), pixel.x(), 1e-9);
    EXPECT_NEAR(300 - 300 * seen.y(), pixel.y(), 1e-9);
    EXPECT_TRUE(seen.z() > -1 && seen.z() < 1) << seen.z();
  }
}

TEST(Camera, FittedItSeesTheWholeBoxAndNotMuchElse) {
  for (const auto& [width, height] : {std::pair{1000, 600}, std::pair{300, 900}}) {
    Camera camera(Vec3::UnitZ(), Vec3(2, -1, 0.7));
    camera.resize(width, height);
    camera.fit(kBox);
    Eigen::AlignedBox2d seen;
    for (int k = 0; k < 8; ++k)
      seen.extend(camera.pixel_of(kBox.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k))));
    EXPECT_TRUE(Eigen::AlignedBox2d(Eigen::Vector2d(0, 0), Eigen::Vector2d(width, height)).contains(seen));
    EXPECT_GT(std::max(seen.sizes().x() / width, seen.sizes().y() / height), 0.7);
  }
}

TEST(Camera, TurnsWithTheMouseAndNeverOver) {
  Camera camera(Vec3::UnitY(), Vec3(0, 0, 1));
  camera.resize(800, 800);
  camera.fit(Eigen::AlignedBox3d(Vec3(-1, -1, -1), Vec3(1, 1, 1)));
  const Vec3 front(0, 0, 1);
  camera.orbit(50, 0);
  EXPECT_GT(camera.pixel_of(front).x(), 410) << "the near side follows the mouse";
  for (int k = 0; k < 20; ++k) camera.orbit(0, 100);
  EXPECT_LT(camera.pixel_of(Vec3(0, 0.5, 0)).y(), 400 + 1e-9) << "up is not below";
}

/// A bar at a moment, drawn out to one and a half times its length.
Snapshot moment(const HexMesh& mesh) {
  Snapshot snapshot;
  snapshot.positions = mesh.positions();
  snapshot.positions.col(2) *= 1.5;
  snapshot.plastic_rest = mesh.positions();
  snapshot.alive.assign(static_cast<std::size_t>(mesh.num_elements()), 1);
  for (int n = 0; n < mesh.num_nodes(); ++n) snapshot.values.push_back(mesh.positions()(n, 2));
  return snapshot;
}

/// What is drawn of it, so small that every quad is one piece.
output::Geometry drawn(const Figure& figure) {
  Camera camera(Vec3::UnitY(), Vec3(1, 2, 3));
  camera.resize(20, 20);
  camera.fit(figure.box());
  return figure.view(camera, output::Scale(Quantity::kPlasticStrain)).geometry;
}

output::Scale scale_of(const Figure& figure, Quantity quantity) {
  output::Scale scale(quantity);
  figure.see_values(scale);
  return scale;
}

class FigureOfABar : public testing::Test {
 protected:
  const HexMesh mesh = support::block({1, 1, 3}, 1);
  Figure figure{mesh, {}};
  Snapshot snapshot = moment(mesh);
};

void fix(Snapshot& snapshot, std::initializer_list<int> nodes) {
  snapshot.conditions.fixed.assign(static_cast<std::size_t>(snapshot.positions.rows()), 0);
  for (const int node : nodes) snapshot.conditions.fixed[static_cast<std::size_t>(node)] = 1;
}

TEST_F(FigureOfABar, ShowsTheFacesThatAreLeft) {
  fix(snapshot, {0, 1});
  figure.update(snapshot, {}, {});
  EXPECT_EQ(drawn(figure).surface.size(), 14u * 4 * 3);
  EXPECT_EQ(drawn(figure).edges.size(), 2u * 28);
  EXPECT_EQ(drawn(figure).fixed.size(), 2u);
  EXPECT_EQ(scale_of(figure, Quantity::kYield).min(), 0);
  EXPECT_EQ(scale_of(figure, Quantity::kYield).max(), 3);
  EXPECT_EQ(figure.box().max().z(), 4.5);
  for (const output::Geometry::Vertex& vertex : drawn(figure).surface) {
    EXPECT_NEAR(vertex.normal.norm(), 1, 1e-6);
    EXPECT_GT(vertex.normal.dot(vertex.place - Eigen::Vector3f(0.5f, 0.5f, 2.25f)), 0) << "it points outwards";
    EXPECT_NEAR(vertex.value, vertex.place.z() / 1.5f, 1e-6);
  }
  EXPECT_EQ(drawn(figure).ghost_outline.size(), 2u * (4 * 3 + 2 * 4)) << "where it bends sharply";

  snapshot.alive[1] = 0;
  figure.update(snapshot, {.shows_edges = false, .ghost = Ghost::kNone}, {});
  EXPECT_EQ(drawn(figure).surface.size(), 12u * 4 * 3);
  EXPECT_TRUE(drawn(figure).edges.empty() && drawn(figure).ghost.empty());
  EXPECT_TRUE(drawn(figure).ghost_outline.empty());
}

TEST_F(FigureOfABar, TheMouseMeetsWhatIsShown) {
  output::EmbeddedSurface embedded;  // a square in the middle of the bar, askew
  embedded.points.resize(4, 3);
  embedded.points << 0, 0, 1.5, 1, 0, 1.5, 1, 1, 1.9, 0, 1, 1.9;
  embedded.triangles = {{0, 1, 2}, {0, 2, 3}};
  output::Staging staging;
  staging.embedded_surfaces = {embedded};
  Figure embedding(mesh, staging);
  const Ray down{Vec3(0.4, 0.5, 9), Vec3(0, 0, -1)};

  embedding.update(snapshot, {.shows_embedded_surfaces = false}, {});
  EXPECT_NEAR(embedding.hit(down)->place.z(), 4.5, 1e-12);
  embedding.update(snapshot, {.shows_embedded_surfaces = true}, {});
  EXPECT_NEAR(embedding.hit(down)->place.z(), 1.5 * 1.7, 1e-12) << "it is carried by the hexahedra";
  EXPECT_EQ(drawn(embedding).surface.size(), 6u);
  for (const output::Geometry::Vertex& vertex : drawn(embedding).surface)
    EXPECT_NEAR(vertex.value, vertex.place.z() / 1.5f, 1e-6);
  EXPECT_FALSE(embedding.hit({Vec3(2, 0.5, 9), Vec3(0, 0, -1)}));
}

TEST(Figure, WhatNeverYieldsHasNoRangeOfYield) {
  const HexMesh mesh = support::block({1, 1, 1}, 1);
  Figure figure(mesh, {});
  Snapshot snapshot = moment(mesh);
  snapshot.values.assign(8, std::numeric_limits<double>::infinity());
  figure.update(snapshot, {}, {});
  EXPECT_EQ(scale_of(figure, Quantity::kYield).words(), "yield stress: none");
  for (const output::Geometry::Vertex& vertex : drawn(figure).surface) EXPECT_FALSE(std::isfinite(vertex.value));
}

TEST_F(FigureOfABar, ACutShowsTheInside) {
  fix(snapshot, {0, 9, 12});
  const Look look{.ghost = Ghost::kNone, .cut = Plane{Vec3::UnitZ(), 2.25}};  // in the middle of the bar, drawn out
  figure.update(snapshot, look, {});
  double area = 0;
  for (std::size_t k = 0; k < drawn(figure).cut_faces.size(); k += 3) {
    const auto place = [&](std::size_t corner) { return drawn(figure).cut_faces[k + corner].place; };
    area += (place(1) - place(0)).cross(place(2) - place(0)).norm() / 2;
    EXPECT_NEAR(drawn(figure).cut_faces[k].value, 1.5, 1e-6);
    EXPECT_EQ(drawn(figure).cut_faces[k].normal, Eigen::Vector3f::UnitZ());
  }
  EXPECT_NEAR(area, 1, 1e-6);
  EXPECT_FALSE(drawn(figure).cut_outline.empty());
  EXPECT_TRUE(drawn(figure).cut_edges.empty()) << "it is that of one hexahedron";
  EXPECT_EQ(drawn(figure).fixed.size(), 1u) << "the others are above";

  // from above the cut is met, from the side only what is left, from below the foot
  const auto seen = figure.hit({Vec3(0.4, 0.5, 9), Vec3(0, 0, -1)});
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->place.z(), 2.25, 1e-12);
  EXPECT_EQ(seen->outwards, Vec3::UnitZ());
  EXPECT_EQ(seen->hexahedron, 1);
  EXPECT_FALSE(figure.hit({Vec3(5, 0.5, 3), Vec3(-1, 0, 0)}));
  const auto foot = figure.hit({Vec3(0.4, 0.5, -9), Vec3(0, 0, 1)});
  ASSERT_TRUE(foot);
  EXPECT_NEAR(foot->place.z(), 0, 1e-12);
  EXPECT_EQ(foot->hexahedron, 0);
  EXPECT_NEAR(foot->outwards.z(), -1, 1e-12);

  figure.update(snapshot, {}, {});
  EXPECT_TRUE(drawn(figure).cut_faces.empty() && drawn(figure).cut_outline.empty());
}

TEST_F(FigureOfABar, InstrumentsHaveTheirShapes) {
  output::Instrument instrument{.id = 2, .place = Vec3(4, 0, 0), .nodes = {}, .forces = PointArray(0, 3)};
  snapshot.conditions.instruments = {instrument};
  figure.update(snapshot, {}, {});
  EXPECT_TRUE(drawn(figure).tools.empty()) << "a grip has none";
  instrument.shape_points.resize(4, 3);
  instrument.shape_points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  instrument.shape_triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  snapshot.conditions.instruments = {instrument};
  figure.update(snapshot, {}, {});
  ASSERT_EQ(drawn(figure).tools.size(), 12u);
  EXPECT_NEAR(drawn(figure).tools[0].normal.z(), -1, 1e-6);
  instrument.shape_points.col(0).array() += 7;
  snapshot.conditions.instruments = {instrument};
  figure.update(snapshot, {}, {});
  EXPECT_EQ(drawn(figure).tools[0].place.x(), 7) << "it has moved";
  figure.update(snapshot, {.shows_instruments = false}, {});
  EXPECT_TRUE(drawn(figure).tools.empty());
}

TEST_F(FigureOfABar, DepthsReachToInstrumentsBeforeTheBody) {
  output::Instrument instrument{.id = 2, .place = Vec3(4, 0, 0), .nodes = {}, .forces = PointArray(0, 3)};
  instrument.shape_points.resize(3, 3);
  instrument.shape_points << 2, 0, 0, 4, 1, 0, 3, 0, 1;
  instrument.shape_triangles = {{0, 1, 2}};
  snapshot.conditions.instruments = {instrument};
  figure.update(snapshot, {}, {});
  Camera camera(Vec3::UnitY(), Vec3::UnitX());
  camera.resize(20, 20);
  camera.fit(figure.box());
  const output::View view = figure.view(camera, output::Scale(Quantity::kPlasticStrain));
  for (int k = 0; k < 3; ++k) {
    const Vec3 point = instrument.shape_points.row(k).transpose();
    const Vec3 seen = (view.camera.clip(20, 20) * point.homogeneous()).hnormalized();
    EXPECT_TRUE(seen.z() > -1 && seen.z() < 1) << seen.z();
  }
}

TEST_F(FigureOfABar, SpringsAreTautOrSlack) {
  snapshot.conditions.springs = {{Vec3(1, 2, 3), Vec3(4, 5, 6)}, {Vec3(7, 8, 9), Vec3(0, 0, 1), true}};
  const std::vector<Eigen::Vector3f> taut{{1, 2, 3}, {4, 5, 6}}, slack{{7, 8, 9}, {0, 0, 1}};
  for (const bool shows_instruments : {true, false}) {
    figure.update(snapshot, {.shows_instruments = shows_instruments}, {});
    EXPECT_EQ(drawn(figure).taut_springs, taut);
    EXPECT_EQ(drawn(figure).slack_springs, slack);
  }
}

TEST_F(FigureOfABar, ArrowsAreThoseOfThePictures) {
  const int above = 14, below = 0;  // corners of the bar
  snapshot.conditions.loads = PointArray::Zero(mesh.num_nodes(), 3);
  snapshot.conditions.loads.row(above) << 0, 0, 2;  // pulls
  snapshot.conditions.loads.row(below) << 0, 0, 4;  // presses
  output::Instrument grip{.id = 0, .place = Vec3(1, 2, 3), .nodes = {above}, .forces = PointArray::Zero(1, 3)};
  grip.forces.row(0) << 3, 0, 0;
  snapshot.conditions.loads.row(above) += grip.forces.row(0);
  snapshot.conditions.instruments = {grip};
  figure.update(snapshot, {}, {.load = 4, .tool = 6});

  const double longest = output::kLongestArrow * std::sqrt(1 + 1 + 9.0);
  const auto reach = [](const output::Geometry::Vertices& vertices, int axis) {
    Eigen::AlignedBox1f box;
    for (const output::Geometry::Vertex& vertex : vertices) box.extend(vertex.place.segment<1>(axis));
    return box;
  };
  const double foot = snapshot.positions(below, 2), top = snapshot.positions(above, 2);
  EXPECT_NEAR(reach(drawn(figure).load_arrows, 2).min()[0], foot - longest, 1e-6) << "it ends at its node";
  EXPECT_NEAR(reach(drawn(figure).load_arrows, 2).max()[0], std::max(foot, top + longest / 2), 1e-6)
      << "it begins there";
  EXPECT_NEAR(reach(drawn(figure).tool_arrows, 0).min()[0], 1, 1e-6);
  EXPECT_NEAR(reach(drawn(figure).tool_arrows, 0).max()[0], 1 + longest / 2, 1e-6);
  ASSERT_EQ(figure.rings().size(), 1u);
  ASSERT_EQ(figure.tool_forces().size(), 1u);
  EXPECT_NEAR(figure.tool_forces()[0].tip.x(), 1 + longest / 2, 1e-6);
  EXPECT_EQ(figure.tool_forces()[0].size, 3);

  figure.update(snapshot, {.shows_instruments = false}, {.load = 4, .tool = 6});
  EXPECT_TRUE(drawn(figure).load_arrows.empty() && drawn(figure).tool_arrows.empty() && figure.rings().empty());
}

TEST(NameOf, SaysWhereAHexahedronBelongs) {
  EXPECT_EQ(name_of(7, {}, {}), "hexahedron 7");
  const std::vector<output::Bodies::Entry> bodies{{.name = "liver"}, {.name = "sac", .first_hexahedron = 3}};
  const output::Regions regions{{0, 2, 0, 0, 1}, {"wall", "tumour"}};
  EXPECT_EQ(name_of(1, bodies, regions), "liver, tumour, hexahedron 1");
  EXPECT_EQ(name_of(3, bodies, regions), "sac, hexahedron 0");
  EXPECT_EQ(name_of(4, bodies, regions), "sac, wall, hexahedron 1");
}

TEST_F(FigureOfABar, ShowsARegionWithinTheBody) {
  output::Staging staging;
  staging.regions = {{0, 1, 0}, {"core"}};
  Figure divided(mesh, staging);
  snapshot.quantity = Quantity::kRegion;
  divided.update(snapshot, {.regions = {1}}, {});
  EXPECT_EQ(drawn(divided).surface.size(), 6u * 4 * 3);
  EXPECT_EQ(drawn(divided).veil.size(), 14u * 4 * 3);
  divided.update(snapshot, {}, {});
  EXPECT_EQ(drawn(divided).surface.size(), (6u + 2 * 6) * 4 * 3) << "each part has its own surface";
  EXPECT_TRUE(drawn(divided).veil.empty());
}

TEST(Trace, ForgetsWhatWasUndone) {
  Trace trace(100);
  for (int k = 0; k <= 10; ++k) trace.add(k, 2 * k);
  trace.forget_after(4);
  EXPECT_EQ(trace.latest_time(), 4);
  trace.forget_after(-1);
  EXPECT_TRUE(trace.empty());
}

TEST(Traces, HaveProbesThatGoBackToo) {
  Traces traces;
  Snapshot snapshot;
  for (const double time : {0.0, 1.0, 2.0, 3.0, 1.0}) {
    snapshot.sample.time = time;
    snapshot.sample.probes = {10 * time, -time};
    if (time == 0) snapshot.sample.probes.clear();  // before the first step
    traces.add(snapshot);
  }
  ASSERT_EQ(traces.probes.size(), 2u);
  EXPECT_EQ(traces.probes[0].latest(), 10);
  EXPECT_EQ(traces.probes[1].latest(), -1);
  EXPECT_EQ(traces.probes[0].latest_time(), 1);
}

}  // namespace
}  // namespace hexaplast::view
