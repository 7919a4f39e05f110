// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output/gallery.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "hexaplast/mesh/sections.hpp"
#include "output/axis.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr Colour kPaper{1, 1, 1};
constexpr Colour kInk{0.13f, 0.13f, 0.15f};
constexpr Colour kFaint{0.45f, 0.46f, 0.48f};
constexpr Colour kOriginal{0.66f, 0.69f, 0.73f};
constexpr Colour kEdge{0.20f, 0.16f, 0.19f};

// the page: what lies outside these margins belongs to the title above and the colour bar below [pixels]
constexpr float kMargin = 56, kTop = 92, kBottom = 128;
constexpr float kTitleLine = 52;
constexpr float kBarWidth = 460, kBarHeight = 14, kBarTop = 648;

// the viewer stands to the right of the body's side and above it
constexpr float kAzimuth = 24 * std::numbers::pi_v<float> / 180;
constexpr float kElevation = 22 * std::numbers::pi_v<float> / 180;

constexpr float kBackground = 0.98f;  // depth behind every body
constexpr float kCrease = 0.75f;      // cosine of the angle from which an edge is sharp, about 41 degrees
constexpr float kWidestEdge = 1.4f;   // [pixels]
constexpr float kPatch = 12;          // [pixels] size of the flat pieces that a face is drawn with
constexpr int kMostParts = 8;         // of them along an edge
constexpr float kShortestEdge = 4;    // [pixels] below this, element edges would cover the colours

/// Brightness of a surface whose unit normal is `normal` in the camera's frame (right, up, towards): mostly even light,
/// so that colours stay comparable with the colour bar, one lamp from the upper left, and some from the viewer's place.
float brightness(Vector3f normal) {
  static const Vector3f lamp = Vector3f(-0.35f, 0.85f, 0.45f).normalized();
  if (normal.z() < 0) normal = -normal;
  return std::min(1.0f, 0.66f + 0.22f * std::max(0.0f, normal.dot(lamp)) + 0.16f * normal.z());
}

Colour operator*(float share, const Colour& colour) {
  return {share * colour.red, share * colour.green, share * colour.blue};
}

}  // namespace

Gallery::Surface::Surface(const HexMesh& mesh, std::span<const unsigned char> alive) {
  std::vector<int> point_of_node(mesh.num_nodes(), -1);
  for (const std::array<int, 4>& nodes : mesh.boundary_faces(alive)) {
    std::array<int, 4> face;
    for (int k = 0; k < 4; ++k) {
      int& point = point_of_node[nodes[k]];
      if (point < 0) {
        point = static_cast<int>(node_of_point.size());
        node_of_point.push_back(nodes[k]);
      }
      face[k] = point;
    }
    faces.push_back(face);

    // the one hexahedron left that has all four nodes
    for (const HexMesh::Incidence& at : mesh.incident(nodes[0])) {
      const Hexahedron& corners = mesh.hexahedra()[at.element];
      if (!alive.empty() && !alive[at.element]) continue;
      if (std::ranges::all_of(nodes, [&](int node) { return std::ranges::find(corners, node) != corners.end(); })) {
        element_of_face.push_back(at.element);
        break;
      }
    }
  }

  faces_of_point.resize(node_of_point.size());
  std::map<std::array<int, 2>, std::vector<int>> faces_of_edge;
  for (int f = 0; f < static_cast<int>(faces.size()); ++f)
    for (int k = 0; k < 4; ++k) {
      faces_of_point[faces[f][k]].push_back(f);
      const auto [low, high] = std::minmax(faces[f][k], faces[f][(k + 1) % 4]);
      faces_of_edge[{low, high}].push_back(f);
    }

  original = points_at(mesh.positions());
  const std::vector<Vector3f> normals = face_normals(original);
  for (const auto& [edge, around] : faces_of_edge) {
    edges.push_back(edge);
    const Vector3f first = normals[around.front()].normalized(), last = normals[around.back()].normalized();
    if (around.size() != 2 || first.dot(last) < kCrease) creases.push_back(edge);
  }
}

std::vector<Vector3f> Gallery::Surface::points_at(ConstPoints positions) const {
  std::vector<Vector3f> points;
  points.reserve(node_of_point.size());
  for (const int node : node_of_point) points.push_back(positions.row(node).transpose().cast<float>());
  return points;
}

std::vector<Vector3f> Gallery::Surface::face_normals(const std::vector<Vector3f>& points) const {
  std::vector<Vector3f> normals;
  normals.reserve(faces.size());
  for (const auto& [a, b, c, d] : faces) normals.push_back((points[c] - points[a]).cross(points[d] - points[b]));
  return normals;
}

Gallery::Gallery(const HexMesh& mesh, std::string title, int time_decimals)
    : mesh_(mesh),
      title_(std::move(title)),
      time_decimals_(time_decimals),
      long_axis_(end_sections(mesh).axis),
      original_(std::make_shared<Surface>(mesh, std::span<const unsigned char>())),
      current_(original_) {}

void Gallery::add(long step, double time, ConstPoints positions, const std::vector<double>& plastic_strain,
                  std::span<const unsigned char> alive) {
  const bool all_alive = std::ranges::all_of(alive, [](unsigned char is_alive) { return is_alive != 0; });
  if (all_alive) {
    current_ = original_;
    current_alive_.clear();
  } else if (!std::ranges::equal(alive, current_alive_)) {
    current_ = std::make_shared<Surface>(mesh_, alive);
    current_alive_.assign(alive.begin(), alive.end());
  }

  State state{
      .step = step, .time = time, .surface = current_, .points = current_->points_at(positions), .plastic_strain = {}};
  for (const int element : current_->element_of_face)
    state.plastic_strain.push_back(static_cast<float>(plastic_strain[element]));
  states_.push_back(std::move(state));
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
  const Vector3f along = Vector3f::Unit(long_axis_), upright = Vector3f::Unit(long_axis_ == 1 ? 2 : 1);
  const Vector3f side = along.cross(upright);
  view.towards =
      std::cos(kElevation) * (std::cos(kAzimuth) * side + std::sin(kAzimuth) * along) + std::sin(kElevation) * upright;
  view.right = upright.cross(view.towards).normalized();
  view.up = view.towards.cross(view.right);

  Eigen::AlignedBox3f seen;
  const auto extend = [&](const std::vector<Vector3f>& points) {
    for (const Vector3f& point : points)
      seen.extend(Vector3f(view.right.dot(point), view.up.dot(point), view.towards.dot(point)));
  };
  extend(original_->original);
  for (const State& state : states_) {
    extend(state.points);
    for (const float strain : state.plastic_strain) view.greatest_strain = std::max(view.greatest_strain, strain);
  }

  view.centre = seen.center().head<2>();
  view.pixels_per_metre =
      std::min((kWidth - 2 * kMargin) / seen.sizes().x(), (kHeight - kTop - kBottom) / seen.sizes().y());
  view.nearest = seen.max().z();
  view.farthest = seen.min().z();
  return view;
}

Drawing Gallery::drawing(const State& state, const View& view) const {
  Drawing picture{.width = kWidth, .height = kHeight, .background = kPaper, .triangles = {}, .lines = {}, .texts = {}};
  draw_original(view, picture);
  draw_body(state, view, picture);

  const auto write = [&](float x, float y, float size, Drawing::Align align, Colour colour, std::string words) {
    picture.texts.push_back(
        {.x = x, .y = y, .size = size, .align = align, .bold = false, .colour = colour, .words = std::move(words)});
  };
  write(kMargin, kTitleLine, 25, Drawing::Align::kLeft, kInk, title_);
  picture.texts.back().bold = true;
  write(kWidth - kMargin, kTitleLine, 25, Drawing::Align::kRight, kInk,
        fmt::format("t = {:.{}f} s", state.time, time_decimals_));

  // key of the grey outline
  const auto line = [&](float x0, float y0, float x1, float y1, float width, Colour colour) {
    picture.lines.push_back({{x0, y0, 0, colour}, {x1, y1, 0, colour}, width});
  };
  const float key = kBarTop + kBarHeight / 2;
  line(kMargin, key, kMargin + 32, key, 1.5f, kOriginal);
  write(kMargin + 42, key + 5, 15, Drawing::Align::kLeft, kFaint, "original shape");

  const float left = (kWidth - kBarWidth) / 2;
  if (view.greatest_strain == 0) {
    write(kWidth / 2, key + 5, 17, Drawing::Align::kCentre, kInk, "no plastic strain in this run");
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
    line(x, kBarTop + kBarHeight, x, kBarTop + kBarHeight + 6, 1.3f, kInk);
    write(x, kBarTop + kBarHeight + 24, 16, Drawing::Align::kCentre, kInk, ticks.label(value));
  }
  return picture;
}

void Gallery::draw_original(const View& view, Drawing& picture) const {
  for (const auto& [a, b] : original_->creases) {
    Drawing::Line line{view.project(original_->original[a]), view.project(original_->original[b]), 1.5f};
    line.from.colour = line.to.colour = kOriginal;
    line.from.depth = line.to.depth = kBackground;
    picture.lines.push_back(line);
  }
}

void Gallery::draw_body(const State& state, const View& view, Drawing& picture) const {
  const Surface& surface = *state.surface;
  const std::vector<Vector3f> normals = surface.face_normals(state.points);
  const auto lit = [&](const Vector3f& normal, const Colour& colour) {
    const Vector3f n = normal.normalized();
    return brightness({view.right.dot(n), view.up.dot(n), view.towards.dot(n)}) * colour;
  };
  // smooth over gentle bends, sharp at creases: the mean normal of the faces around that look about the same way
  const auto smooth_normal = [&](int face, int point) {
    const Vector3f own = normals[face].normalized();
    Vector3f sum = Vector3f::Zero();
    for (const int other : surface.faces_of_point[point])
      if (normals[other].normalized().dot(own) >= kCrease) sum += normals[other];
    return sum;
  };

  if (surface.edges.empty()) return;
  float mean_length = 0;  // of an edge [pixels]
  for (const auto& [a, b] : surface.edges)
    mean_length += view.pixels_per_metre * (surface.original[b] - surface.original[a]).norm();
  mean_length /= static_cast<float>(surface.edges.size());

  // a warped face is a bilinear patch: cut finely enough, it shows no preferred diagonal
  const int parts = std::clamp(static_cast<int>(mean_length / kPatch), 2, kMostParts);
  std::vector<Drawing::Vertex> grid((parts + 1) * (parts + 1));
  for (int f = 0; f < static_cast<int>(surface.faces.size()); ++f) {
    const double share = view.greatest_strain > 0 ? state.plastic_strain[f] / view.greatest_strain : 0;
    const Colour colour = colour_of(share);
    const std::array<int, 4>& face = surface.faces[f];
    std::array<Vector3f, 4> normal;
    for (int k = 0; k < 4; ++k) normal[k] = smooth_normal(f, face[k]).normalized();

    for (int j = 0; j <= parts; ++j)
      for (int i = 0; i <= parts; ++i) {
        const float s = static_cast<float>(i) / parts, t = static_cast<float>(j) / parts;
        const std::array<float, 4> weight{(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
        Vector3f place = Vector3f::Zero(), outwards = Vector3f::Zero();
        for (int k = 0; k < 4; ++k) {
          place += weight[k] * state.points[face[k]];
          outwards += weight[k] * normal[k];
        }
        Drawing::Vertex& vertex = grid[j * (parts + 1) + i];
        vertex = view.project(place);
        vertex.colour = lit(outwards, colour);
      }
    for (int j = 0; j < parts; ++j)
      for (int i = 0; i < parts; ++i) {
        const Drawing::Vertex* low = &grid[j * (parts + 1) + i];
        const Drawing::Vertex* high = low + parts + 1;
        picture.triangles.push_back({{low[0], low[1], high[1]}});
        picture.triangles.push_back({{low[0], high[1], high[0]}});
      }
  }

  if (mean_length < kShortestEdge) return;
  for (const auto& [a, b] : surface.edges) {
    Drawing::Line line{view.project(state.points[a]), view.project(state.points[b]),
                       std::min(kWidestEdge, mean_length / 12)};
    line.from.colour = line.to.colour = kEdge;
    picture.lines.push_back(line);
  }
}

}  // namespace hexaplast::output
