// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "scene/interfaces.hpp"

namespace hexaplast::components {

/// What a topology holds.
struct MappedCells {
  PointArray positions;
  std::vector<scene::Tetrahedron> tetrahedra = {};
  std::vector<Quad> quads = {};
  std::vector<Triangle> triangles = {};
};

/// Fills one topology with cells made of another's.
class TopologicalMapping : public scene::Component {
 public:
  static constexpr std::string_view kCategory = "TopologicalMapping";
  using Component::Component;

  void init() override;

  /// Null: the link leads to none, which init tells.
  scene::Topology* output();

  /// Of the input as it is in the beginning.
  virtual MappedCells make() = 0;

 protected:
  scene::Topology& input();
};

}  // namespace hexaplast::components
