// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/moving_body.hpp"

#include <cmath>
#include <functional>
#include <sstream>
#include <thread>

#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "support/compare.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::refuses;

// Implicit Euler under constant acceleration: v_k = k h g, x_k = h^2 g k (k + 1) / 2.
TEST(MovingBody, FallsFreely) {
  MovingBody body(Body(support::distorted_block({2, 2, 3}, 0.1, 0.1, 201), {Material{}}), {.density = 500});
  const std::vector<double> mass = body.mass();
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
  EXPECT_NEAR(sum, 500 * body.body.initial_volume(), 1e-9);
}

// The springs of recovery turn and move with what they hold, also where a factorisation solves for them.
TEST(MovingBody, FallsFreelyWhileItUnfolds) {
  Settings settings;
  settings.recovery = RecoveryMode::kCluster;
  const HexMesh mesh = support::distorted_block({2, 2, 3}, 0.1, 0.1, 201);
  MovingBody falling(Body(mesh, {Material{}}, settings), {.density = 500, .dt = 0.02, .gravity = {0, 0, -9.81}});
  falling.x += support::Random(202).field(mesh.num_nodes(), 0.08);
  falling.body.linearize(falling.x);
  BlockMatrix K(mesh.num_nodes());
  falling.body.add_stiffness_blocks(-1, K);
  ASSERT_FALSE(K.rank_ones().empty());
  falling.run(5);
  const Eigen::Map<const Eigen::VectorXd> mass(falling.mass().data(), mesh.num_nodes());
  const Vec3 momentum = falling.v.transpose() * mass;
  EXPECT_LE((momentum - Vec3(0, 0, -9.81 * 0.1 * mass.sum())).norm(), 1e-9 * mass.sum());
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

TEST(MovingBody, FallsUnderItsGravityAsUnderTheSameLoad) {
  const Vec3 gravity(0, 1, -9.81);
  MovingBody falling(yielding_bar(), {.dt = 0.02, .gravity = gravity});
  falling.run(10);
  for (int n = 0; n < falling.x.rows(); ++n) {
    EXPECT_LE((falling.v.row(n).transpose() - 0.2 * gravity).norm(), 1e-9);
    EXPECT_LE(
        (falling.x.row(n) - falling.body.mesh().positions().row(n) - 0.02 * 0.02 * 55 * gravity.transpose()).norm(),
        1e-9);
  }
}

/// Nodes of the upper end of the bar.
const std::vector<int> kEnd = {72, 73, 74, 75, 76, 77, 78, 79, 80};

// All nodes move at one velocity, the end's because they are prescribed: a rigid translation, which no force disturbs.
// A velocity of the prescribed nodes that the others did not feel would lag by a step.
TEST(MovingBody, LeadsNodesAndTheOthersAlongWithThem) {
  MovingBody moving(yielding_bar(), {.euler = {.rayleigh_stiffness = 0.05}});
  const Vec3 velocity(0.3, -0.2, 0.5);
  const PointArray start = moving.x;
  const auto moved = [&](int steps) -> PointArray { return start.rowwise() + 0.01 * steps * velocity.transpose(); };
  moving.v.rowwise() = velocity.transpose();
  for (int k = 1; k <= 5; ++k) {
    moving.prescribe(kEnd, moved(k).bottomRows(9));
    moving.step();
    EXPECT_LE(support::max_abs(moving.x - moved(k)), 1e-12) << "step " << k;
  }

  moving.step();  // no longer prescribed, they stand
  EXPECT_LE(support::max_abs(moving.x.bottomRows(9) - moved(5).bottomRows(9)), 1e-12);
  EXPECT_GE(support::max_abs(moving.x.topRows(9) - moved(5).topRows(9)), 1e-3);
  moving.release(kEnd);
  moving.run(3);
  EXPECT_GE(support::max_abs(moving.x.bottomRows(9) - moved(5).bottomRows(9)), 1e-3);
}

TEST(MovingBody, FixesNodesOnTheWay) {
  MovingBody moving(yielding_bar(), {.gravity = {0, 0, -1}});
  moving.run(3);
  const PointArray x = moving.x;
  moving.fix(kEnd);
  moving.run(3);
  EXPECT_EQ(moving.x.bottomRows(9), x.bottomRows(9));
  EXPECT_LT(moving.x(0, 2), x(0, 2));
}

TEST(MovingBody, LeavesNodesWithoutHexahedronWhereTheyAre) {
  const HexMesh cube = regular_grid({1, 1, 1}, {0, 0, 0}, {1, 1, 1});
  PointArray positions = PointArray::Zero(9, 3);
  positions.bottomRows(8) = cube.positions();
  Hexahedron corners = cube.hexahedra()[0];
  for (int& n : corners) ++n;
  const Body body(HexMesh(positions, {corners}), {Material{}});
  MovingBody direct(body, {.gravity = {0, 0, -10}});
  MovingBody iterative(body, {.gravity = {0, 0, -10}}, std::make_unique<PreconditionedConjugateGradients>(1e-10, 100));
  for (MovingBody* moving : {&direct, &iterative}) {
    moving->step();
    EXPECT_EQ(moving->x.row(0), positions.row(0));
    EXPECT_NEAR(moving->x(1, 2), -10 * 0.01 * 0.01, 1e-12);
  }
}

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

TEST(MovingBody, RepeatsItsBitsAfterReset) {
  MovingBody moving(yielding_bar(), pulling());
  const double* memory = moving.x.data();
  moving.run(40);
  const std::string once = moving.state_hash();
  EXPECT_GT(moving.body.state().history.dissipated_energy, 0);
  moving.reset();
  EXPECT_EQ(moving.steps(), 0);
  EXPECT_EQ(moving.x, moving.body.mesh().positions());
  moving.run(40);
  EXPECT_EQ(moving.state_hash(), once);
  EXPECT_EQ(moving.x.data(), memory) << "a view of the positions would dangle";
}

TEST(MovingBody, ManyInOneProcessDoNotDisturbEachOther) {
  MovingBody alone(yielding_bar(), pulling());
  alone.run(40);
  std::vector<std::unique_ptr<MovingBody>> by_turns, at_once;
  for (int k = 0; k < 12; ++k) {
    by_turns.push_back(std::make_unique<MovingBody>(yielding_bar(), pulling()));
    at_once.push_back(std::make_unique<MovingBody>(yielding_bar(), pulling()));
  }
  for (int step = 0; step < 40; ++step)
    for (const auto& body : by_turns) body->step();
  {
    std::vector<std::jthread> threads;
    for (const auto& body : at_once) threads.emplace_back([&body] { body->run(40); });
  }
  for (int k = 0; k < 12; ++k) {
    EXPECT_EQ(by_turns[k]->state_hash(), alone.state_hash());
    EXPECT_EQ(at_once[k]->state_hash(), alone.state_hash());
  }
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

/// Every number that a step changes.
struct MotionState {
  explicit MotionState(const MovingBody& of)
      : x(of.x),
        v(of.v),
        hash(of.state_hash()),
        steps(of.steps()),
        iterations(of.latest.iterations),
        residual(of.latest.residual) {}
  bool operator==(const MotionState&) const = default;
  PointArray x, v;
  std::string hash;
  long steps;
  int iterations;
  double residual;
};

// A step that fails in its load, in its solve or, the world having moved already, in its flow: nothing has happened,
// and what comes after has the bits of a motion in which nothing ever failed.
TEST(MovingBody, IsAsBeforeWhereAStepThrows) {
  struct Trouble {
    const char* what;
    double force;
  };
  const auto solvers = std::initializer_list<std::function<std::unique_ptr<LinearSolver>()>>{
      [] { return std::make_unique<CholeskySolver>(); },
      [] { return std::make_unique<PreconditionedConjugateGradients>(1e-8, 1000); },
      [] {
        return std::make_unique<ConjugateGradients>(
            ConjugateGradientSettings{.iterations = 500, .tolerance = 1e-8, .threshold = 0, .warm_start = true});
      },
  };
  int first_steps = 0;
  for (const auto& make_solver : solvers)
    for (const Trouble& trouble : {Trouble{"thrown", 0}, Trouble{"not finite", NAN}, Trouble{"not finite", 1e160}}) {
      double force = 0;
      bool throws = false;
      Motion motion{.fixed = {0, 1, 2, 3, 4, 5, 6, 7, 8}, .load = [&](double, ConstPoints, Points f) {
                      f.bottomRows(9).col(2).array() += .4;
                      f(40, 1) += force;
                      if (throws) throw std::runtime_error("thrown by the load");
                    }};
      MovingBody moving(yielding_bar(), motion, make_solver()), untroubled(yielding_bar(), motion, make_solver());
      const std::vector<int> prescribed{72, 73};
      const auto go_on = [&](MovingBody& of, int steps) {
        of.prescribe(prescribed, of.x.middleRows(72, 2) * 1.001);
        for (int k = 0; k < steps; ++k) of.step();
      };
      for (MovingBody* of : {&moving, &untroubled}) {
        if (first_steps % 2 == 1) of->run(20);  // else it fails in the very first step
        of->prescribe(prescribed, of->x.middleRows(72, 2) * 1.002);
      }
      ++first_steps;
      const MotionState before(moving);
      const double* memory = moving.x.data();
      force = trouble.force;
      throws = trouble.force == 0;
      for (int k = 0; k < 2; ++k) {
        try {
          moving.step();
          ADD_FAILURE() << trouble.what;
        } catch (const std::exception& error) {
          EXPECT_NE(std::string(error.what()).find(trouble.what), std::string::npos) << error.what();
        }
        EXPECT_TRUE(MotionState(moving) == before) << trouble.what;
      }
      EXPECT_EQ(moving.x.data(), memory) << "a view of the positions would dangle";

      force = 0;
      throws = false;
      for (MovingBody* of : {&moving, &untroubled}) {
        of->step();  // the nodes that were prescribed before still are
        go_on(*of, 5);
      }
      EXPECT_TRUE(MotionState(moving) == MotionState(untroubled)) << trouble.what;
      EXPECT_GT(moving.body.state().history.dissipated_energy + (first_steps % 2), 0);
    }
}

TEST(MovingBody, ReportsTheWorstOfARun) {
  MovingBody good(yielding_bar(), pulling());
  const RunReport report = good.run(30);
  EXPECT_EQ(report.steps, 30);
  EXPECT_EQ(report.stalled, 0);
  EXPECT_TRUE(report.solve.converged);
  EXPECT_EQ(report.solve.iterations, 1);
  EXPECT_GT(report.flow.yielded, 0);
  EXPECT_FALSE(report.flow.averaging.skipped);

  MovingBody bad(yielding_bar(), pulling(), std::make_unique<PreconditionedConjugateGradients>(1e-12, 2));
  RunReport by_hand;
  int stalled = 0;
  for (int k = 0; k < 6; ++k) {
    const FlowReport flowed = bad.step();
    by_hand.add(bad.latest, flowed);
    stalled += !bad.latest.converged;
  }
  EXPECT_EQ(by_hand.stalled, stalled);
  EXPECT_GT(stalled, 0);
  EXPECT_FALSE(by_hand.solve.converged);
  EXPECT_GT(by_hand.solve.residual, 1e-12);
  bad.reset();
  const RunReport once_more = bad.run(6);
  EXPECT_EQ(once_more.stalled, stalled);
  EXPECT_EQ(once_more.solve.residual, by_hand.solve.residual);

  RunReport sum;
  SolveReport solved{.iterations = 3, .residual = 0.1, .converged = true};
  FlowReport flowed;
  flowed.yielded = 7;
  flowed.removed = 2;
  flowed.worst_volume_error = 0.2;
  flowed.averaging = {.skipped = false, .fell_back = true, .iterations = 5, .residual = 0.3, .converged = false};
  sum.add(solved, flowed);
  flowed.yielded = 4;
  flowed.inverted = flowed.skipped = flowed.repaired = 1;
  flowed.worst_volume_error = 0.1;
  flowed.averaging = {};
  sum.add({.iterations = 2, .residual = 0.4, .converged = false}, flowed);
  sum.add(solved, {});
  EXPECT_EQ(sum.steps, 3);
  EXPECT_EQ(sum.stalled, 2);
  EXPECT_EQ(sum.solve.iterations, 3);
  EXPECT_EQ(sum.solve.residual, 0.4);
  EXPECT_FALSE(sum.solve.converged);
  EXPECT_EQ(sum.flow.yielded, 7);
  EXPECT_EQ(sum.flow.removed, 4);
  EXPECT_EQ(sum.flow.inverted + sum.flow.skipped + sum.flow.repaired, 3);
  EXPECT_EQ(sum.flow.worst_volume_error, 0.2);
  EXPECT_TRUE(sum.flow.averaging.fell_back);
  EXPECT_FALSE(sum.flow.averaging.skipped);
  EXPECT_FALSE(sum.flow.averaging.converged);
  EXPECT_EQ(sum.flow.averaging.iterations, 5);
  EXPECT_EQ(sum.flow.averaging.residual, 0.3);
}

/// SOFA's PCG and the Cholesky factors that precondition it.
class OwnPreconditioner final : public LinearSolver {
 public:
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override { return solver_.solve(A, b, x); }

 private:
  CholeskySolver factors_;
  SolverPreconditionedConjugateGradients solver_{1e-12, 100, &factors_};
};

struct SolverKind {
  const char* name;
  std::function<std::unique_ptr<LinearSolver>()> make;
  Precision precision = Precision::kDouble;
};
void PrintTo(const SolverKind& kind, std::ostream* out) { *out << kind.name; }

std::vector<SolverKind> solver_kinds() {
  const auto cg = [](bool warm) {
    return [warm] {
      return std::make_unique<ConjugateGradients>(
          ConjugateGradientSettings{.iterations = 12, .tolerance = 1e-7, .threshold = 0, .warm_start = warm});
    };
  };
  const auto pcg = [](Preconditioner preconditioner) {
    return [preconditioner] { return std::make_unique<PreconditionedConjugateGradients>(1e-6, 1000, preconditioner); };
  };
  return {{"Cholesky", [] { return std::make_unique<CholeskySolver>(); }},
          {"Cg", cg(false)},
          {"WarmCg", cg(true)},
          {"WarmCgMixed", cg(true), Precision::kMixed},
          {"Jacobi", pcg(Preconditioner::kDiagonal)},
          {"JacobiMixed", pcg(Preconditioner::kDiagonal), Precision::kMixed},
          {"Multigrid", pcg(Preconditioner::kMultigrid)},
          {"MultigridMixed", pcg(Preconditioner::kMultigrid), Precision::kMixed},
          {"Auto", pcg(Preconditioner::kAuto)},
          {"SofaPcg", [] { return std::make_unique<OwnPreconditioner>(); }}};
}

class SavedMotion : public testing::TestWithParam<std::tuple<SolverKind, bool>> {
 protected:
  static bool tears() { return std::get<bool>(GetParam()); }
  static std::unique_ptr<MovingBody> make(double averaging_tolerance = 0) {
    const auto& [name, make_solver, precision] = std::get<SolverKind>(GetParam());
    Material material{.young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 100, .flow_rate = 4};
    if (tears()) material.fracture_stretch = 1.004;
    return std::make_unique<MovingBody>(Body(regular_grid({3, 3, 8}, {0, 0, 0}, {.1, .1, .4}), {material},
                                             {.averaging_tolerance = averaging_tolerance, .precision = precision}),
                                        Motion{.gravity = {1, 2, -3}, .fixed = {0, 1, 2, 3, 4, 5, 6, 7}},
                                        make_solver());
  }
  static std::string saved(const MovingBody& of) {
    std::ostringstream out;
    of.save(out);
    return out.str();
  }
  static void load(MovingBody& to, const std::string& bytes) {
    std::istringstream in(bytes + "next");
    to.load(in);
    std::string rest;
    in >> rest;
    EXPECT_EQ(rest, "next");
  }
};

// Into a new motion, into one that has solved other systems, and into the one that it comes from: the bits of a motion
// that never stopped.
TEST_P(SavedMotion, GoesOnWithTheSameBitsWhateverWasSolvedBefore) {
  const auto straight = make();
  straight->run(10);
  if (tears()) straight->body.remove(std::vector{30, 31, 40});
  straight->run(3);
  const std::vector<int> prescribed{140, 141};
  straight->fix(std::vector{142});
  straight->prescribe(prescribed, straight->x.middleRows(140, 2) * 1.001);
  const std::string bytes = saved(*straight);
  straight->run(9);
  EXPECT_EQ(straight->body.removed().size() > 3, tears()) << straight->body.removed().size();

  const auto fresh = make(), worked = make();
  worked->run(4);
  worked->body.remove(std::vector{0, 12});
  worked->release(std::vector{0, 1});
  worked->run(3);
  for (MovingBody* moving : {fresh.get(), worked.get(), straight.get()}) {
    const std::string goal = straight->state_hash();
    load(*moving, bytes);
    EXPECT_EQ(saved(*moving), bytes);
    EXPECT_EQ(moving->steps(), 13);
    moving->run(9);
    EXPECT_EQ(moving->state_hash(), goal);
    EXPECT_EQ(moving->latest.iterations, straight->latest.iterations);
  }

  straight->reset();  // all hexahedra are back
  straight->release(std::vector{140, 141, 142});
  const auto other = make();
  straight->run(12);
  other->run(12);
  EXPECT_EQ(straight->state_hash(), other->state_hash());
}

// So loosely averaged that what a step begins with is often good enough: nothing has been solved in a loaded body then.
TEST_P(SavedMotion, GoesOnFromEveryStepHoweverLooselyItIsAveraged) {
  const auto straight = make(.05);
  for (int k = 0; k < 40; ++k) {
    const std::string bytes = saved(*straight);
    const auto fresh = make(.05);
    load(*fresh, bytes);
    straight->step();
    fresh->step();
    ASSERT_EQ(fresh->state_hash(), straight->state_hash()) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, SavedMotion, testing::Combine(testing::ValuesIn(solver_kinds()), testing::Bool()),
                         [](const auto& kind) {
                           return std::string(std::get<SolverKind>(kind.param).name) +
                                  (std::get<bool>(kind.param) ? "Tearing" : "");
                         });

// Other x and v are a state of their own, once the memory is reset.
TEST(MovingBody, GoesOnFromGivenPositionsWhateverWasSolvedBefore) {
  const auto make = [] {
    return MovingBody(yielding_bar(), {.gravity = {0, 1, -3}, .fixed = {0, 1, 2, 3, 4, 5, 6, 7, 8}},
                      std::make_unique<ConjugateGradients>(ConjugateGradientSettings{
                          .iterations = 8, .tolerance = 1e-9, .threshold = 0, .warm_start = true}));
  };
  MovingBody worked = make(), fresh = make();
  worked.run(12);
  EXPECT_GT(worked.solver_memory().start.rows(), 0);
  std::stringstream history;
  worked.body.save(history);
  const PointArray x = worked.x, v = worked.v;
  worked.run(3);
  for (MovingBody* moving : {&worked, &fresh}) {
    history.seekg(0);
    moving->body.load(history);
    moving->x = x;
    moving->v = v;
    moving->solver_memory().reset();
    moving->run(5);
  }
  EXPECT_EQ(worked.state_hash(), fresh.state_hash());
}

// SOFA's rules, which let the very first solve pass: a motion that goes on has had its first one.
TEST(MovingBody, HasHadItsFirstSolveWhenItGoesOn) {
  const auto make = [] {
    return MovingBody(yielding_bar(), {.gravity = {0, 1, -3}, .fixed = {0, 1, 2, 3, 4, 5, 6, 7, 8}},
                      std::make_unique<ConjugateGradients>(
                          ConjugateGradientSettings{.iterations = 8, .tolerance = 1e-9, .threshold = 1e9}));
  };
  MovingBody moving = make(), loaded = make();
  moving.step();
  EXPECT_EQ(moving.latest.iterations, 1);
  std::stringstream bytes;
  moving.save(bytes);
  loaded.load(bytes);
  for (MovingBody* body : {&moving, &loaded}) {
    body->step();
    EXPECT_EQ(body->latest.iterations, 0);
  }
}

TEST(MovingBody, FixedNodesStayWhateverTheirVelocitiesSay) {
  MovingBody moving(yielding_bar(), {.fixed = {0, 1, 2}});
  const PointArray before = moving.x.topRows(3);
  moving.v.row(1) << 1, 2, 3;
  moving.run(3);
  EXPECT_EQ(moving.x.topRows(3), before);
  EXPECT_TRUE(moving.v.topRows(3).isZero(0));
}

TEST(MovingBody, NodesThatAreReleasedBeforeTheStepDoNotKeepTheVelocityToTheirPlace) {
  MovingBody moving(yielding_bar(), {.fixed = {0, 1, 2}});
  const std::vector<int> nodes{40, 41};
  moving.prescribe(nodes, moving.x.middleRows(40, 2) * 1.5);
  moving.release(nodes);
  EXPECT_TRUE(moving.v.isZero(0));
}

TEST(MovingBody, RefusesADamagedOrAnotherMotion) {
  MovingBody moving(yielding_bar(), pulling());
  moving.run(3);
  std::ostringstream out;
  moving.save(out);
  const std::string bytes = out.str(), before = moving.state_hash();
  const auto refusal = [&](MovingBody& to, std::string from) -> std::string {
    try {
      std::istringstream in(from);
      to.load(in);
      return {};
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const std::string later = [&] {
    moving.run(2);
    return moving.state_hash();
  }();
  ASSERT_NE(later, before);
  for (std::size_t i = 0; i < bytes.size(); i += i < 64 ? 1 : 397) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << i % 8));
    EXPECT_NE(refusal(moving, damaged), "") << "byte " << i;
    EXPECT_NE(refusal(moving, bytes.substr(0, i)), "") << i;
  }
  EXPECT_EQ(moving.state_hash(), later);
  EXPECT_EQ(moving.steps(), 5);
  Motion slower = pulling();
  slower.dt = 0.02;
  MovingBody other_step(yielding_bar(), slower);
  EXPECT_NE(refusal(other_step, bytes).find("another mesh or other settings"), std::string::npos);
  EXPECT_NE(refusal(moving, "a text that is long enough to be a header").find("no saved motion"), std::string::npos);
  EXPECT_EQ(refusal(moving, bytes), "");
  EXPECT_EQ(moving.state_hash(), before);
}

TEST(MovingBody, RefusesWhatCannotMove) {
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.fixed = {81}}); }, {"node 81", "[0, 81)"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.density = 0}); }, {"density = 0"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.dt = -1}); }, {"dt = -1"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.dt = 0.5}); }, {"flow_rate"}));
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refuses<InputError>([&] { MovingBody(yielding_bar(), {.gravity = {0, infinite, 0}}); }, {"gravity"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.euler = {.rayleigh_mass = -1}}); },
                                  {"rayleigh_mass = -1"}));
  MovingBody moving(yielding_bar(), {});
  EXPECT_TRUE(refuses<InputError>([&] { moving.fix(std::vector{-1}); }, {"node -1", "[0, 81)"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.release(std::vector{81}); }, {"81"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.prescribe(kEnd, PointArray::Zero(8, 3)); }, {"8 positions", "9 nodes"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.prescribe(kEnd, PointArray::Constant(9, 3, infinite)); }, {"finite"}));
}

}  // namespace
}  // namespace hexaplast
