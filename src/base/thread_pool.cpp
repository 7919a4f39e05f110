// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/thread_pool.hpp"

#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <exception>

namespace hexaplast {

namespace {

constexpr int kPartsOfAShare = 16;  // small enough that nobody waits long for a thread that was stopped inside one

// A loop with help that took this much longer than alone had a thread stopped by other programs, not a late one.
constexpr std::chrono::microseconds kLoss(50);
constexpr std::chrono::milliseconds kMaxLoss(25);  // of one loop that counts: the program itself may have been stopped
constexpr int kAlonePerLoss = 4;

thread_local bool is_of_a_pool = false;

std::uint64_t pack(std::uint32_t first, std::uint32_t end) { return std::uint64_t{first} << 32 | end; }

/// Indices [first, end), taken out of a share.
struct Part {
  int first = 0, end = 0;
  bool is_empty() const { return first >= end; }
};

Part part_of(std::uint64_t packed) { return {static_cast<int>(packed >> 32), static_cast<int>(packed & 0xffffffffu)}; }

std::uint64_t pack(const Part& part) {
  return pack(static_cast<std::uint32_t>(part.first), static_cast<std::uint32_t>(part.end));
}

/// Cuts what cut(left) says from what is left of a share; `rest` is what then stays.
template <class Cut>
Part take(std::atomic<std::uint64_t>& share, const Cut& cut) {
  std::uint64_t packed = share.load(std::memory_order_relaxed);
  for (;;) {
    const Part left = part_of(packed);
    if (left.is_empty()) return {};
    const auto [taken, rest] = cut(left);
    if (share.compare_exchange_weak(packed, pack(rest), std::memory_order_relaxed)) return taken;
  }
}

void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Signals are for the threads of the program, not for ours.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

}  // namespace

template <class Arrived>
bool Patience::spin_until(const Arrived& arrived) {
  constexpr int kBetweenLooksAtTheClock = 16;
  const Clock::time_point begin = Clock::now();
  do {
    for (int k = 0; k < kBetweenLooksAtTheClock; ++k) {
      if (arrived()) {
        limit_ = std::min(2 * limit_, kMax);
        return true;
      }
      pause();
    }
  } while (Clock::now() - begin < limit_);
  limit_ = std::max(limit_ / 2, kMin);
  return false;
}

ThreadPool::ThreadPool(int threads) : threads_(threads), shares_(std::make_unique<Share[]>(threads)) {
  const SignalsBlocked blocked;
  workers_.reserve(static_cast<std::size_t>(threads - 1));
  try {
    for (int number = 1; number < threads; ++number) workers_.emplace_back([this, number] { live(number); });
  } catch (const std::exception&) {  // std::system_error or std::bad_alloc
    // the shares of those that are not there are taken by the others
  }
}

ThreadPool::~ThreadPool() {
  ends_.store(true);
  call_.fetch_add(1);
  call_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::run(int count, Range range, const void* body) {
  const Clock::time_point begin = Clock::now();
  if (begin < alone_until_) return range(body, 0, count);

  count_ = count;
  range_ = range;
  body_ = body;
  for (int number = 0; number < threads_; ++number) {
    const auto edge = [&](int k) { return static_cast<std::uint32_t>(std::int64_t{count} * k / threads_); };
    shares_[number].left.store(pack(edge(number), edge(number + 1)), std::memory_order_relaxed);
  }
  gate_.store(kOpen, std::memory_order_release);
  call_.fetch_add(1);  // sequentially consistent, as what notify_all and wait ask of each other
  call_.notify_all();  // nothing but a look where nobody sleeps

  const int done = work(0);

  if ((gate_.fetch_and(~kOpen, std::memory_order_acq_rel) & ~kOpen) == 0) return;
  const Clock::time_point own_end = Clock::now();
  wait_for_those_inside();
  if (done == 0) return;
  const Clock::time_point end = Clock::now();
  const auto alone = (own_end - begin) * (static_cast<double>(count) / done);  // what the loop would have taken
  if (const auto loss = std::chrono::duration_cast<Clock::duration>(end - begin - alone); loss > kLoss)
    alone_until_ = end + kAlonePerLoss * std::min<Clock::duration>(loss, kMaxLoss);
}

void ThreadPool::wait_for_those_inside() {
  std::uint32_t inside = 0;
  const auto nobody_inside = [&] { return (inside = gate_.load(std::memory_order_acquire)) == 0; };
  if (patience_.spin_until(nobody_inside)) return;
  while (!nobody_inside()) gate_.wait(inside);
}

bool ThreadPool::is_worker() { return is_of_a_pool; }

void ThreadPool::live(int number) {
  is_of_a_pool = true;
  Patience patience;
  std::uint32_t seen = 0;
  while (!ends_.load()) {
    const auto called = [&] { return call_.load(std::memory_order_acquire) != seen; };
    if (!patience.spin_until(called)) call_.wait(seen);
    seen = call_.load(std::memory_order_acquire);
    if (!enter()) continue;
    work(number);
    leave();
  }
}

bool ThreadPool::enter() {
  std::uint32_t gate = gate_.load(std::memory_order_relaxed);
  while (gate & kOpen)
    if (gate_.compare_exchange_weak(gate, gate + 1, std::memory_order_acquire, std::memory_order_relaxed)) return true;
  return false;
}

void ThreadPool::leave() {
  if (gate_.fetch_sub(1, std::memory_order_release) == 1) gate_.notify_all();  // the gate is closed: the caller waits
}

int ThreadPool::work(int number) {
  using Cut = std::pair<Part, Part>;  // taken, rest
  const int size = std::max(count_ / (threads_ * kPartsOfAShare), 1);
  const auto from_the_front = [&](const Part& left) {
    const int middle = std::min(left.first + size, left.end);
    return Cut{{left.first, middle}, {middle, left.end}};
  };
  const auto half_from_the_back = [](const Part& left) {
    const int middle = left.first + (left.end - left.first) / 2;
    return Cut{{middle, left.end}, {left.first, middle}};
  };

  Share& own = shares_[number];
  int done = 0;
  for (;;) {
    for (Part part = take(own.left, from_the_front); !part.is_empty(); part = take(own.left, from_the_front)) {
      range_(body_, part.first, part.end);
      done += part.end - part.first;
    }
    Part stolen;
    for (int k = 1; k < threads_ && stolen.is_empty(); ++k)
      stolen = take(shares_[(number + k) % threads_].left, half_from_the_back);
    if (stolen.is_empty()) return done;
    own.left.store(pack(stolen), std::memory_order_relaxed);
  }
}

}  // namespace hexaplast
