// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "state/linearization.hpp"

namespace hexaplast {

/// The stiffness of a linearization in double precision whatever its coefficients are: rotations are computed anew in
/// each product. For residuals, which single precision would spoil.
class DoublePrecisionOperator final : public ChunkedProduct<double> {
 public:
  /// All must outlive the use.
  void setup(const Model& model, const History& history, const Linearization& at) {
    model_ = &model;
    history_ = &history;
    at_ = &at;
  }
  const Partition& partition() const override { return *model_->partition; }
  void add_product(int chunk, double factor, const double* p, double* Ap) const override;

 private:
  const Model* model_ = nullptr;
  const History* history_ = nullptr;
  const Linearization* at_ = nullptr;
};

using ElementMatrix = Eigen::Matrix<double, 3 * kCorners, 3 * kCorners>;

/// factor times L of the elements of a block [N/m], rotations computed anew; 0 where nothing is. kBlock matrices.
void element_matrices(const Model& model, const History& history, const Linearization& at, int block, double factor,
                      ElementMatrix* matrices);

}  // namespace hexaplast
