// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace hexaplast::runner {

/// A line on the terminal that follows a run. Shows nothing when stderr is not a terminal, so that logs hold
/// no control codes.
class Progress {
 public:
  Progress(long num_steps, bool is_wanted);
  ~Progress();  ///< takes the line away

  /// Steps, simulated time [s], steps per second, yielded hexahedra.
  void show(long step, double time, int yielded);

 private:
  using Clock = std::chrono::steady_clock;

  long num_steps_;
  bool is_shown_;  // stderr is a terminal
  bool is_on_screen_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = {};
};

}  // namespace hexaplast::runner
