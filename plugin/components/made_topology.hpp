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
};

}  // namespace hexaplast::components
