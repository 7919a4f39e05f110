// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hexaplast::runner {
namespace {

constexpr int kBarWidth = 24;  // [character]
constexpr auto kBetweenRedraws = std::chrono::milliseconds(100);
constexpr auto kBetweenLines = std::chrono::seconds(10);

/// "8 s", "2 min 10 s", "1 h 5 min"
std::string duration(double seconds) {
  const long whole = std::lround(std::min(seconds, 1e9));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

Progress::Progress(long first, long last, bool is_wanted)
    : first_(first), last_(last), is_wanted_(is_wanted), is_terminal_(isatty(STDERR_FILENO) != 0) {}

bool Progress::is_due(long done) const {
  const auto since = Clock::now() - latest_;
  return is_terminal_ ? since >= kBetweenRedraws || done >= last_ : since >= kBetweenLines;
}

void Progress::print(long done, const std::string& words) {
  latest_ = Clock::now();
  const double seconds = std::chrono::duration<double>(latest_ - begin_).count();
  const double rate = static_cast<double>(done - first_) / seconds;  // [1/s]
  std::string said = fmt::format("{} of {}  {}  {:.3g} per s", done, last_, words, rate);
  if (rate > 0) said += fmt::format("  {} left", duration(static_cast<double>(last_ - done) / rate));
  if (is_terminal_) {
    const int filled = static_cast<int>(kBarWidth * std::min(done, last_) / std::max(last_, 1L));
    fmt::print(stderr, "\r\x1b[K[{}{}] {}", std::string(filled, '#'), std::string(kBarWidth - filled, '.'), said);
    is_on_screen_ = true;
  } else {
    fmt::print(stderr, "{}\n", said);
  }
  std::fflush(stderr);
}

Progress::~Progress() {
  if (!is_on_screen_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
}

}  // namespace hexaplast::runner
