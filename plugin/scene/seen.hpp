// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>

#include "hexaplast/base/types.hpp"

/// What scenes and pictures both know: nothing of components, nor of files.
namespace hexaplast::scene {

/// From where something is seen.
struct Viewpoint {
  /// Where exactly the viewer stands. Without it, distance and detail are fitted to what is shown.
  struct Eye {
    Vec3 position;               ///< [m]
    Vec3 looks_at;               ///< [m] in the middle of the picture
    double field_of_view;        ///< [deg] from the lower to the upper border, in (0, 180)
    bool is_perspective = true;  ///< else what lies at looks_at is as large as in perspective, and all else too
  };

  Vec3 towards;            ///< from what is looked at to the viewer; not 0
  std::optional<Vec3> up;  ///< upwards in the picture, as far as it is not along `towards`; none: y
  std::optional<Eye> eye = {};
};

/// What stands in pictures for a spring, or for what ties two places together.
struct SpringLine {
  Vec3 from, to;          ///< [m]
  bool is_slack = false;  ///< shorter than at rest
};

}  // namespace hexaplast::scene
