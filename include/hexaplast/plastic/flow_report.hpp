// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace hexaplast {

/// What became of the rest-shape averaging in one plastic step.
struct AveragingReport {
  bool skipped = true;     ///< the rest shapes fitted already
  bool fell_back = false;  ///< Gauss-Newton would have raised E; the local/global step was taken
  int iterations = 0;      ///< of the linear solver
  double residual = 0;     ///< relative residual it left
  bool converged = true;   ///< false: the linear solver gave up before its tolerance
};

/// What happened in one plastic step. Counts are elements.
struct FlowReport {
  int yielded = 0;   ///< with flow of stretch or rotation at some corner
  int inverted = 0;  ///< inverted at some corner (det F~ < 0)
  int skipped = 0;   ///< without flow, because inverted or nearly so
  int repaired = 0;  ///< whose plastic rest shape was moved towards the initial one
  int rolled_back =
      0;            ///< that would have flowed but keep their shape: averaging would have flattened one of their part
  int removed = 0;  ///< broken in this step: the last ones of Body::removed
  double worst_volume_error = 0;  ///< max |volume without load / initial volume - 1| of an element, before the step
  AveragingReport averaging;
  std::vector<int> torn;  ///< joints that are to open, ascending (Body::open); of Fracture::kFace
};

}  // namespace hexaplast
