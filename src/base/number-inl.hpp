// SPDX-License-Identifier: LGPL-2.1-or-later
// One number, where a formula may have lanes. With HEXAPLAST_ONE_NUMBER defined there are no lanes, and no Highway:
// what a formula includes then is what a compiler for a device can read.
#if defined(HEXAPLAST_BASE_NUMBER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_NUMBER_INL
#undef HEXAPLAST_BASE_NUMBER_INL
#else
#define HEXAPLAST_BASE_NUMBER_INL
#endif

#include <algorithm>
#include <cmath>

#include "base/inline.hpp"

#ifndef HEXAPLAST_ONE_NUMBER
#include "hwy/highway.h"
#elif !defined(HWY_NAMESPACE)
#define HWY_NAMESPACE one_number
#define HWY_BEFORE_NAMESPACE() static_assert(true)
#define HWY_AFTER_NAMESPACE() static_assert(true)
#endif

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

template <class N>
struct ScalarOfNumber {
  using type = N;
};
/// float or double: what one lane of N holds.
template <class N>
using ScalarOf = typename ScalarOfNumber<N>::type;

HEXAPLAST_INLINE double sqrt(double a) { return std::sqrt(a); }
HEXAPLAST_INLINE double abs(double a) { return std::abs(a); }
HEXAPLAST_INLINE double log(double a) { return std::log(a); }
HEXAPLAST_INLINE double min(double a, double b) { return std::min(a, b); }
HEXAPLAST_INLINE double max(double a, double b) { return std::max(a, b); }
HEXAPLAST_INLINE double select(bool condition, double a, double b) { return condition ? a : b; }
HEXAPLAST_INLINE bool any_positive(double a) { return a > 0; }

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
