// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/window_state.hpp"

#include <algorithm>

namespace hexaplast::view {
namespace {

/// Where the viewer stands at first: as in the pictures of a run.
Camera first_camera(const HexMesh& mesh, const output::Staging& staging) {
  const output::Viewpoint viewpoint = staging.seen_from(mesh);
  const bool from_above = viewpoint.up->normalized().cross(viewpoint.towards.normalized()).norm() < 0.05;
  return {from_above ? Vec3(output::Camera(viewpoint).up().cast<double>()) : *viewpoint.up, viewpoint.towards};
}

}  // namespace

WindowState::WindowState(WindowCall& call)
    : session(call.session),
      figure(session.mesh(), call.staging),
      camera(first_camera(session.mesh(), call.staging)),
      hand(session.suggested_hand()),
      bodies(call.bodies),
      probes(call.probes),
      pace(call.options.pace),
      speed(call.options.speed) {
  look.shows_edges = call.staging.shows_hexahedra || !figure.has_embedded_surfaces();
  look.shows_embedded_surfaces = figure.has_embedded_surfaces();
  look.shows_instruments = call.staging.shows_loads;
  look.regions = call.staging.shown_regions;
  session.show(call.staging.quantity);
  set_pace();
}

void WindowState::set_pace() { session.set_pace(pace, speed); }

void WindowState::show_ghost(Ghost ghost) {
  look.ghost = ghost;
  session.show_plastic_rest(ghost == Ghost::kPlasticRest);
}

void WindowState::take(double clock) {
  frames.count(1, clock);
  long num_steps = 0;
  if (session.take(now)) {
    num_steps = static_cast<long>(now.step_ms.size());
    traces.add(now);
    for (const std::string& said : now.messages) message = said;
    for (const output::Instrument& instrument : now.conditions.instruments)
      strongest.tool = std::max(strongest.tool, static_cast<float>(instrument.force().norm()));
    for (const output::NodalLoad& load : output::shown_loads(session.mesh(), now.alive, now.conditions))
      strongest.load = std::max(strongest.load, static_cast<float>(load.force.norm()));
  }
  if (scale.quantity().quantity != now.quantity) scale = empty_scale();
  steps.count(num_steps, clock);
  place_cut();
  figure.update(now, look, strongest);
  figure.see_values(scale);
}

/// The viewer stands above it.
void WindowState::place_cut() {
  look.cut.reset();
  if (cut_axis < 0) return;
  const auto [min, max] = extent_along(Vec3::Unit(cut_axis), session.mesh().positions(), session.mesh().hexahedra());
  const double offset = min + cut_place * (max - min);
  const double side = camera.eye()[cut_axis] >= offset ? 1 : -1;
  look.cut = Plane{side * Vec3::Unit(cut_axis), side * offset};
}

void WindowState::toggle_running() {
  if (now.is_running)
    session.pause();
  else
    session.run();
}

void WindowState::reset() {
  session.reset();
  traces = Traces();
  scale = empty_scale();
  strongest = {};
}

void WindowState::undo() {
  session.release();
  grabbed.reset();
  session.undo();
}

void WindowState::fit() { camera.fit(figure.box(), kBarStrip); }

}  // namespace hexaplast::view
