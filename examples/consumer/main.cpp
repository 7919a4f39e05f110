// SPDX-License-Identifier: LGPL-2.1-or-later
// Pulls a bar for two seconds, lets go, and reads the permanent deformation. docs/api.md and the headers' page show
// this program.
#include <algorithm>
#include <cstdio>
#include <hexaplast/geometry/grid.hpp>
#include <hexaplast/moving_body.hpp>
#include <utility>

int main() {
  using namespace hexaplast;
  Body bar(regular_grid({2, 2, 8}, {0, 0, 0}, {.1, .1, .4}),  // 2 x 2 x 8 hexahedra in a box [m]
           {{.young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 300, .flow_rate = 4}});
  Motion motion{.fixed = {0, 1, 2, 3, 4, 5, 6, 7, 8}};  // nodes run along x first: these lie at z = 0
  motion.load = [](double time, ConstPoints, Points f) {
    if (time < 2) f.bottomRows(9).col(2).array() += .4;  // [N] at each node of the other end
  };
  MovingBody moving(std::move(bar), motion);
  moving.run(500);  // steps of 10 ms
  const ElementFields fields = moving.body.fields(moving.positions);
  std::printf("longer by %.1f mm\n", 1e3 * (moving.positions(80, 2) - .4));
  std::printf("plastic strain up to %.3f\n", std::ranges::max(fields.plastic_strain));
}
