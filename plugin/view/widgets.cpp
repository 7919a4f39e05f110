// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/widgets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "picture/axis.hpp"

namespace hexaplast::view {
namespace {

constexpr float kPlotHeight = 104;  // [pixels]

}  // namespace

void explain(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(24 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

ImVec2 text_size(const std::string& words) { return ImGui::CalcTextSize(words.c_str()); }

void heading(const char* words) {
  ImGui::Dummy({0, 4});
  ImGui::TextDisabled("%s", words);
  ImGui::Separator();
}

void tell(ImU32 colour, const std::string& words) {
  ImGui::Dummy({0, 4});
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(words.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

bool slider(const char* name, const char* unit, double& value, double min, double max, const std::string& help) {
  const bool has_moved =
      ImGui::SliderScalar(name, ImGuiDataType_Double, &value, &min, &max, fmt::format("%.4g {}", unit).c_str(),
                          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoRoundToFormat);
  explain(help);
  return has_moved;
}

void plot(const char* title, const char* unit, std::initializer_list<Curve> curves, double begin, double end) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  ImGui::TextUnformatted(fmt::format("{} [{}]", title, unit).c_str());
  if (curves.size() > 1) ImGui::Dummy({0, ImGui::GetFontSize()});  // values of several do not fit beside the title
  ImVec2 pen = ImGui::GetItemRectMin();
  pen.x += ImGui::GetContentRegionAvail().x;
  for (auto curve = std::rbegin(curves); curve != std::rend(curves); ++curve) {
    if (curve->trace.empty()) continue;
    const std::string words = fmt::format("{}{}{:.3g}", curve->name, *curve->name ? " " : "", curve->trace.latest());
    pen.x -= text_size(words).x;
    draw->AddText(pen, curve->colour, words.c_str());
    pen.x -= 12;
  }

  const ImVec2 corner = ImGui::GetCursorScreenPos(), size{ImGui::GetContentRegionAvail().x, kPlotHeight};
  const ImVec2 opposite{corner.x + size.x, corner.y + size.y};
  ImGui::Dummy(size);
  draw->AddRectFilled(corner, opposite, IM_COL32_WHITE, 4);

  double min = 0, max = 0;
  for (const Curve& curve : curves) curve.trace.extend_range(begin, min, max);
  if (!(max > min)) max = 1;  // all is 0, which is always within
  const double room = 0.08 * (max - min);
  const auto place = [&](double time, double value) {
    return ImVec2(corner.x + size.x * static_cast<float>((time - begin) / (end - begin)),
                  opposite.y - size.y * static_cast<float>((value - min + room) / (max - min + 2 * room)));
  };
  const output::Ticks ticks = output::ticks_within(min, max, 3);
  for (const double value : ticks.values) {
    const float y = place(begin, value).y;
    draw->AddLine({corner.x, y}, {opposite.x, y}, kRule);
    draw->AddText(nullptr, 12, {corner.x + 4, std::max(y - 13, corner.y)}, kFaint, ticks.label(value).c_str());
  }
  draw->PushClipRect(corner, opposite, true);
  for (const Curve& curve : curves) {
    std::vector<ImVec2> line;
    curve.trace.for_each_since(begin, [&](double time, double value) { line.push_back(place(time, value)); });
    draw->AddPolyline(line.data(), static_cast<int>(line.size()), curve.colour, 0, 1.8f);
  }
  draw->PopClipRect();
  draw->AddRect(corner, opposite, kRule, 4);
}

}  // namespace hexaplast::view
