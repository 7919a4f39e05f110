// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "record/viewer_states.hpp"

namespace hexaplast::python {

/// The motion of bodies for the viewer: states at equal distances of steps, which grow where there are too many.
class MotionRecord {
 public:
  /// owner: keeps the bodies alive. Throws InputError where there is no body, or too large a mesh for the viewer.
  MotionRecord(std::vector<output::Bodies::Entry> bodies, std::shared_ptr<const void> owner, std::string title,
               double dt, long first_step);

  MotionRecord(const MotionRecord&) = delete;  // the states refer to bodies_
  MotionRecord& operator=(const MotionRecord&) = delete;

  bool wants(long step) const { return (step - first_step_) % stride_ == 0; }
  void add(long step, ConstPoints positions, ConstPoints velocities, const output::BoundaryConditions& conditions);

  /// A page with all that was added, and the present state behind it.
  std::string page(long step, ConstPoints positions, ConstPoints velocities,
                   const output::BoundaryConditions& conditions) const;

 private:
  std::shared_ptr<const void> owner_;
  output::Bodies bodies_;
  std::string title_;
  long first_step_, stride_ = 1;
  output::ViewerStates states_;
  double dt_;  // [s]
};

}  // namespace hexaplast::python
