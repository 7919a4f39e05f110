// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>

#include "scene/interfaces.hpp"

namespace hexaplast::components {

/// A topology that makes its nodes and cells itself, when they are first asked for: it may stand behind the components
/// that use it.
class MadeTopology : public scene::Topology {
 public:
  using Topology::Topology;

  void provide(scene::Data& output) override;

  const std::vector<Quad>& quads() final;
  const std::vector<Edge>& edges() final;

 private:
  // those of the hexahedra, in their order, where a topology has no order of its own
  virtual std::vector<Quad> make_quads();
  virtual std::vector<Edge> make_edges();

  std::optional<std::vector<Quad>> quads_;
  std::optional<std::vector<Edge>> edges_;
};

}  // namespace hexaplast::components
