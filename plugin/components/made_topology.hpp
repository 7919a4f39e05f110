// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/interfaces.hpp"

namespace hexaplast::components {

/// A topology that makes its nodes and cells itself, when they are first asked for: it may stand behind the components
/// that use it.
class MadeTopology : public scene::Topology {
 public:
  using Topology::Topology;

  void provide(scene::Data& output) override;

 protected:
  /// Rejects more cells than a topology may have.
  void require_few(std::string_view attribute, double num_cells);

  /// Rejects what require_few does, and hexahedra whose body does not fit into the machine's memory; before they are
  /// made.
  void require_feasible(std::string_view attribute, double num_hexahedra);
};

}  // namespace hexaplast::components
