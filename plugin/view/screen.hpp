// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <string>

namespace hexaplast::view {

/// The window on the screen, its OpenGL context, and Dear ImGui within it.
class Screen {
 public:
  /// on_key: hears of keys before Dear ImGui does. Throws OutputError where no window can be opened.
  Screen(int width, int height, const std::string& title, GLFWkeyfun on_key);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  GLFWwindow* window() const { return window_; }

 private:
  GLFWwindow* window_ = nullptr;
};

}  // namespace hexaplast::view
