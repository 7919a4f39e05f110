// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/panels.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>

#include "attributes/admissible.hpp"
#include "view/widgets.hpp"

namespace hexaplast::view {
namespace {

constexpr std::array kGhosts{"none", "original", "without forces"};

void draw_knob(Session& session, const Knob& knob, std::optional<double> value) {
  const std::string name(knob.attribute->name), unit(knob.attribute->unit);
  const bool is_factor = !knob.of_hexahedra.empty();
  const std::string help = fmt::format(
      "{}\n{}{}{}", knob.attribute->help, unit.empty() ? "" : "[" + unit + "]  ",
      attributes::describe(knob.attribute->range),
      is_factor ? "\nEach hexahedron has its own; all of them are multiplied by the number on the slider." : "");
  const float end = ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x * 0.5f;
  ImGui::PushID(name.c_str());
  if (knob.may_be_none) {
    bool is_given = value.has_value();
    if (ImGui::Checkbox("##given", &is_given))
      session.set(name, is_given ? std::optional(knob.value.value_or(knob.suggested)) : std::nullopt);
    explain(help + "\nWithout a tick there is none.");
    ImGui::SameLine();
  }
  if (value) {
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_NoRoundToFormat | (knob.is_logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    ImGui::SetNextItemWidth(end - ImGui::GetCursorPosX());
    if (ImGui::SliderScalar(name.c_str(), ImGuiDataType_Double, &*value, &knob.least, &knob.most,
                            is_factor ? "%.3g times" : fmt::format("%.4g {}", unit).c_str(), flags))
      session.set(name, *value);
  } else {
    ImGui::SetCursorPosX(end + ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextDisabled("%s", name.c_str());
  }
  explain(help);
  ImGui::PopID();
}

}  // namespace

void draw_controls(WindowState& window) {
  ImGui::TextUnformatted(window.session.title().c_str());
  ImGui::TextDisabled("step %ld   t = %.3f s", window.now.step, window.now.sample.time);

  const float across = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
  const ImVec2 third{(across - 2 * gap) / 3, 30};
  if (ImGui::Button(window.now.is_running ? "pause" : "run", third)) window.toggle_running();
  explain("Space");
  ImGui::SameLine();
  if (ImGui::Button("step", third)) window.session.advance(1);
  explain("S: one time step");
  ImGui::SameLine();
  if (ImGui::Button("reset", third)) window.reset();
  explain("R: back to the beginning, with the material as it is now");

  bool is_real_time = window.pace == Pace::kRealTime;
  if (ImGui::Checkbox("real time", &is_real_time))
    window.session.set_pace(window.pace = is_real_time ? Pace::kRealTime : Pace::kFree);
  explain("As the clock on the wall, where steps are fast enough. Otherwise as fast as it goes.");
  ImGui::SameLine();
  if (ImGui::Button("picture")) window.wants_picture = true;
  explain("P: writes a PNG file of this window");
  ImGui::SameLine();
  if (ImGui::Button("fit")) window.fit();
  explain("F: looks at the whole body");

  heading("view");
  int chosen = static_cast<int>(window.now.quantity);
  if (ImGui::BeginCombo("colour", window.colouring().name)) {
    for (int k = 0; k < static_cast<int>(kColourings.size()); ++k)
      if (ImGui::Selectable(kColourings[k].name, k == chosen)) window.session.show(kColourings[k].quantity);
    ImGui::EndCombo();
  }
  int ghost = static_cast<int>(window.look.ghost);
  if (ImGui::Combo("ghost", &ghost, kGhosts.data(), static_cast<int>(kGhosts.size())))
    window.look.ghost = static_cast<Ghost>(ghost);
  explain("The shape behind the body: the original one, or the one that it would have without forces (G)");
  ImGui::Checkbox(window.figure.has_skins() ? "cage" : "edges", &window.look.shows_edges);
  explain("W: edges of the hexahedra");
  if (window.figure.has_skins()) {
    ImGui::SameLine();
    ImGui::Checkbox("embedded surfaces", &window.look.shows_skins);
  }

  heading("material");
  for (std::size_t k = 0; k < window.session.knobs().size(); ++k)
    draw_knob(window.session, window.session.knobs()[k], window.now.knob_values[k]);

  heading("hand");
  ImGui::PushItemWidth(across * 0.5f);
  const HandSettings& usual = window.session.suggested_hand();
  slider("radius", "m", window.hand.radius, usual.radius / 5, usual.radius * 10,
         "The hand holds the nodes of the surface that are as near to where it grips.");
  slider("stiffness", "N/m", window.hand.stiffness, usual.stiffness / 100, usual.stiffness * 100,
         "Of the spring between the mouse and what is held");
  slider("greatest force", "N", window.hand.most_force, usual.most_force / 100, usual.most_force * 100,
         "However far the mouse goes, the hand pulls no harder.");
  slider("damping", "N s/m", window.hand.damping, usual.damping / 100, usual.damping * 10,
         "Of a dashpot beside the spring: tissue follows the mouse without swinging about it.");
  ImGui::PopItemWidth();

  if (!window.now.failure.empty()) tell(kRust, window.now.failure + "\nReset leads back to the beginning.");
  if (!window.message.empty()) tell(kFaint, window.message);
}

void draw_plots(const WindowState& window) {
  const double end = std::max(window.now.sample.time, Traces::kSpan), begin = end - Traces::kSpan;
  plot("elongation", "%",
       {{"world", kSteel, window.traces.world_elongation}, {"plastic", kRust, window.traces.plastic_elongation}}, begin,
       end);
  plot("greatest plastic strain", "-", {{"", kRust, window.traces.plastic_strain}}, begin, end);
  plot("volume error", "%",
       {{"world", kSteel, window.traces.world_volume}, {"plastic", kRust, window.traces.material_volume}}, begin, end);
  plot("energy", "J",
       {{"kin", kLeaf, window.traces.kinetic},
        {"el", kSteel, window.traces.elastic},
        {"diss", kRust, window.traces.dissipated}},
       begin, end);
  if (!window.traces.step_ms.empty()) {
    const double last = window.traces.step_ms.latest_time();
    plot("time of a step", "ms", {{"", kInk, window.traces.step_ms}}, last - Traces::kSteps, last);
  }
  ImGui::TextDisabled("median %.3g ms   99th percentile %.3g ms", window.traces.step_ms.quantile(0.5),
                      window.traces.step_ms.quantile(0.99));
  ImGui::TextDisabled("a step lasts %.4g ms of simulated time", 1e3 * window.session.dt());
}

}  // namespace hexaplast::view
