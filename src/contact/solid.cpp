// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "geometry/box_tree.hpp"
#include "geometry/nearest_place.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {

class Solid::Shape {
 public:
  virtual ~Shape() = default;
  virtual SignedDistance distance(const Vec3& point) const = 0;
  virtual double smallest_radius() const = 0;
  virtual double reach() const = 0;
};

namespace {

constexpr double kOnSurface = 1e-9;  // of the size of a closed surface

void require_size(double size, const char* what) {
  if (!(size > 0) || !std::isfinite(size))
    throw InputError(fmt::format("Solid: {} = {} must be positive and finite", what, size));
}

/// from / |from|, or another direction where there is none.
Vec3 direction(const Vec3& from, double length, const Vec3& otherwise) {
  return length > 0 ? from / length : otherwise;
}

/// A sphere around the nearest point of a segment along z; of a sphere it has no length.
class CapsuleShape final : public Solid::Shape {
 public:
  CapsuleShape(double radius, double length) : radius_(radius), half_length_(length / 2) {}

  SignedDistance distance(const Vec3& point) const override {
    const Vec3 from = point - Vec3(0, 0, std::clamp(point.z(), -half_length_, half_length_));
    const double length = from.norm();
    return {length - radius_, direction(from, length, Vec3::UnitX())};
  }
  double smallest_radius() const override { return radius_; }
  double reach() const override { return half_length_ + radius_; }

 private:
  double radius_, half_length_;
};

class BoxShape final : public Solid::Shape {
 public:
  explicit BoxShape(const Vec3& size) : half_(size / 2) {}

  SignedDistance distance(const Vec3& point) const override {
    const Vec3 beyond = point.cwiseAbs() - half_, outside = beyond.cwiseMax(0);
    const Vec3 sign = point.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; });
    if (const double length = outside.norm(); length > 0) return {length, sign.cwiseProduct(outside) / length};
    int axis = 0;
    const double depth = beyond.maxCoeff(&axis);
    return {depth, sign[axis] * Vec3::Unit(axis)};
  }
  double smallest_radius() const override { return half_.minCoeff(); }
  double reach() const override { return half_.norm(); }

 private:
  Vec3 half_;
};

class CylinderShape final : public Solid::Shape {
 public:
  CylinderShape(double radius, double length) : radius_(radius), half_length_(length / 2) {}

  SignedDistance distance(const Vec3& point) const override {
    const Vec3 across(point.x(), point.y(), 0), along(0, 0, point.z() < 0 ? -1 : 1);
    const double length = across.norm(), beyond_side = length - radius_,
                 beyond_end = std::abs(point.z()) - half_length_;
    const Vec3 outwards = direction(across, length, Vec3::UnitX());
    if (beyond_side > 0 && beyond_end > 0) {
      const double to_edge = std::hypot(beyond_side, beyond_end);
      return {to_edge, (beyond_side * outwards + beyond_end * along) / to_edge};
    }
    return beyond_side > beyond_end ? SignedDistance{beyond_side, outwards} : SignedDistance{beyond_end, along};
  }
  double smallest_radius() const override { return std::min(radius_, half_length_); }
  double reach() const override { return std::hypot(radius_, half_length_); }

 private:
  double radius_, half_length_;
};

/// The nearest triangle tells the distance, and the angle-weighted normal of the corner, edge or face that is nearest
/// tells the side (Baerentzen and Aanaes 2005): at an edge or a corner the normals of single triangles may disagree.
class SurfaceShape final : public Solid::Shape {
 public:
  SurfaceShape(const PointArray& positions, const std::vector<Triangle>& triangles)
      : triangles_(corners_of(positions, triangles)), tree_(boxes_of(triangles_)) {
    require_closed(triangles);
    find_normals(positions, triangles);
    Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity()), max = -min;
    for (const Triangle& triangle : triangles)
      for (const int node : triangle) {
        const Vec3 p = positions.row(node).transpose();
        min = min.cwiseMin(p);
        max = max.cwiseMax(p);
        reach_ = std::max(reach_, p.norm());
      }
    double thickness = (max - min).minCoeff();
    for (const Facet& facet : triangles_) thickness = thickness_at(facet, thickness);
    smallest_radius_ = thickness / 2;
  }

  SignedDistance distance(const Vec3& point) const override {
    int nearest = 0;
    TrianglePlace best;
    tree_.for_each_nearer(point, [&](int t) {
      const TrianglePlace found = nearest_place(triangles_[t].corners, point);
      if (found.squared < best.squared) {
        best = found;
        nearest = t;
      }
      return std::sqrt(best.squared);
    });
    const Facet& facet = triangles_[nearest];
    const Vec3 gap = point - best.place;
    const Vec3& normal = facet.normals[best.feature];
    const double side = gap.dot(normal) < 0 ? -1 : 1, length = gap.norm();
    // on the surface but for rounding the gap tells no direction
    return {side * length, length > kOnSurface * reach_ ? Vec3(side * gap / length) : normal};
  }
  double smallest_radius() const override { return smallest_radius_; }
  double reach() const override { return reach_; }

 private:
  struct Facet {
    Triangle nodes;
    std::array<Vec3, 3> corners;
    std::array<Vec3, 7> normals;  // of its features, of length 1
  };

  static std::vector<Facet> corners_of(const PointArray& positions, const std::vector<Triangle>& triangles) {
    if (triangles.empty()) throw InputError("closed surface: has no triangle");
    std::vector<Facet> facets;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      Facet& facet = facets.emplace_back();
      facet.nodes = triangles[t];
      for (int k = 0; k < 3; ++k) {
        const int node = triangles[t][k];
        if (node < 0 || node >= positions.rows())
          throw InputError(
              fmt::format("closed surface: triangle {} has node {}, must lie in [0, {})", t, node, positions.rows()));
        facet.corners[k] = positions.row(node).transpose();
        if (!facet.corners[k].allFinite()) throw InputError(fmt::format("closed surface: node {} is not finite", node));
      }
      if (!(normal_of(facet).norm() > 0)) throw InputError(fmt::format("closed surface: triangle {} has no area", t));
    }
    return facets;
  }

  static std::vector<Eigen::AlignedBox3d> boxes_of(const std::vector<Facet>& facets) {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (const Facet& facet : facets) {
      Eigen::AlignedBox3d& box = boxes.emplace_back();
      for (const Vec3& corner : facet.corners) box.extend(corner);
    }
    return boxes;
  }

  static Vec3 normal_of(const Facet& facet) {
    return (facet.corners[1] - facet.corners[0]).cross(facet.corners[2] - facet.corners[0]);
  }

  /// The thickness [m] of the solid below a triangle, or `thickness` if that is less: from its middle straight inwards
  /// to where the surface is left again. A long triangle may lie above what is thinner than there: it is measured from
  /// its corners and along its edges too, at distances of the thickness as far as kMaxPerEdge goes. The surface beside
  /// it does not count then: towards a sharp edge or tip everything becomes thin.
  double thickness_at(const Facet& facet, double thickness) const {
    constexpr double kMaxPerEdge = 16;
    const auto touches = [&](const Facet& other) {
      return std::ranges::any_of(facet.nodes,
                                 [&](int node) { return std::ranges::find(other.nodes, node) != other.nodes.end(); });
    };
    const Vec3& normal = facet.normals[TrianglePlace::kFace];
    thickness = length_inwards((facet.corners[0] + facet.corners[1] + facet.corners[2]) / 3, normal, thickness,
                               [](const Facet&) { return false; });
    for (int k = 0; k < 3; ++k) {
      const Vec3 &from = facet.corners[k], edge = facet.corners[(k + 1) % 3] - from;
      thickness = length_inwards(from, facet.normals[k], thickness, [&](const Facet& other) {
        return std::ranges::find(other.nodes, facet.nodes[k]) != other.nodes.end();
      });
      const double count = std::clamp(std::ceil(edge.norm() / thickness), 2.0, kMaxPerEdge);
      for (double i = 0; i < count; ++i)
        for (const Vec3& outwards : {normal, facet.normals[3 + k]})
          thickness = length_inwards(from + i / count * edge, outwards, thickness, touches);
    }
    return thickness;
  }

  /// From a place of the surface straight inwards to where it is left again, or `longest` if that is nearer.
  /// is_left_out: says of facets whether they do not count.
  template <class IsLeftOut>
  double length_inwards(const Vec3& from, const Vec3& outwards, double longest, const IsLeftOut& is_left_out) const {
    constexpr double kRounding = 1e-9;  // a ray must not pass between two triangles, nor end where it begins
    constexpr double kFacing = 0.01;    // sine of the angle to what a ray leaves: it may run within a plane
    tree_.for_each_along(
        from, -outwards,
        [&](int t) {
          const Facet& other = triangles_[t];
          const Vec3& normal = other.normals[TrianglePlace::kFace];
          const double along = -normal.dot(outwards);
          if (!(along > kFacing) || is_left_out(other)) return longest;
          const double length = normal.dot(other.corners[0] - from) / along;
          if (!(length > kRounding * reach_ && length < longest)) return longest;
          const Vec3 place = from - length * outwards;
          for (int k = 0; k < 3; ++k) {
            const Vec3 edge = other.corners[(k + 1) % 3] - other.corners[k];
            if (normal.dot(edge.cross(place - other.corners[k])) < -kRounding * edge.squaredNorm()) return longest;
          }
          longest = length;
          return longest;
        },
        longest);
    return longest;
  }

  // Each edge is that of two triangles, which run along it in opposite directions.
  void require_closed(const std::vector<Triangle>& triangles) {
    std::map<std::pair<int, int>, int> directed;  // edges, and the triangle that runs along each
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int from = triangles[t][k], to = triangles[t][(k + 1) % 3];
        const auto [other, is_new] = directed.emplace(std::pair(from, to), static_cast<int>(t));
        if (!is_new)
          throw InputError(fmt::format(
              "closed surface: triangles {} and {} run along edge {} {} in the same direction: they do not agree which "
              "side is outside, or more than two meet there",
              other->second, t, from, to));
      }
    for (const auto& [edge, t] : directed)
      if (!directed.contains({edge.second, edge.first}))
        throw InputError(
            fmt::format("closed surface: is open at edge {} {} of triangle {}", edge.first, edge.second, t));
    double volume = 0;
    for (const Facet& facet : triangles_) volume += facet.corners[0].dot(normal_of(facet)) / 6;
    if (!(volume > 0))
      throw InputError(fmt::format("closed surface: is inside out (its volume is {:.6g} m^3)", volume));
  }

  void find_normals(const PointArray& positions, const std::vector<Triangle>& triangles) {
    PointArray at_node = PointArray::Zero(positions.rows(), 3);
    std::map<std::pair<int, int>, Vec3> at_edge;
    const auto edge_of = [](int a, int b) { return std::pair(std::min(a, b), std::max(a, b)); };
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      Facet& facet = triangles_[t];
      const Vec3 normal = normal_of(facet).normalized();
      facet.normals[TrianglePlace::kFace] = normal;
      for (int k = 0; k < 3; ++k) {
        const Vec3 in = facet.corners[(k + 1) % 3] - facet.corners[k],
                   out = facet.corners[(k + 2) % 3] - facet.corners[k];
        at_node.row(triangles[t][k]) += std::atan2(in.cross(out).norm(), in.dot(out)) * normal.transpose();
        at_edge.try_emplace(edge_of(triangles[t][k], triangles[t][(k + 1) % 3]), Vec3::Zero()).first->second += normal;
      }
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        triangles_[t].normals[k] = at_node.row(triangles[t][k]).normalized().transpose();
        triangles_[t].normals[3 + k] = at_edge.at(edge_of(triangles[t][k], triangles[t][(k + 1) % 3])).normalized();
      }
  }

  std::vector<Facet> triangles_;
  BoxTree tree_;
  double smallest_radius_ = 0, reach_ = 0;
};

}  // namespace

Solid Solid::sphere(double radius) {
  require_size(radius, "radius");
  return Solid(std::make_shared<CapsuleShape>(radius, 0));
}

Solid Solid::capsule(double radius, double length) {
  require_size(radius, "radius");
  require_size(length, "length");
  return Solid(std::make_shared<CapsuleShape>(radius, length));
}

Solid Solid::cylinder(double radius, double length) {
  require_size(radius, "radius");
  require_size(length, "length");
  return Solid(std::make_shared<CylinderShape>(radius, length));
}

Solid Solid::box(const Vec3& size) {
  for (const double edge : size) require_size(edge, "size");
  return Solid(std::make_shared<BoxShape>(size));
}

Solid Solid::closed_surface(const PointArray& positions, const std::vector<Triangle>& triangles) {
  return Solid(std::make_shared<SurfaceShape>(positions, triangles));
}

SignedDistance Solid::distance(const Vec3& point) const { return shape_->distance(point); }
double Solid::smallest_radius() const { return shape_->smallest_radius(); }
double Solid::reach() const { return shape_->reach(); }

}  // namespace hexaplast
