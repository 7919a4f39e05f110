// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <utility>

#include "picture/gallery.hpp"
#include "view/camera.hpp"
#include "view/figure.hpp"
#include "view/source.hpp"

namespace hexaplast::view {

/// What pictures call the quantities of the window.
output::Quantity picture_quantity(Quantity quantity);

/// A snapshot as `hexaplast render` draws it, from where the window looks at it: with title, time, scale, loads and
/// instruments, and the cut and the ghost of the look. range: of the colours; none: of what is shown.
output::Drawing page_picture(const Source& source, const Snapshot& snapshot, const output::Staging& staging,
                             const Look& look, const Camera& camera, std::optional<std::pair<double, double>> range);

}  // namespace hexaplast::view
