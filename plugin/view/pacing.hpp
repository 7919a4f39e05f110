// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace hexaplast::view {

/// When steps in real time are due, and whether there is time to show them. Knows no clock: the caller says what time
/// it is.
class Pacing {
 public:
  using Clock = std::chrono::steady_clock;

  /// [s] that a step takes on the clock. The next one is due now.
  void set_step(double seconds, Clock::time_point now) {
    step_lasts_ = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    due_ = now;
  }
  void begin(Clock::time_point now) { due_ = now; }

  Clock::time_point due() const { return due_; }  ///< of the next step
  bool is_due(Clock::time_point now) const { return now >= due_; }
  bool is_late(Clock::time_point now) const { return now > due_ + step_lasts_; }

  /// A step has been made.
  void end_step(Clock::time_point now) {
    due_ += step_lasts_;
    if (due_ + kMaxDelay < now) due_ = now;
  }

  /// The latest snapshot is so old that the next one is made however late steps are.
  bool is_show_due(Clock::time_point now) const { return now - shown_ > kSlowestFrame; }
  void show(Clock::time_point now) { shown_ = now; }

 private:
  static constexpr auto kSlowestFrame = std::chrono::milliseconds(200);
  static constexpr auto kMaxDelay = std::chrono::milliseconds(100);  // beyond it, lost time is not made up for

  Clock::duration step_lasts_ = {};
  Clock::time_point due_ = {}, shown_ = {};
};

}  // namespace hexaplast::view
