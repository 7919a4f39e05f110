// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/geometry/sections.hpp"

namespace hexaplast {

/// Pull [N] of nodal forces (num_nodes x 3) along the body's longest axis, positive where they lengthen it: what they
/// add up to on the nodes beyond the middle of its initial length, or against it on those before the middle, whichever
/// is greater in size. A bar that is pulled by F at one end, the other being held, and one that is pulled by F at both
/// ends have the same pull F. The elastic forces of a body at rest, taken negatively, have it too: it is the axial
/// force that the middle carries. Throws InputError for forces of another size.
double axial_pull(const HexMesh& mesh, const EndSections& ends, ConstPoints forces);

}  // namespace hexaplast
