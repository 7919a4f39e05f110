// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/config.h>

#include <algorithm>
#include <array>
#include <istream>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace sofa::type {

enum NoInit { NOINIT };

template <std::size_t N, class Real>
class Vec : public std::array<Real, N> {
 public:
  Vec() : std::array<Real, N>{} {}
  Vec(Real x, Real y, Real z) requires(N == 3) : std::array<Real, N>{x, y, z} {}

  Real* ptr() { return this->data(); }
  const Real* ptr() const { return this->data(); }
};
using Vec3 = Vec<3, SReal>;

template <class T>
class vector : public std::vector<T> {
 public:
  using std::vector<T>::vector;
};

template <std::size_t Rows, std::size_t Columns, class Real>
class Mat {
 public:
  explicit Mat(NoInit) {}
  Real& operator()(std::size_t row, std::size_t column) { return values_[Columns * row + column]; }
  Real operator()(std::size_t row, std::size_t column) const { return values_[Columns * row + column]; }

 private:
  std::array<Real, Rows * Columns> values_;
};

struct RGBAColor {
  float r = 0, g = 0, b = 0, a = 1;
  RGBAColor() = default;
  RGBAColor(float red, float green, float blue, float alpha) : r(red), g(green), b(blue), a(alpha) {}
  static RGBAColor gray() { return {0.5f, 0.5f, 0.5f, 1}; }
  static RGBAColor red() { return {1, 0, 0, 1}; }
  static RGBAColor green() { return {0, 1, 0, 1}; }
  static RGBAColor yellow() { return {1, 1, 0, 1}; }
  bool operator==(const RGBAColor&) const = default;
};

struct BoundingBox {
  BoundingBox() = default;
  BoundingBox(const Vec3& low, const Vec3& high) : min(low), max(high) {}
  void include(const Vec3& point) {
    for (int i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], point[i]);
      max[i] = std::max(max[i], point[i]);
    }
  }
  Vec3 min, max;
};

template <std::size_t N, class Real>
std::istream& operator>>(std::istream& in, Vec<N, Real>& value) {
  for (Real& each : value) in >> each;
  return in;
}
template <std::size_t N, class Real>
std::ostream& operator<<(std::ostream& out, const Vec<N, Real>& value) {
  for (std::size_t i = 0; i < N; ++i) out << (i ? " " : "") << value[i];
  return out;
}
template <class T>
requires requires(std::istream& in, T& value) { in >> value; }
std::istream& operator>>(std::istream& in, vector<T>& values) {
  values.clear();
  for (T each; in >> each;) values.push_back(each);
  if (in.eof()) in.clear(std::ios::eofbit);
  return in;
}
template <class T>
requires requires(std::ostream& out, const T& value) { out << value; }
std::ostream& operator<<(std::ostream& out, const vector<T>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) out << (i ? " " : "") << values[i];
  return out;
}

}  // namespace sofa::type
