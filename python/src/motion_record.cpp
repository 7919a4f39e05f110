// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion_record.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "page/html.hpp"

namespace hexaplast::python {
namespace {

const hexaplast::Body& small_enough(const std::shared_ptr<const hexaplast::Body>& body) {
  if (!body) throw InputError("the scene has no body to show");
  const int num_nodes = body->mesh().num_nodes();
  if (num_nodes > output::ViewerStates::kMostNodes)
    throw InputError(
        fmt::format("the body has {} nodes: the viewer shows at most {}", num_nodes, output::ViewerStates::kMostNodes));
  return *body;
}

}  // namespace

MotionRecord::MotionRecord(std::shared_ptr<const hexaplast::Body> body, std::string title, double dt, long first_step)
    : body_(std::move(body)),
      bodies_(small_enough(body_)),
      title_(std::move(title)),
      first_step_(first_step),
      states_(bodies_, title_, first_step, dt, {}, {}),
      dt_(dt) {}

void MotionRecord::add(long step, ConstPoints positions, ConstPoints velocities,
                       const output::BoundaryConditions& conditions) {
  if (states_.has(step)) return;
  states_.add(step, static_cast<double>(step) * dt_, positions, velocities, conditions);
  if (states_.num_states() <= states_.most_states()) return;
  states_.halve();
  stride_ *= 2;
}

std::string MotionRecord::page(long step, ConstPoints positions, ConstPoints velocities,
                               const output::BoundaryConditions& conditions) const {
  output::ViewerStates states = states_;
  if (!states.has(step)) states.add(step, static_cast<double>(step) * dt_, positions, velocities, conditions);
  return output::viewer_page(title_, output::viewer_markup(states.json()).markup);
}

}  // namespace hexaplast::python
