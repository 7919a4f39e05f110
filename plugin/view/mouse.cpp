// SPDX-License-Identifier: LGPL-2.1-or-later
#include <imgui.h>

#include "view/window_state.hpp"

namespace hexaplast::view {
namespace {

constexpr double kPush = 0.02;  // of the size of what is shown, by which a click of the wheel moves the hand on

void grab(WindowState& window, double x, double y) {
  if (!window.pointed_at) return;
  const Vec3 towards = -window.camera.ray(x, y).direction.normalized();
  window.grabbed = window.pointed_at->place;
  window.session.grab({window.pointed_at->place, window.pointed_at->outwards, towards}, window.hand);
}

}  // namespace

void follow_mouse(WindowState& window) {
  const ImGuiIO& io = ImGui::GetIO();
  const double x = io.MousePos.x - window.left, y = io.MousePos.y;
  const bool is_inside = !io.WantCaptureMouse && x >= 0 && x < window.width;
  window.pointed_at.reset();
  if (is_inside && !window.grabbed && window.turning < 0)
    window.pointed_at = window.figure.hit(window.camera.ray(x, y));
  if (is_inside && io.MouseWheel != 0) {
    const double way = kPush * io.MouseWheel * window.figure.box().diagonal().norm();
    if (window.grabbed)  // away from the viewer: it presses
      *window.grabbed += way * window.camera.ray(x, y).direction.normalized();
    else
      window.camera.zoom(io.MouseWheel);
  }
  if (is_inside && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !io.KeyShift) grab(window, x, y);
  for (const int button : {ImGuiMouseButton_Left, ImGuiMouseButton_Right, ImGuiMouseButton_Middle})
    if (is_inside && ImGui::IsMouseClicked(button)) window.turning = button;

  if (window.grabbed && io.MouseDown[ImGuiMouseButton_Left]) {
    window.session.drag(window.camera.at_depth_of(*window.grabbed, x, y));
  } else if (window.grabbed) {
    window.session.release();
    window.grabbed.reset();
  } else if (window.turning >= 0 && io.MouseDown[window.turning]) {
    const bool is_panning = window.turning == ImGuiMouseButton_Middle || io.KeyShift;
    if (is_panning)
      window.camera.pan(io.MouseDelta.x, io.MouseDelta.y);
    else
      window.camera.orbit(io.MouseDelta.x, io.MouseDelta.y);
  } else {
    window.turning = -1;
  }
}

}  // namespace hexaplast::view
