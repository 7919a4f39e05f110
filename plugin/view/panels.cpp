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

constexpr std::array kGhosts{"none", "initial", "without load"};

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
  explain("Steps in real time if they are fast enough. Otherwise as fast as possible.");
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
  explain("Shape behind the body: the initial shape, or the shape without load (G)");
  ImGui::Checkbox(window.figure.has_embedded_surfaces() ? "cage" : "edges", &window.look.shows_edges);
  explain("W: edges of the hexahedra");
  if (window.figure.has_embedded_surfaces()) {
    ImGui::SameLine();
    ImGui::Checkbox("embedded surfaces", &window.look.shows_embedded_surfaces);
  }

  heading("material");
  const std::vector<Parameter>& parameters = window.session.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (!is_switch(parameters[k])) draw_parameter(window.session, parameters[k], window.now.parameter_values[k]);

  if (std::ranges::any_of(parameters, is_switch)) heading("contact");
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (is_switch(parameters[k])) draw_switch(window.session, parameters[k], window.now.parameter_values[k]);

  heading("hand");
  ImGui::PushItemWidth(across * 0.5f);
  const HandSettings& usual = window.session.suggested_hand();
  slider("radius", "m", window.hand.radius, usual.radius / 5, usual.radius * 10,
         "The hand holds the nodes of the surface within this distance of its grip.");
  slider("stiffness", "N/m", window.hand.stiffness, usual.stiffness / 100, usual.stiffness * 100,
         "Of the spring between the mouse and the held nodes");
  slider("max force", "N", window.hand.max_force, usual.max_force / 100, usual.max_force * 100,
         "Largest force of the hand, for any distance of the mouse.");
  slider("damping", "N s/m", window.hand.damping, usual.damping / 100, usual.damping * 10,
         "Of a dashpot parallel to the spring: it prevents oscillation about the mouse.");
  ImGui::PopItemWidth();

  if (!window.now.failure.empty()) tell(kRust, window.now.failure + "\nReset returns to the initial state.");
  if (!window.message.empty()) tell(kFaint, window.message);
}

void draw_plots(const WindowState& window) {
  const double end = std::max(window.now.sample.time, Traces::kSpan), begin = end - Traces::kSpan;
  plot("elongation", "%",
       {{"current", kSteel, window.traces.world_elongation}, {"plastic", kRust, window.traces.plastic_elongation}},
       begin, end);
  plot("max plastic strain", "-", {{"", kRust, window.traces.plastic_strain}}, begin, end);
  plot("volume error", "%",
       {{"current", kSteel, window.traces.world_volume}, {"plastic", kRust, window.traces.material_volume}}, begin,
       end);
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
