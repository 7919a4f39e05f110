// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace hexaplast::view {

/// Counts events per second.
class Rate {
 public:
  void count(long events, double now) {
    events_ += events;
    if (now - begin_ < kSpan) return;
    per_second_ = static_cast<double>(events_) / (now - begin_);
    events_ = 0;
    begin_ = now;
  }
  double per_second() const { return per_second_; }

 private:
  static constexpr double kSpan = 0.25;  // [s] over which events are counted

  long events_ = 0;
  double begin_ = 0, per_second_ = 0;
};

}  // namespace hexaplast::view
