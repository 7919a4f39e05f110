// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Per element and face (kFaces), an element that has the face too, or -1 where there is none. Of the elements that
/// share a face each has another.
/// alive: if not empty, one entry per element, 0 for those that are gone; these have no neighbours and are none.
std::vector<std::array<int, 6>> neighbours_across_faces(std::span<const Hexahedron> hexahedra,
                                                        std::span<const unsigned char> alive = {});

}  // namespace hexaplast
