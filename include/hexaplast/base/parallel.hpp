// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <atomic>
#include <exception>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

inline constexpr int kMaxThreads = 1024;

/// Number of threads of every parallel loop of the library, from 1 to kMaxThreads: what lies beyond is taken as the
/// nearest of them. Results do not depend on it, bit for bit. The kernels of a body have one part for each 512
/// hexahedra, at most 16: more threads than parts have nothing to do there.
void set_num_threads(int count);
int num_threads();

/// What leaves a parallel loop: the first exception that was caught in it.
class LoopError {
 public:
  void keep() noexcept {
    if (!has_one_.test_and_set()) error_ = std::current_exception();
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic_flag has_one_;
  std::exception_ptr error_;
};

/// Calls range(body, first, last) for consecutive parts of [0, count), on all threads. Use parallel_for.
void run_in_parallel(int count, void (*range)(const void* body, int first, int last) noexcept, const void* body);

/// Calls body(i) for every i in [0, count). The calls may run concurrently, so each writes only what belongs to its i.
/// Where one throws, one such exception is thrown on when the loop has ended, others may not have been called. A loop
/// that is begun within another, or while another thread of the program is in one, runs on the thread that calls it.
///
/// A thread that waits spins for some tens of microseconds at most, then it sleeps; a loop waits only for threads that
/// have begun a part of it. So the loop does not stand still where other programs keep the processors busy.
template <class Body>
void parallel_for(int count, const Body& body) {
  if (num_threads() == 1 || count <= 1) {
    for (int i = 0; i < count; ++i) body(i);
    return;
  }
  struct Loop {
    const Body& body;
    mutable LoopError error = {};
  } loop{body};
  const auto range = [](const void* of, int first, int last) noexcept {
    const Loop& called = *static_cast<const Loop*>(of);
    try {
      for (int i = first; i < last; ++i) called.body(i);
    } catch (...) {
      called.error.keep();
    }
  };
  run_in_parallel(count, range, &loop);
  loop.error.rethrow();
}

/// Sum of the element-wise product of two nodal fields of equal size, InputError otherwise.
/// Added in fixed chunks and then over the chunks, so that the bits do not depend on the number of threads.
double dot(ConstPoints a, ConstPoints b);

}  // namespace hexaplast
