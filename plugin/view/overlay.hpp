// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "view/window_state.hpp"

namespace hexaplast::view {

/// What is written over the body: rates, the colour bar, and the spring from the tissue to the mouse.
void draw_overlay(const WindowState& window);

}  // namespace hexaplast::view
