// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_race shared|own: four threads add numbers, all to one sum (a race, which the thread sanitizer must report:
// if it does not, its silence elsewhere means nothing) or each to sums of its own that are read after the loop (none).
#include <chrono>
#include <cstdio>
#include <numeric>
#include <string_view>
#include <thread>
#include <vector>

#include "hexaplast/base/parallel.hpp"

int main(int argc, char** argv) {
  const std::string_view sums = argc == 2 ? argv[1] : "";
  if (sums != "shared" && sums != "own") {
    std::fprintf(stderr, "usage: %s shared|own\n", argv[0]);
    return 2;
  }
  constexpr int kCount = 1000;
  hexaplast::set_num_threads(4);
  std::vector<long> sum(sums == "shared" ? 1 : kCount, 0);
  hexaplast::parallel_for(kCount, [&](int i) {
    std::this_thread::sleep_for(
        std::chrono::microseconds(20));  // so that one thread alone cannot be done with all of them
    sum[i % sum.size()] += i;
  });
  std::printf("%ld\n", std::accumulate(sum.begin(), sum.end(), 0L));
}
