// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tuple>

#include "support/archive.hpp"
#include "support/core.hpp"
#include "support/yielding_bar.hpp"

namespace hexaplast {
namespace {

// The springs of recovery turn and move with what they hold, also where a factorisation solves for them.
TEST(MovingBody, FallsFreelyWhileItUnfolds) {
  for (const int cells : {2, 6}) {
    const HexMesh mesh = distorted_block({cells, cells, 4}, 0.1, 0.1, 201);
    MovingBody falling(Body(mesh, {Material{}}), {.density = 500, .dt = 0.02, .gravity = {0, 0, -9.81}});
    falling.positions += Random(202).field(mesh.num_nodes(), 0.08);
    falling.body.linearize(falling.positions);
    ASSERT_TRUE(falling.body.state().backend->recovery().acts());
    falling.run(5);
    const Eigen::Map<const Eigen::VectorXd> mass(falling.mass().data(), mesh.num_nodes());
    const Vec3 momentum = falling.velocities.transpose() * mass;
    EXPECT_LE((momentum - Vec3(0, 0, -9.81 * 0.1 * mass.sum())).norm(), 1e-9 * mass.sum());
  }
}

TEST(MovingBody, StaysStretchedWhateverSolvesIt) {
  MovingBody direct(yielding_bar(), pulling());
  MovingBody iterative(yielding_bar(), pulling(), std::make_unique<PreconditionedConjugateGradients>(1e-10, 1000));
  for (MovingBody* moving : {&direct, &iterative}) moving->run(300);
  EXPECT_GT(direct.positions(80, 2), 0.41);
  EXPECT_GT(direct.body.fields(direct.positions).plastic_strain[0], 0.01);
  EXPECT_LE(max_abs(direct.positions - iterative.positions), 1e-6);
  EXPECT_EQ(direct.positions.topRows(9), direct.body.mesh().positions().topRows(9));
  EXPECT_NE(direct.state_hash(), iterative.state_hash());
}

/// Springs and dashpots from every node to where it began, of which kernels know nothing; they count the steps.
class Tethers final : public StepForces {
 public:
  explicit Tethers(PointArray from) : from_(std::move(from)) {}
  void begin_step(const Step& step, const Pair<ConstPoints>&, const Pair<ConstPoints>&) override {
    EXPECT_EQ(step.dt, 0.01);
    ++num_begun;
  }
  void end_step(const Pair<ConstPoints>& x) override {
    if (fails) throw std::runtime_error("thrown at the end");
    end = x.first;
  }
  void reset() override { num_begun = 0; }
  void serialize(Archive& archive) override { archive(num_begun); }
  void add_force(double, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) override {
    f.first -= kStiffness * (x.first - from_) + kDamping * v.first;
  }
  void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    df.first -= factor * kStiffness * dx.first;
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2>) const override {
    for (int n = 0; n < A.num_nodes(); ++n) A.add(n, n, -factor * kStiffness * Mat3::Identity());
  }
  void add_damping_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    df.first -= factor * kDamping * dx.first;
  }
  void add_damping_blocks(double factor, BlockMatrix& A, std::array<int, 2>) const override {
    for (int n = 0; n < A.num_nodes(); ++n) A.add(n, n, -factor * kDamping * Mat3::Identity());
  }

  static constexpr double kStiffness = 20, kDamping = 3;
  int num_begun = 0;
  bool fails = false;
  PointArray end;

 private:
  PointArray from_;
};

// Every node falls by itself with implicit Euler, m dv = h (m g - k (x + h v') - c v'), where masses are equal.
TEST(MovingBody, TakesOtherForcesIntoItsSteps) {
  for (const bool iterates : {false, true}) {
    const HexMesh mesh = regular_grid({1, 1, 1}, Vec3::Zero(), {0.1, 0.1, 0.1});
    std::unique_ptr<LinearSolver> solver;
    if (iterates) solver = std::make_unique<PreconditionedConjugateGradients>(1e-14, 100);
    MovingBody moving(Body(mesh, {Material{}}), {.dt = 0.01, .gravity = {0, 0, -9.81}}, std::move(solver));
    Tethers tethers(mesh.positions());
    moving.add(tethers);
    const double m = 1.0 / 8, h = 0.01, k = Tethers::kStiffness, c = Tethers::kDamping;
    double z = 0, v = 0;
    const auto fall = [&](int steps) {
      for (int s = 0; s < steps; ++s) {
        v = (m * v + h * (-9.81 * m - k * z)) / (m + h * c + h * h * k);
        z += h * v;
      }
    };
    moving.run(20);
    fall(20);
    EXPECT_LE((moving.positions.col(2) - mesh.positions().col(2)).array().abs().maxCoeff() - std::abs(z), 1e-12);
    EXPECT_NEAR(moving.positions(0, 2), z, 1e-12);
    EXPECT_EQ(tethers.num_begun, 20);
    EXPECT_EQ(tethers.end, moving.positions);

    std::stringstream saved;
    moving.save(saved);
    moving.positions(0, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(moving.step(), NumericalError);
    EXPECT_EQ(tethers.num_begun, 20) << "as before the step";
    moving.load(saved);
    moving.step();
    fall(1);
    EXPECT_NEAR(moving.positions(0, 2), z, 1e-12);
    moving.reset();
    EXPECT_EQ(tethers.num_begun, 0);
  }
  Tethers tethers(yielding_bar().mesh().positions());
  MovingBody viscous(yielding_bar(), {.euler = {.first_order = true}});
  EXPECT_TRUE(refuses<InputError>([&] { viscous.add(tethers); }, {"implicit Euler"}));
}

// What the body gains in a step is its weight and what its supports exert.
TEST(MovingBody, MeasuresTheForcesOfItsSupports) {
  const Motion motion{.density = 500, .gravity = {1, 2, -9.81}, .fixed = kEnd};
  MovingBody hanging(yielding_bar(), motion), other(yielding_bar(), motion);
  EXPECT_EQ(hanging.support_forces().rows(), 0);
  hanging.measure_supports();
  const Eigen::Map<const Eigen::VectorXd> mass(hanging.mass().data(), hanging.positions.rows());
  for (int step = 0; step < 30; ++step) {
    if (step == 10) {
      const PointArray to = hanging.positions.bottomRows(9).rowwise() + Eigen::RowVector3d(0.01, 0, 0.02);
      hanging.prescribe(kEnd, to);
      other.prescribe(kEnd, to);
    }
    const Vec3 before = hanging.velocities.transpose() * mass;
    hanging.step();
    other.step();
    if (step == 10) continue;  // its nodes have a velocity before it, and none behind it
    const Vec3 gained = (hanging.velocities.transpose() * mass - before) / hanging.dt();
    const Vec3 supports = hanging.support_forces().colwise().sum();
    EXPECT_LE((gained - mass.sum() * motion.gravity - supports).norm(), 1e-8 * supports.norm());
  }
  EXPECT_EQ(hanging.state_hash(), other.state_hash());
  PointArray free = hanging.support_forces();
  for (const int n : kEnd) free.row(n).setZero();
  EXPECT_EQ(max_abs(free), 0);
}

// All nodes move at one velocity, the end's because they are prescribed: a rigid translation, which no force disturbs.
// A velocity of the prescribed nodes that the others did not feel would lag by a step.
TEST(MovingBody, LeadsNodesAndTheOthersAlongWithThem) {
  MovingBody moving(yielding_bar(), {.euler = {.rayleigh_stiffness = 0.05}});
  const Vec3 velocity(0.3, -0.2, 0.5);
  const PointArray start = moving.positions;
  const auto moved = [&](int steps) -> PointArray { return start.rowwise() + 0.01 * steps * velocity.transpose(); };
  moving.velocities.rowwise() = velocity.transpose();
  for (int k = 1; k <= 5; ++k) {
    moving.prescribe(kEnd, moved(k).bottomRows(9));
    moving.step();
    EXPECT_LE(max_abs(moving.positions - moved(k)), 1e-12) << "step " << k;
  }

  moving.step();  // no longer prescribed, they stand
  EXPECT_LE(max_abs(moving.positions.bottomRows(9) - moved(5).bottomRows(9)), 1e-12);
  EXPECT_GE(max_abs(moving.positions.topRows(9) - moved(5).topRows(9)), 1e-3);
  moving.release(kEnd);
  moving.run(3);
  EXPECT_GE(max_abs(moving.positions.bottomRows(9) - moved(5).bottomRows(9)), 1e-3);
}

// Without lateral contraction the bar is in the end stretched as its end is; on the way there it lags behind.
TEST(MovingBody, LeadsNodesInFirstOrderToo) {
  const HexMesh mesh = regular_grid({2, 2, 8}, {0, 0, 0}, {.1, .1, .4});
  MovingBody moving(Body(mesh, {{.young_modulus = 5000, .poisson_ratio = 0}}),
                    {.density = 10, .euler = {.first_order = true}, .fixed = {0, 1, 2, 3, 4, 5, 6, 7, 8}});
  const PointArray goal = mapped(mesh.positions(), Vec3(1, 1, 1.01).asDiagonal());
  moving.prescribe(kEnd, goal.bottomRows(9));
  moving.step();
  EXPECT_LE(max_abs(moving.positions.bottomRows(9) - goal.bottomRows(9)), 1e-15);
  EXPECT_GT(moving.positions(63, 2), mesh.positions()(63, 2) + 1e-5) << "the others feel it within the step";
  moving.run(500);
  EXPECT_LE(max_abs(moving.positions - goal), 1e-9);
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
    EXPECT_EQ(moving->positions.row(0), positions.row(0));
    EXPECT_NEAR(moving->positions(1, 2), -10 * 0.01 * 0.01, 1e-12);
  }
}

TEST(MovingBody, FixedNodesStayWhateverTheirVelocitiesSay) {
  MovingBody moving(yielding_bar(), {.gravity = {0, 0, -1}, .fixed = {0, 1, 2}});
  moving.run(3);
  moving.fix(kEnd);
  const PointArray before = moving.positions;
  moving.velocities.row(1) << 1, 2, 3;
  moving.run(3);
  for (const auto& [first, count] : {std::pair(0, 3), std::pair(72, 9)}) {
    EXPECT_EQ(moving.positions.middleRows(first, count), before.middleRows(first, count));
    EXPECT_TRUE(moving.velocities.middleRows(first, count).isZero(0));
  }
  EXPECT_LT(moving.positions(10, 2), before(10, 2));
}

// The solution before, which a warm start takes, moves what is fixed now.
TEST(MovingBody, FixedNodesStayWhateverTheLatestSolutionSays) {
  for (const Implementation implementation : {Implementation::kAuto, Implementation::kPlain}) {
    MovingBody moving(yielding_bar({.implementation = implementation}), {.gravity = {0, 0, -1}, .fixed = {0, 1, 2}},
                      std::make_unique<ConjugateGradients>(ConjugateGradientSettings{
                          .iterations = 200, .tolerance = 1e-8, .threshold = 0, .warm_start = true}));
    moving.run(3);
    moving.fix(kEnd);
    const PointArray before = moving.positions;
    moving.run(2);
    EXPECT_EQ(moving.positions.bottomRows(9), before.bottomRows(9));
    EXPECT_LT(moving.positions(10, 2), before(10, 2));
  }
}

// A force that fails at the end of a step: nothing has flowed.
TEST(MovingBody, IsAsBeforeWhereTheEndOfAStepThrows) {
  MovingBody moving(yielding_bar(), pulling());
  Tethers tethers(moving.positions);
  moving.add(tethers);
  moving.run(100);
  ASSERT_GT(moving.body.state().history.dissipated_energy, 0);
  tethers.fails = true;
  const std::string before = moving.state_hash();
  EXPECT_THROW(moving.step(), std::runtime_error);
  EXPECT_EQ(moving.state_hash(), before);
}

TEST(MovingBody, NodesThatAreReleasedBeforeTheStepDoNotKeepTheVelocityToTheirPlace) {
  MovingBody moving(yielding_bar(), {.fixed = {0, 1, 2}});
  const std::vector<int> nodes{40, 41};
  moving.prescribe(nodes, moving.positions.middleRows(40, 2) * 1.5);
  moving.release(nodes);
  EXPECT_TRUE(moving.velocities.isZero(0));
}

/// Every number that a step changes.
std::tuple<std::string, int, double> state_of(const MovingBody& moving) {
  return {support::saved(moving), moving.latest.iterations, moving.latest.residual};
}

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
        of.prescribe(prescribed, of.positions.middleRows(72, 2) * 1.001);
        for (int k = 0; k < steps; ++k) of.step();
      };
      for (MovingBody* of : {&moving, &untroubled}) {
        if (first_steps % 2 == 1) of->run(20);  // else it fails in the very first step
        of->prescribe(prescribed, of->positions.middleRows(72, 2) * 1.002);
      }
      ++first_steps;
      const auto before = state_of(moving);
      const double* memory = moving.positions.data();
      force = trouble.force;
      throws = trouble.force == 0;
      for (int k = 0; k < 2; ++k) {
        try {
          moving.step();
          ADD_FAILURE() << trouble.what;
        } catch (const std::exception& error) {
          EXPECT_NE(std::string(error.what()).find(trouble.what), std::string::npos) << error.what();
        }
        EXPECT_TRUE(state_of(moving) == before) << trouble.what;
      }
      EXPECT_EQ(moving.positions.data(), memory) << "a view of the positions would dangle";

      force = 0;
      throws = false;
      for (MovingBody* of : {&moving, &untroubled}) {
        of->step();  // the nodes that were prescribed before still are
        go_on(*of, 5);
      }
      EXPECT_TRUE(state_of(moving) == state_of(untroubled)) << trouble.what;
      EXPECT_GT(moving.body.state().history.dissipated_energy + (first_steps % 2), 0);
    }
}

TEST(MovingBody, ReportsTheWorstOfARun) {
  MovingBody good(yielding_bar({.rest_shape = RestShape::kJoined}), pulling());
  const RunReport report = good.run(30);
  EXPECT_EQ(report.steps, 30);
  EXPECT_EQ(report.stalled, 0);
  EXPECT_TRUE(report.solve.converged);
  EXPECT_EQ(report.solve.iterations, 1);
  EXPECT_GT(report.flow.yielded, 0);
  EXPECT_FALSE(report.flow.averaging.skipped);

  MovingBody bad(yielding_bar(), pulling(), std::make_unique<PreconditionedConjugateGradients>(1e-12, 2));
  const RunReport of_bad = bad.run(6);
  EXPECT_GT(of_bad.stalled, 0);
  EXPECT_FALSE(of_bad.solve.converged);
  EXPECT_GT(of_bad.solve.residual, 1e-12);

  RunReport sum;
  SolveReport solved{.iterations = 3, .residual = 0.1, .converged = true};
  FlowReport flowed;
  flowed.yielded = 7;
  flowed.removed = 2;
  flowed.worst_volume_error = 0.2;
  flowed.averaging = {.skipped = false, .fell_back = true, .iterations = 5, .residual = 0.3, .converged = false};
  sum.add(solved, flowed);
  flowed.yielded = 4;
  flowed.inverted = flowed.skipped = flowed.repaired = flowed.rolled_back = 1;
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
  EXPECT_EQ(sum.flow.inverted + sum.flow.skipped + sum.flow.repaired + sum.flow.rolled_back, 4);
  EXPECT_EQ(sum.flow.worst_volume_error, 0.2);
  EXPECT_TRUE(sum.flow.averaging.fell_back);
  EXPECT_FALSE(sum.flow.averaging.skipped);
  EXPECT_FALSE(sum.flow.averaging.converged);
  EXPECT_EQ(sum.flow.averaging.iterations, 5);
  EXPECT_EQ(sum.flow.averaging.residual, 0.3);
}

TEST(MovingBody, RefusesWhatCannotMove) {
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.fixed = {81}}); }, {"node 81", "[0, 81)"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.density = 0}); }, {"density = 0"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.dt = -1}); }, {"dt = -1"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar({.rest_shape = RestShape::kJoined}), {.dt = 0.5}); },
                                  {"flow_rate"}));
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refuses<InputError>([&] { MovingBody(yielding_bar(), {.gravity = {0, infinite, 0}}); }, {"gravity"}));
  EXPECT_TRUE(refuses<InputError>([] { MovingBody(yielding_bar(), {.euler = {.rayleigh_mass = -1}}); },
                                  {"rayleigh_mass = -1"}));
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_TRUE(refuses<InputError>([&] { MovingBody(yielding_bar(), {.euler = {.velocity_damping = bad}}); },
                                    {"velocity_damping = "}));
  MovingBody moving(yielding_bar(), {});
  EXPECT_TRUE(refuses<InputError>([&] { moving.fix(std::vector{-1}); }, {"node -1", "[0, 81)"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.release(std::vector{81}); }, {"81"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.prescribe(kEnd, PointArray::Zero(8, 3)); }, {"8 positions", "9 nodes"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.prescribe(kEnd, PointArray::Constant(9, 3, infinite)); }, {"finite"}));
  moving.prescribe(kEnd, moving.positions.bottomRows(9));
  moving.velocities = PointArray::Zero(3, 3);
  EXPECT_TRUE(refuses<InputError>([&] { moving.step(); }, {"velocities has 3 rows, must have 81"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.release(kEnd); }, {"velocities has 3 rows, must have 81"}));
}

// The first call after a move must not look where the body has been.
TEST(MovingBody, GoesOnInAnotherPlaceWithTheSameBits) {
  const std::vector<int> nodes = {0, 1};
  const PointArray places = yielding_bar().mesh().positions().topRows(2).array() + 1e-4;
  const std::function<void(MovingBody&)> calls[] = {[](MovingBody&) {}, [&](MovingBody& moving) { moving.fix(nodes); },
                                                    [&](MovingBody& moving) { moving.prescribe(nodes, places); },
                                                    [&](MovingBody& moving) { moving.release(nodes); }};
  for (const bool is_iterative : {false, true})
    for (const auto& call : calls) {
      const auto make = [&] {
        return MovingBody(yielding_bar(), pulling(),
                          is_iterative ? std::make_unique<PreconditionedConjugateGradients>(1e-8, 1000) : nullptr);
      };
      MovingBody straight = make(), assigned = make();
      auto source = std::make_unique<MovingBody>(make());
      for (MovingBody* moving : {&straight, source.get()}) moving->run(20);
      const double* const rest = source->body.plastic_rest_positions().data();
      MovingBody built(std::move(*source));
      source.reset();
      EXPECT_EQ(built.body.plastic_rest_positions().data(), rest) << "a move copies nothing";
      for (MovingBody* moving : {&straight, &built}) {
        call(*moving);
        moving->run(2);
      }
      EXPECT_EQ(built.state_hash(), straight.state_hash());
      assigned = std::move(built);
      for (MovingBody* moving : {&straight, &assigned}) {
        call(*moving);
        moving->run(2);
      }
      EXPECT_EQ(assigned.state_hash(), straight.state_hash());
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
    body.positions.bottomRows(9).col(2).array() += 1e-4 * k;  // no two are the same
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
