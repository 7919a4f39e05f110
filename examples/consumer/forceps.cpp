// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cstdio>
#include <hexaplast/geometry/grid.hpp>
#include <hexaplast/moving_body.hpp>
#include <parts/instrument.hpp>
#include <utility>
#include <vector>

int main() {
  using namespace hexaplast;
  Body strip(regular_grid({12, 4, 4}, {0, 0, 0}, {.06, .02, .02}),
             {{.young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 400, .flow_rate = 4}});
  Motion motion{.euler = {.rayleigh_stiffness = .02}};
  for (int node = 0; node < strip.mesh().num_nodes(); ++node)
    if (strip.mesh().positions()(node, 2) == 0) motion.fixed.push_back(node);
  MovingBody moving(std::move(strip), motion);

  // two boxes of 1 cm with friction: beside the strip, closed on it, lifted, open again
  std::vector<parts::Instrument> jaws;
  jaws.reserve(2);  // the body refers to them
  for (const double side : {-1., 1.}) {
    PointArray path(4, 3);
    path << .03, .01 + .02 * side, .017, .03, .01 + .01 * side, .017, .03, .01 + .01 * side, .023, .03,
        .01 + .03 * side, .023;
    parts::InstrumentOptions jaw{.shape = parts::InstrumentOptions::Shape::kBox,
                                 .size = Vec3(.01, .01, .01),
                                 .key_times = {0, .4, 1, 1.4},
                                 .positions = path};
    jaw.contact.friction = 1;
    const int n = moving.body.mesh().num_nodes();
    jaws.emplace_back(jaw, parts::Surroundings{.num_nodes = {n, n}, .bodies = {&moving.body, &moving.body}});
    moving.add(jaws.back());
  }
  for (const double until : {.5, 1., 2.}) {
    while (moving.time() < until) moving.step();
    std::printf("t = %.1f s: force on a jaw %.2f N, height of the strip %.1f mm\n", moving.time(),
                jaws[0].contact().force().norm(), 1e3 * moving.positions.col(2).maxCoeff());
  }
}
