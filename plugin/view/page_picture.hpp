// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <utility>

#include "picture/gallery.hpp"
#include "view/camera.hpp"
#include "view/figure.hpp"
#include "view/source.hpp"

namespace hexaplast::view {

/// A snapshot as `hexaplast render` draws it, from where the window looks at it: with title, time, scale, loads and
/// instruments, and the cut and the ghost of the look, and the colours of a scale where that is not flat.
output::Drawing page_picture(const Source& source, const Snapshot& snapshot, const output::Staging& staging,
                             const Look& look, const Camera& camera, const output::Scale& scale);

}  // namespace hexaplast::view
