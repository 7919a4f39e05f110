// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/figure.hpp"

#include <algorithm>
#include <limits>

#include "picture/ink.hpp"

namespace hexaplast::view {
namespace {

using output::Moment;
using output::Surface;

void extend(Eigen::AlignedBox3d& box, ConstPoints points) {
  box.extend(points.colwise().minCoeff().transpose());
  box.extend(points.colwise().maxCoeff().transpose());
}

/// What pictures show that look so.
void stage(const Look& look, output::Staging& staging) {
  staging.cut = look.cut;
  staging.shown_regions = look.regions;
  staging.shows_surfaces = look.shows_embedded_surfaces;
  staging.shows_hexahedra = look.shows_edges || !staging.has_surfaces();
  staging.shows_edges = look.shows_edges;
  staging.shows_loads = look.shows_instruments;
  staging.ghost = look.ghost == Ghost::kNone ? "" : look.ghost == Ghost::kInitial ? "initial shape" : "rest shape";
}

}  // namespace

output::BoundaryConditions Look::conditions(const Snapshot& snapshot) const {
  if (shows_instruments) return snapshot.conditions;
  output::BoundaryConditions shown;
  shown.springs = snapshot.conditions.springs;
  return shown;
}

const PointArray* Look::ghost_nodes(const Snapshot& snapshot) const {
  return ghost == Ghost::kPlasticRest ? &snapshot.plastic_rest : nullptr;
}

void Figure::update(const Snapshot& snapshot, const Look& look, const output::Strongest& strongest) {
  stage(look, shapes_.staging);
  shapes_.staging.quantity = snapshot.quantity;
  moment_ = shapes_.at(snapshot.positions, snapshot.values, snapshot.alive, look.conditions(snapshot),
                       look.ghost_nodes(snapshot), snapshot.open);
  const float longest = shapes_.longest_arrow();
  strongest_ = {strongest.load, strongest.tool, longest, output::kArrowGirth * longest};
  nodes_ = snapshot.positions;
  alive_ = snapshot.alive;

  // with the original, so that the depths of two moments differ little
  box_.setEmpty();
  extend(box_, shapes_.mesh().positions());
  extend(box_, snapshot.positions);
  extend(box_, snapshot.plastic_rest);
}

output::View Figure::view(const Camera& camera, const output::Scale& scale) const {
  // instruments hide each other and the body as far as they are near: what lies farther off shall not flatten the rest
  Eigen::AlignedBox3d box = box_;
  for (const Moment::Tool& tool : moment_.tools)
    for (const Eigen::Vector3f& point : tool.points) box.extend(point.cast<double>());
  const Vec3 margin = Vec3::Constant(box_.diagonal().norm());
  const output::Camera seen = camera.fitted_to(box.clamp({box_.min() - margin, box_.max() + margin}));
  return {shapes_.geometry(moment_, seen, strongest_),
          seen,
          camera.width(),
          camera.height(),
          scale.min(),
          scale.max(),
          0,
          scale.palette()};
}

std::vector<Figure::Force> Figure::tool_forces() const {
  std::vector<Force> forces;
  for (const Moment::Tool& tool : moment_.tools)
    if (const std::optional<output::Arrow> arrow = strongest_.arrow_of(tool))
      forces.push_back({arrow->to.cast<double>(), tool.force.norm()});
  return forces;
}

std::vector<Vec3> Figure::rings() const {
  std::vector<Vec3> places;
  for (const Moment::Tool& tool : moment_.tools)
    if (!tool.surface) places.push_back(tool.place.cast<double>());
  return places;
}

void Figure::see_values(output::Scale& scale) const {
  for (const Moment::Shown* shown : moment_.filled(shapes_.staging)) scale.see(shown->values);
}

std::optional<Figure::Seen> Figure::hit(const Ray& ray) const {
  const output::Staging& staging = shapes_.staging;
  if (staging.cut) return hit_below(*staging.cut, ray);
  return hit_surfaces(ray);
}

std::optional<Figure::Seen> Figure::hit_surfaces(const Ray& ray) const {
  const output::Staging& staging = shapes_.staging;
  if (!staging.has_surfaces()) return hit_body(ray);
  std::optional<Seen> first;
  for (std::size_t s = 0; s < staging.embedded_surfaces.size(); ++s) {
    const auto& [original, embedding, whole, current] = shapes_.embedded_surfaces()[s];
    PointArray points(embedding.num_points(), 3);
    embedding.apply(nodes_, points);
    std::optional<Seen> found = hit(*current, points, ray);
    if (!found || (first && found->distance >= first->distance)) continue;
    const int point = current->faces()[static_cast<std::size_t>(found->hexahedron)][0];
    found->hexahedron = staging.embedded_surfaces[s].first_hexahedron + embedding.hexahedron_of(point);
    first = found;
  }
  return first;
}

std::optional<Figure::Seen> Figure::hit_body(const Ray& ray) const {
  const output::Shapes::Boundary& boundary = shapes_.current();
  std::optional<Seen> seen = hit(*boundary.surface, boundary.points_at(nodes_), ray);
  if (!seen) return seen;
  Surface::Face nodes = boundary.surface->faces()[static_cast<std::size_t>(seen->hexahedron)];
  for (int& corner : nodes) corner = boundary.node_of_point[static_cast<std::size_t>(corner)];
  seen->hexahedron = hexahedron_at(nodes);
  return seen;
}

std::optional<Figure::Seen> Figure::hit_below(const Plane& cut, const Ray& ray) const {
  // from the plane on, where the viewer stands above it
  const double height = cut.height(ray.origin), fall = -cut.normal.dot(ray.direction);
  if (height > 0 && fall <= 0) return std::nullopt;
  Ray below = ray;
  if (height > 0) below.origin += height / fall * ray.direction;
  PointArray points(std::ssize(moment_.cut.points), 3);
  for (Eigen::Index p = 0; p < points.rows(); ++p)
    points.row(p) = moment_.cut.points[static_cast<std::size_t>(p)].transpose().cast<double>();
  const std::optional<Hit> face = first_hit(ray, points, std::span<const Triangle>(moment_.cut.triangles));
  std::optional<Seen> seen = hit_surfaces(below);
  if (seen) seen->distance = (seen->place - ray.origin).norm();
  if (!face || (seen && seen->distance < face->distance)) return seen;
  if (shapes_.staging.has_surfaces() && !(seen && seen->is_back)) return seen;  // the plane is met outside them
  return Seen{face->place, cut.normal, face->distance, nearest_hexahedron(face->place)};
}

/// By the middles of those that are left.
int Figure::nearest_hexahedron(const Vec3& place) const {
  const HexMesh& mesh = shapes_.mesh();
  int nearest = 0;
  double min = std::numeric_limits<double>::infinity();
  for (int e = 0; e < mesh.num_elements(); ++e) {
    if (!alive_[static_cast<std::size_t>(e)]) continue;
    Vec3 middle = Vec3::Zero();
    for (const int node : mesh.hexahedra()[static_cast<std::size_t>(e)])
      middle += nodes_.row(node).transpose() / kCorners;
    if (const double distance = (middle - place).squaredNorm(); distance < min) {
      min = distance;
      nearest = e;
    }
  }
  return nearest;
}

/// With the number of the face that is met in place of its hexahedron.
std::optional<Figure::Seen> Figure::hit(const Surface& surface, ConstPoints points, const Ray& ray) const {
  const std::optional<Hit> met = first_hit(ray, points, surface.faces());
  if (!met) return std::nullopt;
  const Surface::Face& face = surface.faces()[static_cast<std::size_t>(met->face)];
  const auto corner = [&](int k) { return Vec3(points.row(face[k]).transpose()); };
  const Vec3 normal =
      (corner(2) - corner(0)).cross(corner(3) == corner(2) ? Vec3(corner(2) - corner(1)) : Vec3(corner(3) - corner(1)));
  Seen seen{met->place, -ray.direction.normalized(), met->distance, met->face};
  seen.is_back = normal.dot(ray.direction) > 0;
  if (normal.norm() > 0) seen.outwards = (seen.is_back ? -1 : 1) * normal.normalized();
  return seen;
}

int Figure::hexahedron_at(const Surface::Face& face) const {
  const HexMesh& mesh = shapes_.mesh();
  for (int e = 0; e < mesh.num_elements(); ++e) {
    const Hexahedron& corners = mesh.hexahedra()[static_cast<std::size_t>(e)];
    const auto has = [&](int node) { return std::ranges::find(corners, node) != corners.end(); };
    if (alive_[static_cast<std::size_t>(e)] && std::ranges::all_of(face, has)) return e;
  }
  return 0;
}

}  // namespace hexaplast::view
