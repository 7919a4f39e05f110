// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace hexaplast::runner {
namespace {

constexpr int kBarWidth = 24;                               // [character]
constexpr auto kInterval = std::chrono::milliseconds(100);  // between two redraws

}  // namespace

Progress::Progress(long num_steps, bool is_wanted)
    : num_steps_(num_steps), is_shown_(is_wanted && isatty(STDERR_FILENO) != 0) {}

void Progress::show(long step, double time, int yielded) {
  if (!is_shown_ || (Clock::now() - last_ < kInterval && step < num_steps_)) return;
  last_ = Clock::now();
  const double seconds = std::chrono::duration<double>(last_ - begin_).count();
  const int filled = static_cast<int>(kBarWidth * std::min(step, num_steps_) / std::max(num_steps_, 1L));
  fmt::print(stderr, "\r\x1b[K[{}{}] {}/{}  t = {:.3f} s  {:.0f} steps/s  {} yielded", std::string(filled, '#'),
             std::string(kBarWidth - filled, '.'), step, num_steps_, time, static_cast<double>(step) / seconds,
             yielded);
  std::fflush(stderr);
  is_on_screen_ = true;
}

Progress::~Progress() {
  if (!is_on_screen_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
}

}  // namespace hexaplast::runner
