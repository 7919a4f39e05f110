// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "scene/interfaces.hpp"

namespace hexaplast::scene {

/// Gives some hexahedra of a body values of their own: attributes that are named as the rows of Material.
class MaterialRegion : public Component {
 public:
  static constexpr std::string_view kCategory = "MaterialRegion";
  using Component::Component;

  /// Their numbers in the body's mesh, when the body is ready. Valid until the next time step.
  virtual std::span<const int> hexahedra() const = 0;

  /// The body that it belongs to; null: there is none.
  virtual const ForceField* field() = 0;
};

}  // namespace hexaplast::scene
