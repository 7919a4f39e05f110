// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion_record.hpp"

#include <fmt/format.h>

#include <utility>

#include "hexaplast/base/error.hpp"
#include "page/html.hpp"

namespace hexaplast::python {
namespace {

output::Bodies small_enough(std::vector<output::Bodies::Entry> entries) {
  if (entries.empty()) throw InputError("the scene has no body to show");
  output::Bodies bodies(std::move(entries));
  const int num_nodes = bodies.mesh().num_nodes();
  if (num_nodes > output::ViewerStates::kMaxNodes)
    throw InputError(fmt::format("the {} {} nodes: the viewer shows at most {}",
                                 bodies.is_one() ? "body has" : "bodies have", num_nodes,
                                 output::ViewerStates::kMaxNodes));
  return bodies;
}

}  // namespace

MotionRecord::MotionRecord(std::vector<output::Bodies::Entry> bodies, std::shared_ptr<const void> owner,
                           std::string title, double dt, long first_step)
    : owner_(std::move(owner)),
      bodies_(small_enough(std::move(bodies))),
      title_(std::move(title)),
      first_step_(first_step),
      states_(bodies_, title_, first_step, dt, {}),
      dt_(dt) {}

void MotionRecord::add(long step, ConstPoints positions, ConstPoints velocities,
                       const output::BoundaryConditions& conditions) {
  if (states_.has(step)) return;
  states_.add(step, static_cast<double>(step) * dt_, positions, velocities, conditions);
  if (states_.num_states() <= states_.max_states()) return;
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
