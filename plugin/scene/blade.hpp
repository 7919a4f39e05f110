// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "scene/interfaces.hpp"

namespace hexaplast::scene {

/// Opens joints of a body at the end of each step. All blades of a body act together: none sees what another one opens.
class Blade : public Component {
 public:
  static constexpr std::string_view kCategory = "Controller";
  using Component::Component;

  virtual ForceField& field() = 0;  ///< of the body; known from bwd_init on

  /// The joints that it opens (ForceField::open), asked when end_step of all is done. Valid until the next step.
  virtual std::span<const int> joints() = 0;
  virtual std::span<const double> crossings() const = 0;  ///< of these
};

}  // namespace hexaplast::scene
