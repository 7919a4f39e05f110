// SPDX-License-Identifier: LGPL-2.1-or-later
// Enough of CUDA to run the kernels on the CPU. The threads of a block take turns, each from one barrier to the next:
// what lacks a barrier has other bits where the turns go backwards.
#pragma once

#include <setjmp.h>
#include <ucontext.h>

#include <cstring>
#include <functional>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

struct float4 {
  float x, y, z, w;
};
struct uint4 {
  unsigned x, y, z, w;
};
struct double4_32a {
  double x, y, z, w;
};
inline float4 make_float4(float x, float y, float z, float w) { return {x, y, z, w}; }

#define __host__
#define __device__
#define __global__
#define __shared__ static
#define __launch_bounds__(...)

struct Index {
  unsigned x;
};
inline Index threadIdx, blockIdx, gridDim;

/// A thread of the largest block, for all kernels one after the other.
struct EmulatedThread {
  ucontext_t context;
  jmp_buf place;  ///< where it waits
  char stack[1 << 16];
  bool has_begun = false, is_done = false;
};
inline std::vector<EmulatedThread> emulated(256);
inline jmp_buf turns;  ///< where its turn ends
inline std::function<void()> emulated_kernel;
inline bool goes_backwards = false;
inline std::mutex one_at_a_time;  ///< of all kernels

inline void end_turn() {
  if (_setjmp(emulated[threadIdx.x].place) == 0) _longjmp(turns, 1);
}
inline void begin_turn(EmulatedThread& thread) {
  if (_setjmp(turns) != 0) return;
  if (std::exchange(thread.has_begun, true)) _longjmp(thread.place, 1);
  getcontext(&thread.context);
  thread.context.uc_stack = {.ss_sp = thread.stack, .ss_flags = 0, .ss_size = sizeof thread.stack};
  const auto run = [] {
    for (;; end_turn()) {
      emulated_kernel();
      emulated[threadIdx.x].is_done = true;
    }
  };
  makecontext(&thread.context, run, 0);
  setcontext(&thread.context);
}

/// All threads of a block that have not returned wait at the same barriers.
inline void __syncthreads() { end_turn(); }
inline void __syncwarp() { end_turn(); }
inline void __threadfence() {}
inline void __pipeline_memcpy_async(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
inline void __pipeline_commit() {}
inline void __pipeline_wait_prior(int) {}
inline double __ldcg(const double* a) { return *a; }
inline unsigned atomicInc(unsigned* a, unsigned last) {
  const unsigned before = *a;
  *a = before == last ? 0 : before + 1;
  return before;
}

inline void emulate_block(int threads) {
  for (EmulatedThread& thread : std::span(emulated).first(threads)) thread.is_done = false;
  for (int left = threads; left > 0;)
    for (int t = 0; t < threads; ++t) {
      threadIdx.x = goes_backwards ? threads - 1 - t : t;
      EmulatedThread& thread = emulated[threadIdx.x];
      if (thread.is_done) continue;
      begin_turn(thread);
      left -= thread.is_done;
    }
}

template <class... Parameters, class... Args>
void emulate(void (*kernel)(Parameters...), int blocks, int threads, const Args&... args) {
  const std::lock_guard lock(one_at_a_time);
  emulated_kernel = [&] { kernel(args...); };
  gridDim.x = blocks;
  for (int block = 0; block < blocks; ++block) {
    blockIdx.x = goes_backwards ? blocks - 1 - block : block;
    emulate_block(threads);
  }
}
