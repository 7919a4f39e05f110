// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "hexaplast/geometry/sections.hpp"
#include "mesh/neighbours.hpp"
#include "picture/ink.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector3f;

constexpr float kPatch = 24;  // size on the page of the pieces of a face, at whose corners and middles light is found
constexpr int kMaxParts = 6;  // of them along an edge

std::vector<Surface::Face> faces_of(const std::vector<Triangle>& triangles) {
  std::vector<Surface::Face> faces;
  for (const auto& [a, b, c] : triangles) faces.push_back({a, b, c, c});
  return faces;
}

float diagonal(ConstPoints points) {
  return static_cast<float>((points.colwise().maxCoeff() - points.colwise().minCoeff()).norm());
}

PointArray applied(const Embedding& embedding, ConstPoints nodes) {
  PointArray points(embedding.num_points(), 3);
  embedding.apply(nodes, points);
  return points;
}

/// Weights of a quad's corners at a place in it.
std::array<float, 4> weights_at(float s, float t) { return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t}; }

/// None where no open face parts nodes.
std::optional<CutWalls> walls_of(const HexMesh& mesh, const OpenFaces* open, std::span<const unsigned char> alive) {
  std::optional<CutWalls> walls;
  if (open) walls.emplace(mesh, *open, alive);
  if (walls && walls->empty()) walls.reset();
  return walls;
}

void add_lines(const std::vector<Edge>& edges, const Moment::Places& points, Geometry::Places& lines) {
  for (const auto& [a, b] : edges) lines.insert(lines.end(), {points[a], points[b]});
}

/// Where a plane crosses triangles.
void add_crossing(const Geometry::Vertices& triangles, const Plane& plane, Geometry::Places& lines) {
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3)
    for (int k = 0; k < 3; ++k) {
      const Vector3f &a = triangles[t + k].place, &b = triangles[t + (k + 1) % 3].place;
      const double from = plane.height(a.cast<double>()), to = plane.height(b.cast<double>());
      if ((from > 0) != (to > 0)) lines.push_back(a + static_cast<float>(from / (from - to)) * (b - a));
    }
}

}  // namespace

Vec3 Staging::upright() const {
  if (up) return *up;
  if (!gravity.isZero(0)) return -gravity.normalized();
  return is_anatomical ? Vec3::UnitZ() : Vec3::UnitY();
}

Viewpoint Staging::seen_from(const HexMesh& mesh) const {
  Viewpoint view = viewpoint.value_or(beside(end_sections(mesh).axis, upright()));
  if (up || !view.up) view.up = upright();
  return view;
}

std::vector<int> Staging::parts() const {
  return shown_regions.empty() && shows_numbers() ? regions.numbers() : shown_regions;
}

std::vector<const Moment::Shown*> Moment::filled(const Staging& staging) const {
  if (parts.empty()) return whole(staging);
  std::vector<const Shown*> shown;
  for (const Shown& part : parts) shown.push_back(&part);
  return shown;
}

std::vector<const Moment::Shown*> Moment::whole(const Staging& staging) const {
  std::vector<const Shown*> shown;
  if (staging.shows_body()) shown.push_back(&body);
  for (const Shown& embedded : embedded_surfaces) shown.push_back(&embedded);
  return shown;
}

std::optional<Arrow> Strongest::arrow_of(const Moment::Load& one) const {
  if (!(load > 0)) return std::nullopt;
  const Vector3f along = arrow / load * one.force;
  const bool presses = one.outwards.dot(one.force) < -kArrowPresses * one.outwards.norm() * one.force.norm();
  return Arrow{presses ? Vector3f(one.place - along) : one.place, presses ? one.place : Vector3f(one.place + along),
               girth};
}

std::optional<Arrow> Strongest::arrow_of(const Moment::Tool& one) const {
  if (!(tool > 0) || one.force.isZero(0)) return std::nullopt;
  return Arrow{one.place, one.place + arrow / tool * one.force, girth};
}

Shapes::Boundary::Boundary(const HexMesh& mesh, std::span<const unsigned char> alive, const CutWalls* walls_of_cuts) {
  std::vector<int> point_of_node(static_cast<std::size_t>(mesh.num_nodes()), -1);
  std::vector<Surface::Face> faces;
  std::vector<unsigned char> is_wall;
  for (const auto& [nodes, element] : boundary_of(mesh, alive)) {
    Surface::Face& face = faces.emplace_back(nodes);
    for (int& corner : face) {
      int& point = point_of_node[corner];
      if (point < 0) {
        point = static_cast<int>(node_of_point.size());
        node_of_point.push_back(corner);
      }
      corner = point;
    }
    if (walls_of_cuts) is_wall.push_back(walls_of_cuts->is_wall(element, nodes) ? 1 : 0);
  }
  if (walls_of_cuts) {
    WallVertices vertices = wall_vertices(*walls_of_cuts);
    std::vector<int> rows, hexahedra;
    for (std::size_t k = 0; k < vertices.node.size(); ++k)
      if (const int point = point_of_node[static_cast<std::size_t>(vertices.node[k])]; point >= 0) {
        wall_points.push_back(point);
        rows.push_back(static_cast<int>(k));
        hexahedra.push_back(vertices.hexahedron[k]);
      }
    walls.emplace(mesh.positions(), mesh.hexahedra(), PointArray(vertices.points(rows, Eigen::all)), hexahedra);
  }
  surface = std::make_shared<Surface>(single(points_at(mesh.positions())), std::move(faces), std::move(is_wall));
}

PointArray Shapes::Boundary::points_at(ConstPoints nodes) const {
  PointArray points = nodes(node_of_point, Eigen::all);
  if (walls) points(wall_points, Eigen::all) = applied(*walls, nodes);
  return points;
}

Shapes::Shapes(const HexMesh& mesh, Staging staging_of_all)
    : staging(std::move(staging_of_all)),
      mesh_(mesh),
      longest_arrow_(kLongestArrow * diagonal(mesh.positions())),
      original_hexahedra_(mesh.hexahedra()),
      current_hexahedra_(mesh.hexahedra()),
      original_(std::make_shared<Boundary>(mesh, std::span<const unsigned char>())),
      current_(original_) {
  for (const EmbeddedSurface& embedded : staging.embedded_surfaces) {
    std::vector<Surface::Face> faces = embedded.quads;
    std::ranges::copy(faces_of(embedded.triangles), std::back_inserter(faces));
    const auto whole = std::make_shared<Surface>(single(embedded.points), std::move(faces));
    const Embedding embedding = embedded.embedding(mesh);
    embedded_surfaces_.push_back({embedding, embedding, whole, whole});
  }
}

// What is left from now on.
void Shapes::follow(std::span<const unsigned char> alive, const std::shared_ptr<const OpenFaces>& open) {
  const bool all_alive = std::ranges::all_of(alive, [](unsigned char is_alive) { return is_alive != 0; });
  const bool has_split = mesh_.hexahedra() != current_hexahedra_,
             has_opened = open && current_open_ ? *open != *current_open_ : open != current_open_;
  if (has_split) {
    current_hexahedra_ = mesh_.hexahedra();
    for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s)
      embedded_surfaces_[s].original.follow(staging.embedded_surfaces[s].carriers(mesh_), mesh_.num_nodes());
  }
  if (!open && all_alive && current_hexahedra_ == original_hexahedra_) {
    current_ = original_;
    for (Carried& embedded : embedded_surfaces_) {
      embedded.embedding = embedded.original;
      embedded.current = embedded.whole;
    }
    current_alive_.clear();
  } else if (has_split || has_opened || !std::ranges::equal(alive, current_alive_)) {
    const std::optional<CutWalls> walls = walls_of(mesh_, open.get(), alive);
    current_ = std::make_shared<Boundary>(mesh_, alive, walls ? &*walls : nullptr);
    carry(alive, walls ? &*walls : nullptr);
    current_alive_.assign(alive.begin(), alive.end());
  }
  current_open_ = open;
  divide(alive);
}

// What is left of the embedded surfaces.
void Shapes::carry(std::span<const unsigned char> alive, const CutWalls* walls) {
  for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
    Carried& embedded = embedded_surfaces_[s];
    const EmbeddedSurface& carried = staging.embedded_surfaces[s];
    const CarriedSurface surface = carried.cut(mesh_, embedded.original, embedded.whole->faces(), walls);
    embedded.embedding = walls ? carried.embedding(mesh_, surface) : embedded.original;
    std::vector<Surface::Face> left;
    std::vector<unsigned char> is_wall;
    for (std::size_t f = 0; f < surface.faces.size(); ++f)
      if (is_carried(surface.faces[f], carried, embedded.embedding, alive)) {
        left.push_back(surface.faces[f]);
        is_wall.push_back(surface.is_wall[f]);
      }
    embedded.current = std::make_shared<Surface>(single(surface.points), std::move(left), std::move(is_wall));
  }
}

// Into what is shown by itself.
void Shapes::divide(std::span<const unsigned char> alive) {
  const std::vector<int> numbers = staging.parts();
  if (parts_of_ == current_ && std::ranges::equal(numbers, parts_, {}, {}, &Part::number)) return;
  parts_of_ = current_;
  parts_.clear();
  if (numbers.empty()) return;
  const std::optional<CutWalls> walls = walls_of(mesh_, current_open_.get(), alive);
  for (const int number : numbers) {
    Part& part = parts_.emplace_back(
        Part{number, {mesh_, staging.regions.alive_in(number, alive), walls ? &*walls : nullptr}, {}});
    if (!staging.shown_regions.empty()) continue;
    for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
      const auto& [original, embedding, whole, current] = embedded_surfaces_[s];
      std::vector<Surface::Face> carried;
      std::vector<unsigned char> is_wall;
      for (std::size_t f = 0; f < current->faces().size(); ++f) {
        const Surface::Face& face = current->faces()[f];
        const int hexahedron = staging.embedded_surfaces[s].first_hexahedron + embedding.hexahedron_of(face[0]);
        if (staging.regions.of_hexahedra[static_cast<std::size_t>(hexahedron)] != number) continue;
        carried.push_back(face);
        is_wall.push_back(current->is_wall(f) ? 1 : 0);
      }
      part.embedded_surfaces.push_back(
          std::make_shared<Surface>(current->original(), std::move(carried), std::move(is_wall)));
    }
  }
}

void Shapes::add_parts(ConstPoints positions, std::span<const double> values, Moment& moment) const {
  for (const Part& part : parts_) {
    const auto add = [&](const std::shared_ptr<const Surface>& surface, Moment::Places points,
                         std::vector<float> own_values) {
      if (staging.shows_numbers()) own_values.assign(points.size(), static_cast<float>(part.number));
      moment.parts.push_back({surface, std::move(points), std::move(own_values)});
    };
    if (staging.has_surfaces() && staging.shown_regions.empty()) {
      for (std::size_t s = 0; s < part.embedded_surfaces.size(); ++s)
        add(part.embedded_surfaces[s], moment.embedded_surfaces[s].points, {});
      continue;
    }
    std::vector<float> of_points;
    for (const int node : part.hexahedra.node_of_point)
      of_points.push_back(static_cast<float>(values[static_cast<std::size_t>(node)]));
    add(part.hexahedra.surface, single(part.hexahedra.points_at(positions)), std::move(of_points));
  }
}

Moment Shapes::at(ConstPoints positions, std::span<const double> values, std::span<const unsigned char> alive,
                  const BoundaryConditions& conditions, const PointArray* ghost,
                  const std::shared_ptr<const OpenFaces>& open) {
  follow(alive, open);
  Moment moment;
  PointArray at_nodes = PointArray::Zero(mesh_.num_nodes(), 3);  // in its first column
  at_nodes.col(0) = Eigen::VectorXd::Map(values.data(), mesh_.num_nodes());
  moment.body = {current_->surface, single(current_->points_at(positions)), {}};
  for (const int node : current_->node_of_point) moment.body.values.push_back(static_cast<float>(at_nodes(node, 0)));
  // an embedded surface that reaches out of the hexahedra continues their values, and shall not pass them
  float min = std::numeric_limits<float>::infinity(), max = -min;
  for (const float value : moment.body.values) {
    if (!std::isfinite(value)) continue;
    min = std::min(min, value);
    max = std::max(max, value);
  }
  if (staging.has_surfaces())
    for (const Carried& embedded : embedded_surfaces_) {
      Moment::Shown shown{embedded.current, single(applied(embedded.embedding, positions)), {}};
      const PointArray blended = applied(embedded.embedding, at_nodes);
      for (Eigen::Index n = 0; n < blended.rows(); ++n) {
        const auto value = static_cast<float>(blended(n, 0));
        shown.values.push_back(std::isfinite(value) && min <= max ? std::clamp(value, min, max) : value);
      }
      moment.embedded_surfaces.push_back(std::move(shown));
    }
  add_parts(positions, values, moment);
  if (staging.shows_ghost()) moment.ghosts = ghosts_at(ghost);
  if (staging.cut)
    moment.cut = parts_.empty() ? cut_face(mesh_, positions, at_nodes, *staging.cut, alive)
                                : cut_face(mesh_, positions, at_nodes, *staging.cut, alive, staging.regions,
                                           staging.parts(), staging.shows_numbers());

  if (staging.shows_hexahedra && !conditions.fixed.empty())
    for (const int node : current_->node_of_point)
      if (conditions.fixed[static_cast<std::size_t>(node)])
        moment.fixed.push_back(positions.row(node).transpose().cast<float>());
  if (staging.shows_loads) moment.loads = loads_of(conditions, positions, alive);
  for (const Instrument& instrument : conditions.instruments) moment.tools.push_back(tool_of(instrument, positions));
  moment.springs = conditions.springs;
  return moment;
}

Moment::Tool Shapes::tool_of(const Instrument& instrument, ConstPoints positions) {
  Moment::Tool tool{instrument.acts_at(positions).cast<float>(), instrument.force().cast<float>(), nullptr,
                    single(instrument.shape_points)};
  if (instrument.shape_triangles.empty()) return tool;

  std::vector<Surface::Face> faces = faces_of(instrument.shape_triangles);
  std::shared_ptr<const Surface>& latest = tools_[instrument.id];
  if (!latest || latest->faces() != faces || latest->original().size() != tool.points.size())
    latest = std::make_shared<Surface>(tool.points, std::move(faces));
  tool.surface = latest;
  return tool;
}

std::vector<Moment::Load> Shapes::loads_of(const BoundaryConditions& conditions, ConstPoints positions,
                                           std::span<const unsigned char> alive) const {
  std::vector<Moment::Load> loads;
  if (conditions.loads.rows() == 0) return loads;
  Moment::Places outwards(static_cast<std::size_t>(mesh_.num_nodes()), Vector3f::Zero());
  const Moment::Places normals = current_->surface->point_normals(single(current_->points_at(positions)));
  for (std::size_t p = 0; p < normals.size(); ++p) outwards[current_->node_of_point[p]] = normals[p];
  for (const auto& [node, force] : shown_loads(mesh_, alive, conditions))
    loads.push_back({positions.row(node).transpose().cast<float>(), force.cast<float>(), outwards[node]});
  return loads;
}

std::vector<Moment::Shown> Shapes::ghosts_at(const PointArray* nodes) const {
  std::vector<Moment::Shown> ghosts;
  if (!staging.has_surfaces()) {
    const Boundary& shown = nodes ? *current_ : *original_;
    ghosts.push_back({shown.surface, nodes ? single(shown.points_at(*nodes)) : shown.surface->original(), {}});
    return ghosts;
  }
  for (const auto& [original, embedding, whole, current] : embedded_surfaces_)
    if (nodes)
      ghosts.push_back({current, single(applied(embedding, *nodes)), {}});
    else
      ghosts.push_back({whole, whole->original(), {}});
  return ghosts;
}

Geometry Shapes::geometry(const Moment& moment, const Camera& camera, const Strongest& strongest) const {
  Geometry geometry;
  geometry.cut = staging.cut;
  const auto is_left = [&](const Vector3f& place) {
    return !staging.cut || staging.cut->height(place.cast<double>()) <= 0;
  };
  for (const Moment::Shown& ghost : moment.ghosts) {
    for (const auto& [a, b, c, d] : ghost.surface->faces())
      for (const int point : {a, b, c, a, c, d}) geometry.ghost.push_back(ghost.points[point]);
    add_lines(ghost.surface->outline(ghost.points, camera.towards()), ghost.points, geometry.ghost_outline);
  }

  const Surface& hexahedra = *moment.body.surface;
  geometry.edge_length = hexahedra.mean_edge();
  const bool is_within = !staging.shown_regions.empty();
  geometry.is_cage = staging.has_surfaces() && !is_within;
  for (const Moment::Shown* one : moment.filled(staging)) {
    draw_surface(*one, camera.scale(), geometry.surface, geometry.walls);
    if (is_within && staging.shows_edges) add_lines(one->surface->edges(), one->points, geometry.edges);
  }
  for (const Moment::Shown* one : moment.whole(staging)) {
    if (is_within) draw_surface(*one, camera.scale(), geometry.veil, geometry.veil);
    if (!moment.ghosts.empty())
      add_lines(one->surface->outline(one->points, camera.towards()), one->points, geometry.halo);
    geometry.is_closed = geometry.is_closed && one->surface->is_closed();
  }
  geometry.is_hollow = geometry.is_cage;
  const Vector3f above = staging.cut ? Vector3f(staging.cut->normal.cast<float>()) : Vector3f(0, 0, 0);
  for (const Triangle& triangle : moment.cut.triangles)
    for (const int point : triangle)
      geometry.cut_faces.add({{moment.cut.points[point], above, moment.cut.values[point]}});
  if (staging.shows_hexahedra && staging.shows_edges) {
    if (!is_within) add_lines(hexahedra.edges(), moment.body.points, geometry.edges);
    if (!geometry.is_hollow) add_lines(moment.cut.inner_lines, moment.cut.points, geometry.cut_edges);
  }
  if (!geometry.is_hollow)
    add_lines(moment.cut.outline, moment.cut.points, geometry.cut_outline);
  else if (staging.cut && geometry.is_closed)
    for (const Geometry::Vertices* surface : {&geometry.surface, &geometry.walls})
      add_crossing(*surface, *staging.cut, geometry.cut_outline);
  std::ranges::copy_if(moment.fixed, std::back_inserter(geometry.fixed), is_left);

  for (const Moment::Tool& tool : moment.tools) {
    if (const std::optional<Arrow> arrow = strongest.arrow_of(tool)) arrow->draw(geometry.tool_arrows);
    if (!tool.surface) continue;
    add_lines(tool.surface->outline(tool.points, camera.towards()), tool.points, geometry.tool_outline);
    geometry.are_tools_closed = geometry.are_tools_closed && tool.surface->is_closed();
    const std::vector<Vector3f> normals = tool.surface->group_normals(tool.points);
    for (std::size_t f = 0; f < tool.surface->faces().size(); ++f)
      for (int k = 0; k < 3; ++k)
        geometry.tools.add({{tool.points[tool.surface->faces()[f][k]], normals[tool.surface->groups()[f][k]]}});
  }
  if (staging.cut && geometry.are_tools_closed) add_crossing(geometry.tools, *staging.cut, geometry.tool_cut_outline);
  for (const Moment::Load& load : moment.loads)
    if (const std::optional<Arrow> arrow = strongest.arrow_of(load)) arrow->draw(geometry.load_arrows);
  for (const auto& [from, to, is_slack] : moment.springs) {
    Geometry::Places& lines = is_slack ? geometry.slack_springs : geometry.taut_springs;
    lines.insert(lines.end(), {from.cast<float>(), to.cast<float>()});
  }
  return geometry;
}

// A quad is a bilinear patch, and a triangle one with two corners in one place: their pieces are drawn as four
// triangles around the middle of each, so that none shows a preferred diagonal.
void Shapes::draw_surface(const Moment::Shown& shown, float scale, Geometry::Vertices& surface_vertices,
                          Geometry::Vertices& walls) const {
  const Surface& surface = *shown.surface;
  const std::vector<Vector3f> normals = surface.group_normals(shown.points);
  const int fine = std::clamp(static_cast<int>(surface.mean_edge() * scale / kPatch), 1, kMaxParts);
  constexpr unsigned kNone = -1;
  std::vector<unsigned> number_of_group(normals.size(), kNone), grid;
  for (std::size_t f = 0; f < surface.faces().size(); ++f) {
    const Surface::Face &face = surface.faces()[f], &groups = surface.groups()[f];
    Geometry::Vertices& vertices = surface.is_wall(f) ? walls : surface_vertices;
    const auto corner = [&](int k) {
      unsigned& number = number_of_group[static_cast<std::size_t>(groups[k])];
      if (number == kNone) number = vertices.number({shown.points[face[k]], normals[groups[k]], shown.values[face[k]]});
      return number;
    };
    if (Surface::is_triangle(face) && fine == 1) {
      for (int k = 0; k < 3; ++k) vertices.corners.push_back(corner(k));
      continue;
    }
    // where the cut crosses it, as the cut face sees it, so that the two meet
    const auto is_above = [&](int point) {
      return staging.cut && staging.cut->height(shown.points[point].cast<double>()) > 0;
    };
    const bool meets_cut =
        !Surface::is_triangle(face) && std::ranges::any_of(face, is_above) && !std::ranges::all_of(face, is_above);
    const int parts = meets_cut ? kCutParts : fine;
    const auto at = [&](float i, float j) {
      const std::array weight = weights_at(i / static_cast<float>(parts), j / static_cast<float>(parts));
      Geometry::Vertex vertex{Vector3f::Zero(), Vector3f::Zero()};
      for (int k = 0; k < 4; ++k) {
        vertex.place += weight[k] * shown.points[face[k]];
        vertex.normal += weight[k] * normals[groups[k]];
        vertex.value += weight[k] * shown.values[face[k]];
      }
      vertex.normal.normalize();
      return vertices.number(vertex);
    };
    // where a corner has no value, the face has none
    const bool shares_corners =
        std::ranges::all_of(face, [&](int point) { return std::isfinite(shown.values[point]); });
    grid.clear();
    for (int j = 0; j <= parts; ++j)
      for (int i = 0; i <= parts; ++i)
        grid.push_back(shares_corners && i % parts == 0 && j % parts == 0
                           ? corner(j == 0 ? i / parts : 3 - i / parts)
                           : at(static_cast<float>(i), static_cast<float>(j)));
    for (int j = 0; j < parts; ++j)
      for (int i = 0; i < parts; ++i) {
        const unsigned *low = &grid[j * (parts + 1) + i], *high = low + parts + 1;
        const unsigned middle = at(static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f);
        for (const auto& [from, to] :
             {std::pair(low, low + 1), std::pair(low + 1, high + 1), std::pair(high + 1, high), std::pair(high, low)})
          vertices.corners.insert(vertices.corners.end(), {*from, *to, middle});
      }
  }
}

}  // namespace hexaplast::output
