// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "view/window_state.hpp"

namespace hexaplast::view {

/// What the mouse does beside the panels: pulls at tissue, and moves the camera.
class Mouse {
 public:
  void follow(WindowState& window);  ///< once per frame, after the panels, which take the mouse first

 private:
  int turning_ = -1;  // button that moves the camera; -1: none
};

}  // namespace hexaplast::view
