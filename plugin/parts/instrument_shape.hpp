// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/base/types.hpp"
#include "parts/blade.hpp"
#include "parts/instrument.hpp"

namespace hexaplast::parts {

/// The surface of an instrument as triangles, counter-clockwise seen from outside, in its own frame. Round shapes are
/// polyhedra with their corners on the shape. For pictures and files: contact is computed with the exact shape.
struct InstrumentShape {
  PointArray points = PointArray(0, 3);  ///< [m]
  std::vector<Triangle> triangles;

  PointArray at(const Pose& pose) const;  ///< [m] the points, where the instrument is
};

/// Of options that Instrument accepts.
InstrumentShape shape_of(const InstrumentOptions& options);

/// The edge of a blade, as a thread that is thick enough to be seen.
InstrumentShape edge_of(const BladeOptions& options);

}  // namespace hexaplast::parts
