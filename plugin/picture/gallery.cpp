// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/gallery.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hexaplast/geometry/sections.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "picture/picture_cut.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Vector3f;

constexpr float kNoLoad = 1e-6f;  // of the strongest: rounding that is left of loads without pulls

std::vector<Surface::Face> faces_of(const EmbeddedSurface& embedded) {
  std::vector<Surface::Face> faces = embedded.quads;
  for (const auto& [a, b, c] : embedded.triangles) faces.push_back({a, b, c, c});
  return faces;
}

float diagonal(ConstPoints points) {
  return static_cast<float>((points.colwise().maxCoeff() - points.colwise().minCoeff()).norm());
}

std::vector<Vector3f> single(ConstPoints points) {
  std::vector<Vector3f> places;
  places.reserve(points.rows());
  for (Eigen::Index n = 0; n < points.rows(); ++n) places.push_back(points.row(n).transpose().cast<float>());
  return places;
}

}  // namespace

int time_decimals(double dt) {
  return dt > 0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(dt) - 1e-9)), 2, 6) : 2;
}

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
      longest_arrow_(kLongestArrow * diagonal(mesh.positions())),
      original_(std::make_shared<Boundary>(mesh, std::span<const unsigned char>())),
      current_(original_) {
  for (const EmbeddedSurface& embedded : staging_.embedded_surfaces) {
    std::vector<Surface::Face> faces = output::faces_of(embedded);
    auto whole = std::make_shared<Surface>(single(embedded.points), faces);
    embedded_surfaces_.push_back({embedded.embedding(mesh), std::move(faces), std::move(whole)});
    current_embedded_surfaces_.push_back(embedded_surfaces_.back().whole);
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
    for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s)
      current_embedded_surfaces_[s] = embedded_surfaces_[s].whole;
    current_alive_.clear();
  } else if (!std::ranges::equal(alive, current_alive_)) {
    current_ = std::make_shared<Boundary>(mesh_, alive);
    for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
      const CarriedSurface& embedded = embedded_surfaces_[s];
      std::vector<Surface::Face> left;
      for (const Surface::Face& face : embedded.faces)
        if (is_carried(face, staging_.embedded_surfaces[s], embedded.embedding, alive)) left.push_back(face);
      current_embedded_surfaces_[s] = std::make_shared<Surface>(embedded.whole->original(), std::move(left));
    }
    current_alive_.assign(alive.begin(), alive.end());
  }
}

void Gallery::add(long step, double time, ConstPoints positions, const std::vector<double>& values,
                  std::span<const unsigned char> alive, const BoundaryConditions& conditions, const PointArray* ghost) {
  follow(alive);
  State state;
  state.step = step;
  state.time = time;
  PointArray at_nodes = PointArray::Zero(mesh_.num_nodes(), 3);  // in its first column
  at_nodes.col(0) = Eigen::VectorXd::Map(
      (entry_of(staging_.quantity).of_nodes ? values : nodal_means(mesh_, values, alive)).data(), mesh_.num_nodes());
  state.body = {current_->surface, current_->points_at(positions), {}};
  for (const int node : current_->node_of_point) state.body.values.push_back(static_cast<float>(at_nodes(node, 0)));
  // an embedded surface that reaches out of the hexahedra continues their values, and shall not pass them
  float min = std::numeric_limits<float>::infinity(), max = -min;
  for (const float value : state.body.values) {
    if (!std::isfinite(value)) continue;
    min = std::min(min, value);
    max = std::max(max, value);
  }
  for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
    const Embedding& embedding = embedded_surfaces_[s].embedding;
    PointArray points(embedding.num_points(), 3), blended(embedding.num_points(), 3);
    embedding.apply(positions, points);
    embedding.apply(at_nodes, blended);
    Shown shown{current_embedded_surfaces_[s], single(points), {}};
    for (Eigen::Index n = 0; n < blended.rows(); ++n) {
      const auto value = static_cast<float>(blended(n, 0));
      shown.values.push_back(std::isfinite(value) && min <= max ? std::clamp(value, min, max) : value);
    }
    state.embedded_surfaces.push_back(std::move(shown));
  }
  if (!staging_.ghost.empty()) state.ghosts = ghosts_at(ghost);
  if (staging_.cut && shows_body()) state.cut = cut_face(positions, at_nodes, alive);

  if (!conditions.fixed.empty())
    for (const int node : current_->node_of_point)
      if (conditions.fixed[node]) state.fixed.push_back(positions.row(node).transpose().cast<float>());
  if (staging_.shows_loads && conditions.loads.rows() > 0) state.loads = loads_of(conditions, positions, alive);
  for (const Instrument& instrument : conditions.instruments) state.tools.push_back(tool_of(instrument, positions));
  for (const auto& [from, to, is_slack] : conditions.springs)
    state.springs.push_back({from.cast<float>(), to.cast<float>(), is_slack});
  states_.push_back(std::move(state));
}

Gallery::Tool Gallery::tool_of(const Instrument& instrument, ConstPoints positions) {
  Tool tool{instrument.acts_at(positions).cast<float>(), instrument.force().cast<float>(), nullptr,
            single(instrument.shape_points)};
  if (instrument.shape_triangles.empty()) return tool;

  std::vector<Surface::Face> faces;
  for (const auto& [a, b, c] : instrument.shape_triangles) faces.push_back({a, b, c, c});
  std::shared_ptr<const Surface>& latest = tools_[instrument.id];
  if (!latest || latest->faces() != faces || latest->original().size() != tool.points.size())
    latest = std::make_shared<Surface>(tool.points, std::move(faces));
  tool.surface = latest;
  return tool;
}

// Those of single nodes: the force of an instrument is shown as one.
std::vector<Gallery::Load> Gallery::loads_of(const BoundaryConditions& conditions, ConstPoints positions,
                                             std::span<const unsigned char> alive) const {
  PointArray forces = conditions.loads;
  for (const Instrument& instrument : conditions.instruments)
    for (std::size_t k = 0; k < instrument.nodes.size(); ++k)
      forces.row(instrument.nodes[k]) -= instrument.forces.row(static_cast<Eigen::Index>(k));

  PointArray outwards = PointArray::Zero(mesh_.num_nodes(), 3);
  const std::vector<Vector3f> normals = current_->surface->point_normals(current_->points_at(positions));
  for (std::size_t p = 0; p < normals.size(); ++p)
    outwards.row(current_->node_of_point[p]) = normals[p].transpose().cast<double>();

  std::vector<Load> loads;
  const double min = kNoLoad * conditions.loads.rowwise().norm().maxCoeff();
  for (int node = 0; node < mesh_.num_nodes(); ++node) {
    if (!(forces.row(node).norm() > min)) continue;
    if (!alive.empty() && !hold_together(mesh_, alive, {&node, 1})) continue;
    loads.push_back({node, positions.row(node).transpose().cast<float>(), forces.row(node).transpose().cast<float>(),
                     outwards.row(node).transpose().cast<float>()});
  }
  return loads;
}

std::vector<Gallery::Shown> Gallery::ghosts_at(const PointArray* nodes) const {
  std::vector<Shown> ghosts;
  if (embedded_surfaces_.empty() && nodes) ghosts.push_back({current_->surface, current_->points_at(*nodes), {}});
  if (embedded_surfaces_.empty() && !nodes) ghosts.push_back({original_->surface, original_->surface->original(), {}});
  for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
    if (!nodes) {
      ghosts.push_back({embedded_surfaces_[s].whole, embedded_surfaces_[s].whole->original(), {}});
      continue;
    }
    PointArray points(embedded_surfaces_[s].embedding.num_points(), 3);
    embedded_surfaces_[s].embedding.apply(*nodes, points);
    ghosts.push_back({current_embedded_surfaces_[s], single(points), {}});
  }
  return ghosts;
}

Gallery::CutFace Gallery::cut_face(ConstPoints positions, const PointArray& values,
                                   std::span<const unsigned char> alive) const {
  const PlaneCut cut = picture_cut(mesh_, positions, *staging_.cut, alive);
  PointArray points(cut.num_points(), 3), blended(cut.num_points(), 3);
  cut.apply(positions, points);
  cut.apply(values, blended);
  CutFace face{single(points), {}, cut.triangles(), cut.inner_lines(), cut.outline()};
  for (Eigen::Index n = 0; n < blended.rows(); ++n) face.values.push_back(static_cast<float>(blended(n, 0)));
  return face;
}

}  // namespace hexaplast::output
