// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/figure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "picture/arrow.hpp"
#include "picture/ink.hpp"
#include "picture/picture_cut.hpp"

namespace hexaplast::view {
namespace {

using Eigen::Vector3f;
using output::Surface;

std::vector<Vector3f> single(ConstPoints points) {
  std::vector<Vector3f> places;
  places.reserve(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index n = 0; n < points.rows(); ++n) places.push_back(points.row(n).transpose().cast<float>());
  return places;
}

std::vector<Surface::Face> faces_of(const output::EmbeddedSurface& embedded) {
  std::vector<Surface::Face> faces = embedded.quads;
  for (const auto& [a, b, c] : embedded.triangles) faces.push_back({a, b, c, c});
  return faces;
}

std::vector<Surface::Face> faces_of(const std::vector<Triangle>& triangles) {
  std::vector<Surface::Face> faces;
  for (const auto& [a, b, c] : triangles) faces.push_back({a, b, c, c});
  return faces;
}

void extend(Eigen::AlignedBox3d& box, ConstPoints points) {
  box.extend(points.colwise().minCoeff().transpose());
  box.extend(points.colwise().maxCoeff().transpose());
}

}  // namespace

Figure::Figure(const HexMesh& mesh, output::Staging staging) : mesh_(mesh), staging_(std::move(staging)) {
  body_.original = mesh.positions();
  for (const output::EmbeddedSurface& embedded : staging_.embedded_surfaces) {
    Sheet& sheet = embedded_surfaces_.emplace_back();
    sheet.embedding.emplace(mesh.positions(), mesh.hexahedra(), embedded.points);
    sheet.original = embedded.points;
    sheet.faces = faces_of(embedded);
  }
  leave(std::vector<unsigned char>(static_cast<std::size_t>(mesh.num_elements()), 1));
}

void Figure::leave(std::span<const unsigned char> alive) {
  alive_.assign(alive.begin(), alive.end());
  body_.faces = mesh_.boundary_faces(alive_);
  body_.surface = std::make_unique<Surface>(single(body_.original), body_.faces);
  for (Sheet& embedded : embedded_surfaces_) {
    std::vector<Face> left;
    for (const Face& face : embedded.faces)
      if (std::ranges::all_of(face, [&](int point) { return alive_[embedded.embedding->hexahedron_of(point)] != 0; }))
        left.push_back(face);
    embedded.surface = std::make_unique<Surface>(single(embedded.original), std::move(left));
  }
}

void Figure::place(Sheet& sheet, ConstPoints nodes) const {
  sheet.points.resize(sheet.original.rows(), 3);
  if (sheet.embedding)
    sheet.embedding->apply(nodes, sheet.points);
  else
    sheet.points = nodes;
}

void Figure::update(const Snapshot& snapshot, const Look& look, const Strongest& strongest) {
  if (!std::ranges::equal(alive_, snapshot.alive)) leave(snapshot.alive);
  triangles_.clear();
  edges_.clear();
  ghost_triangles_.clear();
  ghosts_.clear();
  fixed_places_.clear();
  range_.setEmpty();
  cut_ = look.cut;
  cut_triangles_.clear();
  cut_edges_.clear();
  cut_outline_.clear();
  shows_embedded_surfaces_ = look.shows_embedded_surfaces && has_embedded_surfaces() && !cut_;

  if (look.ghost != Ghost::kNone) {
    const ConstPoints nodes = look.ghost == Ghost::kInitial ? mesh_.positions() : snapshot.plastic_rest;
    if (!shows_embedded_surfaces_) draw_ghost(body_, nodes);
    for (Sheet& embedded : embedded_surfaces_)
      if (shows_embedded_surfaces_) draw_ghost(embedded, nodes);
  }

  place(body_, snapshot.positions);
  for (Sheet& embedded : embedded_surfaces_) place(embedded, snapshot.positions);
  if (!shows_embedded_surfaces_) draw(body_, snapshot.values);
  for (const Sheet& embedded : embedded_surfaces_)
    if (shows_embedded_surfaces_) draw(embedded, snapshot.values);

  const Places nodes = single(snapshot.positions);
  if (look.shows_edges)
    for (const auto& [a, b] : body_.surface->edges()) edges_.insert(edges_.end(), {nodes[a], nodes[b]});
  if ((look.shows_edges || !shows_embedded_surfaces_) && !snapshot.conditions.fixed.empty()) {
    std::vector<unsigned char> is_shown(nodes.size(), 0);
    for (const Face& face : body_.faces)
      for (const int node : face) is_shown[node] = snapshot.conditions.fixed[node];
    for (std::size_t node = 0; node < nodes.size(); ++node)
      if (is_shown[node] && (!cut_ || cut_->height(nodes[node].cast<double>()) <= 0))
        fixed_places_.push_back(nodes[node]);
  }
  taut_springs_.clear();
  slack_springs_.clear();
  for (const auto& [from, to, is_slack] : snapshot.conditions.springs) {
    Places& lines = is_slack ? slack_springs_ : taut_springs_;
    lines.insert(lines.end(), {from.cast<float>(), to.cast<float>()});
  }
  if (cut_) draw_cut(snapshot.positions, snapshot.values, look.shows_edges);
  draw_tools(look.shows_instruments ? snapshot.conditions.instruments : std::vector<output::Instrument>());
  load_arrows_.clear();
  tool_arrows_.clear();
  tool_forces_.clear();
  if (look.shows_instruments) draw_forces(snapshot, strongest);

  // with the original, so that the depths of two moments differ little
  box_.setEmpty();
  extend(box_, mesh_.positions());
  extend(box_, snapshot.positions);
  extend(box_, snapshot.plastic_rest);
}

// Every quad is drawn as four triangles around its middle, so that a warped one shows no preferred diagonal.
void Figure::draw(const Sheet& sheet, std::span<const double> nodal_values) {
  PointArray at_nodes = PointArray::Zero(mesh_.num_nodes(), 3), values = at_nodes;  // in their first column
  const bool has_values = std::ranges::all_of(nodal_values, [](double value) { return std::isfinite(value); });
  if (has_values) at_nodes.col(0) = Eigen::VectorXd::Map(nodal_values.data(), mesh_.num_nodes());
  if (sheet.embedding) {
    values.resize(sheet.embedding->num_points(), 3);
    sheet.embedding->apply(at_nodes, values);
  } else {
    values = at_nodes;
  }

  const Places points = single(sheet.points);
  const std::vector<std::array<Vector3f, 4>> normals = sheet.surface->corner_normals(points);
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const Face& face = sheet.surface->faces()[f];
    std::array<Vertex, 4> corner;
    Vertex middle{Vector3f::Zero(), Vector3f::Zero(), 0};
    for (int k = 0; k < 4; ++k) {
      corner[k] = {points[face[k]], normals[f][k], static_cast<float>(values(face[k], 0))};
      middle.place += corner[k].place / 4;
      middle.normal += corner[k].normal;
      middle.value += corner[k].value / 4;
      if (has_values) range_.extend(Eigen::Matrix<double, 1, 1>(values(face[k], 0)));
    }
    if (Surface::is_triangle(face)) {
      triangles_.insert(triangles_.end(), {corner[0], corner[1], corner[2]});
      continue;
    }
    middle.normal.normalize();
    for (int k = 0; k < 4; ++k) triangles_.insert(triangles_.end(), {corner[k], corner[(k + 1) % 4], middle});
  }
}

void Figure::draw_cut(ConstPoints positions, std::span<const double> nodal_values, bool shows_edges) {
  const PlaneCut cut = output::picture_cut(mesh_, positions, *cut_, alive_);
  PointArray at_nodes = PointArray::Zero(mesh_.num_nodes(), 3), values(cut.num_points(), 3);  // in their first column
  if (std::ranges::all_of(nodal_values, [](double value) { return std::isfinite(value); }))
    at_nodes.col(0) = Eigen::VectorXd::Map(nodal_values.data(), mesh_.num_nodes());
  cut_points_.resize(cut.num_points(), 3);
  cut.apply(positions, cut_points_);
  cut.apply(at_nodes, values);
  cut_faces_ = cut.triangles();

  const Places points = single(cut_points_);
  const Vector3f normal = cut_->normal.cast<float>();
  for (const Triangle& face : cut_faces_)
    for (const int point : face)
      cut_triangles_.push_back({points[point], normal, static_cast<float>(values(point, 0))});
  for (const auto& [a, b] : cut.outline()) cut_outline_.insert(cut_outline_.end(), {points[a], points[b]});
  if (!shows_edges) return;
  for (const auto& [a, b] : cut.inner_lines()) cut_edges_.insert(cut_edges_.end(), {points[a], points[b]});
}

void Figure::draw_tools(const std::vector<output::Instrument>& instruments) {
  tool_triangles_.clear();
  shown_tools_.clear();
  rings_.clear();
  for (const output::Instrument& instrument : instruments) {
    if (instrument.shape_triangles.empty()) {
      rings_.push_back(instrument.place);
      continue;
    }
    const Places points = single(instrument.shape_points);
    Tool& tool = tools_[instrument.id];
    if (tool.triangles != instrument.shape_triangles || tool.surface->original().size() != points.size())
      tool = {instrument.shape_triangles, std::make_unique<Surface>(points, faces_of(instrument.shape_triangles))};
    const std::vector<std::array<Vector3f, 4>> normals = tool.surface->corner_normals(points);
    for (std::size_t f = 0; f < normals.size(); ++f)
      for (int k = 0; k < 3; ++k) tool_triangles_.push_back({points[tool.triangles[f][k]], normals[f][k], 0});
    shown_tools_.push_back({tool.surface.get(), points});
  }
}

void Figure::draw_ghost(Sheet& sheet, ConstPoints nodes) {
  place(sheet, nodes);
  const Places points = single(sheet.points);
  for (const auto& [a, b, c, d] : sheet.surface->faces())
    ghost_triangles_.insert(ghost_triangles_.end(), {points[a], points[b], points[c], points[a], points[c], points[d]});
  ghosts_.push_back({sheet.surface.get(), points});
}

std::vector<Vector3f> Figure::outline(const std::vector<Shape>& shapes, const Vec3& towards) {
  Places lines;
  for (const Shape& shape : shapes)
    for (const auto& [a, b] : shape.surface->outline(shape.points, towards.cast<float>()))
      lines.insert(lines.end(), {shape.points[a], shape.points[b]});
  return lines;
}

void Figure::draw_forces(const Snapshot& snapshot, const Strongest& strongest) {
  const PointArray& original = mesh_.positions();
  const auto longest = output::kLongestArrow *
                       static_cast<float>((original.colwise().maxCoeff() - original.colwise().minCoeff()).norm());
  const float girth = output::kArrowGirth * longest;
  const auto add = [](std::vector<Vertex>& vertices, const output::Arrow& arrow) {
    for (const output::Arrow::Face& face : arrow.faces())
      for (const auto& [place, normal] : face) vertices.push_back({place, normal});
  };
  const auto single_precision = [](const Vec3& vector) -> Vector3f { return vector.cast<float>(); };

  if (strongest.load > 0) {
    const output::ArrowScale scale{longest, static_cast<float>(strongest.load), girth};
    const std::vector<Vector3f> outwards = body_.surface->point_normals(single(snapshot.positions));
    for (const auto& [node, force] : output::shown_loads(mesh_, snapshot.alive, snapshot.conditions))
      add(load_arrows_, scale.of_load(single_precision(snapshot.positions.row(node)), single_precision(force),
                                      outwards[static_cast<std::size_t>(node)]));
  }
  if (!(strongest.tool > 0)) return;
  const output::ArrowScale scale{longest, static_cast<float>(strongest.tool), girth};
  for (const output::Instrument& instrument : snapshot.conditions.instruments) {
    const Vec3 force = instrument.force();
    if (!(force.norm() > 0)) continue;
    const output::Arrow arrow =
        scale.of_tool(single_precision(instrument.acts_at(snapshot.positions)), single_precision(force));
    add(tool_arrows_, arrow);
    tool_forces_.push_back({arrow.to.cast<double>(), force.norm()});
  }
}

std::optional<Figure::Seen> Figure::hit(const Ray& ray) const {
  if (cut_) return hit_below(*cut_, ray);
  if (!shows_embedded_surfaces_) return hit(body_, ray);
  std::optional<Seen> first;
  for (const Sheet& embedded : embedded_surfaces_)
    if (const std::optional<Seen> found = hit(embedded, ray); found && (!first || found->distance < first->distance))
      first = found;
  return first;
}

std::optional<Figure::Seen> Figure::hit_below(const Plane& cut, const Ray& ray) const {
  // from the plane on, where the viewer stands above it
  const double height = cut.height(ray.origin), fall = -cut.normal.dot(ray.direction);
  if (height > 0 && fall <= 0) return std::nullopt;
  Ray below = ray;
  if (height > 0) below.origin += height / fall * ray.direction;
  const std::optional<Hit> face = first_hit(ray, cut_points_, std::span<const Triangle>(cut_faces_));
  std::optional<Seen> seen = hit(body_, below);
  if (seen) seen->distance = (seen->place - ray.origin).norm();
  if (!face || (seen && seen->distance < face->distance)) return seen;
  Seen in_plane{.place = face->place, .outwards = cut.normal, .distance = face->distance};
  in_plane.hexahedron = nearest_hexahedron(face->place);
  return in_plane;
}

/// By the middles of those that are left.
int Figure::nearest_hexahedron(const Vec3& place) const {
  int nearest = 0;
  double min = std::numeric_limits<double>::infinity();
  for (int e = 0; e < mesh_.num_elements(); ++e) {
    if (!alive_[static_cast<std::size_t>(e)]) continue;
    Vec3 middle = Vec3::Zero();
    for (const int node : mesh_.hexahedra()[static_cast<std::size_t>(e)])
      middle += body_.points.row(node).transpose() / kCorners;
    if (const double distance = (middle - place).squaredNorm(); distance < min) {
      min = distance;
      nearest = e;
    }
  }
  return nearest;
}

std::optional<Figure::Seen> Figure::hit(const Sheet& sheet, const Ray& ray) const {
  const std::optional<Hit> met = first_hit(ray, sheet.points, sheet.surface->faces());
  if (!met) return std::nullopt;
  const Face& face = sheet.surface->faces()[static_cast<std::size_t>(met->face)];
  const auto corner = [&](int k) { return Vec3(sheet.points.row(face[k]).transpose()); };
  const Vec3 normal =
      (corner(2) - corner(0)).cross(corner(3) == corner(2) ? Vec3(corner(2) - corner(1)) : Vec3(corner(3) - corner(1)));
  Seen seen{.place = met->place, .outwards = -ray.direction.normalized(), .distance = met->distance};
  if (normal.norm() > 0) seen.outwards = (normal.dot(ray.direction) > 0 ? -1 : 1) * normal.normalized();
  seen.hexahedron = hexahedron_at(sheet, face);
  return seen;
}

int Figure::hexahedron_at(const Sheet& sheet, const Face& face) const {
  if (sheet.embedding) return sheet.embedding->hexahedron_of(face[0]);
  for (int e = 0; e < mesh_.num_elements(); ++e) {
    const Hexahedron& corners = mesh_.hexahedra()[static_cast<std::size_t>(e)];
    const auto has = [&](int node) { return std::ranges::find(corners, node) != corners.end(); };
    if (alive_[static_cast<std::size_t>(e)] && std::ranges::all_of(face, has)) return e;
  }
  return 0;
}

}  // namespace hexaplast::view
