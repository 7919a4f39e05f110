// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>

namespace hexaplast {

/// products = X^T R, by the instruction set of the processor; Eigen has that of the compiler. Each entry is the same
/// sum whichever other columns there are.
void column_products(const Eigen::Ref<const Eigen::MatrixXd>& X, const Eigen::Ref<const Eigen::MatrixXd>& R,
                     Eigen::Ref<Eigen::MatrixXd> products);

}  // namespace hexaplast
