// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

namespace hexaplast {

/// How long a thread spins before it sleeps: longer while spinning pays, hardly at all while it does not.
class Patience {
 public:
  /// Spins until arrived() holds; false where it did not in time.
  template <class Arrived>
  bool spin_until(const Arrived& arrived);

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kMin = std::chrono::microseconds(2), kMax = std::chrono::microseconds(50);
  Clock::duration limit_ = kMax;
};

/// Threads that run one loop at a time together with the thread that calls.
///
/// Every thread has a share of consecutive indices, the same in every loop of the same length, so that what it has in
/// its cache serves it again. It takes its share in parts from the front; when that is empty it takes half of what is
/// left of another's, from the back. The caller waits only for threads that are inside the loop: one that other
/// programs keep from running has taken nothing, and its share is done by the rest. Where it has waited for one that
/// was stopped inside, it runs the following loops alone, four times as long as it has lost: waiting costs at most a
/// fifth.
class ThreadPool {
 public:
  using Range = void (*)(const void* body, int first, int last) noexcept;

  /// `threads` counts the caller. Where the system refuses some, the pool is smaller.
  explicit ThreadPool(int threads);
  ~ThreadPool();

  /// Whether the calling thread is one that a pool has made.
  static bool is_worker();

  /// Calls range(body, first, last) for consecutive parts of [0, count). One caller at a time.
  void run(int count, Range range, const void* body);

 private:
  using Clock = std::chrono::steady_clock;

  /// What is left of a share: first index and end, 32 bits each. On a cache line of its own.
  struct alignas(64) Share {
    std::atomic<std::uint64_t> left{0};
  };

  void live(int number);
  /// The number of indices done.
  int work(int number);
  bool enter();
  void leave();
  void wait_for_those_inside();

  int threads_;
  std::unique_ptr<Share[]> shares_;  // the caller's is the first
  std::vector<std::thread> workers_;

  int count_ = 0;  // of the present loop, as the next two: written while nobody is inside
  Range range_ = nullptr;
  const void* body_ = nullptr;

  static constexpr std::uint32_t kOpen = 1u << 31;
  alignas(64) std::atomic<std::uint32_t> call_{0};  // rises by one with every loop
  alignas(64) std::atomic<std::uint32_t> gate_{0};  // kOpen while workers may enter, plus the number of those inside
  std::atomic<bool> ends_{false};
  Patience patience_;                // the caller's
  Clock::time_point alone_until_{};  // likewise
};

}  // namespace hexaplast
