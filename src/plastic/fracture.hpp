// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "state/history.hpp"

namespace hexaplast {

/// Whether plastic steps of a body may report joints that are to open: Fracture::kFace, and something can break.
bool may_tear(const std::vector<Material>& materials, const Settings& settings);

/// Whether a step has carried an element past its limits at some corner: its yield stress by hardening, or its plastic
/// stretch. A yield stress that lies beyond the limit without having grown there breaks nothing: an element without
/// one, for which it is infinite, may still flow by rotation. tau_before: [Pa] before the step.
bool is_broken(const Model& model, const CornerValues& tau_before, const History& next, int element);

/// [-] Largest singular value of the plastic deformation at a corner, which the history must know.
double largest_plastic_stretch(const History& history, int element, int corner);

}  // namespace hexaplast
