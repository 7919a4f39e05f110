// SPDX-License-Identifier: LGPL-2.1-or-later
// Enough of CUDA to run the kernels on the CPU, a thread each: to check them without a card, slowly.
#pragma once

#include <barrier>
#include <cstring>
#include <memory>
#include <thread>
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
inline thread_local Index threadIdx, blockIdx, gridDim;

struct Gates {
  explicit Gates(int threads) : block(threads) {
    for (int warp = 0; warp < threads / 32; ++warp) warps.push_back(std::make_unique<std::barrier<>>(32));
  }
  std::barrier<> block;
  std::vector<std::unique_ptr<std::barrier<>>> warps;
};
inline Gates* gates;
inline void __syncthreads() { gates->block.arrive_and_wait(); }
inline void __syncwarp() { gates->warps[threadIdx.x / 32]->arrive_and_wait(); }
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

template <class... Parameters, class... Args>
void emulate(void (*kernel)(Parameters...), int blocks, int threads, const Args&... args) {
  Gates here(threads);
  gates = &here;
  std::vector<std::thread> team;
  for (int t = 0; t < threads; ++t)
    team.emplace_back([&, t] {
      threadIdx.x = t;
      gridDim.x = blocks;
      for (int block = 0; block < blocks; ++block) {
        blockIdx.x = block;
        kernel(args...);
        __syncthreads();
      }
    });
  for (std::thread& thread : team) thread.join();
}
