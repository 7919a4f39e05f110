// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/config.h>
#include <sofa/core/objectmodel/Event.h>

namespace sofa::simulation {

class AnimateBeginEvent : public core::objectmodel::Event {
 public:
  explicit AnimateBeginEvent(SReal dt) : dt_(dt) {}
  SReal getDt() const { return dt_; }
  static bool checkEventType(const Event* event) { return dynamic_cast<const AnimateBeginEvent*>(event); }

 private:
  SReal dt_;
};

}  // namespace sofa::simulation
