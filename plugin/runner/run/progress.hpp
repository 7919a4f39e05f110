// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <string_view>

namespace hexaplast::runner {

/// A line on the terminal that follows a long command. Shows nothing when stderr is not a terminal, so that logs hold
/// no control codes.
class Progress {
 public:
  /// total: steps, or whatever the command counts
  Progress(long total, bool is_wanted);
  ~Progress() { clear(); }

  /// Of a run: steps, simulated time, steps per second, yielded hexahedra.
  void show(long step, double time, int yielded);

  /// How many are done, and words beside the bar.
  void show(long done, std::string_view words);

  /// Takes the line away, for other messages.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool is_due(long done) const;
  void draw(long done, std::string_view words);

  long total_;
  bool is_shown_;  // stderr is a terminal
  bool is_on_screen_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = {};
};

}  // namespace hexaplast::runner
