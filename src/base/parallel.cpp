// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/parallel.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

namespace hexaplast {

namespace {

int threads_in_use = 1;

// Nodes per partial sum: the chunks, not the threads, fix the order of addition.
constexpr int kChunk = 1024;

}  // namespace

void set_num_threads(int count) { threads_in_use = std::max(count, 1); }
int num_threads() { return threads_in_use; }

double dot(ConstPoints a, ConstPoints b) {
  assert(a.rows() == b.rows());
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
