// SPDX-License-Identifier: LGPL-2.1-or-later
// A body's history through a stream, as host applications keep it, and a whole motion.
#include <fmt/format.h>

#include "hexaplast/material/rows.hpp"
#include "support/archive.hpp"
#include "support/core.hpp"
#include "support/rows.hpp"
#include "support/yielding_bar.hpp"

namespace hexaplast {
namespace {

Material breaking(RestShape rest_shape = RestShape::kJoined) {
  Material material = rest_shape == RestShape::kJoined ? yielding(100, 0.01) : stretching(100);
  material.fracture_stretch = 1.02;
  return material;
}

Body make_body(const Settings& settings, std::array<int, 3> cells = {2, 2, 3}) {
  return Body(distorted_block(cells, kEdge, 0.15, 162), {breaking(settings.rest_shape)}, settings);
}

/// Several plastic steps at positions that wander away from the initial ones.
void flow(Body& body, int first, int last) {
  body.set_time_step(kStep);
  for (int step = first; step < last; ++step) {
    Random random(100 + step);
    const PointArray& X = body.mesh().positions();
    const PointArray stretched = X * Vec3(1.0 + 0.02 * step, 1, 1).asDiagonal();
    body.flow(stretched + random.field(static_cast<int>(X.rows()), 0.1 * kEdge), kStep);
  }
}

// A body that goes on and one that is read anew before each step.
TEST(SavedBody, GoesOnBitForBitAndBeginsAgain) {
  const std::vector<double> relaxing = {0.7, 0.3, 2, 0.02};
  for (const Settings& settings :
       std::vector<Settings>{kJoined,
                             {.implementation = Implementation::kPlain},
                             {.precision = Precision::kMixed},
                             {.relaxation = relaxing},
                             {.relaxation = relaxing, .precision = Precision::kMixed},
                             {.relaxation = relaxing, .implementation = Implementation::kPlain}}) {
    Body straight = make_body(settings);
    const std::string initial = hash_of(straight);
    for (int step = 0; step < 12; ++step) {
      Body second = make_body(settings);
      load(second, saved(straight));
      EXPECT_EQ(hash_of(second), hash_of(straight));
      EXPECT_EQ(saved(second), saved(straight));
      for (Body* body : {&straight, &second}) {
        if (step == 7) body->remove(std::vector<int>{5});
        flow(*body, step, step + 1);
      }
      EXPECT_EQ(hash_of(second), hash_of(straight)) << step;
    }
    EXPECT_GT(straight.removed().size(), 1u) << "the case is to tear";
    straight.reset();
    EXPECT_EQ(hash_of(straight), initial);
  }
}

// Which keeps more than one that never flows.
TEST(SavedBody, ThatFlowsIsReadByOneThatIsElastic) {
  for (const RestShape rest_shape : {RestShape::kJoined, RestShape::kIsolated}) {
    Settings settings = kJoined;
    settings.rest_shape = rest_shape;
    Body body = make_body(settings, {6, 6, 8});
    flow(body, 1, 3);
    Body other(body.mesh(), {Material{}}, settings);
    load(other, saved(body));
    EXPECT_EQ(hash_of(other), hash_of(body));
  }
}

TEST(SavedBody, DamageIsFoundAndNothingChanges) {
  Body body = make_body(kJoined, {1, 1, 2});
  flow(body, 0, 2);
  const std::string bytes = saved(body);
  flow(body, 2, 3);
  const std::string before = hash_of(body);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << i % 8));
    EXPECT_THROW(load(body, damaged), InputError) << "byte " << i;
  }
  for (std::size_t size = 0; size < bytes.size(); size += 7)
    EXPECT_THROW(load(body, bytes.substr(0, size)), InputError) << size;
  EXPECT_EQ(hash_of(body), before);
}

testing::AssertionResult cannot_load(Body& body, const std::string& bytes, const char* message) {
  return refuses<InputError>([&] { load(body, bytes); }, {message});
}

TEST(SavedBody, OfAnotherBodyIsRefused) {
  Body body = make_body(kJoined), other_isolated = make_body({}), shorter = other_isolated;
  const std::string bytes = saved(body);
  Body other_mesh(distorted_block({2, 2, 3}, kEdge, 0.15, 163), {breaking()}, kJoined);
  Body other_settings = make_body({.precision = Precision::kMixed});
  EXPECT_TRUE(cannot_load(other_mesh, bytes, "another mesh"));
  EXPECT_TRUE(cannot_load(other_settings, bytes, "another rest_shape, must be isolated"));
  std::string later = bytes;
  later[8] = 99;
  EXPECT_TRUE(cannot_load(body, later, "format version 99, must be 10"));
  shorter.state().history.plastic_inverse.pop_back();
  EXPECT_THROW(load(other_isolated, saved(shorter)), InputError);
  EXPECT_TRUE(cannot_load(body, "mesh.pvd and other things that are no body", "no saved body"));
}

// Files that were saved stay readable as long as no member or word is added: then the body is another one, and so is
// this hash. Where the order of bytes changes alone, the version of the format does, too.
TEST(SavedBody, KeepsTheBytesOfItsFormat) {
  Settings settings;
  Material material;
  for (const Row<Settings>& row : settings_rows()) support::change(row, settings);
  for (const Row<Material>& row : material_rows()) support::change(row, material);
  settings.precision = Precision::kDouble;  // all that the plain implementation has with joined rest shapes
  settings.rest_shape = RestShape::kJoined;
  settings.yield_stress_measure = YieldStressMeasure::kBiot;
  settings.relaxation = {};
  settings.fracture = Fracture::kCell;
  const std::string bytes = saved(Body(block({1, 1, 1}, kEdge), {material}, settings));
  const auto size = serialized_size([&](Archive& archive) { serialize(archive, settings_rows(), settings); });
  StateHash hash;  // of "HXPBODY", version, what identifies the body, size, settings, number of materials, material
  hash.add(bytes.data(), 8 + 4 + 2 * 8 + size + 8 + 8 * material_rows().size());
  EXPECT_EQ(hash.text(), "7e2deb1a7ec40623");
}

TEST(SavedBody, KnowsEveryMember) {
  const HexMesh mesh = distorted_block({1, 1, 1}, kEdge, 0.15, 162);
  for (const Row<Settings>& row : settings_rows()) {
    Settings settings, others;
    support::change(row, others);
    try {
      validate(others);
    } catch (const InputError&) {
      settings.implementation = others.implementation = Implementation::kPlain;
    }
    Body other(mesh, {{}}, others);
    EXPECT_TRUE(
        cannot_load(other, saved(Body(mesh, {{}}, settings)), fmt::format("another {}, must be ", row.member).c_str()))
        << row.member;
  }
  for (const Row<Material>& row : material_rows()) {
    Material material;
    row.at.set(material, another(row, row.at.get(material)));
    Body first(mesh, {material}, kJoined), second(mesh, {{}}, kJoined);
    load(second, saved(first));
    EXPECT_EQ(row.at.get(second.material(0)), row.at.get(material)) << row.member;
    EXPECT_EQ(saved(second), saved(first)) << row.member;
  }
}

TEST(SavedBody, AStreamThatTakesNothingIsAnError) {
  std::ostringstream closed;
  closed.setstate(std::ios::badbit);
  EXPECT_THROW(make_body(kJoined).save(closed), InputError);
}

TEST(Archive, ListsAreCheckedBeforeTheyAreAllocated) {
  const std::uint64_t bomb = std::uint64_t{1} << 60;
  for (const bool is_text : {false, true}) {
    Archive archive{std::as_bytes(std::span(&bomb, 1))};
    std::vector<double> numbers;
    std::string text;
    EXPECT_THROW(is_text ? archive(text) : archive(numbers), InputError);
  }
}

// ---- motions that go on from what was saved of them

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
  static std::unique_ptr<MovingBody> make() {
    const auto& [name, make_solver, precision] = std::get<SolverKind>(GetParam());
    Material material{.young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 100, .flow_rate = 4};
    if (tears()) material.fracture_stretch = 1.004;
    return std::make_unique<MovingBody>(
        Body(regular_grid({3, 3, 8}, {0, 0, 0}, {.1, .1, .4}), {material}, {.precision = precision}),
        Motion{.gravity = {1, 2, -3}, .fixed = {0, 1, 2, 3, 4, 5, 6, 7}}, make_solver());
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
  straight->prescribe(prescribed, straight->positions.middleRows(140, 2) * 1.001);
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

TEST(SavedMotion, IsRefusedByOneThatMovesByOtherRules) {
  const Motion as_saved{.gravity = {0, 0, -1}};
  const std::string bytes = saved(MovingBody(yielding_bar(), as_saved));
  const auto loads = [&](const std::function<void(Motion&)>& change) {
    Motion motion = as_saved;
    change(motion);
    MovingBody moving(yielding_bar(), motion);
    return !refuses<InputError>([&] { load(moving, bytes); }, {"the saved motion has another"});
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
  const std::string history = saved(worked.body);
  const PointArray x = worked.positions, v = worked.velocities;
  worked.run(3);
  for (MovingBody* moving : {&worked, &fresh}) {
    load(moving->body, history);
    moving->positions = x;
    moving->velocities = v;
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
  load(loaded, saved(moving));
  for (MovingBody* body : {&moving, &loaded}) {
    body->step();
    EXPECT_EQ(body->latest.iterations, 0);
  }
}

TEST(MovingBody, RefusesADamagedOrAnotherMotion) {
  MovingBody moving(yielding_bar(), pulling());
  moving.run(3);
  const std::string bytes = saved(moving), before = moving.state_hash();
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
  EXPECT_TRUE(
      refuses<InputError>([&] { load(moving, "a text that is long enough to be a header"); }, {"no saved motion"}));
  load(moving, bytes);
  EXPECT_EQ(moving.state_hash(), before);
}

}  // namespace
}  // namespace hexaplast
