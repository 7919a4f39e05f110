// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
    if (is_given("hexahedra")) integers("hexahedronIndices");
  }

 protected:
  virtual void take_region() = 0;
  virtual bool is_inside(const Vec3& point) const = 0;

 private:
  // Cells of a large grid cost more to list than its nodes: only where somebody asks for them.
  void compute(std::string_view output) override {
    take_region();
    const PointArray points = given_points();
    output.starts_with("hexahedr") ? find_hexahedra(points) : find_points(points);
  }

  void find_points(const PointArray& points) {
    std::vector<std::int64_t> inside, outside;
    for (Eigen::Index n = 0; n < points.rows(); ++n)
      (is_inside(points.row(n).transpose()) ? inside : outside).push_back(n);
    found("indices", std::move(inside));
    found("indicesOut", std::move(outside));
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

  /// Those whose corners or centre lie in the region.
  void find_hexahedra(const PointArray& points) {
    const int num_points = static_cast<int>(points.rows());
    std::vector<Hexahedron> all;
    if (is_given("hexahedra"))
      all = cells_of<8>(*this, "hexahedra", num_points);
    else if (auto* topology = node().nearest<scene::Topology>();
             topology && (topology->positions().rows() == 0 || topology->positions().rows() == points.rows()))
      all = topology->hexahedra();  // otherwise the points are not its nodes
    for (const Hexahedron& hexahedron : all)
      if (std::ranges::max(hexahedron) >= num_points)
        reject(fmt::format("the topology has node {} in its hexahedra, there are {} points",
                           std::ranges::max(hexahedron), num_points));

    const std::vector<int> inside =
        cells_inside<8>(points, all, boolean("strict") ? Inside::kAllCorners : Inside::kCentre,
                        [&](const Vec3& point) { return is_inside(point); });
    found("hexahedronIndices", std::vector<std::int64_t>(inside.begin(), inside.end()));
    std::vector<Hexahedron> chosen;
    for (const int hexahedron : inside) chosen.push_back(all[hexahedron]);
    found("hexahedraInROI", flattened<8>(chosen));
  }
};

constexpr double kSkew = 0.01;  // cosine of a right angle whose corners were written with few digits

/// Ten numbers for each.
std::vector<OrientedBox> oriented_boxes(scene::Object& owner, std::string_view attribute) {
  const std::vector<double>& numbers = owner.reals(attribute);
  if (numbers.size() % 10 != 0)
    owner.reject(attribute, fmt::format("{} numbers given, must be groups of 10", numbers.size()));
  std::vector<OrientedBox> boxes;
  for (std::size_t b = 0; b < numbers.size(); b += 10) {
    const double* box = &numbers[b];
    const auto& [p0, p1, p2, depth] = boxes.emplace_back(OrientedBox{Vec3(box), Vec3(box + 3), Vec3(box + 6), box[9]});
    const Vec3 along = p1 - p0, across = p2 - p1;
    if (!(std::abs(along.dot(across)) < kSkew * along.norm() * across.norm()))
      owner.reject(attribute, fmt::format("the corners of box {} are not those of a rectangle", b / 10));
    if (depth <= 0) owner.reject(attribute, fmt::format("the thickness of box {} is {}, must be > 0", b / 10, depth));
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
  }
  bool is_inside(const Vec3& point) const override { return space_->contains(point); }

  std::optional<EnclosedSpace> space_;
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
    std::vector<std::int64_t> places;
    for (const double value : values) {
      const std::size_t count = places.size();
      for (std::size_t i = 0; i < list.size() && (boolean("recursiveSearch") || places.size() == count); ++i)
        if (list[i] == value) places.push_back(static_cast<std::int64_t>(i));
      if (places.size() == count)
        remark(scene::Severity::kWarning, "values", fmt::format("{} is not among the values of global", value));
    }
    if (boolean("recursiveSearch")) std::ranges::sort(places);
    found("indices", std::move(places));
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
