// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set, as the kernels are.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/elementary_test.cpp"
#include "hwy/foreach_target.h"
//
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/elementary-inl.hpp"
#include "base/simd.hpp"
#include "support/random.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// log, atan and sin of one number, by lanes that are alike.
template <class T>
std::array<T (*)(T), 3> of_lanes() {
  return {[](T a) { return hn::GetLane(log(Lanes<T>(a)).raw()); },
          [](T a) { return hn::GetLane(atan(Lanes<T>(a)).raw()); },
          [](T a) { return hn::GetLane(sin(Lanes<T>(a)).raw()); }};
}
std::array<double (*)(double), 3> of_lanes_of_double() { return of_lanes<double>(); }
std::array<float (*)(float), 3> of_lanes_of_float() { return of_lanes<float>(); }

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(of_lanes_of_double);
HWY_EXPORT(of_lanes_of_float);

namespace {

template <class T>
void expect_elementary_functions(const std::array<T (*)(T), 3>& functions) {
  constexpr T kInfinity = std::numeric_limits<T>::infinity(), kTiny = std::numeric_limits<T>::min();
  constexpr T kOctant = T(std::numbers::pi / 4), kTangent = T(std::numbers::sqrt2 - 1);
  const struct {
    int function;
    long double (*expected)(long double);
    T least, largest;
    std::vector<T> special;
  } cases[] = {{0, std::log, T(0.25), T(4), {kTiny, T(1e-30), T(1e30), std::numeric_limits<T>::max(), kInfinity, NAN}},
               {0, std::log, T(4), T(1e6), {1, 2}},
               {1, std::atan, -kTangent, kTangent, {0, kTiny, T(1e-9), NAN}},
               {2, std::sin, -kOctant, kOctant, {0, kTiny, T(1e-9), NAN}}};
  support::Random random(61);
  for (const auto& [function, expected, least, largest, special] : cases) {
    std::vector<T> arguments = special;
    arguments.insert(arguments.end(), {least, largest});
    for (int k = 0; k < 20000; ++k) arguments.push_back(static_cast<T>(random.uniform(least, largest)));
    for (const T a : arguments) {
      const T found = functions[function](a);
      const long double exact = expected(a);
      if (!std::isfinite(a)) {
        EXPECT_TRUE(std::isnan(a) ? std::isnan(found) : found == a) << "function " << function << " of " << a;
        continue;
      }
      const T size = std::max(std::abs(static_cast<T>(exact)), kTiny), unit = std::nextafter(size, kInfinity) - size;
      ASSERT_LE(std::abs(found - exact), 2 * unit) << "function " << function << " of " << a;
    }
  }
}

TEST(Elementary, FunctionsAreRightToTwoUnitsInTheLastPlace) {
  namespace formula = HWY_NAMESPACE;
  expect_elementary_functions<double>({formula::log<double>, formula::atan<double>, formula::sin<double>});
  expect_elementary_functions<float>({formula::log<float>, formula::atan<float>, formula::sin<float>});
  for (const std::string& target : simd_targets()) {
    SCOPED_TRACE(target);
    set_simd_target(target);
    expect_elementary_functions(HWY_DYNAMIC_DISPATCH(of_lanes_of_double)());
    expect_elementary_functions(HWY_DYNAMIC_DISPATCH(of_lanes_of_float)());
  }
  set_simd_target("");
}

}  // namespace
}  // namespace hexaplast
#endif
