// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "state/linearization.hpp"

namespace hexaplast {

/// Ap += factor L p in double precision, rotations computed anew: no coefficients are kept.
void add_exact_product(const Model& model, const History& history, const Linearization& at, int chunk, double factor,
                       const double* p, double* Ap);

using ElementMatrix = Eigen::Matrix<double, 3 * kCorners, 3 * kCorners>;

/// factor times L of the elements of a block [N/m], rotations computed anew; 0 where nothing is. kBlock matrices.
void element_matrices(const Model& model, const History& history, const Linearization& at, int block, double factor,
                      ElementMatrix* matrices);

}  // namespace hexaplast
