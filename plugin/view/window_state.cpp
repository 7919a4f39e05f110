// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/window_state.hpp"

#include <algorithm>

#include "view/page_picture.hpp"

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
    : source(call.source),
      session(call.session),
      replay(call.replay),
      figure(source.mesh(), call.staging),
      camera(first_camera(source.mesh(), call.staging)),
      hand(session ? session->suggested_hand() : HandSettings()),
      names(call.names),
      pace(call.options.pace),
      speed(call.options.speed) {
  look.shows_edges = call.staging.shows_hexahedra || !figure.has_embedded_surfaces();
  look.shows_embedded_surfaces = figure.has_embedded_surfaces();
  look.shows_instruments = call.staging.shows_loads;
  look.regions = call.staging.shown_regions;
  source.show(call.staging.quantity);
  if (replay) traces = traces_of(replay->directory(), names.probes);
  set_pace();
}

void WindowState::set_pace() { source.set_pace(pace, speed); }

void WindowState::show_ghost(Ghost ghost) {
  look.ghost = ghost;
  if (session) session->show_plastic_rest(ghost == Ghost::kPlasticRest);
}

void WindowState::take(double clock) {
  frames.count(1, clock);
  long num_steps = 0;
  if (source.take(now)) {
    num_steps = static_cast<long>(now.step_ms.size());
    if (session) traces.add(now);
    for (const std::string& said : now.messages) message = said;
    for (const output::Instrument& instrument : now.conditions.instruments)
      strongest.tool = std::max(strongest.tool, static_cast<float>(instrument.force().norm()));
    for (const output::NodalLoad& load : output::shown_loads(source.mesh(), now.alive, now.conditions))
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
  const auto [min, max] = extent_along(Vec3::Unit(cut_axis), source.mesh().positions(), source.mesh().hexahedra());
  const double offset = min + cut_place * (max - min);
  const double side = camera.eye()[cut_axis] >= offset ? 1 : -1;
  look.cut = Plane{side * Vec3::Unit(cut_axis), side * offset};
}

void WindowState::toggle_running() {
  if (now.is_running)
    source.pause();
  else
    source.run();
}

void WindowState::reset() {
  source.reset();
  if (session) traces = Traces();
  scale = empty_scale();
  strongest = {};
}

void WindowState::undo() {
  if (!session) return;
  session->release();
  grabbed.reset();
  session->undo();
}

output::Drawing WindowState::page() const { return page_picture(source, now, figure.staging(), look, camera, scale); }

void WindowState::fit() { camera.fit(figure.box(), kBarStrip); }

}  // namespace hexaplast::view
