// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "mesh/selection.hpp"

namespace hexaplast::components {
namespace {

/// Finds points and cells in a region.
class RegionOfInterest : public scene::Engine {
 public:
  using Engine::Engine;

  void bwd_init() override {
    if (integers("indices").empty()) remark(scene::Severity::kWarning, {}, "holds no point");
    // mistakes in what is written are found, whoever uses the outputs
    for (const Cells& cells : kCells)
      if (is_given(cells.given)) integers(cells.numbers);
  }

 protected:
  virtual void take_region() = 0;
  virtual bool is_inside(const Vec3& point) const = 0;

 private:
  /// Cells that can be sought: the attribute that may give them, and the outputs.
  struct Cells {
    std::string_view given, numbers, nodes;
  };
  static constexpr Cells kHexahedra{"hexahedra", "hexahedronIndices", "hexahedraInROI"};
  static constexpr Cells kQuads{"quads", "quadIndices", "quadsInROI"};
  static constexpr Cells kTriangles{"triangles", "triangleIndices", "trianglesInROI"};
  static constexpr Cells kEdges{"edges", "edgeIndices", "edgesInROI"};
  static constexpr std::array kCells = {kHexahedra, kQuads, kTriangles, kEdges};

  // Cells of a large grid cost more to list than its nodes: only those that somebody asks for.
  void compute(std::string_view output) override {
    take_region();
    const PointArray points = given_points();
    const auto cells =
        std::ranges::find_if(kCells, [&](const Cells& c) { return output == c.numbers || output == c.nodes; });
    if (cells == kCells.end()) return find_points(points);

    scene::Topology* topology = node().nearest<scene::Topology>();
    const bool fits = topology && (topology->positions().rows() == 0 || topology->positions().rows() == points.rows());
    if (!fits) topology = nullptr;  // the points are not its nodes
    if (cells->given == kHexahedra.given)
      find<8>(points, *cells, topology ? topology->hexahedra() : std::vector<Hexahedron>());
    else if (cells->given == kQuads.given)
      find<4>(points, *cells, topology ? topology->quads() : std::vector<Quad>());
    else if (cells->given == kTriangles.given)
      find<3>(points, *cells, topology ? topology->triangles() : std::vector<Triangle>());
    else
      find<2>(points, *cells, topology ? topology->edges() : std::vector<Edge>());
  }

  void find_points(const PointArray& points) {
    std::vector<std::int64_t> inside, outside;
    std::vector<double> positions;
    for (Eigen::Index n = 0; n < points.rows(); ++n) {
      const Vec3 point = points.row(n).transpose();
      const bool counts = is_inside(point);
      (counts ? inside : outside).push_back(n);
      if (counts) positions.insert(positions.end(), point.begin(), point.end());
    }
    found("nbIndices", static_cast<std::int64_t>(inside.size()));
    found("indices", std::move(inside));
    found("indicesOut", std::move(outside));
    found("pointsInROI", std::move(positions));
  }

  PointArray given_points() {
    if (!is_given("position")) return initial_nodes(needed_ready<scene::MechanicalState>().rest_positions());
    return initial_nodes(vectors3("position"));
  }

  // Of positions of a state whose nodes have split: one copy of each, in the order of the topology.
  PointArray initial_nodes(ConstPoints points) {
    const scene::Data* source = find_data("position");
    while (source->source()) source = source->source();
    auto* state = dynamic_cast<scene::MechanicalState*>(&source->owner());
    if (!is_given("position")) state = node().nearest<scene::MechanicalState>();
    return state && state->copies() ? PointArray(points.topRows(state->num_initial_nodes())) : PointArray(points);
  }

  /// The cells whose corners or centre lie in the region.
  template <std::size_t N>
  void find(const PointArray& points, const Cells& cells, const std::vector<std::array<int, N>>& of_topology) {
    const int num_points = static_cast<int>(points.rows());
    const auto candidates = is_given(cells.given) ? cells_of<N>(*this, cells.given, num_points) : of_topology;
    for (const std::array<int, N>& cell : candidates)
      if (std::ranges::max(cell) >= num_points)
        reject(fmt::format("the topology has node {} in its {}, there are {} points", std::ranges::max(cell),
                           cells.given, num_points));

    const std::span<const std::array<int, N>> all(candidates);
    const std::vector<int> inside =
        cells_inside<N>(points, all, boolean("strict") ? Inside::kAllCorners : Inside::kCentre,
                        [&](const Vec3& point) { return is_inside(point); });
    found(cells.numbers, std::vector<std::int64_t>(inside.begin(), inside.end()));
    std::vector<std::array<int, N>> chosen;
    for (const int cell : inside) chosen.push_back(all[cell]);
    found(cells.nodes, flattened<N>(chosen));
  }
};

/// Ten numbers for each.
std::vector<OrientedBox> oriented_boxes(scene::Object& owner, std::string_view attribute) {
  const std::vector<double>& numbers = owner.reals(attribute);
  if (numbers.size() % 10 != 0)
    owner.reject(attribute, fmt::format("{} numbers given, must be groups of 10", numbers.size()));
  std::vector<OrientedBox> boxes;
  for (std::size_t b = 0; b < numbers.size(); b += 10) {
    const double* box = &numbers[b];
    boxes.push_back({Vec3(box), Vec3(box + 3), Vec3(box + 6), box[9]});
  }
  return boxes;
}

class BoxROI final : public RegionOfInterest {
 public:
  BoxROI() : RegionOfInterest(attributes::kBoxROI) {}

 private:
  void take_region() override {
    boxes_.clear();
    const bool has_boxes = is_given("box") || !is_given("orientedBox");
    const std::vector<double> corners = has_boxes ? reals("box") : std::vector<double>();
    for (std::size_t b = 0; b < corners.size(); b += 6) {
      const Eigen::Map<const Vec3> one(&corners[b]), other(&corners[b + 3]);
      boxes_.emplace_back(one.cwiseMin(other), one.cwiseMax(other));
    }
    oriented_boxes_ = oriented_boxes(*this, "orientedBox");
  }

  bool is_inside(const Vec3& point) const override {
    return std::ranges::any_of(boxes_, [&](const auto& box) { return box.contains(point); }) ||
           std::ranges::any_of(oriented_boxes_, [&](const OrientedBox& box) { return box.contains(point); });
  }

  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<OrientedBox> oriented_boxes_;
};

class SphereROI final : public RegionOfInterest {
 public:
  SphereROI() : RegionOfInterest(attributes::kSphereROI) {}

 private:
  void take_region() override {
    centres_ = vectors3("centers");
    radii_ = reals("radii");
    const auto count = static_cast<std::size_t>(centres_.rows());
    if (radii_.size() == 1) radii_.resize(count, radii_[0]);
    if (radii_.size() != count)
      reject("radii", fmt::format("{} radii given for {} centers, must be one or as many", radii_.size(), count));
  }

  bool is_inside(const Vec3& point) const override {
    for (Eigen::Index i = 0; i < centres_.rows(); ++i)
      if ((centres_.row(i).transpose() - point).squaredNorm() <= radii_[i] * radii_[i]) return true;
    return false;
  }

  PointArray centres_;         // [m]
  std::vector<double> radii_;  // [m]
};

class PlaneROI final : public RegionOfInterest {
 public:
  PlaneROI() : RegionOfInterest(attributes::kPlaneROI) {}

 private:
  void take_region() override { rectangles_ = oriented_boxes(*this, "plane"); }
  bool is_inside(const Vec3& point) const override {
    return std::ranges::any_of(rectangles_, [&](const OrientedBox& box) { return box.contains(point); });
  }

  std::vector<OrientedBox> rectangles_;
};

class MeshROI final : public RegionOfInterest {
 public:
  MeshROI() : RegionOfInterest(attributes::kMeshROI) {}

 private:
  void take_region() override {
    const PointArray points = vectors3("ROIposition");
    const std::vector<Triangle> triangles = cells_of<3>(*this, "ROItriangles", static_cast<int>(points.rows()));
    if (triangles.empty()) reject("ROItriangles", "has no triangle, must have those of a closed surface");
    accepted(*this, "ROItriangles", [&] { space_.emplace(points, triangles); });
    const Vec3 &min = space_->box().min(), &max = space_->box().max();
    found("box", std::vector<double>{min.x(), min.y(), min.z(), max.x(), max.y(), max.z()});
    takes_box_ = !boolean("computeMeshROI");
  }
  bool is_inside(const Vec3& point) const override {
    return takes_box_ ? space_->box().contains(point) : space_->contains(point);
  }

  std::optional<EnclosedSpace> space_;
  bool takes_box_ = false;
};

/// Gives some of a list's values another one.
class IndexValueMapper final : public scene::Engine {
 public:
  IndexValueMapper() : Engine(attributes::kIndexValueMapper) {}

 private:
  void compute(std::string_view) override {
    std::vector<double> values = reals("inputValues");
    const std::vector<std::int64_t>& chosen = integers("indices");
    const auto length = chosen.empty() ? 0 : static_cast<std::size_t>(std::ranges::max(chosen)) + 1;
    values.resize(std::max(values.size(), length), real("defaultValue"));
    for (const std::int64_t index : chosen) values[static_cast<std::size_t>(index)] = real("value");
    found("outputValues", std::move(values));
  }
};

/// Finds values in a list.
class IndicesFromValues final : public scene::Engine {
 public:
  IndicesFromValues() : Engine(attributes::kIndicesFromValues) {}

 private:
  void compute(std::string_view) override {
    const std::vector<double>&values = reals("values"), &list = reals("global");
    std::vector<std::int64_t> places, others;
    std::vector<bool> is_found(list.size(), false);
    for (const double value : values) {
      const std::size_t count = places.size();
      for (std::size_t i = 0; i < list.size() && (boolean("recursiveSearch") || places.size() == count); ++i) {
        if (list[i] != value) continue;
        places.push_back(static_cast<std::int64_t>(i));
        is_found[i] = true;
      }
      if (places.size() == count)
        remark(scene::Severity::kWarning, "values", fmt::format("{} is not among the values of global", value));
    }
    if (boolean("recursiveSearch")) std::ranges::sort(places);
    for (std::size_t i = 0; i < list.size(); ++i)
      if (!is_found[i]) others.push_back(static_cast<std::int64_t>(i));
    found("indices", std::move(places));
    found("otherIndices", std::move(others));
  }
};

}  // namespace

void add_engines(scene::Factory& factory) {
  factory.add<BoxROI>(attributes::kBoxROI);
  factory.add<SphereROI>(attributes::kSphereROI);
  factory.add<PlaneROI>(attributes::kPlaneROI);
  factory.add<MeshROI>(attributes::kMeshROI);
  factory.add<IndicesFromValues>(attributes::kIndicesFromValues);
  factory.add<IndexValueMapper>(attributes::kIndexValueMapper);
}

}  // namespace hexaplast::components
