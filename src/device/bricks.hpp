// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "device/device_kernels.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// Whether all edges of a direction are alike, to rounding.
bool is_parallelepiped(const ElementPoints& corners);

/// The hexahedra of a body in bricks of neighbours, 4 x 4 x 2 of a grid, and its nodes in the order of these.
struct Bricks {
  Bricks() = default;
  /// Of parallelepipeds; those that are gone keep their places.
  Bricks(const Model& model, const History& history);

  BrickArrays arrays() const;
  int num_bricks() const { return static_cast<int>(present.size()); }
  int num_nodes() const { return static_cast<int>(node_of.size()); }
  /// Of number k of `count` of the hexahedron at a place (brick kBrick + lane).
  static std::size_t index(int place, int count, int k) {
    return (static_cast<std::size_t>(place / kBrick) * count + k) * kBrick + place % kBrick;
  }

  std::vector<int> element;  ///< [place]: of the body, or -1
  std::vector<int> node_of;  ///< of the body, per node of the device

 private:
  void add_brick(const Model& model, const History& history, std::span<const int> elements, std::vector<int>& number,
                 std::vector<std::vector<int>>& places);

  std::vector<std::uint8_t> local, sorted;
  std::vector<std::uint16_t> begin;
  std::vector<int> node, partial_begin, partial;
  std::vector<std::uint32_t> present;
  std::vector<float> rest;
  float length = 1;
};

}  // namespace hexaplast
