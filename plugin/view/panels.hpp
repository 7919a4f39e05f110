// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "view/window_state.hpp"

namespace hexaplast::view {

void draw_controls(WindowState& window);     ///< what can be changed
void draw_plots(const WindowState& window);  ///< what is measured

}  // namespace hexaplast::view
