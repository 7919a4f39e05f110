// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output/gallery.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hexaplast/mesh/faces.hpp"
#include "hexaplast/mesh/sections.hpp"
#include "output/lighting.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr Colour kCage{0.25f, 0.30f, 0.38f};

constexpr float kPatch = 12;             // size on the page of the flat pieces that a face is drawn with
constexpr int kMostParts = 8;            // of them along an edge
constexpr int kCutParts = 4;             // of a hexahedron along each direction, for its cut
constexpr float kNearer = 4e-3f;         // depth by which marks stand before the surface that they are on
constexpr float kOutlineNearer = 1e-4f;  // the same of the outline of what stands behind

// element edges grow fainter with their length on the page, so that on fine meshes they do not cover the colours
constexpr float kShortestEdge = 4, kLongestEdge = 48;
constexpr float kWidestEdge = 1.2f, kCageWidth = 1.1f, kWireWidth = 1.5f, kCutWidth = 1.6f;
constexpr float kStrongestEdge = 0.75f, kCageOpacity = 0.3f;

constexpr float kDot = 3.2f;  // radius of the mark of a fixed node, at most

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

/// A place with its colour, not yet on the page.
struct Corner {
  Vector3f place;
  Colour colour;
};

Corner operator*(float share, const Corner& corner) { return {share * corner.place, share * corner.colour}; }
Corner operator+(const Corner& a, const Corner& b) {
  return {a.place + b.place,
          {a.colour.red + b.colour.red, a.colour.green + b.colour.green, a.colour.blue + b.colour.blue}};
}

double height(const Plane& plane, const Vector3f& place) { return plane.height(place.cast<double>()); }

/// Weights of a quad's corners at a place in it.
std::array<float, 4> weights_at(float s, float t) { return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t}; }

bool straddles(const Plane& plane, const std::vector<Vector3f>& points, const Surface::Face& face) {
  const auto is_above = [&](int point) { return height(plane, points[point]) >= 0; };
  return std::ranges::any_of(face, is_above) && !std::ranges::all_of(face, is_above);
}

/// Hands out the parts of a triangle that lie above all planes.
template <class Take>
void for_each_part(const std::array<Corner, 3>& triangle, std::span<const Plane> above, const Take& take) {
  if (above.empty()) {
    take(triangle);
    return;
  }
  const Plane& plane = above.front();
  std::array<TriangleShares, 4> part;
  const int count = part_above(
      {height(plane, triangle[0].place), height(plane, triangle[1].place), height(plane, triangle[2].place)}, part);
  const auto corner = [&](int k) {
    const auto share = [&](int c) { return static_cast<float>(part[k][c]); };
    return share(0) * triangle[0] + share(1) * triangle[1] + share(2) * triangle[2];
  };
  for (int k = 2; k < count; ++k) for_each_part({corner(0), corner(k - 1), corner(k)}, above.subspan(1), take);
}

/// Draws what lies in front of the camera, and in what is left of a body that is cut.
class Pen {
 public:
  Pen(const Camera& camera, std::vector<Plane> above, Drawing& picture)
      : camera_(camera), above_(std::move(above)), picture_(picture) {}

  void fill(const std::array<Corner, 3>& triangle) const {
    for_each_part(triangle, above_, [&](const std::array<Corner, 3>& part) {
      picture_.triangles.push_back({{vertex(part[0]), vertex(part[1]), vertex(part[2])}});
    });
  }

  void line(Corner from, Corner to, float width, float opacity) const {
    for (const Plane& plane : above_) {
      const double at_from = height(plane, from.place), at_to = height(plane, to.place);
      if (at_from < 0 && at_to < 0) return;
      if (at_from >= 0 && at_to >= 0) continue;
      const auto share = static_cast<float>(at_from / (at_from - at_to));
      (at_from < 0 ? from : to) = (1 - share) * from + share * to;
    }
    picture_.lines.push_back({vertex(from), vertex(to), width, opacity});
    if (!is_behind_) return;
    for (Drawing::Vertex* end : {&picture_.lines.back().from, &picture_.lines.back().to}) end->depth -= kOutlineNearer;
  }

  /// Whether a place is seen at all.
  bool reaches(const Vector3f& place) const {
    return std::ranges::all_of(above_, [&](const Plane& plane) { return height(plane, place) >= 0; });
  }

  /// From now on: behind everything that is drawn otherwise.
  void step_back() { is_behind_ = true; }

 private:
  Drawing::Vertex vertex(const Corner& corner) const {
    Drawing::Vertex vertex = camera_.project(corner.place);
    if (is_behind_) vertex.depth = 0.93f + 0.06f * vertex.depth;
    vertex.colour = corner.colour;
    return vertex;
  }

  const Camera& camera_;
  std::vector<Plane> above_;
  Drawing& picture_;
  bool is_behind_ = false;
};

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
      staging_(std::move(staging)),
      viewpoint_(staging_.viewpoint.value_or(beside(end_sections(mesh).axis))),
      original_(std::make_shared<Boundary>(mesh, std::span<const unsigned char>())),
      current_(original_) {
  for (const Skin& skin : staging_.skins) {
    std::vector<Surface::Face> faces = output::faces_of(skin);
    auto whole = std::make_shared<Surface>(single(skin.points), faces);
    skins_.push_back({Embedding(mesh.positions(), mesh.hexahedra(), skin.points), std::move(faces), std::move(whole)});
    current_skins_.push_back(skins_.back().whole);
  }
  if (staging_.cut) {
    // what is left lies above
    Plane& cut = *staging_.cut;
    const double viewer = viewpoint_.eye ? cut.height(viewpoint_.eye->position) : cut.normal.dot(viewpoint_.towards);
    if (viewer > 0) cut = {-cut.normal, -cut.offset};
  }
}

// What is left from now on.
void Gallery::follow(std::span<const unsigned char> alive) {
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
}

void Gallery::add(long step, double time, ConstPoints positions, const std::vector<double>& values,
                  std::span<const unsigned char> alive, std::span<const Vec3> instruments, const PointArray* ghost) {
  follow(alive);
  State state;
  state.step = step;
  state.time = time;
  PointArray at_nodes = PointArray::Zero(mesh_.num_nodes(), 3);  // in its first column
  at_nodes.col(0) = Eigen::VectorXd::Map(
      (entry_of(staging_.quantity).of_nodes ? values : nodal_means(mesh_, values, alive)).data(), mesh_.num_nodes());
  state.body = {current_->surface, current_->points_at(positions), {}};
  for (const int node : current_->node_of_point) state.body.values.push_back(static_cast<float>(at_nodes(node, 0)));
  // a skin that reaches out of the hexahedra continues their values, and shall not pass them
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (const float value : state.body.values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    const Embedding& embedding = skins_[s].embedding;
    PointArray points(embedding.num_points(), 3), blended(embedding.num_points(), 3);
    embedding.apply(positions, points);
    embedding.apply(at_nodes, blended);
    Shown shown{current_skins_[s], single(points), {}};
    for (Eigen::Index n = 0; n < blended.rows(); ++n) {
      const auto value = static_cast<float>(blended(n, 0));
      shown.values.push_back(std::isfinite(value) && least <= most ? std::clamp(value, least, most) : value);
    }
    state.skins.push_back(std::move(shown));
  }
  if (!staging_.ghost.empty()) state.ghosts = ghosts_at(ghost);
  if (staging_.cut && shows_body()) state.cut = cut_face(positions, at_nodes, alive);

  std::vector<bool> is_outside(mesh_.num_nodes(), false);
  for (const int node : current_->node_of_point) is_outside[node] = true;
  for (const int node : staging_.fixed_nodes)
    if (is_outside[node]) state.fixed.push_back(positions.row(node).transpose().cast<float>());
  for (const Vec3& place : instruments) state.instruments.push_back(place.cast<float>());
  states_.push_back(std::move(state));
}

std::vector<Gallery::Shown> Gallery::ghosts_at(const PointArray* nodes) const {
  std::vector<Shown> ghosts;
  if (skins_.empty() && nodes) ghosts.push_back({current_->surface, current_->points_at(*nodes), {}});
  if (skins_.empty() && !nodes) ghosts.push_back({original_->surface, original_->surface->original(), {}});
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    if (!nodes) {
      ghosts.push_back({skins_[s].whole, skins_[s].whole->original(), {}});
      continue;
    }
    PointArray points(skins_[s].embedding.num_points(), 3);
    skins_[s].embedding.apply(*nodes, points);
    ghosts.push_back({current_skins_[s], single(points), {}});
  }
  return ghosts;
}

Gallery::CutFace Gallery::cut_face(ConstPoints positions, const PointArray& values,
                                   std::span<const unsigned char> alive) const {
  const PlaneCut cut(positions, mesh_.hexahedra(), *staging_.cut, alive, kCutParts);
  PointArray points(cut.num_points(), 3), blended(cut.num_points(), 3);
  cut.apply(positions, points);
  cut.apply(values, blended);
  CutFace face{single(points), {}, cut.triangles(), cut.inner_lines(), cut.outline()};
  for (Eigen::Index n = 0; n < blended.rows(); ++n) face.values.push_back(static_cast<float>(blended(n, 0)));
  return face;
}

std::vector<const Gallery::Shown*> Gallery::shown_in(const State& state) const {
  std::vector<const Shown*> shown;
  if (shows_body()) shown.push_back(&state.body);
  for (const Shown& skin : state.skins) shown.push_back(&skin);
  return shown;
}

// What is drawn lies above these.
std::vector<Plane> Gallery::sides(const Camera& camera) const {
  std::vector<Plane> above;
  if (camera.front()) above.push_back(*camera.front());
  if (staging_.cut) above.push_back(*staging_.cut);
  return above;
}

void Gallery::fit(Camera& camera, Scale& scale) const {
  for (const State& state : states_) {
    if (skins_.empty() || shows_cage()) camera.see(state.body.points);
    for (const Shown& skin : state.skins) camera.see(skin.points);
    for (const Shown& ghost : state.ghosts) camera.see(ghost.points);
    camera.see(state.instruments);
    for (const Shown* shown : shown_in(state)) scale.see(shown->values);
    scale.see(state.cut.values);
  }
  if (skins_.empty() || shows_cage()) camera.see(original_->surface->original());
  camera.fit(Page(staging_.width, staging_.height).window());
}

Drawing Gallery::drawing(const State& state, const Camera& camera, const Scale& scale) const {
  Page page(staging_.width, staging_.height);
  Drawing& picture = page.drawing();
  draw_ghosts(state, camera, picture);
  if (staging_.is_wireframe) {
    draw_wires(state, camera, scale, picture);
  } else {
    draw_surfaces(state, camera, scale, picture);
    draw_edges(state, camera, picture);
  }
  draw_marks(state, camera, page);
  page.add_title(title_, fmt::format("t = {:.{}f} s", state.time, time_decimals_));
  page.add_colour_bar(scale);
  page.add_keys(keys(scale));
  return std::move(page).finished();
}

// The ghost is a pale shadow behind everything else, however near it is.
void Gallery::draw_ghosts(const State& state, const Camera& camera, Drawing& picture) const {
  std::vector<Plane> in_front;
  if (camera.front()) in_front.push_back(*camera.front());
  Pen pen(camera, std::move(in_front), picture);
  pen.step_back();
  for (const Shown& ghost : state.ghosts) {
    const Places& points = ghost.points;
    for (const auto& [a, b, c, d] : ghost.surface->faces()) {
      pen.fill({{{points[a], kGhost}, {points[b], kGhost}, {points[c], kGhost}}});
      pen.fill({{{points[a], kGhost}, {points[c], kGhost}, {points[d], kGhost}}});
    }
    for (const auto& [a, b] : ghost.surface->outline(points, camera.towards()))
      pen.line({points[a], kOriginal}, {points[b], kOriginal}, 1.3f, 1);
  }
}

void Gallery::draw_surfaces(const State& state, const Camera& camera, const Scale& scale, Drawing& picture) const {
  const std::vector<const Shown*> shown = shown_in(state);
  const std::vector<Plane> above = sides(camera);
  const Pen pen(camera, above, picture);

  // light is kept off by what is left alone
  Places points;
  std::vector<Triangle> triangles;
  const auto keep = [&](const std::array<Corner, 3>& part) {
    const int first = static_cast<int>(points.size());
    for (const Corner& corner : part) points.push_back(corner.place);
    triangles.push_back({first, first + 1, first + 2});
  };
  const auto place_above = [&](const Vector3f& a, const Vector3f& b, const Vector3f& c) {
    for_each_part({{{a, {}}, {b, {}}, {c, {}}}}, above, keep);
  };
  for (const Shown* one : shown)
    for (const auto& [a, b, c, d] : one->surface->faces()) {
      place_above(one->points[a], one->points[b], one->points[c]);
      if (c != d) place_above(one->points[a], one->points[c], one->points[d]);
    }
  for (const auto& [a, b, c] : state.cut.triangles)
    keep({{{state.cut.points[a], {}}, {state.cut.points[b], {}}, {state.cut.points[c], {}}}});
  Lighting lighting(camera.up(), camera.towards());
  lighting.place(points, triangles);

  const Vector3f halfway = (0.8f * camera.up() + 1.42f * camera.towards() - 0.43f * camera.right()).normalized();
  const auto lit = [&](const Vector3f& at, Vector3f normal, float value) {
    if (normal.dot(camera.towards()) < 0) normal = -normal;
    const float received = lighting.received(at, normal);
    const float gleam = 0.16f * received * std::pow(std::max(0.0f, normal.dot(halfway)), 40.0f);
    return gleaming(brightness(received) * scale.colour(value), gleam);
  };

  for (const Shown* one : shown) {
    const Surface& surface = *one->surface;
    const std::vector<std::array<Vector3f, 4>> normals = surface.corner_normals(one->points);
    const int across = static_cast<int>(mean_edge(surface) * camera.scale() / kPatch);
    std::vector<Corner> grid;
    for (std::size_t f = 0; f < surface.faces().size(); ++f) {
      const Surface::Face& face = surface.faces()[f];
      const auto at = [&](const std::array<float, 4>& weight) {
        Vector3f place = Vector3f::Zero(), outwards = Vector3f::Zero();
        float value = 0;
        for (int k = 0; k < 4; ++k) {
          place += weight[k] * one->points[face[k]];
          outwards += weight[k] * normals[f][k];
          value += weight[k] * one->values[face[k]];
        }
        return Corner{place, lit(place, outwards.normalized(), value)};
      };
      // a warped quad is a bilinear patch: cut finely enough, it shows no preferred diagonal
      const bool meets_cut = staging_.cut && !Surface::is_triangle(face) && straddles(*staging_.cut, one->points, face);
      const int parts = meets_cut ? kCutParts : std::clamp(across, Surface::is_triangle(face) ? 1 : 2, kMostParts);
      grid.resize((parts + 1) * (parts + 1));
      for (int j = 0; j <= parts; ++j)
        for (int i = 0; i <= parts; ++i)
          grid[j * (parts + 1) + i] = at(weights_at(static_cast<float>(i) / parts, static_cast<float>(j) / parts));
      for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i) {
          const Corner* low = &grid[j * (parts + 1) + i];
          const Corner* high = low + parts + 1;
          if (meets_cut) {
            // as the cut face sees it, so that the two meet
            const Corner middle = 0.25f * low[0] + 0.25f * low[1] + 0.25f * high[0] + 0.25f * high[1];
            pen.fill({{low[0], low[1], middle}});
            pen.fill({{low[1], high[1], middle}});
            pen.fill({{high[1], high[0], middle}});
            pen.fill({{high[0], low[0], middle}});
            continue;
          }
          pen.fill({{low[0], low[1], high[1]}});
          pen.fill({{low[0], high[1], high[0]}});
        }
    }
  }

  if (state.cut.triangles.empty()) return;
  // nothing is left above the cut face in the viewer's direction
  const Pen on_cut(camera, camera.front() ? std::vector{*camera.front()} : std::vector<Plane>(), picture);
  const Vector3f normal = -staging_.cut->normal.cast<float>();
  std::vector<Corner> corners;
  for (std::size_t n = 0; n < state.cut.points.size(); ++n)
    corners.push_back({state.cut.points[n], lit(state.cut.points[n], normal, state.cut.values[n])});
  for (const auto& [a, b, c] : state.cut.triangles) on_cut.fill({{corners[a], corners[b], corners[c]}});
}

void Gallery::draw_edges(const State& state, const Camera& camera, Drawing& picture) const {
  if (!staging_.shows_hexahedra || !staging_.shows_edges) return;
  const Surface& surface = *state.body.surface;
  const float length = mean_edge(surface) * camera.scale();
  if (length < kShortestEdge) return;
  const float share = std::min(1.0f, length / kLongestEdge);
  const Colour colour = shows_cage() ? kCage : kEdge;
  const float width = shows_cage() ? kCageWidth : kWidestEdge * std::sqrt(share);
  const float opacity = shows_cage() ? kCageOpacity : kStrongestEdge * share;
  const Pen pen(camera, sides(camera), picture);
  for (const auto& [a, b] : surface.edges())
    pen.line({state.body.points[a], colour}, {state.body.points[b], colour}, width, opacity);

  const Pen on_cut(camera, camera.front() ? std::vector{*camera.front()} : std::vector<Plane>(), picture);
  const Places& points = state.cut.points;
  for (const auto& [a, b] : state.cut.inner_lines)
    on_cut.line({points[a], colour}, {points[b], colour}, width, opacity);
  for (const auto& [a, b] : state.cut.outline) on_cut.line({points[a], kEdge}, {points[b], kEdge}, kCutWidth, 1);
}

void Gallery::draw_wires(const State& state, const Camera& camera, const Scale& scale, Drawing& picture) const {
  const Pen pen(camera, sides(camera), picture);
  std::vector<const Shown*> shown;
  if (staging_.shows_hexahedra) shown.push_back(&state.body);
  for (const Shown& skin : state.skins) shown.push_back(&skin);
  for (const Shown* one : shown)
    for (const auto& [a, b] : one->surface->edges())
      pen.line({one->points[a], scale.colour(one->values[a])}, {one->points[b], scale.colour(one->values[b])},
               kWireWidth, 1);
}

void Gallery::draw_marks(const State& state, const Camera& camera, Page& page) const {
  const Pen pen(camera, sides(camera), page.drawing());
  if (shows_body()) {
    const float radius = std::min(kDot, mean_edge(*state.body.surface) * camera.scale() / 6);
    for (const Vector3f& place : state.fixed) {
      if (!pen.reaches(place)) continue;
      Drawing::Vertex centre = camera.project(place);
      centre.depth -= kNearer;
      page.add_dot(centre, radius);
    }
  }
  for (const Vector3f& place : state.instruments) {
    if (camera.front() && height(*camera.front(), place) < 0) continue;
    Drawing::Vertex centre = camera.project(place);
    centre.depth = 0;  // seen also where it lies within the tissue
    page.add_ring(centre);
  }
}

// What the marks mean.
std::vector<Key> Gallery::keys(const Scale& scale) const {
  const auto appears = [&](Places State::*marks) {
    return std::ranges::any_of(states_, [&](const State& state) { return !(state.*marks).empty(); });
  };
  std::vector<Key> keys;
  if (!staging_.ghost.empty()) keys.push_back({Key::Mark::kLine, staging_.ghost});
  if (shows_body() && appears(&State::fixed)) keys.push_back({Key::Mark::kDot, "fixed"});
  if (appears(&State::instruments)) keys.push_back({Key::Mark::kRing, "instrument"});
  if (scale.has_gaps()) keys.push_back({Key::Mark::kGap, fmt::format("no {}", scale.quantity().label)});
  return keys;
}

}  // namespace hexaplast::output
