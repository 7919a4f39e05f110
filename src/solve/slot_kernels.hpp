// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>

namespace hexaplast {

/// Passes over a range of a nodal vector in slots, fused so that each number is moved as rarely as possible. Sums are
/// added in one order, whatever the number of threads; products are rounded in T, sums kept in double. T: double,
/// float.

/// p = r inverse + beta p (inverse null: p = r + beta p), and Ap = diagonal p.
template <class T>
void update_search_direction(std::size_t size, T beta, const T* r, const T* inverse, const T* diagonal, T* p, T* Ap);

/// x += alpha p, r -= alpha Ap. Returns r.r, and in `r_z` r.(inverse r) (inverse null: r.r).
template <class T>
double advance(std::size_t size, T alpha, const T* p, const T* Ap, const T* inverse, T* x, T* r, double& r_z);

/// a.b
template <class T>
double slot_dot(std::size_t size, const T* a, const T* b);

/// One step of the Chebyshev iteration on r = b - A x: d = a d + b inverse r, x += d. Where a is 0, d may have any
/// content before, NaN included. diagonal: null, or of a D of which the new r -= D d is found too.
void smooth(std::size_t size, float a, float b, const float* inverse, const float* diagonal, float* r, float* d,
            float* x);

}  // namespace hexaplast
