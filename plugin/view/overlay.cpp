// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/overlay.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "picture/axis.hpp"
#include "picture/colour_map.hpp"
#include "picture/quantity.hpp"
#include "view/widgets.hpp"

namespace hexaplast::view {
namespace {

constexpr double kLongestArrow = 0.16;  // of the diagonal of what is shown
constexpr double kShortestArrow = 6;    // [pixels]
constexpr float kHead = 11;             // [pixels] of an arrow

ImVec2 pixel_of(const WindowState& window, const Vec3& place) {
  const Eigen::Vector2d pixel = window.camera.pixel_of(place);
  return {window.left + static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

void draw_label(ImDrawList* draw, const ImVec2& corner, ImU32 colour, const std::string& words) {
  const ImVec2 size = text_size(words);
  draw->AddRectFilled({corner.x - 5, corner.y - 2}, {corner.x + size.x + 5, corner.y + size.y + 2}, kPaper, 4);
  draw->AddText(corner, colour, words.c_str());
}

void draw_arrow(const WindowState& window, ImDrawList* draw, const Vec3& from, const Vec3& to, ImU32 colour) {
  const ImVec2 foot = pixel_of(window, from), tip = pixel_of(window, to);
  const float x = tip.x - foot.x, y = tip.y - foot.y, length = std::hypot(x, y);
  if (length < kShortestArrow) return;
  const float head = std::min(kHead, 0.6f * length), dx = x / length, dy = y / length;
  const ImVec2 neck{tip.x - head * dx, tip.y - head * dy};
  const ImVec2 left{neck.x - 0.45f * head * dy, neck.y + 0.45f * head * dx},
      right{neck.x + 0.45f * head * dy, neck.y - 0.45f * head * dx};
  draw->AddLine(foot, neck, kPaper, 5);
  draw->AddLine(foot, neck, colour, 2.4f);
  draw->AddTriangleFilled(tip, left, right, colour);
  draw->AddTriangle(tip, left, right, kPaper, 1);
}

/// Forces on the bodies. What pushes ends where it acts, so that it is seen.
void draw_loads(const WindowState& window, ImDrawList* draw) {
  const Snapshot& now = window.now;
  const double longest = kLongestArrow * window.figure.box().diagonal().norm();
  for (const output::NodalLoad& load : output::shown_loads(window.source.mesh(), now.alive, now.conditions)) {
    const Vec3 place = now.positions.row(load.node).transpose();
    draw_arrow(window, draw, place, place + longest / window.strongest_load * load.force, kLeaf);
  }
  for (const output::Instrument& instrument : now.conditions.instruments) {
    const Vec3 force = instrument.force(), place = instrument.acts_at(now.positions);
    if (!(force.norm() > 0) || !(window.strongest_force > 0)) continue;
    const Vec3 arrow = longest / window.strongest_force * force;
    const bool pushes = !instrument.shape_triangles.empty();
    const Vec3 from = pushes ? Vec3(place - arrow) : place, to = pushes ? place : Vec3(place + arrow);
    draw_arrow(window, draw, from, to, kSteel);
    const ImVec2 end = pixel_of(window, pushes ? from : to);
    draw_label(draw, {end.x + 10, end.y - 9}, kSteel, output::with_unit(force.norm(), "N"));
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
  draw->AddCircle(from, 9, kPaper, 0, 5);
  draw->AddCircle(from, 9, kSteel, 0, 2.4f);
  draw->AddCircleFilled(to, 4, kSteel);
}

/// What is under the mouse.
void draw_name(const WindowState& window, ImDrawList* draw) {
  if (!window.pointed_at) return;
  const auto hexahedron = static_cast<std::size_t>(window.pointed_at->hexahedron);
  std::string words = window.names.of(window.pointed_at->hexahedron);
  const std::vector<double>& values = window.now.of_hexahedra;
  const std::string_view unit = window.colouring().unit;
  if (hexahedron < values.size() && std::isfinite(values[hexahedron]))
    words += fmt::format(", {} {:.3g}{}{}", window.colouring().name, values[hexahedron], unit == "-" ? "" : " ",
                         unit == "-" ? "" : unit);
  draw->AddText({window.left + 16, 34}, kInk, words.c_str());
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
  const auto write_at_right = [&](const std::string& words, float y) {
    draw->AddText({window.left + window.width - text_size(words).x - 16, y}, kFaint, words.c_str());
  };
  write_at_right(
      fmt::format("{:.0f} frames/s   {} hexahedra", window.frames.per_second(), window.source.mesh().num_elements()),
      14);
  if (window.session) {
    const double speed = window.steps.per_second() * window.source.dt();
    write_at_right(fmt::format("{:.0f} steps/s   speed {:.2f}   99 % of steps within {:.3g} ms",
                               window.steps.per_second(), speed, window.traces.step_ms.quantile(0.99)),
                   34);
  }
  draw->AddText({window.left + 16, 14}, kFaint,
                window.session ? "left: hand   right: turn   middle: move   wheel: nearer"
                               : "left, right: turn   middle: move   wheel: nearer");
  if (window.look.shows_instruments) draw_loads(window, draw);
  if (window.grabbed) draw_hand(window, draw);
  draw_name(window, draw);
  draw_colour_bar(window, draw);
}

}  // namespace hexaplast::view
