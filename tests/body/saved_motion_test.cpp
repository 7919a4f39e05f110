// SPDX-License-Identifier: LGPL-2.1-or-later
// Motions that go on from what was saved of them.
#include <functional>
#include <memory>
#include <sstream>

#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "support/compare.hpp"
#include "support/yielding_bar.hpp"

namespace hexaplast {
namespace {

using support::pulling;
using support::yielding_bar;

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
          {"Auto", pcg(Preconditioner::kAuto)}};
}

class SavedMotion : public testing::TestWithParam<std::tuple<SolverKind, bool>> {
 protected:
  static bool tears() { return std::get<bool>(GetParam()); }
  static std::unique_ptr<MovingBody> make(double averaging_tolerance = 1e-6) {
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

TEST(SavedMotion, IsRefusedByOneThatMovesByOtherRules) {
  const Motion as_saved{.gravity = {0, 0, -1}};
  std::stringstream bytes;
  MovingBody(yielding_bar(), as_saved).save(bytes);
  const auto loads = [&](const std::function<void(Motion&)>& change) {
    Motion motion = as_saved;
    change(motion);
    MovingBody moving(yielding_bar(), motion);
    std::istringstream in(bytes.str());
    return !support::refuses<InputError>([&] { moving.load(in); }, {"the saved motion has another"});
  };
  EXPECT_TRUE(loads([](Motion&) {}));
  EXPECT_FALSE(loads([](Motion& m) { m.gravity.z() = -2; }));
  EXPECT_FALSE(loads([](Motion& m) { m.dt = 0.02; }));
  EXPECT_FALSE(loads([](Motion& m) { m.euler.rayleigh_mass = 1; }));
  EXPECT_FALSE(loads([](Motion& m) { m.euler.rayleigh_stiffness = 1; }));
  EXPECT_FALSE(loads([](Motion& m) { m.euler.velocity_damping = 1; }));
  EXPECT_FALSE(loads([](Motion& m) { m.euler.first_order = true; }));
  EXPECT_FALSE(loads([](Motion& m) { m.euler.trapezoidal = true; }));
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

TEST(MovingBody, RefusesADamagedOrAnotherMotion) {
  MovingBody moving(yielding_bar(), pulling());
  moving.run(3);
  std::ostringstream out;
  moving.save(out);
  const std::string bytes = out.str(), before = moving.state_hash();
  const auto load = [](MovingBody& to, const std::string& from) {
    std::istringstream in(from);
    to.load(in);
  };
  const std::string later = [&] {
    moving.run(2);
    return moving.state_hash();
  }();
  ASSERT_NE(later, before);
  for (std::size_t i = 0; i < bytes.size(); i += i < 64 ? 1 : 397) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << i % 8));
    EXPECT_THROW(load(moving, damaged), InputError) << "byte " << i;
    EXPECT_THROW(load(moving, bytes.substr(0, i)), InputError) << i;
  }
  EXPECT_EQ(moving.state_hash(), later);
  EXPECT_EQ(moving.steps(), 5);
  Motion slower = pulling();
  slower.dt = 0.02;
  MovingBody other_step(yielding_bar(), slower);
  EXPECT_TRUE(support::refuses<InputError>([&] { load(other_step, bytes); }, {"another mesh or other settings"}));
  EXPECT_TRUE(support::refuses<InputError>([&] { load(moving, "a text that is long enough to be a header"); },
                                           {"no saved motion"}));
  load(moving, bytes);
  EXPECT_EQ(moving.state_hash(), before);
}

}  // namespace
}  // namespace hexaplast
