// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/window_state.hpp"

#include "hexaplast/geometry/sections.hpp"

namespace hexaplast::view {
namespace {

/// Where the viewer stands at first: as in the pictures of a run.
Camera first_camera(const HexMesh& mesh, const output::Staging& staging) {
  const int long_axis = end_sections(mesh).axis;
  if (staging.viewpoint) {
    const Vec3& towards = staging.viewpoint->towards;
    const bool from_above = Vec3::UnitY().cross(towards.normalized()).norm() < 0.05;
    const Vec3 up = staging.viewpoint->up.value_or(from_above ? Vec3(-Vec3::UnitZ()) : Vec3(Vec3::UnitY()));
    return {up, towards};
  }
  const Vec3 upright = Vec3::Unit(long_axis == 1 ? 2 : 1), along = Vec3::Unit(long_axis);
  return {upright, along.cross(upright) + 0.45 * along + 0.42 * upright};
}

}  // namespace

WindowState::WindowState(WindowCall& call)
    : session(call.subject, call.make),
      figure(session.mesh(), call.staging, call.fixed_nodes),
      camera(first_camera(session.mesh(), call.staging)),
      hand(session.suggested_hand()),
      pace(call.options.pace) {
  look.shows_edges = call.staging.shows_hexahedra || !figure.has_embedded_surfaces();
  look.shows_embedded_surfaces = figure.has_embedded_surfaces();
  session.set_pace(pace);
}

void WindowState::take(double clock) {
  frames.count(1, clock);
  long num_steps = 0;
  if (session.take(now)) {
    num_steps = static_cast<long>(now.step_ms.size());
    traces.add(now);
    for (const std::string& said : now.messages) message = said;
    if (shown_quantity_ != now.quantity) greatest_.setEmpty();
    shown_quantity_ = now.quantity;
  }
  steps.count(num_steps, clock);
  figure.update(now, look);
  greatest_.extend(figure.range());
}

void WindowState::toggle_running() {
  if (now.is_running)
    session.pause();
  else
    session.run();
}

void WindowState::reset() {
  session.reset();
  traces = {};
  greatest_.setEmpty();
}

void WindowState::fit() { camera.fit(figure.box()); }

std::optional<std::pair<double, double>> WindowState::scale() const {
  if (greatest_.isEmpty()) return std::nullopt;
  return std::pair(colouring().begins_at_zero ? 0 : greatest_.min()[0], greatest_.max()[0]);
}

}  // namespace hexaplast::view
