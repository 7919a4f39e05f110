// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast::support {

/// Greatest magnitude of an entry.
template <class Derived>
double max_abs(const Eigen::MatrixBase<Derived>& values) {
  return values.size() == 0 ? 0.0 : values.cwiseAbs().maxCoeff();
}

/// Greatest difference of two entries, relative to the greatest entry of `expected` (absolute where that is zero).
template <class Actual, class Expected>
double relative_error(const Eigen::MatrixBase<Actual>& actual, const Eigen::MatrixBase<Expected>& expected) {
  const double size = max_abs(expected);
  return max_abs(actual - expected) / (size > 0 ? size : 1.0);
}

inline double relative_error(double actual, double expected) {
  return std::abs(actual - expected) / (expected != 0 ? std::abs(expected) : 1.0);
}

/// Passes when relative_error is a number not greater than `tolerance`.
template <class Actual, class Expected>
testing::AssertionResult agrees(const Actual& actual, const Expected& expected, double tolerance) {
  const double error = relative_error(actual, expected);
  if (error <= tolerance) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "relative error " << error << " above " << tolerance;
}

/// Of forces at points, about the origin.
inline Vec3 moment(ConstPoints x, ConstPoints f) {
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index n = 0; n < x.rows(); ++n) sum += Vec3(x.row(n)).cross(Vec3(f.row(n)));
  return sum;
}

/// Whether forces at points have neither sum nor moment.
inline void expect_balance(ConstPoints x, ConstPoints f) {
  const double size = f.cwiseAbs().sum();
  EXPECT_LE(f.colwise().sum().norm(), 1e-12 * size);
  const PointArray arms = x.rowwise() - x.colwise().mean();
  EXPECT_LE(moment(arms, f).norm(), 1e-12 * size * max_abs(arms));
}

/// (f(+step) - f(-step)) / 2 step.
inline double central_difference(const std::function<double(double)>& f, double step) {
  return (f(step) - f(-step)) / (2 * step);
}

/// Whether `result` has the same value with any number of threads.
template <class Result>
void expect_the_same_for_any_threads(const Result& result) {
  const int before = num_threads();
  set_num_threads(1);
  const auto expected = result();
  for (const int threads : {1, 2, 3, 7}) {
    set_num_threads(threads);
    EXPECT_EQ(result(), expected) << threads << " threads";
  }
  set_num_threads(before);
}

/// The message of the Error that `act` throws; empty where it throws nothing.
template <class Error, class Act>
std::string error_of(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Passes when `act` throws an Error whose message contains every one of `parts`.
template <class Error, class Act>
testing::AssertionResult refuses(const Act& act, std::initializer_list<std::string> parts) {
  try {
    const std::string message = error_of<Error>(act);
    if (message.empty()) return testing::AssertionFailure() << "nothing was thrown";
    for (const std::string& part : parts)
      if (message.find(part) == std::string::npos)
        return testing::AssertionFailure() << "'" << part << "' is missing in: " << message;
    return testing::AssertionSuccess();
  } catch (const std::exception& error) {
    return testing::AssertionFailure() << "another kind of exception: " << error.what();
  }
}

}  // namespace hexaplast::support
