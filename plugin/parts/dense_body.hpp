// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "elastic/dense_hexahedra.hpp"
#include "parts/hexahedral_body.hpp"

namespace hexaplast::parts {

/// The frame of `small`, `large` and `polar`, as SOFA names them.
ElementFrame frame_of(std::string_view method);

/// In scenes: HexahedronFEMForceField and its like, SOFA's elastic hexahedra. A body of the same mesh and materials
/// stands beside them, makes no force, and serves the measures and the fields of a run.
class DenseBody {
 public:
  /// rest: num_nodes x 3 [m]; dt [s]. Refuses what does not fit into the machine's memory, before it is made. Throws
  /// InputError.
  DenseBody(ConstPoints rest, const std::vector<Hexahedron>& hexahedra, HexahedralBodyOptions options,
            DenseHexahedraSettings settings, double dt);

  /// Other materials for the same hexahedra. Throws InputError.
  void set_options(HexahedralBodyOptions options, double dt);

  std::vector<Remark> take_warnings() { return measured_.take_warnings(); }

  /// At accepted positions: counts inverted hexahedra.
  void end_step(ConstPoints x, double dt) { measured_.end_step(x, dt); }

  void remove(std::span<const int> elements);
  void reset();
  void serialize(Archive& archive);
  std::span<const int> take_removed() { return measured_.take_removed(); }

  DenseHexahedra& hexahedra() { return hexahedra_; }
  const DenseHexahedra& hexahedra() const { return hexahedra_; }
  const Body& body() const { return measured_.body(); }
  const FlowReport& report() const { return measured_.report(); }

 private:
  HexahedralBody measured_;
  DenseHexahedra hexahedra_;
};

}  // namespace hexaplast::parts
