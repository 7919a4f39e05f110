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

Progress::Progress(long total, bool is_wanted) : total_(total), is_shown_(is_wanted && isatty(STDERR_FILENO) != 0) {}

bool Progress::is_due(long done) const { return is_shown_ && (Clock::now() - last_ >= kInterval || done >= total_); }

void Progress::show(long step, double time, int yielded) {
  if (!is_due(step)) return;
  const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  draw(step,
       fmt::format("t = {:.3f} s  {:.0f} steps/s  {} yielded", time, static_cast<double>(step) / seconds, yielded));
}

void Progress::show(long done, std::string_view words) {
  if (is_due(done)) draw(done, words);
}

void Progress::draw(long done, std::string_view words) {
  last_ = Clock::now();
  const int filled = static_cast<int>(kBarWidth * std::min(done, total_) / std::max(total_, 1L));
  fmt::print(stderr, "\r\x1b[K[{}{}] {}/{}  {}", std::string(filled, '#'), std::string(kBarWidth - filled, '.'), done,
             total_, words);
  std::fflush(stderr);
  is_on_screen_ = true;
}

void Progress::clear() {
  if (!is_on_screen_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  is_on_screen_ = false;
}

}  // namespace hexaplast::runner
