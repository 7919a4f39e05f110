// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/geometry/sections.hpp"
#include "picture/bodies.hpp"

namespace hexaplast::output {

/// How far a body has been stretched and twisted, between the end sections of its longest axis. Volumes are those of
/// the hexahedra that are left; the ratios are 0 when none is.
struct Measures {
  double plastic_elongation = 0;  ///< [-] of the plastic rest shape along the longest axis of the initial bounding box
  double plastic_twist_deg = 0;   ///< of the plastic rest shape about that axis
  double current_elongation = 0;
  double current_twist_deg = 0;
  double plastic_rest_volume_ratio = 1;  ///< plastic volume / initial volume
  double current_volume_ratio = 1;
};

/// Measures bodies again and again, as if they were one. They must outlive it.
class Measurement {
 public:
  explicit Measurement(Bodies bodies);

  /// positions: num_nodes x 3 [m], the current state; the plastic rest shape is the body's present one.
  Measures measure(ConstPoints positions) const;

  /// The same without plastic elongation and twist, which are no numbers then: with isolated rest shapes they take
  /// linear systems.
  Measures measure_current(ConstPoints positions) const;

 private:
  Bodies bodies_;
  EndSections ends_;
};

}  // namespace hexaplast::output
