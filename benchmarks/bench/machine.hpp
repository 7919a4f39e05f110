// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hexaplast/material/material.hpp"

namespace hexaplast::bench {

/// What the machine can do at best at this moment, with the library's instruction set (hexaplast/base/simd.hpp):
/// independent fused multiply-adds in registers, and sums over arrays of several sizes. Both written with the same SIMD
/// library as the kernels, chosen at run time alike. On a shared machine the figures fall with the load, as the
/// kernels' do.
class MachineLimits {
 public:
  /// Measures for each number of threads; takes about a third of a second per number.
  explicit MachineLimits(const std::vector<int>& threads);

  /// [GFLOP/s] of multiply-adds, two operations each, in the numbers that the products are computed in.
  double peak_gflops(Precision precision, int threads) const;

  /// [GB/s] of reading an array of that size over and over; between two measured sizes the smaller one counts.
  double read_gbs(std::size_t bytes, int threads) const;

  /// Model of the processor, as the system names it.
  static std::string processor();

 private:
  struct Limits {
    int threads;
    double gflops_double, gflops_single;
    std::vector<double> read_gbs;  // per entry of kWorkingSets
  };
  const Limits& of(int threads) const;
  std::vector<Limits> limits_;
};

}  // namespace hexaplast::bench
