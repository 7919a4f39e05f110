// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "picture/axis.hpp"
#include "picture/ink.hpp"
#include "picture/quantity.hpp"
#include "view/shown_scene.hpp"
#include "view/widgets.hpp"
#include "view/window_state.hpp"

namespace hexaplast::view {
namespace {

ImVec2 pixel_of(const WindowState& window, const Vec3& place) {
  const Eigen::Vector2d pixel = window.camera.pixel_of(place);
  return {window.left + static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

void draw_label(ImDrawList* draw, const ImVec2& corner, ImU32 colour, const std::string& words) {
  const ImVec2 size = text_size(words);
  draw->AddRectFilled({corner.x - 5, corner.y - 2}, {corner.x + size.x + 5, corner.y + size.y + 2}, kPaper, 4);
  draw->AddText(corner, colour, words.c_str());
}

/// A ring with a rim that sets it off from any colour.
void draw_ring(ImDrawList* draw, const ImVec2& centre) {
  draw->AddCircle(centre, output::kRingRadius, kPaper, 0, output::kRingWidth + output::kRimWidth);
  draw->AddCircle(centre, output::kRingRadius, kSteel, 0, output::kRingWidth);
}

/// What belongs to instruments and is not part of their shapes.
void draw_instruments(const WindowState& window, ImDrawList* draw) {
  for (const Vec3& place : window.figure.rings()) draw_ring(draw, pixel_of(window, place));
  std::vector<ImVec2> corners;  // of labels
  for (const auto& [tip, force] : window.figure.tool_forces()) {
    const std::string words = output::with_unit(force, "N");
    ImVec2 corner = pixel_of(window, tip);
    corner.x += 10;
    corner.y -= 9;
    // above those that it would cover
    const ImVec2 size = text_size(words);
    std::ranges::sort(corners, std::ranges::greater(), &ImVec2::y);
    for (const ImVec2& other : corners)
      if (std::abs(corner.x - other.x) < size.x + 10 && std::abs(corner.y - other.y) < size.y + 4)
        corner.y = other.y - size.y - 4;
    corners.push_back(corner);
    draw_label(draw, corner, kSteel, words);
  }
}

/// What the hand holds, and the spring from there to the mouse.
void draw_hand(const WindowState& window, ImDrawList* draw) {
  if (window.now.held.empty()) return;
  Vec3 held = Vec3::Zero();
  for (const int node : window.now.held)
    held += window.now.positions.row(node).transpose() / static_cast<double>(window.now.held.size());
  const ImVec2 from = pixel_of(window, held), to = ImGui::GetIO().MousePos;
  draw->AddLine(from, to, kPaper, 5);
  draw->AddLine(from, to, kSteel, 2.2f);
  draw_ring(draw, from);
  draw->AddCircleFilled(to, 4, kSteel);
}

/// What is under the mouse.
void draw_name(const WindowState& window, ImDrawList* draw) {
  if (!window.pointed_at) return;
  const auto hexahedron = static_cast<std::size_t>(window.pointed_at->hexahedron);
  std::string words = name_of(window.pointed_at->hexahedron, window.bodies, window.regions());
  const std::vector<double>& values = window.now.of_hexahedra;
  const output::QuantityEntry& quantity = window.scale.quantity();
  if (quantity.quantity != Quantity::kRegion && hexahedron < values.size() && std::isfinite(values[hexahedron]))
    words += fmt::format(", {} {:.3g}{}", quantity.label, values[hexahedron],
                         quantity.unit == "–" ? "" : fmt::format(" {}", quantity.unit));
  draw->AddText({window.left + 16, 34}, kInk, words.c_str());
}

/// In one line, which goes on below where there is no room.
void draw_legend(const WindowState& window, ImDrawList* draw) {
  constexpr float kSwatch = 18, kGap = 6, kBetween = 22, kLine = 20;
  const std::vector<output::Scale::Name> names = window.scale.legend();
  const auto width = [&](const output::Scale::Name& name) {
    return kSwatch + kGap + text_size(name.words).x + kBetween;
  };
  float all = -kBetween;
  for (const output::Scale::Name& name : names) all += width(name);
  const float begin = window.left + std::max(20.0f, (window.width - all) / 2);
  float x = begin, y = window.height - kBarStrip + 20;
  for (const output::Scale::Name& name : names) {
    if (x > begin && x + width(name) > window.left + window.width) x = begin, y += kLine;
    draw->AddRectFilled({x, y + 2}, {x + kSwatch, y + 13},
                        ImGui::ColorConvertFloat4ToU32({name.colour.red, name.colour.green, name.colour.blue, 1}));
    draw->AddText({x + kSwatch + kGap, y}, kInk, name.words.c_str());
    x += width(name);
  }
}

void draw_colour_bar(const WindowState& window, ImDrawList* draw) {
  if (!window.scale.palette().empty()) return draw_legend(window, draw);
  const float bar = std::min(380.0f, window.width - 80), left = window.left + (window.width - bar) / 2,
              top = window.height - kBarStrip + 28;
  const std::string words = window.scale.words();
  draw->AddText({window.left + (window.width - text_size(words).x) / 2, top - 22}, kInk, words.c_str());
  if (window.scale.is_flat()) return;
  for (int k = 0; k < static_cast<int>(bar); ++k) {
    const output::Colour colour = output::colour_of((k + 0.5) / bar);
    const float x = left + static_cast<float>(k);
    draw->AddRectFilled({x, top}, {x + 1, top + 13},
                        ImGui::ColorConvertFloat4ToU32({colour.red, colour.green, colour.blue, 1}));
  }
  const double min = window.scale.min(), max = window.scale.max();
  for (const auto& [value, label] : output::labels_of_scale(min, max, 5)) {
    const float x = left + bar * static_cast<float>((value - min) / (max - min));
    draw->AddLine({x, top + 13}, {x, top + 18}, kInk);
    draw->AddText({x - text_size(label).x / 2, top + 20}, kInk, label.c_str());
  }
}

/// How x, y and z run.
void draw_axes(const WindowState& window, ImDrawList* draw) {
  constexpr float kLength = 28, kToName = 11;
  const ImVec2 origin(window.left + 50, window.height - kBarStrip - 40);
  for (const output::AxisMark& axis : output::axis_marks(window.camera.axes(), window.figure.staging().is_anatomical)) {
    const ImU32 colour = ImGui::ColorConvertFloat4ToU32({axis.colour.red, axis.colour.green, axis.colour.blue, 1});
    draw->AddLine(origin, {origin.x + kLength * axis.tip.x(), origin.y + kLength * axis.tip.y()}, colour, 2);
    const std::string name(axis.name);
    const ImVec2 size = text_size(name);
    draw->AddText({origin.x + (kLength + kToName) * axis.tip.x() - size.x / 2,
                   origin.y + (kLength + kToName) * axis.tip.y() - size.y / 2},
                  colour, name.c_str());
  }
}

}  // namespace

void draw_overlay(const WindowState& window) {
  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  const auto write_at_right = [&](const std::string& words, float y) {
    draw->AddText({window.left + window.width - text_size(words).x - 16, y}, kFaint, words.c_str());
  };
  write_at_right(
      fmt::format("{:.0f} frames/s   {} hexahedra", window.frames.per_second(), window.session.mesh().num_elements()),
      14);
  const double speed = window.steps.per_second() * window.session.dt();
  write_at_right(fmt::format("{:.0f} steps/s   speed {:.2f}   99 % of steps within {:.3g} ms",
                             window.steps.per_second(), speed, window.traces.step_ms.quantile(0.99)),
                 34);
  draw->AddText({window.left + 16, 14}, kFaint, "left: hand   right: turn   middle: move   wheel: nearer");
  draw_instruments(window, draw);
  if (window.grabbed) draw_hand(window, draw);
  draw_name(window, draw);
  draw_axes(window, draw);
  draw_colour_bar(window, draw);
}

}  // namespace hexaplast::view
