// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output/gallery.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hexaplast/mesh/faces.hpp"
#include "hexaplast/mesh/sections.hpp"
#include "output/axis.hpp"
#include "output/lighting.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr Colour kPaper{1, 1, 1};
constexpr Colour kInk{0.13f, 0.13f, 0.15f};
constexpr Colour kFaint{0.45f, 0.46f, 0.48f};
constexpr Colour kOriginal{0.70f, 0.73f, 0.77f};
constexpr Colour kGhost{0.945f, 0.950f, 0.958f};
constexpr Colour kEdge{0.20f, 0.16f, 0.19f};
constexpr Colour kCage{0.25f, 0.30f, 0.38f};
constexpr Colour kSteel{0.16f, 0.36f, 0.55f};

// the page: what lies outside these margins belongs to the title above and the colour bar below [pixels]
constexpr float kMargin = 56, kTop = 92, kBottom = 128;
constexpr float kTitleLine = 52;
constexpr float kBarWidth = 460, kBarHeight = 14, kBarTop = 648;
constexpr float kKeyLine = 25;

// the viewer stands to the right of the body's side and above it
constexpr float kAzimuth = 24 * std::numbers::pi_v<float> / 180;
constexpr float kElevation = 22 * std::numbers::pi_v<float> / 180;

constexpr float kPatch = 12;      // [pixels] size of the flat pieces that a face is drawn with
constexpr int kMostParts = 8;     // of them along an edge
constexpr float kNearer = 4e-3f;  // depth by which marks stand before the surface that they are on

// element edges grow fainter with their length, so that on fine meshes they do not cover the colours [pixels]
constexpr float kShortestEdge = 4, kLongestEdge = 48;
constexpr float kWidestEdge = 1.2f, kCageWidth = 1.1f;
constexpr float kStrongestEdge = 0.75f, kCageOpacity = 0.3f;

constexpr float kDot = 3.2f;                   // [pixels] radius of the mark of a fixed node, at most
constexpr float kRing = 9, kRingWidth = 2.4f;  // [pixels] of the mark of an instrument
constexpr int kCircle = 28;                    // corners of a round mark

/// Brightness of what receives a share of the light: never dark, so that colours stay comparable with the colour bar.
float brightness(float received) { return std::min(1.0f, 0.52f + 0.50f * received); }

Colour operator*(float share, const Colour& colour) {
  return {share * colour.red, share * colour.green, share * colour.blue};
}

/// Towards white by a share, for the gleam of what is moist.
Colour gleaming(const Colour& colour, float share) {
  return {colour.red + share * (1 - colour.red), colour.green + share * (1 - colour.green),
          colour.blue + share * (1 - colour.blue)};
}

float mean_edge(const Surface& surface) {
  float sum = 0;
  for (const auto& [a, b] : surface.edges()) sum += (surface.original()[b] - surface.original()[a]).norm();
  return surface.edges().empty() ? 0 : sum / static_cast<float>(surface.edges().size());
}

std::vector<Surface::Face> faces_of(const Skin& skin) {
  std::vector<Surface::Face> faces = skin.quads;
  for (const auto& [a, b, c] : skin.triangles) faces.push_back({a, b, c, c});
  return faces;
}

Drawing::Vertex on_circle(Drawing::Vertex centre, float radius, int corner) {
  const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(corner) / kCircle;
  centre.x += radius * std::cos(angle);
  centre.y += radius * std::sin(angle);
  return centre;
}

/// The mark of a fixed node.
void draw_dot(Drawing::Vertex centre, float radius, Drawing& picture) {
  centre.colour = kInk;
  for (int k = 0; k < kCircle; ++k)
    picture.triangles.push_back({{centre, on_circle(centre, radius, k), on_circle(centre, radius, k + 1)}});
}

/// The mark of an instrument, with a rim that sets it off from any colour.
void draw_ring(Drawing::Vertex centre, Drawing& picture) {
  for (const auto& [colour, width] : {std::pair{kPaper, kRingWidth + 2.4f}, std::pair{kSteel, kRingWidth}}) {
    centre.colour = colour;
    for (int k = 0; k < kCircle; ++k)
      picture.lines.push_back({on_circle(centre, kRing, k), on_circle(centre, kRing, k + 1), width});
  }
}

std::vector<Vector3f> single(ConstPoints points) {
  std::vector<Vector3f> places;
  places.reserve(points.rows());
  for (Eigen::Index n = 0; n < points.rows(); ++n) places.push_back(points.row(n).transpose().cast<float>());
  return places;
}

}  // namespace

Gallery::Boundary::Boundary(const HexMesh& mesh, std::span<const unsigned char> alive) {
  std::vector<int> point_of_node(mesh.num_nodes(), -1);
  std::vector<Surface::Face> faces = mesh.boundary_faces(alive);
  for (Surface::Face& face : faces)
    for (int& corner : face) {
      int& point = point_of_node[corner];
      if (point < 0) {
        point = static_cast<int>(node_of_point.size());
        node_of_point.push_back(corner);
      }
      corner = point;
    }
  surface = std::make_shared<Surface>(points_at(mesh.positions()), std::move(faces));
}

Gallery::Places Gallery::Boundary::points_at(ConstPoints positions) const {
  Places points;
  points.reserve(node_of_point.size());
  for (const int node : node_of_point) points.push_back(positions.row(node).transpose().cast<float>());
  return points;
}

Gallery::Gallery(const HexMesh& mesh, std::string title, int time_decimals, Staging staging)
    : mesh_(mesh),
      title_(std::move(title)),
      time_decimals_(time_decimals),
      long_axis_(end_sections(mesh).axis),
      staging_(std::move(staging)),
      original_(std::make_shared<Boundary>(mesh, std::span<const unsigned char>())),
      current_(original_) {
  for (const Skin& skin : staging_.skins) {
    std::vector<Surface::Face> faces = output::faces_of(skin);
    auto whole = std::make_shared<Surface>(single(skin.points), faces);
    skins_.push_back({Embedding(mesh.positions(), mesh.hexahedra(), skin.points), std::move(faces), std::move(whole)});
    current_skins_.push_back(skins_.back().whole);
  }
}

void Gallery::add(long step, double time, ConstPoints positions, const std::vector<double>& plastic_strain,
                  std::span<const unsigned char> alive, std::span<const Vec3> instruments) {
  const bool all_alive = std::ranges::all_of(alive, [](unsigned char is_alive) { return is_alive != 0; });
  if (all_alive) {
    current_ = original_;
    for (std::size_t s = 0; s < skins_.size(); ++s) current_skins_[s] = skins_[s].whole;
    current_alive_.clear();
  } else if (!std::ranges::equal(alive, current_alive_)) {
    current_ = std::make_shared<Boundary>(mesh_, alive);
    for (std::size_t s = 0; s < skins_.size(); ++s) {
      const EmbeddedSkin& skin = skins_[s];
      std::vector<Surface::Face> left;
      for (const Surface::Face& face : skin.faces)
        if (std::ranges::all_of(face, [&](int point) { return alive[skin.embedding.hexahedron_of(point)] != 0; }))
          left.push_back(face);
      current_skins_[s] = std::make_shared<Surface>(skin.whole->original(), std::move(left));
    }
    current_alive_.assign(alive.begin(), alive.end());
  }

  State state;
  state.step = step;
  state.time = time;
  PointArray strain = PointArray::Zero(mesh_.num_nodes(), 3);  // in its first column
  strain.col(0) = Eigen::VectorXd::Map(nodal_means(mesh_, plastic_strain, alive).data(), mesh_.num_nodes());
  state.body = {current_->surface, current_->points_at(positions), {}};
  for (const int node : current_->node_of_point) state.body.strain.push_back(static_cast<float>(strain(node, 0)));
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    const Embedding& embedding = skins_[s].embedding;
    PointArray points(embedding.num_points(), 3), values(embedding.num_points(), 3);
    embedding.apply(positions, points);
    embedding.apply(strain, values);
    Shown shown{current_skins_[s], single(points), {}};
    for (Eigen::Index n = 0; n < values.rows(); ++n)
      shown.strain.push_back(std::max(0.0f, static_cast<float>(values(n, 0))));  // outside, weights may be negative
    state.skins.push_back(std::move(shown));
  }

  std::vector<bool> is_outside(mesh_.num_nodes(), false);
  for (const int node : current_->node_of_point) is_outside[node] = true;
  for (const int node : staging_.fixed_nodes)
    if (is_outside[node]) state.fixed.push_back(positions.row(node).transpose().cast<float>());
  for (const Vec3& place : instruments) state.instruments.push_back(place.cast<float>());
  states_.push_back(std::move(state));
}

std::vector<const Gallery::Shown*> Gallery::shown_in(const State& state) const {
  std::vector<const Shown*> shown;
  if (shows_body()) shown.push_back(&state.body);
  for (const Shown& skin : state.skins) shown.push_back(&skin);
  return shown;
}

Drawing::Vertex Gallery::View::project(const Vector3f& point) const {
  const float width = kWidth - 2 * kMargin, height = kHeight - kTop - kBottom;
  return {.x = kMargin + width / 2 + pixels_per_metre * (right.dot(point) - centre.x()),
          .y = kTop + height / 2 - pixels_per_metre * (up.dot(point) - centre.y()),
          .depth = 0.1f + 0.8f * (nearest - towards.dot(point)) / (nearest - farthest),
          .colour = {}};
}

Gallery::View Gallery::fitted_view() const {
  View view;

  // the long axis runs to the right; y stands upright, as in SOFA's scenes, unless it is the long one
  Vector3f upright = Vector3f::Unit(long_axis_ == 1 ? 2 : 1);
  if (staging_.towards) {
    view.towards = staging_.towards->normalized().cast<float>();
    upright = Vector3f::UnitY();
    if (upright.cross(view.towards).norm() < 1e-3f) upright = -Vector3f::UnitZ();  // seen from above
  } else {
    const Vector3f along = Vector3f::Unit(long_axis_), side = along.cross(upright);
    view.towards = std::cos(kElevation) * (std::cos(kAzimuth) * side + std::sin(kAzimuth) * along) +
                   std::sin(kElevation) * upright;
  }
  view.right = upright.cross(view.towards).normalized();
  view.up = view.towards.cross(view.right);

  Eigen::AlignedBox3f seen;
  const auto extend = [&](const Places& points) {
    for (const Vector3f& point : points)
      seen.extend(Vector3f(view.right.dot(point), view.up.dot(point), view.towards.dot(point)));
  };
  if (skins_.empty() || shows_cage()) extend(original_->surface->original());
  for (const EmbeddedSkin& skin : skins_) extend(skin.whole->original());
  for (const State& state : states_) {
    if (skins_.empty() || shows_cage()) extend(state.body.points);
    for (const Shown& skin : state.skins) extend(skin.points);
    extend(state.instruments);
    for (const Shown* shown : shown_in(state))
      for (const float value : shown->strain) view.greatest_strain = std::max(view.greatest_strain, value);
  }

  view.centre = seen.center().head<2>();
  view.pixels_per_metre =
      std::min((kWidth - 2 * kMargin) / seen.sizes().x(), (kHeight - kTop - kBottom) / seen.sizes().y());
  view.nearest = seen.max().z();
  view.farthest = std::min(seen.min().z(), view.nearest - 1e-3f * seen.sizes().norm());  // flat ones have no depth
  return view;
}

Drawing Gallery::drawing(const State& state, const View& view) const {
  Drawing picture{.width = kWidth, .height = kHeight, .background = kPaper, .triangles = {}, .lines = {}, .texts = {}};
  draw_original(view, picture);
  draw_surfaces(state, view, picture);
  draw_edges(state, view, picture);
  draw_marks(state, view, picture);
  draw_keys(picture);

  const auto write = [&](float x, float y, float size, Drawing::Align align, Colour colour, std::string words) {
    picture.texts.push_back(
        {.x = x, .y = y, .size = size, .align = align, .bold = false, .colour = colour, .words = std::move(words)});
  };
  write(kMargin, kTitleLine, 25, Drawing::Align::kLeft, kInk, title_);
  picture.texts.back().bold = true;
  write(kWidth - kMargin, kTitleLine, 25, Drawing::Align::kRight, kInk,
        fmt::format("t = {:.{}f} s", state.time, time_decimals_));

  const float left = (kWidth - kBarWidth) / 2;
  if (view.greatest_strain == 0) {
    write(kWidth / 2, kBarTop + kBarHeight / 2 + 5, 17, Drawing::Align::kCentre, kInk, "no plastic strain in this run");
    return picture;
  }

  // colour bar: every pixel column has its own colour
  for (int column = 0; column < static_cast<int>(kBarWidth); ++column) {
    const Colour colour = colour_of((column + 0.5) / kBarWidth);
    const float x0 = left + column, x1 = x0 + 1, y0 = kBarTop, y1 = kBarTop + kBarHeight;
    const Drawing::Vertex a{x0, y0, 0, colour}, b{x1, y0, 0, colour}, c{x1, y1, 0, colour}, d{x0, y1, 0, colour};
    picture.triangles.push_back({{a, b, c}});
    picture.triangles.push_back({{a, c, d}});
  }
  write(kWidth / 2, kBarTop - 12, 17, Drawing::Align::kCentre, kInk, "plastic strain [–]");
  const Ticks ticks = ticks_within(0, view.greatest_strain, 6);
  for (const double value : ticks.values) {
    const float x = left + kBarWidth * static_cast<float>(value / view.greatest_strain);
    picture.lines.push_back({{x, kBarTop + kBarHeight, 0, kInk}, {x, kBarTop + kBarHeight + 6, 0, kInk}, 1.3f});
    write(x, kBarTop + kBarHeight + 24, 16, Drawing::Align::kCentre, kInk, ticks.label(value));
  }
  return picture;
}

// The original shape is a pale shadow behind everything else, however near it is.
void Gallery::draw_original(const View& view, Drawing& picture) const {
  const auto behind = [&](const Vector3f& point, float nearer, const Colour& colour) {
    Drawing::Vertex vertex = view.project(point);
    vertex.depth = 0.93f + 0.06f * vertex.depth - nearer;
    vertex.colour = colour;
    return vertex;
  };
  const auto draw = [&](const Surface& surface) {
    const Places& points = surface.original();
    for (const auto& [a, b, c, d] : surface.faces()) {
      const Drawing::Vertex corner = behind(points[a], 0, kGhost), opposite = behind(points[c], 0, kGhost);
      picture.triangles.push_back({{corner, behind(points[b], 0, kGhost), opposite}});
      picture.triangles.push_back({{corner, opposite, behind(points[d], 0, kGhost)}});
    }
    for (const auto& [a, b] : surface.outline(points, view.towards))
      picture.lines.push_back({behind(points[a], 1e-4f, kOriginal), behind(points[b], 1e-4f, kOriginal), 1.3f});
  };
  if (skins_.empty()) draw(*original_->surface);
  for (const EmbeddedSkin& skin : skins_) draw(*skin.whole);
}

void Gallery::draw_surfaces(const State& state, const View& view, Drawing& picture) const {
  const std::vector<const Shown*> shown = shown_in(state);
  Places points;
  std::vector<Triangle> triangles;
  for (const Shown* one : shown) {
    const int first = static_cast<int>(points.size());
    points.insert(points.end(), one->points.begin(), one->points.end());
    for (const Surface::Face& face : one->surface->faces()) {
      triangles.push_back({first + face[0], first + face[1], first + face[2]});
      if (!Surface::is_triangle(face)) triangles.push_back({first + face[0], first + face[2], first + face[3]});
    }
  }
  Lighting lighting(view.up, view.towards);
  lighting.place(points, triangles);

  const Vector3f halfway = (0.8f * view.up + 1.42f * view.towards - 0.43f * view.right).normalized();
  const auto lit = [&](const Vector3f& place, Vector3f normal, float strain) {
    if (normal.dot(view.towards) < 0) normal = -normal;
    const float received = lighting.received(place, normal);
    const float gleam = 0.16f * received * std::pow(std::max(0.0f, normal.dot(halfway)), 40.0f);
    const double share = view.greatest_strain > 0 ? strain / view.greatest_strain : 0;
    return gleaming(brightness(received) * colour_of(share), gleam);
  };

  for (const Shown* one : shown) {
    const Surface& surface = *one->surface;
    const std::vector<std::array<Vector3f, 4>> normals = surface.corner_normals(one->points);
    const int across = static_cast<int>(mean_edge(surface) * view.pixels_per_metre / kPatch);
    std::vector<Drawing::Vertex> grid;
    for (std::size_t f = 0; f < surface.faces().size(); ++f) {
      // a warped quad is a bilinear patch: cut finely enough, it shows no preferred diagonal
      const Surface::Face& face = surface.faces()[f];
      const int parts = std::clamp(across, Surface::is_triangle(face) ? 1 : 2, kMostParts);
      grid.resize((parts + 1) * (parts + 1));
      for (int j = 0; j <= parts; ++j)
        for (int i = 0; i <= parts; ++i) {
          const float s = static_cast<float>(i) / parts, t = static_cast<float>(j) / parts;
          const std::array<float, 4> weight{(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
          Vector3f place = Vector3f::Zero(), outwards = Vector3f::Zero();
          float strain = 0;
          for (int k = 0; k < 4; ++k) {
            place += weight[k] * one->points[face[k]];
            outwards += weight[k] * normals[f][k];
            strain += weight[k] * one->strain[face[k]];
          }
          Drawing::Vertex& vertex = grid[j * (parts + 1) + i];
          vertex = view.project(place);
          vertex.colour = lit(place, outwards.normalized(), strain);
        }
      for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i) {
          const Drawing::Vertex* low = &grid[j * (parts + 1) + i];
          const Drawing::Vertex* high = low + parts + 1;
          picture.triangles.push_back({{low[0], low[1], high[1]}});
          picture.triangles.push_back({{low[0], high[1], high[0]}});
        }
    }
  }
}

void Gallery::draw_edges(const State& state, const View& view, Drawing& picture) const {
  if (!staging_.shows_hexahedra) return;
  const Surface& surface = *state.body.surface;
  const float length = mean_edge(surface) * view.pixels_per_metre;
  if (length < kShortestEdge) return;
  const float share = std::min(1.0f, length / kLongestEdge);
  const Colour colour = shows_cage() ? kCage : kEdge;
  const float width = shows_cage() ? kCageWidth : kWidestEdge * std::sqrt(share);
  const float opacity = shows_cage() ? kCageOpacity : kStrongestEdge * share;
  for (const auto& [a, b] : surface.edges()) {
    Drawing::Line line{view.project(state.body.points[a]), view.project(state.body.points[b]), width, opacity};
    line.from.colour = line.to.colour = colour;
    picture.lines.push_back(line);
  }
}

void Gallery::draw_marks(const State& state, const View& view, Drawing& picture) const {
  if (shows_body()) {
    const float radius = std::min(kDot, mean_edge(*state.body.surface) * view.pixels_per_metre / 6);
    for (const Vector3f& place : state.fixed) {
      Drawing::Vertex centre = view.project(place);
      centre.depth -= kNearer;
      draw_dot(centre, radius, picture);
    }
  }
  for (const Vector3f& place : state.instruments) {
    Drawing::Vertex centre = view.project(place);
    centre.depth = 0;  // seen also where it lies within the tissue
    draw_ring(centre, picture);
  }
}

// What the marks mean, one below the other at the lower left.
void Gallery::draw_keys(Drawing& picture) const {
  const auto appears = [&](Places State::*marks) {
    return std::ranges::any_of(states_, [&](const State& state) { return !(state.*marks).empty(); });
  };
  const bool has_dots = shows_body() && appears(&State::fixed), has_rings = appears(&State::instruments);
  float y = kBarTop + kBarHeight / 2 - kKeyLine * static_cast<float>(has_dots + has_rings) / 2;
  const auto name = [&](std::string words) {
    picture.texts.push_back({.x = kMargin + 42,
                             .y = y + 5,
                             .size = 15,
                             .align = Drawing::Align::kLeft,
                             .bold = false,
                             .colour = kFaint,
                             .words = std::move(words)});
    y += kKeyLine;
  };

  picture.lines.push_back({{kMargin, y, 0, kOriginal}, {kMargin + 32, y, 0, kOriginal}, 1.5f});
  name("original shape");
  if (has_dots) {
    draw_dot({kMargin + 16, y, 0, {}}, kDot, picture);
    name("fixed");
  }
  if (has_rings) {
    draw_ring({kMargin + 16, y, 0, {}}, picture);
    name("instrument");
  }
}

}  // namespace hexaplast::output
