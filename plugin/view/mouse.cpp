// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/mouse.hpp"

#include <imgui.h>

namespace hexaplast::view {
namespace {

void grab(WindowState& window, double x, double y) {
  const Ray ray = window.camera.ray(x, y);
  const std::optional<Figure::Seen> seen = window.figure.hit(ray);
  if (!seen) return;
  window.grabbed = seen->place;
  window.session.grab({seen->place, seen->outwards, -ray.direction.normalized()}, window.hand);
}

}  // namespace

void Mouse::follow(WindowState& window) {
  const ImGuiIO& io = ImGui::GetIO();
  const double x = io.MousePos.x - window.left, y = io.MousePos.y;
  const bool is_inside = !io.WantCaptureMouse && x >= 0 && x < window.width;
  if (is_inside && io.MouseWheel != 0) window.camera.zoom(io.MouseWheel);
  if (is_inside && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !io.KeyShift) grab(window, x, y);
  for (const int button : {ImGuiMouseButton_Left, ImGuiMouseButton_Right, ImGuiMouseButton_Middle})
    if (is_inside && ImGui::IsMouseClicked(button)) turning_ = button;

  if (window.grabbed && io.MouseDown[ImGuiMouseButton_Left]) {
    window.session.drag(window.camera.at_depth_of(*window.grabbed, x, y));
  } else if (window.grabbed) {
    window.session.release();
    window.grabbed.reset();
  } else if (turning_ >= 0 && io.MouseDown[turning_]) {
    const bool is_panning = turning_ == ImGuiMouseButton_Middle || io.KeyShift;
    if (is_panning)
      window.camera.pan(io.MouseDelta.x, io.MouseDelta.y);
    else
      window.camera.orbit(io.MouseDelta.x, io.MouseDelta.y);
  } else {
    turning_ = -1;
  }
}

}  // namespace hexaplast::view
