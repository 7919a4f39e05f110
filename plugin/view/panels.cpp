// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>

#include "attributes/words.hpp"
#include "view/widgets.hpp"
#include "view/window_state.hpp"

namespace hexaplast::view {
namespace {

constexpr std::array kGhosts{"none", "initial", "without load"};
constexpr std::array kCuts{"none", "x", "y", "z"};

bool is_switch(const Parameter& parameter) { return parameter.attribute->type == attributes::Type::kBool; }

void draw_switch(Session& session, const Parameter& parameter, std::optional<double> value) {
  bool is_on = value.value_or(0) != 0;
  if (ImGui::Checkbox(parameter.name.c_str(), &is_on)) session.set(parameter.name, is_on ? 1 : 0);
  explain(std::string(parameter.attribute->help));
}

void draw_parameter(Session& session, const Parameter& parameter, std::optional<double> value) {
  const std::string &name = parameter.name, unit(parameter.attribute->unit);
  const bool is_factor = !parameter.of_hexahedra.empty();
  const std::string help = fmt::format(
      "{}\n{}{}{}", parameter.attribute->help, unit.empty() ? "" : "[" + unit + "]  ",
      attributes::describe(parameter.attribute->range),
      is_factor ? "\nEach hexahedron has its own; all of them are multiplied by the number on the slider." : "");
  const float end = ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x * 0.5f;
  ImGui::PushID(name.c_str());
  if (parameter.may_be_none) {
    bool is_given = value.has_value();
    if (ImGui::Checkbox("##given", &is_given))
      session.set(name, is_given ? std::optional(parameter.value.value_or(parameter.suggested)) : std::nullopt);
    explain(help + (name == parameter.attribute->name ? "\nWithout a check mark there is no limit."
                                                      : "\nWithout a check mark the region has the body's value."));
    ImGui::SameLine();
  }
  if (value) {
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_NoRoundToFormat | (parameter.is_logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    ImGui::SetNextItemWidth(end - ImGui::GetCursorPosX());
    if (ImGui::SliderScalar(name.c_str(), ImGuiDataType_Double, &*value, &parameter.min, &parameter.max,
                            is_factor ? "%.3g times" : fmt::format("%.4g {}", unit).c_str(), flags))
      session.set(name, *value);
  } else {
    ImGui::SetCursorPosX(end + ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextDisabled("%s", name.c_str());
  }
  explain(help);
  ImGui::PopID();
}

/// One of several words.
bool choose(const char* label, int& chosen, std::span<const char* const> words) {
  return ImGui::Combo(label, &chosen, words.data(), static_cast<int>(words.size()));
}

void draw_motion(WindowState& window) {
  const float across = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
  const ImVec2 button{(across - 3 * gap) / 4, 30};
  if (ImGui::Button(window.now.is_running ? "pause" : "run", button)) window.toggle_running();
  explain("Space");
  ImGui::SameLine();
  if (ImGui::Button("step", button)) window.session.advance(1);
  explain("S: one time step");
  ImGui::SameLine();
  if (ImGui::Button("reset", button)) window.reset();
  explain("R: back to the beginning, with the material as it is now");
  ImGui::SameLine();
  ImGui::BeginDisabled(window.now.num_undo == 0);
  if (ImGui::Button("undo", button)) window.undo();
  ImGui::EndDisabled();
  explain("U: back to the state before the hand took hold last. The sliders of the material go back too.");

  bool is_real_time = window.pace == Pace::kRealTime;
  if (ImGui::Checkbox("real time", &is_real_time)) {
    window.pace = is_real_time ? Pace::kRealTime : Pace::kFree;
    window.set_pace();
  }
  explain("Steps in real time if they are fast enough. Otherwise as fast as possible.");
  ImGui::SameLine();
  ImGui::BeginDisabled(!is_real_time);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const double slowest = 0.02, fastest = 5;
  if (ImGui::SliderScalar("##speed", ImGuiDataType_Double, &window.speed, &slowest, &fastest, "speed %.3g",
                          ImGuiSliderFlags_Logarithmic))
    window.set_pace();
  ImGui::EndDisabled();
  explain("Seconds of the simulation per second. Frames are dropped before steps are.");
}

void draw_regions(WindowState& window) {
  const std::vector<std::string>& names = window.regions().names;
  std::vector<int>& shown = window.look.regions;
  if (names.empty()) return;
  std::string words;
  for (const int region : shown) words += (words.empty() ? "" : ", ") + names[static_cast<std::size_t>(region - 1)];
  if (ImGui::BeginCombo("regions", words.empty() ? "whole body" : words.c_str())) {
    for (int region = 1; region <= std::ssize(names); ++region) {
      const auto at = std::ranges::find(shown, region);
      if (!ImGui::Selectable(names[static_cast<std::size_t>(region - 1)].c_str(), at != shown.end(),
                             ImGuiSelectableFlags_DontClosePopups))
        continue;
      if (at != shown.end())
        shown.erase(at);
      else
        shown.push_back(region);
    }
    ImGui::EndCombo();
  }
  explain("Regions that are shown within the body, which is then translucent");
}

void draw_view(WindowState& window) {
  if (ImGui::BeginCombo("colour", window.scale.quantity().label.data())) {
    for (const output::QuantityEntry& entry : output::kQuantities)
      if ((entry.quantity != Quantity::kRegion || !window.regions().names.empty()) &&
          ImGui::Selectable(entry.label.data(), entry.quantity == window.now.quantity))
        window.session.show(entry.quantity);
    ImGui::EndCombo();
  }
  draw_regions(window);
  int ghost = static_cast<int>(window.look.ghost);
  if (choose("ghost", ghost, kGhosts)) window.show_ghost(static_cast<Ghost>(ghost));
  explain("Shape behind the body: the initial shape, or the shape without load (G)");
  int cut = window.cut_axis + 1;
  if (choose("cut", cut, kCuts)) window.cut_axis = cut - 1;
  explain("X, Y, Z: leaves out what lies before a plane across this axis");
  if (window.cut_axis >= 0) {
    const double min = 0, max = 1;
    ImGui::SliderScalar("place of the cut", ImGuiDataType_Double, &window.cut_place, &min, &max,
                        fmt::format("{:.4g} m", std::abs(window.look.cut ? window.look.cut->offset : 0)).c_str());
  }
  ImGui::Checkbox(window.figure.has_embedded_surfaces() ? "cage" : "edges", &window.look.shows_edges);
  explain("W: edges of the hexahedra");
  if (window.figure.has_embedded_surfaces()) {
    ImGui::SameLine();
    ImGui::Checkbox("surfaces", &window.look.shows_embedded_surfaces);
    explain("Embedded surfaces");
  }
  ImGui::SameLine();
  ImGui::Checkbox("loads", &window.look.shows_instruments);
  explain("Instruments, and forces as arrows");
  if (ImGui::Button("fit")) window.fit();
  explain("F: looks at the whole body");
  ImGui::SameLine();
  if (ImGui::Button("window.png")) window.wants_picture = true;
  explain("P: writes a picture of this window");
}

void draw_hand(WindowState& window) {
  const HandSettings& usual = window.session.suggested_hand();
  int tool = static_cast<int>(window.hand.tool);
  if (choose("instrument", tool, kToolNames)) window.hand.tool = static_cast<Tool>(tool);
  explain(
      "grip: holds nodes by springs. scalpel: cuts where it is drawn. The others are rigid and touch the tissue: they "
      "press and rub, and never pull. The wheel pushes them away from you. Keys: 1 to 5");
  if (window.hand.tool == Tool::kScalpel) {
    slider("depth", "m", window.hand.depth, usual.depth / 20, usual.depth * 10,
           "Of the cut, below the place where it begins, away from you");
    return;
  }
  if (window.hand.tool != Tool::kGrip) {
    if (!window.session.touch_refusal().empty()) return tell(kRust, window.session.touch_refusal());
    slider("size", "m", window.hand.size, usual.size / 10, usual.size * 4,
           "Diameter of the sphere and the capsule, edge of the box");
    const double none = 0, max = 2;
    ImGui::SliderScalar("friction", ImGuiDataType_Double, &window.hand.friction, &none, &max, "%.3g");
    explain("Coefficient of friction between instrument and tissue");
    return;
  }
  slider("radius", "m", window.hand.radius, usual.radius / 5, usual.radius * 10,
         "The hand holds the nodes of the surface within this distance of its grip.");
  slider("stiffness", "N/m", window.hand.stiffness, usual.stiffness / 100, usual.stiffness * 100,
         "Of the spring between the mouse and the held nodes");
  slider("max force", "N", window.hand.max_force, usual.max_force / 100, usual.max_force * 100,
         "Largest force of the hand, for any distance of the mouse.");
  slider("damping", "N s/m", window.hand.damping, usual.damping / 100, usual.damping * 10,
         "Of a dashpot parallel to the spring: it prevents oscillation about the mouse.");
}

}  // namespace

void draw_controls(WindowState& window) {
  ImGui::TextUnformatted(window.session.title().c_str());
  ImGui::TextDisabled("step %ld   t = %.3f s", window.now.step, window.now.sample.time);
  draw_motion(window);
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.5f);
  heading("view");
  draw_view(window);
  heading("material");
  const std::vector<Parameter>& parameters = window.session.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (!is_switch(parameters[k])) draw_parameter(window.session, parameters[k], window.now.parameter_values[k]);
  if (std::ranges::any_of(parameters, is_switch)) heading("contact");
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (is_switch(parameters[k])) draw_switch(window.session, parameters[k], window.now.parameter_values[k]);
  heading("hand");
  draw_hand(window);
  ImGui::PopItemWidth();
  if (!window.now.failure.empty()) tell(kRust, window.now.failure + "\nReset returns to the initial state.");
  if (!window.message.empty()) tell(kFaint, window.message);
}

void draw_plots(const WindowState& window) {
  const Traces& traces = window.traces;
  const double begin = std::max(window.now.sample.time - Traces::kSpan, 0.0), end = begin + Traces::kSpan;
  const auto draw = [&](const char* title, const char* unit, std::initializer_list<Curve> curves) {
    plot(title, unit, curves, begin, end);
  };
  for (std::size_t p = 0; p < traces.probes.size(); ++p) {
    const auto& [name, unit] = window.probes[p];
    draw(name.c_str(), unit.empty() ? "-" : unit.c_str(), {{"", kSteel, traces.probes[p]}});
  }
  draw("elongation", "%",
       {{"current", kSteel, traces.current_elongation}, {"plastic", kRust, traces.plastic_elongation}});
  draw("max plastic strain", "-", {{"", kRust, traces.plastic_strain}});
  draw("volume error", "%",
       {{"current", kSteel, traces.current_volume}, {"plastic", kRust, traces.plastic_rest_volume}});
  draw("energy", "J",
       {{"kin", kLeaf, traces.kinetic}, {"el", kSteel, traces.elastic}, {"diss", kRust, traces.dissipated}});
  if (!traces.step_ms.empty()) {
    const double last = traces.step_ms.latest_time();
    plot("time of a step", "ms", {{"", kInk, traces.step_ms}}, last - Traces::kSteps, last);
    ImGui::TextDisabled("median %.3g ms   99th percentile %.3g ms", traces.step_ms.quantile(0.5),
                        traces.step_ms.quantile(0.99));
  }
  ImGui::TextDisabled("a step lasts %.4g ms of simulated time", 1e3 * window.session.dt());
}

}  // namespace hexaplast::view
