// SPDX-License-Identifier: LGPL-2.1-or-later
// What a cycle of multigrid knows of the spectrum of D^-1 A, D being the diagonal of A, and what it makes of it; the
// same for cycles on the CPU and on a device.                                                  theory.md section 9.5
#pragma once

#include <cstdint>

#include "solve/constants.hpp"

namespace hexaplast {

/// Numbers in [-0.5, 0.5) that no symmetry of a mesh is blind to, the same in every run.
class IrregularNumbers {
 public:
  float operator()() {
    state_ = state_ * 1664525u + 1013904223u;
    return static_cast<float>(static_cast<double>(state_ >> 8) / (1 << 24) - 0.5);
  }

 private:
  std::uint32_t state_ = 12345;
};

/// D^-1 A in the scalar product of D, seen by Lanczos' method, which has a vector v and the one before it, u.
class LanczosSpace {
 public:
  virtual ~LanczosSpace() = default;
  virtual double start() = 0;                               ///< v: irregular, u = 0. Returns v.Dv
  virtual double multiply(double scale) = 0;                ///< v *= scale. Returns v.Av
  virtual double advance(double along, double before) = 0;  ///< v, u = D^-1 A v - along v - before u, v. Returns v.Dv
};

/// Largest eigenvalue, from below: `min_steps` and on until one finds little more. Unlike the power method it finds
/// what a single element stands out by. 1 where there is none.
double largest_eigenvalue(LanczosSpace& space, int min_steps);

/// set(k, radius) for the meshes of a cycle, from the finest on: what a smoother takes for the upper end of the
/// spectrum. space_of(k): its LanczosSpace.
template <class SpaceOf, class Set>
void find_radii_of_meshes(int num_levels, const SpaceOf& space_of, const Set& set) {
  int min_steps = kMinLanczosSteps;
  for (int k = 0; k < num_levels; ++k) {
    auto space = space_of(k);
    const double radius = kSafety * largest_eigenvalue(space, min_steps);
    // where elements stand out, coarse ones may, which the first steps pass by; steps on coarse meshes cost little
    if (k == 0 && radius > kSafety * kIrregular) min_steps = kMaxLanczosSteps;
    set(k, radius);
  }
}

/// take(a, b) for the steps d = a d + b D^-1 r, x += d of Chebyshev's iteration on what is above min_fraction of the
/// radius.
template <class Take>
void for_each_chebyshev_step(double radius, double min_fraction, int degree, const Take& take) {
  const double theta = radius * (1 + min_fraction) / 2, delta = radius * (1 - min_fraction) / 2;
  const double sigma = theta / delta;
  double rho = 1 / sigma;
  take(0.0, 1 / theta);
  for (int step = 1; step < degree; ++step) {
    const double next = 1 / (2 * sigma - rho);
    take(next * rho, 2 * next / delta);
    rho = next;
  }
}

}  // namespace hexaplast
