// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/parallel.hpp"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

#include "base/require.hpp"
#include "base/thread_pool.hpp"

namespace hexaplast {

namespace {

std::atomic<int> threads_in_use = 1;

thread_local bool is_in_loop = false;

/// The threads of the process, made by the first loop that wants them.
class Threads {
 public:
  constexpr Threads() = default;
  ~Threads() {
    const std::lock_guard<std::mutex> lock(busy_);
    has_ended_ = true;
    pool_.reset();
  }

  /// False where another thread of the program is in a loop, or the program ends.
  bool run(int count, ThreadPool::Range range, const void* body);

  /// A process that was forked has none of the threads of the one before: they are forgotten, not waited for.
  void forget() {
    new (&busy_) std::mutex;
    static_cast<void>(pool_.release());
  }

 private:
  std::mutex busy_;
  std::unique_ptr<ThreadPool> pool_;
  int size_ = 0;
  bool has_ended_ = false;
};

constinit Threads threads;

bool Threads::run(int count, ThreadPool::Range range, const void* body) {
  const std::unique_lock<std::mutex> lock(busy_, std::try_to_lock);
  if (!lock || has_ended_) return false;
  if (const int wanted = num_threads(); !pool_ || size_ != wanted) {
    [[maybe_unused]] static const int once = pthread_atfork(nullptr, nullptr, [] { threads.forget(); });
    pool_.reset();
    pool_ = std::make_unique<ThreadPool>(wanted);
    size_ = wanted;
  }
  pool_->run(count, range, body);
  return true;
}

// Nodes per partial sum: the chunks, not the threads, fix the order of addition.
constexpr int kChunk = 1024;

}  // namespace

void set_num_threads(int count) { threads_in_use.store(std::clamp(count, 1, kMaxThreads), std::memory_order_relaxed); }
int num_threads() { return threads_in_use.load(std::memory_order_relaxed); }

void run_in_parallel(int count, void (*range)(const void* body, int first, int last) noexcept, const void* body) {
  struct InLoop {
    InLoop() { is_in_loop = true; }
    ~InLoop() { is_in_loop = false; }
  };
  bool done = false;
  // a worker is in a loop: it must not even ask, or the lock's cache line goes from one to the other in every loop
  if (!is_in_loop && !ThreadPool::is_worker()) {
    const InLoop scope;
    done = threads.run(count, range, body);
  }
  if (!done) range(body, 0, count);
}

double dot(ConstPoints a, ConstPoints b) {
  require_rows("dot", "b", b, a.rows());
  const int num_nodes = static_cast<int>(a.rows());
  const int num_chunks = (num_nodes + kChunk - 1) / kChunk;

  const auto chunk_sum = [&](int chunk) {
    const int first = chunk * kChunk;
    const int count = std::min(kChunk, num_nodes - first);
    double sum = 0;
    for (int n = first; n < first + count; ++n) sum += a(n, 0) * b(n, 0) + a(n, 1) * b(n, 1) + a(n, 2) * b(n, 2);
    return sum;
  };
  if (num_chunks == 1) return chunk_sum(0);

  thread_local std::vector<double> partial;  // kept between calls: a step allocates nothing
  partial.resize(num_chunks);
  double* const sums = partial.data();
  parallel_for(num_chunks, [&](int chunk) { sums[chunk] = chunk_sum(chunk); });
  double sum = 0;
  for (int chunk = 0; chunk < num_chunks; ++chunk) sum += sums[chunk];
  return sum;
}

}  // namespace hexaplast
