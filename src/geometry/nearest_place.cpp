// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/nearest_place.hpp"

#include <cmath>

#include "mesh/trilinear.hpp"

namespace hexaplast {
namespace {

constexpr double kExact = 1e-15;        // of its size, and in reference coordinates: as exact as doubles are
constexpr double kShortestStep = 1e-6;  // fraction of a Gauss-Newton step
constexpr int kMaxIterations = 60;      // inside a sound hexahedron less than ten are needed

}  // namespace

CornerWeights shape_functions(const Vec3& s) {
  CornerWeights N;
  for (int a = 0; a < kCorners; ++a)
    N[a] = (1 + kCornerSign[a][0] * s[0]) * (1 + kCornerSign[a][1] * s[1]) * (1 + kCornerSign[a][2] * s[2]) / 8;
  return N;
}

/// Gauss-Newton steps on |x(s) - p|, held within the reference cube: a
/// coordinate at a face stays there while the gap points out of the cube, and
/// no step may lead farther away. Inside a sound hexahedron this is Newton's
/// method.
HexahedronPlace nearest_place(const ElementPoints& x, const Vec3& p, double size) {
  const auto gap_at = [&](const Vec3& s) -> Vec3 { return p - x.transpose() * shape_functions(s); };
  Vec3 s = Vec3::Zero(), gap = gap_at(s);
  for (int iteration = 0; iteration < kMaxIterations && gap.norm() > kExact * size; ++iteration) {
    const Mat3 J = x.transpose() * shape_derivatives(s);
    const Vec3 descent = J.transpose() * gap;
    Mat3 A = J.transpose() * J;
    Vec3 b = descent;
    bool is_free = true;
    for (int d = 0; d < 3; ++d) {
      if (std::abs(s[d]) < 1 || s[d] * descent[d] <= 0) continue;
      A.row(d).setZero();
      A.col(d).setZero();
      A(d, d) = 1;
      b[d] = 0;
      is_free = false;
    }
    Vec3 step = is_free ? J.inverse() * gap : A.inverse() * b;
    if (!step.allFinite()) step = descent / J.squaredNorm();

    Vec3 next = s, next_gap = gap;
    for (double fraction = 1; fraction > kShortestStep; fraction /= 2) {
      next = (s + fraction * step).cwiseMin(1).cwiseMax(-1);
      next_gap = gap_at(next);
      if (next_gap.squaredNorm() < gap.squaredNorm()) break;
    }
    if (!(next_gap.squaredNorm() < gap.squaredNorm())) break;
    const double advance = (next - s).cwiseAbs().maxCoeff();
    s = next;
    gap = next_gap;
    if (advance < kExact) break;
  }
  return {s, gap.norm()};
}

CornerWeights weights_beyond(const ElementPoints& x, const Vec3& s, const Vec3& p, double farthest) {
  const ElementPoints dN = shape_derivatives(s);
  const CornerWeights N = shape_functions(s);
  const Mat3 J = x.transpose() * dN;
  const Vec3 ds = J.inverse() * (p - x.transpose() * N);
  return ds.cwiseAbs().maxCoeff() <= farthest ? CornerWeights(N + dN * ds) : N;
}

// The regions of a point around a triangle a b c, after Ericson (2005).
TrianglePlace nearest_place(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const auto& [a, b, c] = corners;
  const auto at = [&](const Vec3& place, int feature) {
    return TrianglePlace{place, (p - place).squaredNorm(), feature};
  };
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return at(a, 0);
  if (d3 >= 0 && d4 <= d3) return at(b, 1);
  if (d6 >= 0 && d5 <= d6) return at(c, 2);
  const double of_c = d1 * d4 - d3 * d2, of_b = d5 * d2 - d1 * d6, of_a = d3 * d6 - d5 * d4;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return at(a + d1 / (d1 - d3) * ab, 3);
  if (of_a <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return at(b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), 4);
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return at(a + d2 / (d2 - d6) * ac, 5);
  const double sum = of_a + of_b + of_c;
  return at(a + of_b / sum * ab + of_c / sum * ac, TrianglePlace::kFace);
}

}  // namespace hexaplast
