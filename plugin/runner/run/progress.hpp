// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <string>

namespace hexaplast::runner {

/// How far long work has come, on stderr: a line that is drawn anew on a terminal, and a line every ten seconds in a
/// log, which holds no control codes.
class Progress {
 public:
  /// Of `first` to `last`, for example steps.
  Progress(long first, long last, bool is_wanted);
  ~Progress();  ///< takes the line away from the terminal

  /// words(): what else there is to say, as text.
  template <class Words>
  void show(long done, const Words& words) {
    if (is_wanted_ && is_due(done)) print(done, words());
  }

 private:
  using Clock = std::chrono::steady_clock;

  bool is_due(long done) const;
  void print(long done, const std::string& words);

  long first_, last_;
  bool is_wanted_, is_terminal_;
  bool is_on_screen_ = false;
  Clock::time_point begin_ = Clock::now(), latest_ = begin_;
};

}  // namespace hexaplast::runner
