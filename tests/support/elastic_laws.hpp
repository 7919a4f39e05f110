// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/materials.hpp"
#include "support/shapes.hpp"

namespace hexaplast::support {

/// What holds of the elasticity of every body of cells of kEdge: its force is the slope of its energy, in balance, and
/// turns with the body; its stiffness with rotations held is symmetric, has no negative eigenvalue, resists no
/// translation, and is what products multiply by. is_folded: so far that rotations jump, and forces do not turn.
inline void expect_elastic_laws(Body& body, const PointArray& x, Random& random, bool is_folded = false) {
  const PointArray f = force_at(body, x), u = random.field(static_cast<int>(x.rows()), 1);
  const double slope = central_difference([&](double step) { return body.energy(x + step * u); }, 1e-6 * kEdge);
  EXPECT_NEAR(-f.cwiseProduct(u).sum(), slope, 1e-6 * std::abs(slope));
  expect_balance(x, f);
  const Mat3 Q = random.rotation();
  if (!is_folded) {
    EXPECT_TRUE(agrees(force_at(body, mapped(x, Q, random.vector(1))), mapped(f, Q), 1e-11));
  }

  const Eigen::MatrixXd K = stiffness_at(body, x);
  EXPECT_LE(max_abs(K - K.transpose()), 1e-12 * max_abs(K));
  const Eigen::VectorXd of_K = eigenvalues(K);
  const double greatest = of_K[of_K.size() - 1];
  EXPECT_GE(of_K[0], -1e-12 * greatest);
  EXPECT_LE(std::abs(of_K[2]), 1e-12 * greatest) << "three translations";
  PointArray product = PointArray::Zero(x.rows(), 3);
  body.add_stiffness_product(-1, u, product);
  EXPECT_TRUE(agrees(product, unstacked(K * stacked(u)), 1e-12));
}

}  // namespace hexaplast::support
