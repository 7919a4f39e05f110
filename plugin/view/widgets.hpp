// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <imgui.h>

#include <initializer_list>
#include <string>

#include "picture/ink.hpp"
#include "view/trace.hpp"

/// What Dear ImGui does not bring along.
namespace hexaplast::view {

/// An ink of the pictures.
constexpr ImU32 ink(const output::Colour& colour) {
  const auto byte = [](float fraction) { return static_cast<int>(255 * fraction + 0.5f); };
  return IM_COL32(byte(colour.red), byte(colour.green), byte(colour.blue), 255);
}

inline constexpr ImU32 kInk = ink(output::kInk);
inline constexpr ImU32 kFaint = ink(output::kFaint);
inline constexpr ImU32 kSteel = ink(output::kSteel);
inline constexpr ImU32 kRust = IM_COL32(196, 84, 40, 255);
inline constexpr ImU32 kLeaf = IM_COL32(72, 128, 74, 255);
inline constexpr ImU32 kPaper = IM_COL32(255, 255, 255, 235);
inline constexpr ImU32 kRule = IM_COL32(205, 210, 216, 255);

/// A tooltip of the item before.
void explain(const std::string& text);

void heading(const char* words);
void tell(ImU32 colour, const std::string& words);  ///< a paragraph
ImVec2 text_size(const std::string& words);         ///< [pixels]

/// Moves a positive number by equal factors. Returns whether it has moved.
bool slider(const char* name, const char* unit, double& value, double min, double max, const std::string& help);

/// One curve of a plot.
struct Curve {
  const char* name;
  ImU32 colour;
  const Trace& trace;
};

/// Curves over the same time, under a line that names them with their latest values.
void plot(const char* title, const char* unit, std::initializer_list<Curve> curves, double begin, double end);

}  // namespace hexaplast::view
