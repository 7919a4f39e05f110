// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/mesh/selection.hpp"

namespace hexaplast::components {
namespace {

/// Finds points and cells in a region.
class RegionOfInterest : public scene::Engine {
 public:
  using Engine::Engine;

  void bwd_init() override {
    if (integers("indices").empty()) remark(scene::Severity::kWarning, {}, "holds no point");
  }

 protected:
  virtual void take_region() = 0;
  virtual bool is_inside(const Vec3& point) const = 0;

 private:
  void compute() override {
    take_region();
    const PointArray points = given_points();
    std::vector<std::int64_t> inside, outside;
    std::vector<double> positions;
    for (Eigen::Index n = 0; n < points.rows(); ++n) {
      const Vec3 point = points.row(n).transpose();
      const bool counts = is_inside(point);
      (counts ? inside : outside).push_back(n);
      if (counts) positions.insert(positions.end(), point.begin(), point.end());
    }
    find_data("nbIndices")->set(static_cast<std::int64_t>(inside.size()));
    find_data("indices")->set(std::move(inside));
    find_data("indicesOut")->set(std::move(outside));
    find_data("pointsInROI")->set(std::move(positions));

    scene::Topology* topology = node().nearest<scene::Topology>();
    const bool fits = topology && (topology->positions().rows() == 0 || topology->positions().rows() == points.rows());
    if (!fits) topology = nullptr;  // the points are not its nodes
    find<8>(points, "hexahedra", "hexahedronIndices", topology ? topology->hexahedra() : std::vector<Hexahedron>());
    find<4>(points, "quads", "quadIndices", topology ? topology->quads() : std::vector<Quad>());
    find<3>(points, "triangles", "triangleIndices", topology ? topology->triangles() : std::vector<Triangle>());
    find<2>(points, "edges", "edgeIndices", topology ? topology->edges() : std::vector<Edge>());
  }

  PointArray given_points() {
    return is_given("position") ? PointArray(vectors3("position"))
                                : needed_ready<scene::MechanicalState>().rest_positions();
  }

  /// Sets `numbers` and `<cells>InROI`.
  template <std::size_t N>
  void find(const PointArray& points, std::string_view cells, std::string_view numbers,
            const std::vector<std::array<int, N>>& of_topology) {
    const int num_points = static_cast<int>(points.rows());
    const auto candidates = is_given(cells) ? cells_of<N>(*this, cells, num_points) : of_topology;
    for (const std::array<int, N>& cell : candidates)
      if (std::ranges::max(cell) >= num_points)
        reject(fmt::format("the topology has node {} in its {}, there are {} points", std::ranges::max(cell), cells,
                           num_points));

    const std::span<const std::array<int, N>> all(candidates);
    const std::vector<int> found =
        cells_inside<N>(points, all, boolean("strict") ? Inside::kAllCorners : Inside::kCentre,
                        [&](const Vec3& point) { return is_inside(point); });
    find_data(numbers)->set(std::vector<std::int64_t>(found.begin(), found.end()));
    find_data(std::string(cells) + "InROI")->set(flattened<N>(all, found));
  }
};

class BoxROI final : public RegionOfInterest {
 public:
  BoxROI() : RegionOfInterest(attributes::kBoxROI) {}

 private:
  void take_region() override {
    boxes_.clear();
    oriented_boxes_.clear();
    const bool has_boxes = is_given("box") || !is_given("orientedBox");
    const std::vector<double> corners = has_boxes ? reals("box") : std::vector<double>();
    for (std::size_t b = 0; b < corners.size(); b += 6) {
      const Eigen::Map<const Vec3> one(&corners[b]), other(&corners[b + 3]);
      boxes_.emplace_back(one.cwiseMin(other), one.cwiseMax(other));
    }
    const std::vector<double>& oriented = reals("orientedBox");
    if (oriented.size() % 10 != 0)
      reject("orientedBox", fmt::format("{} numbers given, must be groups of 10", oriented.size()));
    for (std::size_t b = 0; b < oriented.size(); b += 10) {
      const double* numbers = &oriented[b];
      oriented_boxes_.push_back({Vec3(numbers), Vec3(numbers + 3), Vec3(numbers + 6), numbers[9]});
    }
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

}  // namespace

void add_engines(scene::Factory& factory) {
  factory.add<BoxROI>(attributes::kBoxROI);
  factory.add<SphereROI>(attributes::kSphereROI);
}

}  // namespace hexaplast::components
