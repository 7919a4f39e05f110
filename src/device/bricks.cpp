// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device/bricks.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "mesh/trilinear.hpp"

namespace hexaplast {

namespace {

/// Numbers of hexahedra along a curve that fills space: x, y, z by turns, so that 32 that follow one another are 4 x 4
/// x 2 of a grid.
std::vector<std::uint64_t> along_curve(std::span<const Hexahedron> hexahedra, ConstPoints points_of_nodes) {
  std::vector<Vec3> centre;
  Vec3 size = Vec3::Zero();
  for (const Hexahedron& corners : hexahedra) {
    const ElementPoints points = gather(points_of_nodes, corners);
    centre.emplace_back(points.colwise().mean().transpose());
    size += (points.colwise().maxCoeff() - points.colwise().minCoeff()).transpose();
  }
  size /= static_cast<double>(std::max<std::size_t>(centre.size(), 1));
  Vec3 origin = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (const Vec3& one : centre) origin = origin.cwiseMin(one);
  std::vector<std::uint64_t> numbers;
  for (const Vec3& one : centre) {
    std::uint64_t number = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell = static_cast<std::uint64_t>(std::clamp((one[axis] - origin[axis]) / size[axis] + 0.5, 0.0, 2e6));
      for (int bit = 0; bit < 21; ++bit) number |= (cell >> bit & 1) << (3 * bit + axis);
    }
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace

bool is_parallelepiped(const ElementPoints& corners) {
  const Mat3 edges = 2 * centre_jacobian(corners);
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * corners.cwiseAbs().maxCoeff();
  for (int a = 0; a < kCorners; ++a)
    for (int d = 0; d < 3; ++d) {
      const Vec3 edge = (corners.row(kEdgeNeighbour[a][d]) - corners.row(a)).transpose() * -kCornerSign[a][d];
      if ((edge - edges.col(d)).norm() > 1e-9 * edges.norm() + rounding) return false;
    }
  return true;
}

void BrickLayout::build(std::span<const Hexahedron> hexahedra, ConstPoints points,
                        const std::vector<unsigned char>& is_there) {
  const std::vector<std::uint64_t> along = along_curve(hexahedra, points);
  std::vector<int> order(hexahedra.size());
  for (std::size_t e = 0; e < order.size(); ++e) order[e] = static_cast<int>(e);
  std::ranges::stable_sort(order, {}, [&](int e) { return along[e]; });

  place_of.resize(hexahedra.size());
  device_node.assign(points.rows(), -1);
  std::vector<std::vector<int>> places;  // of each node of the device
  std::set<int> nodes;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    nodes.clear();
    for (last = first; last < order.size() && last - first < kBrick; ++last) {
      const Hexahedron& corners = hexahedra[order[last]];
      const auto added = std::ranges::count_if(corners, [&](int n) { return !nodes.contains(n); });
      if (nodes.size() + added > kBrickNodes) break;
      nodes.insert(corners.begin(), corners.end());
    }
    add_brick(hexahedra, std::span(order).subspan(first, last - first), is_there, places);
  }
  for (std::size_t n = 0; n < device_node.size(); ++n)  // that no hexahedron has
    if (device_node[n] < 0) {
      device_node[n] = num_nodes();
      node_of.push_back(static_cast<int>(n));
      places.emplace_back();
    }
  partial_begin.push_back(0);
  for (const std::vector<int>& of_node : places) {
    partial.insert(partial.end(), of_node.begin(), of_node.end());
    partial_begin.push_back(static_cast<int>(partial.size()));
  }
}

void BrickLayout::add_brick(std::span<const Hexahedron> hexahedra, std::span<const int> elements,
                            const std::vector<unsigned char>& is_there, std::vector<std::vector<int>>& places) {
  const int brick = num_bricks();
  std::uint32_t in_brick = 0;
  std::vector<int> nodes;
  std::vector<std::uint8_t> corners_of[kBrickNodes];
  local.resize(local.size() + kCorners * kBrick);
  for (int lane = 0; lane < kBrick; ++lane) {
    const bool has_one = lane < static_cast<int>(elements.size());
    const int e = elements[has_one ? lane : 0], place = brick * kBrick + lane;  // what is not there is as the first one
    element.push_back(has_one ? e : -1);
    if (has_one) place_of[e] = place;
    const bool counts = has_one && is_there[e];
    in_brick |= static_cast<std::uint32_t>(counts) << lane;
    for (int c = 0; c < kCorners; ++c) {
      auto at = std::ranges::find(nodes, hexahedra[e][c]);
      if (at == nodes.end()) at = nodes.insert(at, hexahedra[e][c]);
      const auto t = static_cast<std::uint8_t>(at - nodes.begin());
      local[index(place, kCorners, c)] = t;
      if (counts) corners_of[t].push_back(static_cast<std::uint8_t>(c * kBrick + lane));
    }
  }
  present.push_back(in_brick);

  begin.push_back(0);
  for (int t = 0; t < kBrickNodes; ++t) {
    std::ranges::sort(corners_of[t]);
    sorted.insert(sorted.end(), corners_of[t].begin(), corners_of[t].end());
    begin.push_back(static_cast<std::uint16_t>(begin.back() + corners_of[t].size()));
    if (t >= static_cast<int>(nodes.size())) {
      node.push_back(-1);
      continue;
    }
    int& of_device = device_node[nodes[t]];
    if (of_device < 0) {
      of_device = num_nodes();
      node_of.push_back(nodes[t]);
      places.emplace_back();
    }
    node.push_back(of_device);
    places[of_device].push_back(brick * kBrickNodes + t);
  }
  sorted.resize(static_cast<std::size_t>(num_bricks()) * kCorners * kBrick);
}

LayoutArrays BrickLayout::arrays() const {
  return {.num_bricks = num_bricks(),
          .num_nodes = num_nodes(),
          .local = local.data(),
          .sorted = sorted.data(),
          .begin = begin.data(),
          .node = node.data(),
          .partial_begin = partial_begin.data(),
          .partial = partial.data(),
          .present = present.data()};
}

Bricks::Bricks(const Model& model, const History& history)
    : BrickLayout(model.mesh.hexahedra(), model.mesh.positions(), [&](int e) { return history.alive[e]; }),
      length(static_cast<float>(model.length)) {
  rest.resize(static_cast<std::size_t>(num_places()) * kBrickNumbers);
  for (int place = 0; place < num_places(); ++place) {
    const int e = like(place);
    const ElementPoints X = gather(model.mesh.positions(), model.mesh.hexahedra()[e]);
    const Mat3 inverse = (2 * centre_jacobian(X)).inverse();  // half of that of J, whose columns are half the edges
    const auto set = [&](int k, double a) { rest[index(place, kBrickNumbers, k)] = static_cast<float>(a); };
    for (int k = 0; k < 9; ++k) set(k, inverse(k / 3, k % 3));
    const Material& material = model.material(e);
    set(9, model.volume[e]);
    set(10, model.lame[e].mu);
    set(11, model.lame[e].lambda);
    set(12, material.flow_rate);
    set(13, material.hardening);
    set(14, material.fracture_stress);
    set(15, material.fracture_stretch);
  }
}

}  // namespace hexaplast
