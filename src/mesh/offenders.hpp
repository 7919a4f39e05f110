// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

/// Collects offending ids; throws one message that names the first ten.
class Offenders {
 public:
  void add(int id) {
    if (first_.size() < kNamed) first_.push_back(std::to_string(id));
    ++count_;
  }

  /// "ID as OTHER"
  void add(int id, int other) {
    if (first_.size() < kNamed) first_.push_back(fmt::format("{} as {}", id, other));
    ++count_;
  }

  /// "12 WHAT: 0, 1, 2, ...; ALLOWED", as an InputError; nothing where there are none.
  void refuse(const char* what, const char* allowed) const {
    if (count_ > 0) throw InputError(fmt::format("{} {}: {}; {}", count_, what, list(), allowed));
  }

  int count() const { return count_; }
  std::string list() const {
    return fmt::format("{}{}", fmt::join(first_, ", "), count_ > static_cast<int>(kNamed) ? ", ..." : "");
  }

 private:
  static constexpr std::size_t kNamed = 10;  // how many offenders a message lists
  std::vector<std::string> first_;
  int count_ = 0;
};

}  // namespace hexaplast
