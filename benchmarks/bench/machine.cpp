// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/machine.cpp"
#include "hwy/foreach_target.h"
//
#include "bench/machine.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Multiply-adds of `rounds` rounds over twelve independent registers, enough to hide the latency of each: returns how
/// many numbers went through. `sink` keeps the compiler from leaving them out.
template <class T>
double multiply_add(long rounds, double& sink) {
  const hn::ScalableTag<T> tag;
  using V = hn::Vec<decltype(tag)>;
  const V factor = hn::Set(tag, static_cast<T>(1 - 1e-7 * sink)), term = hn::Set(tag, static_cast<T>(1e-9));
  // twelve different starts, or the compiler sees that all of them are one
  const auto start = [&](int number) { return hn::Set(tag, static_cast<T>(1 + 0.01 * number * (1 + sink))); };
  V a = start(0), b = start(1), c = start(2), d = start(3), e = start(4), f = start(5), g = start(6), h = start(7),
    i = start(8), j = start(9), k = start(10), l = start(11);
  for (long round = 0; round < rounds; ++round) {
    a = hn::MulAdd(a, factor, term), b = hn::MulAdd(b, factor, term), c = hn::MulAdd(c, factor, term);
    d = hn::MulAdd(d, factor, term), e = hn::MulAdd(e, factor, term), f = hn::MulAdd(f, factor, term);
    g = hn::MulAdd(g, factor, term), h = hn::MulAdd(h, factor, term), i = hn::MulAdd(i, factor, term);
    j = hn::MulAdd(j, factor, term), k = hn::MulAdd(k, factor, term), l = hn::MulAdd(l, factor, term);
  }
  const V sum = hn::Add(hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, d)), hn::Add(hn::Add(e, f), hn::Add(g, h))),
                        hn::Add(hn::Add(i, j), hn::Add(k, l)));
  sink += static_cast<double>(hn::GetLane(sum));
  return 12.0 * static_cast<double>(rounds) * static_cast<double>(hn::Lanes(tag));
}

double multiply_add_double(long rounds, double& sink) { return multiply_add<double>(rounds, sink); }
double multiply_add_single(long rounds, double& sink) { return multiply_add<float>(rounds, sink); }

/// Sum of an array, eight registers at a time; count is a multiple of 128.
double read_all(const double* from, std::size_t count) {
  const hn::ScalableTag<double> tag;
  using V = hn::Vec<decltype(tag)>;
  const std::size_t step = hn::Lanes(tag);
  V a = hn::Zero(tag), b = a, c = a, d = a, e = a, f = a, g = a, h = a;
  for (const double* at = from; at < from + count; at += 8 * step) {
    a = hn::Add(a, hn::Load(tag, at)), b = hn::Add(b, hn::Load(tag, at + step));
    c = hn::Add(c, hn::Load(tag, at + 2 * step)), d = hn::Add(d, hn::Load(tag, at + 3 * step));
    e = hn::Add(e, hn::Load(tag, at + 4 * step)), f = hn::Add(f, hn::Load(tag, at + 5 * step));
    g = hn::Add(g, hn::Load(tag, at + 6 * step)), h = hn::Add(h, hn::Load(tag, at + 7 * step));
  }
  return static_cast<double>(
      hn::GetLane(hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, d)), hn::Add(hn::Add(e, f), hn::Add(g, h)))));
}

}  // namespace hexaplast::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>

#include "base/blocks.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast::bench {

namespace {

HWY_EXPORT(multiply_add_double);
HWY_EXPORT(multiply_add_single);
HWY_EXPORT(read_all);

/// [B] of the arrays that are read: from what a second-level cache holds to what only memory does.
constexpr std::array<std::size_t, 6> kWorkingSets{256u << 10, 1u << 20, 4u << 20, 16u << 20, 64u << 20, 256u << 20};
constexpr int kRepetitions = 4;  // the best of them counts

template <class Work>
double seconds(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double peak(int threads, bool single) {
  constexpr long kRounds = 6'000'000;  // about 10 ms: long against waking a thread
  double best = 0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    std::vector<double> numbers(threads);
    const double time = seconds([&] {
      parallel_for(threads, [&](int thread) {
        double sink = 0;
        numbers[thread] = single ? HWY_DYNAMIC_DISPATCH(multiply_add_single)(kRounds, sink)
                                 : HWY_DYNAMIC_DISPATCH(multiply_add_double)(kRounds, sink);
        numbers[thread] += sink == 0.5;  // never: the sum is greater
      });
    });
    double all = 0;
    for (const double each : numbers) all += each;
    best = std::max(best, 2e-9 * all / time);
  }
  return best;
}

double bandwidth(const AlignedVector<double>& array, std::size_t bytes, int threads) {
  const std::size_t part = bytes / sizeof(double) / threads / 128 * 128;
  const int passes = static_cast<int>(std::max<std::size_t>(1, (32u << 20) / bytes));
  std::vector<double> sums(threads);
  double best = 0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    const double time = seconds([&] {
      parallel_for(threads, [&](int thread) {
        for (int pass = 0; pass < passes; ++pass)
          sums[thread] += HWY_DYNAMIC_DISPATCH(read_all)(array.data() + thread * part, part);
      });
    });
    const double read = static_cast<double>(part * sizeof(double)) * threads * passes;
    best = std::max(best, 1e-9 * read / time + (sums[0] == 0.5));  // the array holds ones: never
  }
  return best;
}

}  // namespace

MachineLimits::MachineLimits(const std::vector<int>& threads) {
  const AlignedVector<double> array(kWorkingSets.back() / sizeof(double), 1.0);
  const int before = num_threads();
  for (const int count : threads) {
    set_num_threads(count);
    Limits limits{count, peak(count, false), peak(count, true), {}};
    for (const std::size_t bytes : kWorkingSets) limits.read_gbs.push_back(bandwidth(array, bytes, count));
    limits_.push_back(std::move(limits));
  }
  set_num_threads(before);
}

const MachineLimits::Limits& MachineLimits::of(int threads) const {
  return *std::find_if(limits_.begin(), limits_.end(), [&](const Limits& each) { return each.threads == threads; });
}

double MachineLimits::peak_gflops(Precision precision, int threads) const {
  return precision == Precision::kDouble ? of(threads).gflops_double : of(threads).gflops_single;
}

double MachineLimits::read_gbs(std::size_t bytes, int threads) const {
  std::size_t k = 0;
  while (k + 1 < kWorkingSets.size() && kWorkingSets[k + 1] <= bytes) ++k;
  return of(threads).read_gbs[k];
}

std::string MachineLimits::processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace hexaplast::bench
#endif
