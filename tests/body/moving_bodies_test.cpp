// SPDX-License-Identifier: LGPL-2.1-or-later
// Motions that are moved in memory, and many of them in one process.
#include <cmath>
#include <functional>
#include <memory>
#include <thread>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "support/compare.hpp"
#include "support/yielding_bar.hpp"

namespace hexaplast {
namespace {

using support::pulling;
using support::yielding_bar;

TEST(MovingBody, GoesOnInAnotherPlaceWithTheSameBits) {
  for (const bool is_iterative : {false, true}) {
    const auto make = [&] {
      return MovingBody(yielding_bar(), pulling(),
                        is_iterative ? std::make_unique<PreconditionedConjugateGradients>(1e-8, 1000) : nullptr);
    };
    MovingBody straight = make(), first = make();
    straight.run(40);
    first.run(20);
    const double* const material = first.body.plastic_rest_positions().data();
    std::vector<MovingBody> moved;
    moved.push_back(std::move(first));
    moved.reserve(10);  // moves it once more
    EXPECT_EQ(moved.front().body.plastic_rest_positions().data(), material) << "a move copies nothing";
    moved.front().run(20);
    EXPECT_EQ(moved.front().state_hash(), straight.state_hash());

    MovingBody assigned = make();
    assigned = std::move(moved.front());
    EXPECT_EQ(assigned.state_hash(), straight.state_hash());
    assigned.run(1);
    straight.run(1);
    EXPECT_EQ(assigned.state_hash(), straight.state_hash());
  }
}

// The first call after a move must not look where the body has been.
TEST(MovingBody, IsHeldRightAfterAMove) {
  const std::vector<int> nodes = {0, 1};
  const PointArray places = yielding_bar().mesh().positions().topRows(2).array() + 1e-4;
  const std::function<void(MovingBody&)> calls[] = {[&](MovingBody& moving) { moving.fix(nodes); },
                                                    [&](MovingBody& moving) { moving.prescribe(nodes, places); },
                                                    [&](MovingBody& moving) { moving.release(nodes); }};
  for (const auto& call : calls) {
    MovingBody straight(yielding_bar(), pulling());
    call(straight);
    straight.run(2);

    auto source = std::make_unique<MovingBody>(yielding_bar(), pulling());
    MovingBody built(std::move(*source));
    source = std::make_unique<MovingBody>(yielding_bar(), pulling());
    MovingBody assigned(yielding_bar(), pulling());
    assigned = std::move(*source);
    source.reset();
    for (MovingBody* moving : {&built, &assigned}) {
      call(*moving);
      moving->run(2);
      EXPECT_EQ(moving->state_hash(), straight.state_hash());
    }
  }
}

TEST(MovingBody, ManyInOneProcessDoNotDisturbEachOther) {
  MovingBody alone(yielding_bar(), pulling());
  alone.run(40);
  std::vector<std::unique_ptr<MovingBody>> at_once;
  for (int k = 0; k < 12; ++k) at_once.push_back(std::make_unique<MovingBody>(yielding_bar(), pulling()));
  {
    std::vector<std::jthread> threads;
    for (const auto& body : at_once) threads.emplace_back([&body] { body->run(40); });
  }
  for (const auto& body : at_once) EXPECT_EQ(body->state_hash(), alone.state_hash());
}

// One that fails takes nothing from the others, and stays as it was before the step.
TEST(MovingBody, ManyInOneParallelLoopHaveTheBitsThatTheyHaveAlone) {
  constexpr int kBodies = 13, kHowMany = 25, kFailing = 4, kLast = 11;
  const auto make = [](int k) {
    Motion motion = pulling();
    if (k == kFailing)
      motion.load = [](double time, ConstPoints, Points f) {
        f.bottomRows(9).col(2).array() += time < (kLast - .5) * .01 ? .4 : NAN;
      };
    MovingBody body(yielding_bar(), motion);
    body.x.bottomRows(9).col(2).array() += 1e-4 * k;  // no two are the same
    return body;
  };
  std::vector<std::string> alone;
  for (int k = 0; k < kBodies; ++k) {
    MovingBody body = make(k);
    body.run(k == kFailing ? kLast : kHowMany);
    alone.push_back(body.state_hash());
  }
  const int before = num_threads();
  for (const int threads : {1, 2, 5}) {
    set_num_threads(threads);
    std::vector<MovingBody> bodies;
    for (int k = 0; k < kBodies; ++k) bodies.push_back(make(k));
    std::vector<int> failed(kBodies, 0);
    for (int step = 0; step < kHowMany; ++step)
      parallel_for(kBodies, [&](int k) {
        try {
          bodies[static_cast<std::size_t>(k)].step();
        } catch (const NumericalError&) {
          ++failed[static_cast<std::size_t>(k)];
        }
      });
    for (int k = 0; k < kBodies; ++k) {
      EXPECT_EQ(bodies[static_cast<std::size_t>(k)].state_hash(), alone[static_cast<std::size_t>(k)])
          << "body " << k << ", " << threads << " threads";
      EXPECT_EQ(failed[static_cast<std::size_t>(k)], k == kFailing ? kHowMany - kLast : 0);
    }
  }
  set_num_threads(before);
}

}  // namespace
}  // namespace hexaplast
