// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "hexaplast/mesh/selection.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

class BoxROI final : public scene::Engine {
 public:
  BoxROI() : Engine(attributes::kBoxROI) {}

  void bwd_init() override {
    if (integers("indices").empty()) remark(scene::Severity::kWarning, "box", "holds no point");
  }

 private:
  void compute() override {
    const PointArray points = given_points();
    std::vector<std::int64_t> inside, outside;
    std::vector<double> positions;
    for (Eigen::Index n = 0; n < points.rows(); ++n) {
      const Vec3 point = points.row(n).transpose();
      (is_inside(point) ? inside : outside).push_back(n);
      if (is_inside(point)) positions.insert(positions.end(), point.begin(), point.end());
    }
    find_data("indices")->set(std::move(inside));
    find_data("indicesOut")->set(std::move(outside));
    find_data("pointsInROI")->set(std::move(positions));
    find_data("hexahedronIndices")->set(hexahedra_inside(points));
  }

  PointArray given_points() {
    return is_given("position") ? PointArray(vectors3("position"))
                                : needed_ready<scene::MechanicalState>().rest_positions();
  }

  bool is_inside(const Vec3& point) {
    const std::vector<double>& corners = reals("box");
    for (std::size_t b = 0; b < corners.size(); b += 6) {
      const Eigen::Map<const Eigen::Array3d> one(&corners[b]), other(&corners[b + 3]);
      const Eigen::Array3d p = point.array();
      if ((p >= one.min(other)).all() && (p <= one.max(other)).all()) return true;
    }
    return false;
  }

  std::vector<std::int64_t> hexahedra_inside(const PointArray& points) {
    scene::Topology* topology = node().nearest<scene::Topology>();
    if (!topology || topology->positions().rows() != points.rows()) return {};  // the points are not its nodes
    const std::vector<int> found = hexaplast::hexahedra_inside(
        points, topology->hexahedra(), boolean("strict") ? Inside::kAllCorners : Inside::kCentre,
        [&](const Vec3& point) { return is_inside(point); });
    return {found.begin(), found.end()};
  }
};

}  // namespace

void add_engines(scene::Factory& factory) { factory.add<BoxROI>(attributes::kBoxROI); }

}  // namespace hexaplast::components
