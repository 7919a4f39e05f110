// SPDX-License-Identifier: LGPL-2.1-or-later
// What callers owe: order and sizes of calls. Each breach is an InputError that names it, in every build; a view with
// gaps between its rows gives the same as one without.
#include <type_traits>

#include "geometry/pick.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/geometry/plane_cut.hpp"
#include "hexaplast/geometry/sections.hpp"
#include "hexaplast/solve/grip.hpp"
#include "hexaplast/solve/newton_raphson.hpp"
#include "mesh/selection.hpp"
#include "solve/contact_loads.hpp"
#include "solve/loads.hpp"
#include "support/archive.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

const HexMesh kCalled = distorted_block({2, 2, 3}, kEdge, 0.15, 162);
constexpr int kRows = 36;  // its nodes

PointArray called_world() { return stretched_and_twisted(kCalled, 1.2, 0.3); }

Body called_body(Precision precision = Precision::kDouble) {
  return Body(kCalled, {stretching(100)}, {.precision = precision});
}

struct BodyVerb {
  std::string name;
  std::function<void(Body&)> call;
};

/// Those that refer to the linearization.
std::vector<BodyVerb> referring_verbs() {
  return {{"add_force",
           [](Body& body) {
             PointArray f = PointArray::Zero(kRows, 3);
             body.add_force(f);
           }},
          {"add_stiffness_product",
           [](Body& body) {
             PointArray df = PointArray::Zero(kRows, 3);
             body.add_stiffness_product(-1, called_world(), df);
           }},
          {"add_stiffness_blocks",
           [](Body& body) {
             BlockMatrix K(kRows);
             body.add_stiffness_blocks(-1, K);
           }},
          {"add_operator", [](Body& body) {
             MatrixFreeSystem system;
             body.add_operator(-1, system);
           }}};
}

/// Those that end it.
std::vector<BodyVerb> ending_verbs() {
  return {{"flow", [](Body& body) { body.flow(called_world(), kStep); }},
          {"remove", [](Body& body) { body.remove(std::vector{3}); }},
          {"set_materials", [](Body& body) { body.set_materials({stretching(200)}); }},
          {"reset", [](Body& body) { body.reset(); }},
          {"load",
           [](Body& body) {
             std::stringstream stream;
             body.save(stream);
             body.load(stream);
           }},
          {"serialize", [](Body& body) { read_from(written(body), body); }}};
}

TEST(OrderOfCalls, WhatRefersToTheLinearizationNamesWhatIsMissing) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    for (const BodyVerb& verb : referring_verbs()) {
      Body body = called_body(precision);
      EXPECT_TRUE(refuses<InputError>([&] { verb.call(body); }, {verb.name, "linearize", "since the body was made"}));
      for (const BodyVerb& ending : ending_verbs()) {
        body.linearize(called_world());
        EXPECT_NO_THROW(verb.call(body)) << verb.name;
        ending.call(body);
        EXPECT_TRUE(refuses<InputError>([&] { verb.call(body); }, {verb.name, "linearize", "since " + ending.name}))
            << ending.name;
      }
      Body copy = body;
      EXPECT_TRUE(refuses<InputError>([&] { verb.call(copy); }, {verb.name, "since the body was copied"}));
      copy.linearize(called_world());
      EXPECT_NO_THROW(verb.call(copy)) << verb.name;
      EXPECT_THROW(verb.call(body), InputError) << verb.name;
    }
}

TEST(OrderOfCalls, AFlowThatIsRefusedEndsNothing) {
  Body body = called_body();
  body.linearize(called_world());
  PointArray spoiled = called_world();
  spoiled(3, 1) = NAN;
  EXPECT_THROW(body.flow(called_world(), -1), InputError);
  EXPECT_THROW(body.flow(spoiled, kStep), NumericalError);
  EXPECT_THROW(body.remove(std::vector{99}), InputError);
  EXPECT_THROW(body.set_materials({}), InputError);
  for (const BodyVerb& verb : referring_verbs()) EXPECT_NO_THROW(verb.call(body)) << verb.name;
}

TEST(OrderOfCalls, OfAnElasticBodyIsTheSame) {
  Body body(kCalled, {Material{}});
  body.linearize(called_world());
  body.flow(called_world(), kStep);
  for (const BodyVerb& verb : referring_verbs()) EXPECT_THROW(verb.call(body), InputError) << verb.name;
}

/// A call, one of whose arguments has `wrong` rows in place of `right` ones.
struct SizedCall {
  std::string call, argument;
  int right;
  std::function<void(PointArray& wrong)> act;
};

/// Twice the identity.
class Doubling final : public LinearSystem {
 public:
  int num_nodes() const override { return 4; }
  void apply(ConstPoints p, Points Ap) const override { Ap = 2 * p; }
  void assemble(BlockMatrix& A) const override {
    for (int n = 0; n < 4; ++n) A.add(n, n, 2 * Mat3::Identity());
  }
};

class SizesOfCalls : public testing::Test {
 protected:
  SizesOfCalls() {
    body.linearize(x);
    grip.close({5, 0, 30}, Vec3::Zero(), x);
    grip.elongations_at(Vec3(0.1, 0, 0), x, elongations);
  }

  /// Every size that is not `right`: refused with the name of the call, the argument and both numbers.
  void expect_refusals(const std::vector<SizedCall>& calls) {
    for (const auto& [call, argument, right, act] : calls) {
      PointArray fitting = PointArray::Constant(right, 3, 0.01);
      EXPECT_NO_THROW(act(fitting)) << call << ": " << argument;
      for (const int rows : {0, right - 1, right + 1, 7 * right}) {
        PointArray wrong = PointArray::Zero(rows, 3);
        EXPECT_TRUE(refuses<InputError>(
            [&, &act = act] { act(wrong); },
            {call + ": ", argument + " has " + std::to_string(rows) + " rows, must have " + std::to_string(right)}))
            << call << ": " << argument;
      }
    }
  }

  /// As above where an argument must only have the nodes that are asked for.
  void expect_refusal_of_missing_nodes(const std::vector<std::pair<std::string, std::function<void()>>>& calls) {
    for (const auto& [call, act] : calls) EXPECT_TRUE(refuses<InputError>(act, {call + ": node ", "must lie in [0, "}));
  }

  Body body = called_body();
  PointArray x = called_world(), v = PointArray::Zero(kRows, 3), f = PointArray::Zero(kRows, 3);
  Grip grip{.stiffness = 100, .damping = 2};
  PointArray elongations;
};

TEST_F(SizesOfCalls, OfABody) {
  expect_refusals({
      {"linearize", "x", kRows, [&](PointArray& wrong) { Body(called_body()).linearize(wrong); }},
      {"add_force", "f", kRows, [&](PointArray& wrong) { body.add_force(wrong); }},
      {"add_stiffness_product", "dx", kRows, [&](PointArray& wrong) { body.add_stiffness_product(1, wrong, f); }},
      {"add_stiffness_product", "df", kRows, [&](PointArray& wrong) { body.add_stiffness_product(1, x, wrong); }},
      {"add_stiffness_blocks", "K", kRows,
       [&](PointArray& wrong) {
         BlockMatrix K(static_cast<int>(wrong.rows()));
         body.add_stiffness_blocks(1, K);
       }},
      {"energy", "x", kRows, [&](PointArray& wrong) { body.energy(wrong); }},
      {"recovery_work", "x", kRows,
       [&](PointArray& wrong) {
         Body recovering(kCalled, {Material{}}, {.recovery = RecoveryMode::kCluster});
         recovering.linearize(x);
         recovering.recovery_work(wrong);
       }},
      {"fields", "x", kRows, [&](PointArray& wrong) { body.fields(wrong); }},
      {"volume", "x", kRows, [&](PointArray& wrong) { body.volume(wrong); }},
      {"flow", "x", kRows,
       [&](PointArray& wrong) {
         if (wrong.rows() == kRows) wrong = x;
         Body(body).flow(wrong, kStep);
       }},
  });
  PointArray wrong = PointArray::Zero(kRows - 1, 3);
  const std::string before = hash_of(body);
  EXPECT_THROW(body.flow(wrong, kStep), InputError);
  EXPECT_THROW(body.linearize(wrong), InputError);
  EXPECT_EQ(hash_of(body), before);
  EXPECT_NO_THROW(body.add_force(f)) << "what was refused has changed nothing";
}

TEST_F(SizesOfCalls, OfSystemsAndIntegrators) {
  LoadedBody system(body, std::vector<double>(kRows, 1), {0, 1, 2, 3}, {});
  CholeskySolver solver;
  ImplicitEuler euler{EulerSettings{}};
  NewtonRaphson newton{NewtonSettings{}};
  MovingBody moving(called_body(), {});
  expect_refusals({
      {"LoadedBody", "mass", kRows,
       [&](PointArray& wrong) { LoadedBody(body, std::vector<double>(wrong.rows(), 1), {}, {}); }},
      {"LayeredSystem::add_product", "dx", kRows,
       [&](PointArray& wrong) { system.add_product({.mass = 1}, wrong, f); }},
      {"LayeredSystem::add_product", "df", kRows,
       [&](PointArray& wrong) { system.add_product({.mass = 1}, x, wrong); }},
      {"Constraints::project", "field", kRows, [&](PointArray& wrong) { constraints_of(system).project(wrong); }},
      {"LayeredSystem::compute_force", "x", kRows, [&](PointArray& wrong) { system.compute_force(0, wrong, v, f); }},
      {"LayeredSystem::compute_force", "f", kRows, [&](PointArray& wrong) { system.compute_force(0, x, v, wrong); }},
      {"ImplicitEuler::step", "x", kRows, [&](PointArray& wrong) { euler.step(system, solver, 0, kStep, wrong, v); }},
      {"ImplicitEuler::step", "v", kRows, [&](PointArray& wrong) { euler.step(system, solver, 0, kStep, x, wrong); }},
      {"NewtonRaphson::solve", "x", kRows,
       [&](PointArray& wrong) {
         if (wrong.rows() == kRows) wrong = kCalled.positions();
         newton.solve(system, solver, 0, wrong);
       }},
      {"MovingBody", "velocities", kRows,
       [&](PointArray& wrong) {
         moving.velocities = wrong;
         moving.step();
       }},
      {"MovingBody", "velocities", kRows,
       [&](PointArray& wrong) {
         moving.velocities = wrong;
         moving.fix(std::vector{0});
       }},
  });
  expect_refusal_of_missing_nodes({{"LoadedBody::fix", [&] { system.fix(std::vector{kRows}); }},
                                   {"LoadedBody::fix", [&] { system.fix(std::vector{-1}); }},
                                   {"MovingBody", [&] { moving.fix(std::vector{kRows}); }},
                                   {"MovingBody", [&] { moving.release(std::vector{-1}); }}});
}

TEST_F(SizesOfCalls, OfEverySolver) {
  const Doubling A;
  CholeskySolver cholesky;
  ConjugateGradients cg{ConjugateGradientSettings{}};
  PreconditionedConjugateGradients pcg(1e-6, 10);
  PointArray b = PointArray::Ones(4, 3), y = PointArray::Zero(4, 3);
  SolverMemory memory;
  for (LinearSolver* solver : std::initializer_list<LinearSolver*>{&cholesky, &cg, &pcg})
    expect_refusals({{"solve", "b", 4, [&](PointArray& wrong) { solver->solve(A, wrong, y); }},
                     {"solve", "x", 4, [&](PointArray& wrong) { solver->solve(A, b, wrong); }},
                     {"solve", "b", 4, [&](PointArray& wrong) { solver->solve_from_guess(A, wrong, y, memory); }},
                     {"solve", "x", 4, [&](PointArray& wrong) { solver->solve_from_guess(A, b, wrong, memory); }}});
}

TEST_F(SizesOfCalls, OfGripsLoadsAndObstacles) {
  const Obstacle wall{.normal = Vec3::UnitZ(), .distance = 0.1};
  const std::vector<int> touching{0, 5};
  const Triangle triangle{0, 1, 2};
  expect_refusals({
      {"Grip::add_force", "f", kRows, [&](PointArray& wrong) { grip.add_force(Vec3::Zero(), x, wrong); }},
      {"Grip::total_force", "elongations", 3, [&](PointArray& wrong) { grip.total_force(wrong); }},
      {"Grip::add_stiffness_product", "elongations", 3,
       [&](PointArray& wrong) { grip.add_stiffness_product(wrong, 1, x, f); }},
      {"Grip::add_stiffness_product", "df", kRows,
       [&](PointArray& wrong) { grip.add_stiffness_product(elongations, 1, x, wrong); }},
      {"Grip::add_stiffness_blocks", "elongations", 3,
       [&](PointArray& wrong) {
         BlockMatrix A(kRows);
         grip.add_stiffness_blocks(wrong, 1, A);
       }},
      {"Grip::add_stiffness_diagonal", "elongations", 3,
       [&](PointArray& wrong) { grip.add_stiffness_diagonal(wrong, 1, f); }},
      {"Grip::add_damping_force", "f", kRows,
       [&](PointArray& wrong) { grip.add_damping_force(Vec3::Zero(), v, wrong); }},
      {"Grip::add_damping_product", "df", kRows, [&](PointArray& wrong) { grip.add_damping_product(1, v, wrong); }},
      {"add_pressure", "f", kRows, [&](PointArray& wrong) { add_pressure(triangle, 1, x, wrong); }},
      {"Obstacle::add_force", "v", kRows, [&](PointArray& wrong) { wall.add_force(x, wrong, f); }},
      {"Obstacle::add_force", "f", kRows, [&](PointArray& wrong) { wall.add_force(x, v, wrong); }},
      {"Obstacle::stiff_at", "v", kRows,
       [&](PointArray& wrong) {
         std::vector<int> stiff;
         wall.stiff_at(x, wrong, stiff);
       }},
      {"Obstacle::add_stiffness_product", "df", kRows,
       [&](PointArray& wrong) { wall.add_stiffness_product(touching, 1, x, wrong); }},
      {"add_tangential_forces", "f", kRows,
       [&](PointArray& wrong) { add_tangential_forces(touching, 1, Vec3::UnitZ(), Vec3(-1, -1, 0), 1, x, wrong); }},
      {"dot", "b", kRows, [&](PointArray& wrong) { dot(x, wrong); }},
  });

  PointArray few = x.topRows(30), few_f = PointArray::Zero(30, 3);  // without the last node that the grip holds
  BlockMatrix small(30);
  const Triangle beyond{0, 1, 30};
  const Quad before{-1, 1, 2, 3};
  expect_refusal_of_missing_nodes({
      {"nodes_near", [&] { nodes_near(x, std::vector{kRows}, Vec3::Zero(), 1); }},
      {"Grip::close", [&] { grip.close({kRows}, Vec3::Zero(), x); }},
      {"Grip::elongations_at", [&] { grip.elongations_at(Vec3::Zero(), few, elongations); }},
      {"Grip::add_force", [&] { grip.add_force(Vec3::Zero(), few, few_f); }},
      {"Grip::energy", [&] { grip.energy(Vec3::Zero(), few); }},
      {"Grip::add_stiffness_product", [&] { grip.add_stiffness_product(elongations, 1, few, few_f); }},
      {"Grip::add_stiffness_blocks", [&] { grip.add_stiffness_blocks(elongations, 1, small); }},
      {"Grip::add_stiffness_diagonal", [&] { grip.add_stiffness_diagonal(elongations, 1, few_f); }},
      {"Grip::add_damping_force", [&] { grip.add_damping_force(Vec3::Zero(), few, few_f); }},
      {"Grip::add_damping_product", [&] { grip.add_damping_product(1, few, few_f); }},
      {"Grip::add_damping_blocks", [&] { grip.add_damping_blocks(1, small); }},
      {"Grip::add_damping_diagonal", [&] { grip.add_damping_diagonal(1, few_f); }},
      {"add_pressure", [&] { add_pressure(beyond, 1, few, few_f); }},
      {"add_pressure", [&] { add_pressure(before, 1, few, few_f); }},
      {"Obstacle::add_stiffness_product", [&] { wall.add_stiffness_product(std::vector{30}, 1, few, few_f); }},
      {"Obstacle::add_stiffness_blocks", [&] { wall.add_stiffness_blocks(std::vector{-1}, 1, small); }},
      {"add_tangential_forces",
       [&] { add_tangential_forces(std::vector{30}, 1, Vec3::UnitZ(), Vec3::Zero(), 1, few, few_f); }},
  });
  EXPECT_THROW(add_tangential_forces(touching, 0, Vec3::UnitZ(), Vec3::Zero(), 1, x, f), InputError);

  const std::vector<double> times{0, 1, 3};
  for (const KeyPhase& bad : {phase_at(times, -1), KeyPhase{.key = 3}, KeyPhase{.key = 2, .fraction = 0.5}}) {
    EXPECT_TRUE(refuses<InputError>([&] { interpolate(bad, std::span(times)); }, {"interpolate: key ", "[0, 3)"}));
    EXPECT_TRUE(refuses<InputError>([&] { interpolate(bad, x.topRows(3)); }, {"interpolate: key ", "[0, 3)"}));
  }
  EXPECT_TRUE(refuses<InputError>([&] { slope(phase_at(times, 5), times, x); }, {"slope: key 2", "[0, 3)"}));
}

TEST_F(SizesOfCalls, OfWhatFollowsOrMeasuresAMesh) {
  const PointArray& X = kCalled.positions();
  const std::vector<Hexahedron>& hexahedra = kCalled.hexahedra();
  const Embedding embedding(X, hexahedra, X.topRows(5) * 0.5);
  const PlaneCut cut(X, hexahedra, Plane{.normal = Vec3::UnitZ(), .offset = 0.15});
  const std::vector<double> masses(hexahedra.size(), 2);
  const EndSections ends = end_sections(kCalled);
  PointArray five = PointArray::Zero(5, 3), points = PointArray::Zero(cut.num_points(), 3);
  const auto blocks = [](const PointArray& like) { return BlockMatrix(static_cast<int>(like.rows())); };
  expect_refusals({
      {"Embedding::apply", "nodes", kRows, [&](PointArray& wrong) { embedding.apply(wrong, five); }},
      {"Embedding::apply", "points", 5, [&](PointArray& wrong) { embedding.apply(x, wrong); }},
      {"Embedding::add_transposed", "points", 5, [&](PointArray& wrong) { embedding.add_transposed(wrong, f); }},
      {"Embedding::add_transposed", "nodes", kRows, [&](PointArray& wrong) { embedding.add_transposed(five, wrong); }},
      {"Embedding::add_transposed_blocks", "B", 5,
       [&](PointArray& wrong) {
         BlockMatrix A(kRows);
         embedding.add_transposed_blocks(blocks(wrong), A);
       }},
      {"Embedding::add_transposed_blocks", "A", kRows,
       [&](PointArray& wrong) {
         BlockMatrix A = blocks(wrong);
         embedding.add_transposed_blocks(BlockMatrix(5), A);
       }},
      {"PlaneCut::apply", "nodes", kRows, [&](PointArray& wrong) { cut.apply(wrong, points); }},
      {"PlaneCut::apply", "points", cut.num_points(), [&](PointArray& wrong) { cut.apply(x, wrong); }},
      {"nodal_masses", "masses", 12,
       [&](PointArray& wrong) { nodal_masses(kRows, hexahedra, std::vector<double>(wrong.rows(), 1)); }},
      {"add_gravity", "f", 3, [&](PointArray& wrong) { add_gravity(Eigen::Vector3d(1, 2, 3), Vec3::UnitZ(), wrong); }},
      {"kinetic_energy", "v", 3, [&](PointArray& wrong) { kinetic_energy(Eigen::Vector3d(1, 2, 3), wrong); }},
      {"axial_pull", "forces", kRows, [&](PointArray& wrong) { axial_pull(kCalled, ends, wrong); }},
      {"twist", "at", kRows, [&](PointArray& wrong) { twist(kCalled, ends, wrong); }},
      {"section_angle", "at", kRows, [&](PointArray& wrong) { section_angle(kCalled, ends.max, 2, wrong); }},
  });

  const PointArray few = X.topRows(20);
  const std::vector<Triangle> triangles{{0, 1, 20}};
  expect_refusal_of_missing_nodes({
      {"Embedding", [&] { Embedding(few, hexahedra, few); }},
      {"PlaneCut", [&] { PlaneCut(few, hexahedra, Plane{}); }},
      {"extent_along", [&] { extent_along(Vec3::UnitZ(), few, hexahedra); }},
      {"element_volumes", [&] { element_volumes(few, hexahedra); }},
      {"nodal_masses", [&] { nodal_masses(20, hexahedra, masses); }},
      {"elongation", [&] { elongation(ends, few); }},
      {"first_hit", [&] { first_hit(Ray{}, few, triangles); }},
      {"nearest_nodes", [&] { nearest_nodes(few, std::vector{20}, Vec3::Zero(), 1, 1); }},
      {"cells_inside", [&] { cells_inside<3>(few, triangles, Inside::kCentre, [](const Vec3&) { return true; }); }},
  });
  EXPECT_THROW(PlaneCut(X, hexahedra, Plane{}, std::vector<unsigned char>(3, 1)), InputError);
}

/// Positions and velocities side by side.
using BesideEachOther = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;
using WithGaps = decltype(std::declval<BesideEachOther&>().leftCols<3>());
static_assert(!std::is_constructible_v<Points, WithGaps>, "forces would be written elsewhere");
static_assert(!std::is_constructible_v<Points, Eigen::MatrixXd&>, "whose columns lie one behind the other");
static_assert(std::is_constructible_v<ConstPoints, WithGaps>);
static_assert(std::is_constructible_v<Points, decltype(std::declval<PointArray&>().bottomRows(2))>);

TEST(Views, OfPointsGiveTheirRowsWhateverLiesBetween) {
  const PointArray x = called_world();
  BesideEachOther state(kRows, 6);
  state << x, 2 * x;
  const Eigen::MatrixXd columns = x;
  const Eigen::Map<const PointArray, 0, Eigen::OuterStride<>> every_other(x.data(), kRows / 2, 3,
                                                                          Eigen::OuterStride<>(6));
  const auto rows = [](ConstPoints view) { return PointArray(view); };
  EXPECT_EQ(rows(state.leftCols<3>()), x);
  EXPECT_EQ(rows(state.rightCols<3>()), 2 * x);
  EXPECT_EQ(rows(columns), x);
  EXPECT_EQ(rows(2 * x), 2 * x);
  EXPECT_EQ(rows(every_other).row(5), x.row(10));
  Body with = called_body(), without = called_body();
  with.flow(state.leftCols<3>(), kStep);
  without.flow(x, kStep);
  EXPECT_EQ(hash_of(with), hash_of(without));
}

TEST(Views, OfPointsWithoutGapsAreNotCopied) {
  PointArray x = called_world();
  const auto place = [](ConstPoints view) { return view.data(); };
  const auto place_to_write = [](Points view) { return view.data(); };
  EXPECT_EQ(place(x), x.data());
  EXPECT_EQ(place(x.middleRows(3, 5)), x.data() + 9);
  EXPECT_EQ(place(Eigen::Map<const PointArray>(x.data(), kRows, 3)), x.data());
  EXPECT_EQ(place(Points(x)), x.data());
  EXPECT_EQ(place(ConstPoints(x).topRows(2)), x.data());
  EXPECT_EQ(place_to_write(Eigen::Map<PointArray>(x.data(), kRows, 3)), x.data());
  EXPECT_EQ(place_to_write(Points(x).bottomRows(2)), x.data() + 3 * (kRows - 2));
}

}  // namespace
}  // namespace hexaplast
