// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/overlay.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "picture/axis.hpp"
#include "picture/colour_map.hpp"
#include "view/widgets.hpp"

namespace hexaplast::view {
namespace {

/// The spring from what is held to the mouse.
void draw_hand(const WindowState& window, ImDrawList* draw) {
  Vec3 held = Vec3::Zero();
  if (window.now.held.empty()) return;
  for (const int node : window.now.held)
    held += window.now.positions.row(node).transpose() / static_cast<double>(window.now.held.size());
  const Eigen::Vector2d pixel = window.camera.pixel_of(held);
  const ImVec2 from{window.left + static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
      to = ImGui::GetIO().MousePos;
  draw->AddLine(from, to, kPaper, 5);
  draw->AddLine(from, to, kSteel, 2.2f);
  draw->AddCircle(from, 9, kPaper, 0, 5);
  draw->AddCircle(from, 9, kSteel, 0, 2.4f);
  draw->AddCircleFilled(to, 4, kSteel);
  const std::string force = fmt::format("{:.3g} N", window.now.hand_force.norm());
  const ImVec2 corner{to.x + 14, to.y - 9}, size = text_size(force);
  draw->AddRectFilled({corner.x - 5, corner.y - 2}, {corner.x + size.x + 5, corner.y + size.y + 2}, kPaper, 4);
  draw->AddText(corner, kSteel, force.c_str());
}

void draw_colour_bar(const WindowState& window, ImDrawList* draw) {
  const float bar = std::min(380.0f, window.width - 80), left = window.left + (window.width - bar) / 2,
              top = window.height - 54;
  const auto [least, most] = window.scale().value_or(std::pair(0.0, 0.0));
  const std::string words = !window.scale() ? fmt::format("{}: it never yields", window.colouring().name)
                            : most > least  ? fmt::format("{} [{}]", window.colouring().name, window.colouring().unit)
                                            : fmt::format("{} [{}]: {:.4g} everywhere", window.colouring().name,
                                                          window.colouring().unit, most);
  draw->AddText({window.left + (window.width - text_size(words).x) / 2, top - 22}, kInk, words.c_str());
  if (!(most > least)) return;
  for (int k = 0; k < static_cast<int>(bar); ++k) {
    const output::Colour colour = output::colour_of((k + 0.5) / bar);
    const float x = left + static_cast<float>(k);
    draw->AddRectFilled({x, top}, {x + 1, top + 13},
                        ImGui::ColorConvertFloat4ToU32({colour.red, colour.green, colour.blue, 1}));
  }
  const output::Ticks ticks = output::ticks_within(least, most, 5);
  for (const double value : ticks.values) {
    const float x = left + bar * static_cast<float>((value - least) / (most - least));
    draw->AddLine({x, top + 13}, {x, top + 18}, kInk);
    const std::string label = ticks.label(value);
    draw->AddText({x - text_size(label).x / 2, top + 20}, kInk, label.c_str());
  }
}

}  // namespace

void draw_overlay(const WindowState& window) {
  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  const std::string rates = fmt::format("{:.0f} frames/s   {:.0f} steps/s   {} hexahedra", window.frames.per_second(),
                                        window.steps.per_second(), window.session.mesh().num_elements());
  draw->AddText({window.left + window.width - text_size(rates).x - 16, 14}, kFaint, rates.c_str());
  const char* help = "drag tissue: left   turn: right   move: middle   nearer: wheel";
  draw->AddText({window.left + 16, 14}, kFaint, help);
  if (window.grabbed) draw_hand(window, draw);
  draw_colour_bar(window, draw);
}

}  // namespace hexaplast::view
