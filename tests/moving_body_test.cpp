// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/moving_body.hpp"

#include <limits>

#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/grid.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "support/compare.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::refuses;

// Implicit Euler under constant acceleration: v_k = k h g, x_k = h^2 g k (k + 1) / 2.
TEST(MovingBody, FallsFreely) {
  MovingBody body(Body(support::distorted_block({2, 2, 3}, 0.1, 0.1, 201), {Material{}}), {.density = 500});
  const std::vector<double> mass = body.mass;
  Motion motion{.density = 500, .dt = 0.02, .load = [&](double, ConstPoints, Points f) {
                  for (int n = 0; n < f.rows(); ++n) f(n, 2) -= 9.81 * mass[n];
                }};
  MovingBody falling(Body(body.body.mesh(), {Material{}}), motion);
  falling.run(10);
  EXPECT_NEAR(falling.time(), 0.2, 1e-15);
  for (int n = 0; n < falling.x.rows(); ++n) {
    EXPECT_NEAR(falling.v(n, 2), -9.81 * 0.2, 1e-9);
    EXPECT_NEAR(falling.x(n, 2) - body.x(n, 2), -9.81 * 0.02 * 0.02 * 55, 1e-9);
  }
  double sum = 0;
  for (const double m : mass) sum += m;
  EXPECT_NEAR(sum, 500 * body.body.original_volume(), 1e-9);
}

/// The example of include/hexaplast/README.md.
MovingBody& pulled(MovingBody& moving) {
  moving.run(300);
  return moving;
}

Motion pulling() {
  return {.fixed = {0, 1, 2, 3, 4, 5, 6, 7, 8}, .load = [](double time, ConstPoints, Points f) {
            if (time < 2) f.bottomRows(9).col(2).array() += .4;
          }};
}

Body yielding_bar() {
  return Body(regular_grid({2, 2, 8}, {0, 0, 0}, {.1, .1, .4}),
              {{.young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 300, .flow_rate = 4}});
}

TEST(MovingBody, StaysStretchedWhateverSolvesIt) {
  MovingBody direct(yielding_bar(), pulling());
  MovingBody iterative(yielding_bar(), pulling(), std::make_unique<PreconditionedConjugateGradients>(1e-10, 1000));
  pulled(direct);
  pulled(iterative);
  EXPECT_GT(direct.x(80, 2), 0.41);
  EXPECT_GT(direct.body.fields(direct.x).plastic_strain[0], 0.01);
  EXPECT_LE(support::max_abs(direct.x - iterative.x), 1e-6);
  EXPECT_EQ(direct.x.topRows(9), direct.body.mesh().positions().topRows(9));
  EXPECT_NE(direct.state_hash(), iterative.state_hash());
}

TEST(MovingBody, RefusesWhatCannotMove) {
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.fixed = {81}}); }, {"81", "0 to 80"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.density = 0}); }, {"density = 0"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.dt = -1}); }, {"dt = -1"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.dt = 0.5}); }, {"plasticFlowRate"}));
}

}  // namespace
}  // namespace hexaplast
