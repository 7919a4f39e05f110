// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/stock.hpp"
#include "components/components.hpp"
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
    std::vector<std::int64_t> inside;
    scene::Topology* topology = node().nearest<scene::Topology>();
    if (!topology || topology->positions().rows() != points.rows()) return inside;  // the points are not its nodes

    const bool strict = boolean("strict");
    const std::vector<Hexahedron>& hexahedra = topology->hexahedra();
    for (std::size_t e = 0; e < hexahedra.size(); ++e) {
      Vec3 centre = Vec3::Zero();
      bool all_inside = true;
      for (const int corner : hexahedra[e]) {
        const Vec3 point = points.row(corner).transpose();
        centre += point / kCorners;
        all_inside = all_inside && is_inside(point);
      }
      if (strict ? all_inside : is_inside(centre)) inside.push_back(static_cast<std::int64_t>(e));
    }
    return inside;
  }
};

}  // namespace

void add_engines(scene::Factory& factory) { factory.add<BoxROI>(attributes::kBoxROI); }

}  // namespace hexaplast::components
