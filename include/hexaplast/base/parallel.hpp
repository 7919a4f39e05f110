// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Number of threads of every parallel loop of the library (at least 1). Results do not depend on it, bit for bit.
void set_num_threads(int count);
int num_threads();

/// Calls body(i) for every i in [0, count). The calls may run concurrently, so each writes only what belongs to its i.
template <class Body>
void parallel_for(int count, const Body& body) {
  const int threads = num_threads();
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (int i = 0; i < count; ++i) body(i);
}

/// Sum of the element-wise product of two nodal fields of equal size.
/// Added in fixed chunks and then over the chunks, so that the bits do not depend on the number of threads.
double dot(ConstPoints a, ConstPoints b);

}  // namespace hexaplast
