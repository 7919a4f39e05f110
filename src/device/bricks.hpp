// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "device/device_kernels.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// Whether all edges of a direction are alike, to rounding.
bool is_parallelepiped(const ElementPoints& corners);

/// Hexahedra in bricks of neighbours, 4 x 4 x 2 of a grid, and nodes in the order of these.
struct BrickLayout {
  BrickLayout() = default;
  /// points: of the nodes, num_nodes x 3. is_there(e): false leaves hexahedron e its place, and what it adds out of all
  /// sums.
  template <class Test>
  BrickLayout(std::span<const Hexahedron> hexahedra, ConstPoints points, const Test& is_there) {
    std::vector<unsigned char> there;
    for (std::size_t e = 0; e < hexahedra.size(); ++e) there.push_back(is_there(static_cast<int>(e)));
    build(hexahedra, points, there);
  }

  LayoutArrays arrays() const;
  int num_bricks() const { return static_cast<int>(present.size()); }
  int num_nodes() const { return static_cast<int>(node_of.size()); }
  int num_places() const { return static_cast<int>(element.size()); }
  /// Hexahedron at a place (brick kBrick + lane), or what stands in for one that is not there.
  int like(int place) const { return element[element[place] < 0 ? place / kBrick * kBrick : place]; }
  /// Of number k of `count` of the hexahedron at a place.
  static std::size_t index(int place, int count, int k) {
    return (static_cast<std::size_t>(place / kBrick) * count + k) * kBrick + place % kBrick;
  }

  std::vector<int> element;      ///< [place]: hexahedron, or -1
  std::vector<int> place_of;     ///< the inverse
  std::vector<int> node_of;      ///< node, per node of the device
  std::vector<int> device_node;  ///< the inverse

 private:
  void build(std::span<const Hexahedron> hexahedra, ConstPoints points, const std::vector<unsigned char>& is_there);
  void add_brick(std::span<const Hexahedron> hexahedra, std::span<const int> elements,
                 const std::vector<unsigned char>& is_there, std::vector<std::vector<int>>& places);

  std::vector<std::uint8_t> local, sorted;
  std::vector<std::uint16_t> begin;
  std::vector<int> node, partial_begin, partial;
  std::vector<std::uint32_t> present;
};

/// A body of parallelepipeds.
struct Bricks : BrickLayout {
  Bricks() = default;
  Bricks(const Model& model, const History& history);

  BrickArrays arrays() const { return {.at = BrickLayout::arrays(), .rest = rest.data(), .length = length}; }

 private:
  std::vector<float> rest;
  float length = 1;
};

}  // namespace hexaplast
