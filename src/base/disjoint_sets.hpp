// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace hexaplast {

/// Sets of the numbers from 0 that grow together (union-find); every number is at first alone.
class DisjointSets {
 public:
  explicit DisjointSets(int count = 0) { assign(count); }

  /// Numbers up to `count`, each alone again.
  void assign(int count) {
    parent_.resize(static_cast<std::size_t>(count));
    std::iota(parent_.begin(), parent_.end(), 0);
    num_sets_ = count;
  }

  /// One number more.
  void add() {
    parent_.push_back(num_members());
    ++num_sets_;
  }

  /// The set of `b` joins that of `a`, whose root stays.
  void join(int a, int b) {
    const int of_a = root(a), of_b = root(b);
    if (of_a == of_b) return;
    parent_[static_cast<std::size_t>(of_b)] = of_a;
    --num_sets_;
  }

  /// One member of the set that stands for it.
  int root(int member) {
    auto at = static_cast<std::size_t>(member);
    while (parent_[at] != static_cast<int>(at))
      at = static_cast<std::size_t>(parent_[at] = parent_[static_cast<std::size_t>(parent_[at])]);
    return static_cast<int>(at);
  }

  int num_members() const { return static_cast<int>(parent_.size()); }
  int num_sets() const { return num_sets_; }

 private:
  std::vector<int> parent_;
  int num_sets_ = 0;
};

}  // namespace hexaplast
