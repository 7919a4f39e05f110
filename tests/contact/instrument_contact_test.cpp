// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/instrument_contact.hpp"

#include <numeric>

#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/implicit_euler.hpp"
#include "support/archive.hpp"
#include "support/compare.hpp"
#include "support/random.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

// Two by two by one cubes of .1 m.
HexMesh block() { return regular_grid({2, 2, 1}, Vec3::Zero(), {0.2, 0.2, 0.1}); }

PointArray random_field(const HexMesh& mesh, unsigned seed, double size) {
  return Random(seed).field(mesh.num_nodes(), size);
}

TEST(SurfaceSamples, ShareTheSurfaceAmongThem) {
  const HexMesh mesh = block();
  for (const int parts : {1, 2, 3, 7}) {
    const SurfaceSamples found = SurfaceSamples::on(mesh, {}, 0.1 / parts, 64);
    EXPECT_NEAR(found.spacing, 0.1 / parts, 1e-15);
    // a grid of 2 parts x 2 parts x parts points, without those inside
    const int n = 2 * parts;
    EXPECT_EQ(found.samples.size(),
              static_cast<std::size_t>((n + 1) * (n + 1) * (parts + 1) - (n - 1) * (n - 1) * (parts - 1)));
    double area = 0;
    for (const SurfaceSamples::Sample& sample : found.samples) {
      area += sample.area;
      EXPECT_NEAR(std::accumulate(sample.weights.begin(), sample.weights.begin() + sample.num_nodes, 0.0), 1, 1e-14);
    }
    EXPECT_NEAR(area, 2 * (0.2 * 0.2 + 2 * 0.2 * 0.1), 1e-14);
  }
  EXPECT_EQ(SurfaceSamples::on(mesh, {}, 1e-9, 4).spacing, 0.025);
  // some 4e13 of them
  EXPECT_TRUE(refuses<InputError>([&] { SurfaceSamples::on(mesh, {}, 1e-9, 1'500'000); },
                                  {"contact at points of 16 faces, edges in 1500000 parts, needs about"}));
  EXPECT_TRUE(refuses<InputError>(
      [&] {
        SurfaceSamples::on_embedded(mesh, {}, mesh.positions(), {{0, 1, 3}}, 1e-9, 9'000'000);
      },
      {"contact at points of 1 faces, edges in 9000000 parts, needs about"}));
  EXPECT_THROW(SurfaceSamples::on(mesh, {}, 0, 4), InputError);
  EXPECT_THROW(SurfaceSamples::on(mesh, {}, 0.1, 0), InputError);
}

TEST(SurfaceSamples, OfAnEmbeddedSurface) {
  const HexMesh mesh = block();
  PointArray surface(4, 3);
  surface << 0.03, 0.02, 0.08, 0.17, 0.02, 0.08, 0.17, 0.16, 0.06, 0.03, 0.16, 0.06;
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  const double area = 0.14 * std::hypot(0.14, 0.02);
  for (const int parts : {1, 3, 8}) {
    const SurfaceSamples found = SurfaceSamples::on_embedded(mesh, {}, surface, triangles, 1e-9, parts);
    EXPECT_EQ(found.samples.size(), static_cast<std::size_t>((parts + 1) * (parts + 1)));
    double sum = 0;
    for (const SurfaceSamples::Sample& sample : found.samples) {
      sum += sample.area;
      const Vec3 p = sample.at(mesh.positions());
      EXPECT_NEAR(p.z(), 0.08 - 0.02 * (p.y() - 0.02) / 0.14, 1e-13);
    }
    EXPECT_NEAR(sum, area, 1e-13);
  }
  std::vector<unsigned char> alive(4, 1);
  alive[0] = 0;  // [0, .1] x [0, .1], in which both triangles begin
  EXPECT_TRUE(SurfaceSamples::on_embedded(mesh, alive, surface, triangles, 1, 1).samples.empty());
  EXPECT_THROW(SurfaceSamples::on_embedded(mesh, {}, surface, {{0, 1, 4}}, 1, 1), InputError);
}

// An even pressure on samples of flat faces is a quarter of each face's on its nodes, however many samples there are.
TEST(SurfaceSamples, CarryPressureAsFacesDo) {
  const HexMesh mesh = block();
  const auto fraction = [](double at) { return at < 1e-9 || at > 0.2 - 1e-9 ? 0.5 : 1.0; };
  const auto is_on_top = [](const Vec3& p) { return p.z() > 0.0999; };
  PointArray expected = PointArray::Zero(mesh.num_nodes(), 3), by_samples = expected;
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    const Vec3 p = mesh.positions().row(n).transpose();
    if (is_on_top(p)) expected(n, 2) = 7 * 0.01 * fraction(p.x()) * fraction(p.y());
  }
  for (const SurfaceSamples::Sample& sample : SurfaceSamples::on(mesh, {}, 0.025, 64).samples) {
    const Vec3 p = sample.at(mesh.positions());
    // those on the rim have area of the sides too
    if (is_on_top(p)) sample.add({0, 0, 7 * 0.025 * 0.025 * fraction(p.x()) * fraction(p.y())}, by_samples);
  }
  EXPECT_TRUE(agrees(by_samples, expected, 1e-12));
}

TEST(SurfaceSamples, PointOutwards) {
  const HexMesh mesh = block();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const PointArray x = mesh.positions() * turn.transpose();
  const SurfaceSamples found = SurfaceSamples::on(mesh, {}, 0.025, 64);
  for (int i = 0; i < static_cast<int>(found.samples.size()); ++i) {
    Vec3 expected = Vec3::Zero();  // all faces are as large
    const Vec3 p = found.samples[i].at(mesh.positions()), size(0.2, 0.2, 0.1);
    for (int axis = 0; axis < 3; ++axis) {
      const double at = p[axis] / size[axis];
      expected[axis] = at < 1e-9 ? -1 : at > 1 - 1e-9 ? 1 : 0;
    }
    ASSERT_TRUE(agrees(found.outwards(i, x), Vec3(turn * expected.normalized()), 1e-12)) << p.transpose();
  }

  PointArray sheet(4, 3);
  sheet << 0.03, 0.02, 0.08, 0.17, 0.02, 0.08, 0.17, 0.16, 0.06, 0.03, 0.16, 0.06;
  const SurfaceSamples embedded = SurfaceSamples::on_embedded(mesh, {}, sheet, {{0, 1, 2}, {0, 2, 3}}, 1e-9, 3);
  for (int i = 0; i < 16; ++i)
    ASSERT_TRUE(agrees(embedded.outwards(i, x), Vec3(turn * Vec3(0, 0.02, 0.14).normalized()), 1e-12)) << i;
}

struct Pressed {
  HexMesh mesh = block();
  PointArray x = mesh.positions(), v = PointArray::Zero(mesh.num_nodes(), 3);
  InstrumentContact contact{Solid::sphere(0.05),
                            {.stiffness = 1e5, .tangential_stiffness = 5e4, .friction = 0.3, .damping = 100},
                            SurfaceSamples::on(mesh, {}, 0.02, 64)};
  Pose before{.position = {0.1, 0.1, 0.16}}, after{.position = {0.11, 0.1, 0.13}};

  Pressed() { contact.begin_step(x, v, 0.01, before, after); }
};

TEST(InstrumentContact, ActsOnBothAlike) {
  Pressed pressed;
  const PointArray x = pressed.x + random_field(pressed.mesh, 2, 1e-3), v = (x - pressed.x) / 0.01;
  PointArray f = PointArray::Zero(x.rows(), 3);
  while (pressed.contact.release(x, v)) {
  }
  pressed.contact.terms().add_force(x, v, f);
  PointArray moved = x;
  moved.col(2).array() -= 0.01;
  pressed.contact.end_step(moved);
  const Vec3 force = pressed.contact.force() + f.colwise().sum().transpose(),
             moment = pressed.contact.torque() + support::moment(x.rowwise() - pressed.after.position.transpose(), f);
  const double size = f.rowwise().norm().sum();
  EXPECT_GT(size, 0.1);
  EXPECT_LT(force.norm(), 1e-13 * size);
  EXPECT_LT(moment.norm(), 1e-13 * size);
}

// A chain of nodes that lies in contact and is lifted at one end: what is released leaves its load to the next contact.
class Peeling final : public MechanicalSystem {
 public:
  static constexpr int kNodes = 20;
  static constexpr double kMass = 1e-3, kWeight = 1, kLift = 10.5, kBetween = 100, kContact = 1e5;

  Peeling() {
    for (int n = 0; n < kNodes; ++n) {
      ContactTerm& term = contact.terms.emplace_back();
      term.add_node(n, 1);
      term.num_first = 1;
      term.stiffness = kContact;
    }
  }
  int num_nodes() const override { return kNodes; }
  void compute_force(double, ConstPoints x, ConstPoints v, Points f) override {
    f.setZero();
    f.col(2).array() -= kWeight;
    f(kNodes - 1, 2) += kLift;
    add_between(1, x, f);
    contact.add_force(x, v, f);
  }
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override {
    df += factors.mass * kMass * dx;
    add_between(factors.stiffness, dx, df);
    contact.add_stiffness_product(factors.stiffness, dx, df);
  }
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override {
    const Mat3 K = factors.stiffness * kBetween * Mat3::Identity();
    for (int n = 0; n < kNodes; ++n) A.add(n, n, factors.mass * kMass * Mat3::Identity());
    for (int n = 1; n < kNodes; ++n)
      for (const int a : {n - 1, n})
        for (const int b : {n - 1, n}) A.add(a, b, a == b ? Mat3(-K) : K);
    contact.add_stiffness_blocks(factors.stiffness, A);
  }
  bool release(double, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end, Points force,
               Points product) override {
    const auto add = [&](double sign) {
      PointArray change = PointArray::Zero(kNodes, 3);
      contact.add_force(x, v, change);
      force += sign * change;
      contact.add_stiffness_product(sign, v, product);
    };
    ++num_tries;
    add(-1);
    const bool has_released = contact.release(x_end, v_end);
    add(1);
    return has_released;
  }

  ContactTerms contact;
  int num_tries = 0;

 private:
  static void add_between(double factor, ConstPoints x, Points f) {
    for (int n = 1; n < kNodes; ++n) {
      const Eigen::RowVector3d pull = factor * kBetween * (x.row(n) - x.row(n - 1));
      f.row(n - 1) += pull;
      f.row(n) -= pull;
    }
  }
};

// However often that has to be done: about ten nodes are lifted by ten times their weight, one after the other.
TEST(ContactTerms, NothingPullsAfterAStep) {
  Peeling chain;
  CholeskySolver solver;
  PointArray x = PointArray::Zero(Peeling::kNodes, 3), v = x;
  x.col(2).array() -= Peeling::kWeight / Peeling::kContact;
  ImplicitEuler({}).step(chain, solver, 0, 1, x, v);
  EXPECT_GT(chain.num_tries, 5);
  std::vector<bool> touches(Peeling::kNodes);
  for (const ContactTerm& term : chain.contact.terms) {
    EXPECT_GT(term.normal_force(term.at(x), term.at(v)), 0) << "node " << term.nodes[0];
    touches[term.nodes[0]] = true;
  }
  for (int n = 0; n < Peeling::kNodes; ++n) EXPECT_EQ(x(n, 2) < 0, touches[n]) << "node " << n;
  EXPECT_NEAR(static_cast<double>(chain.contact.terms.size()), Peeling::kNodes - 10, 1);
}

TEST(ContactTerms, ReleasesAreNoCorrectionsOfFriction) {
  constexpr int kCount = 10, kPulling = 5;
  ContactTerms contact;
  for (int n = 0; n < kCount; ++n) {
    contact.terms.push_back({.stiffness = 1e3, .stick = 1e5, .friction = 0.5});
    contact.terms.back().add_node(n, 1);
  }
  PointArray x = PointArray::Zero(kCount, 3);
  const PointArray v = x;
  x.col(0).setConstant(1);  // slips
  x.col(2).setConstant(-1e-3);
  contact.begin_step({x, x}, {x, x}, 0.01);
  for (int n = 0; n < kPulling; ++n) {
    x(n, 2) = 1e-3;
    EXPECT_TRUE(contact.release({x, x}, {v, v}));
  }
  ASSERT_EQ(contact.terms.size(), std::size_t{kCount - kPulling});
  x.col(2) *= 3;
  EXPECT_TRUE(contact.release({x, x}, {v, v}));
  for (const ContactTerm& term : contact.terms) EXPECT_NEAR(term.limit, 0.5 * 3, 1e-12);
  EXPECT_FALSE(contact.release({x, x}, {v, v}));
}

/// A solid that goes into a body from one pose to the next, and what acts on the body then, which keeps its shape.
struct Into {
  HexMesh mesh;
  Solid solid;
  double spacing;
  InstrumentContact contact{solid, {.stiffness = 1e5}, SurfaceSamples::on(mesh, {}, spacing, 64)};
  Pose pose = {};

  Vec3 force_at(const Pose& to) {
    const PointArray v = PointArray::Zero(mesh.num_nodes(), 3);
    contact.begin_step(mesh.positions(), v, 0.01, pose, to);
    PointArray f = v;
    contact.terms().add_force(mesh.positions(), v, f);
    contact.end_step(mesh.positions());
    pose = to;
    return f.colwise().sum().transpose();
  }
};

// A box that is pressed straight down, 4.5 mm in a step: points .5 and 1 mm from its sides are nearest to these.
TEST(InstrumentContact, NewContactsKeepTheSideTheyCameThrough) {
  Into box{.mesh = regular_grid({8, 8, 3}, {-0.04, -0.04, 0}, {0.04, 0.04, 0.03}),
           .solid = Solid::box({0.02, 0.02, 0.02}),
           .spacing = 0.005,
           .pose = {.position = {0.001, 0.0005, 0.0405}}};
  const Pose pressed{.position = {0.001, 0.0005, 0.0355}};
  const Vec3 first = box.force_at(pressed);
  EXPECT_NEAR(first.z(), -1e5 * 16 * 25e-6 * 0.0045, 1e-9) << "4 x 4 samples";
  EXPECT_LT(first.head<2>().norm(), 1e-9 * first.norm());
  EXPECT_LT((box.force_at(pressed) - first).norm(), 1e-9 * first.norm()) << "nor do they turn in the next step";
}

// A plate of 1 mm, deeper than half of that: its far side is nearer then.
TEST(InstrumentContact, WhatTouchesKeepsItsSide) {
  const HexMesh mesh = regular_grid({4, 4, 3}, {-0.02, -0.02, 0}, {0.02, 0.02, 0.03});
  const Solid plate = Solid::box({0.1, 0.1, 0.001});
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.2, Vec3::UnitZ()));
  const auto at = [&](double depth) { return Pose{.position = {0, 0, 0.0305 - depth}, .orientation = turn}; };
  Into pressed{.mesh = mesh, .solid = plate, .spacing = 0.0025, .pose = at(-0.0001)};
  for (const double depth : {0.0001, 0.0003, 0.00055, 0.0008, 0.00095}) {
    const Vec3 force = pressed.force_at(at(depth));
    // of the rim the upper part of the sides too
    EXPECT_NEAR(force.z(), -1e5 * (0.04 * 0.04 + 4 * 0.04 * 0.00125) * depth, 1e-9) << depth;
    EXPECT_NEAR(pressed.contact.depth(), depth, 1e-12);
  }
  // the side is part of the state
  Into other{.mesh = mesh, .solid = plate, .spacing = 0.0025, .pose = pressed.pose};
  read_from(written(pressed.contact), other.contact);
  EXPECT_EQ(other.force_at(at(0.0009)), pressed.force_at(at(0.0009)));
}

// A ball that is thin as a hair and moves by hundreds of its radii in a step.
TEST(InstrumentContact, NothingIsMissedHoweverThinAndFast) {
  const HexMesh mesh = block();
  const PointArray x = mesh.positions(), v = PointArray::Zero(mesh.num_nodes(), 3);
  const double r = 1e-4;
  InstrumentContact contact(Solid::sphere(r), {.stiffness = 1e5}, SurfaceSamples::on(mesh, {}, 0.02, 64));
  Random random(4);
  int aimed = 0;
  for (const SurfaceSamples::Sample& sample : contact.samples().samples) {
    const Vec3 p = sample.at(x), off(random.uniform(-r, r) / 2, random.uniform(-r, r) / 2, random.uniform(0.01, 0.03));
    if (p.z() < 0.0999 || std::min(p.x(), p.y()) < 0.01 || std::max(p.x(), p.y()) > 0.19) continue;
    ++aimed;
    contact.begin_step(x, v, 0.01, {.position = p + off}, {.position = p + off - Vec3(0, 0, 0.05)});
    ASSERT_EQ(contact.num_touching(), 1) << p.transpose();
    EXPECT_LT(contact.terms().terms[0].normal.z(), 0) << "from above, where it comes from";
  }
  EXPECT_GT(aimed, 50);

  // what slides along a surface is looked at all the way, which has an end
  InstrumentContact sheet(Solid::box({1, 1, 1e-7}), {.stiffness = 1e5}, SurfaceSamples::on(mesh, {}, 0.1, 4));
  const Vec3 above(0.1, 0.1, 0.1 + 1e-6);
  EXPECT_NO_THROW(sheet.begin_step(x, v, 0.01, {.position = above}, {.position = above + Vec3(1e-6, 0, 0)}));
  EXPECT_THROW(sheet.begin_step(x, v, 0.01, {.position = above}, {.position = above + Vec3(0.05, 0, 0)}),
               NumericalError);
}

// Boxes only leave out what cannot touch: poses that turn and go through each other at random, against samples looked
// at all the way.
TEST(InstrumentContact, SamplesAreLookedAtWhereTheBodyIsNear) {
  const HexMesh mesh = block();
  const Solid solid = Solid::box({0.05, 0.02, 0.3});
  InstrumentContact contact(solid, {.stiffness = 1e5, .distance = 0.01}, SurfaceSamples::on(mesh, {}, 0.05, 64));
  const auto num_samples = static_cast<int>(contact.samples().samples.size());
  Random random(5);
  int left_out = 0;
  for (int k = 0; k < 300; ++k) {
    const auto pose = [&](double size) {
      const Eigen::AngleAxisd turn(random.uniform(-0.4, 0.4), random.vector(1).normalized());
      return Pose{.position = Vec3(0.1, 0.1, 0.05) + random.vector(size), .orientation = Eigen::Quaterniond(turn)};
    };
    const Pose begin = pose(1), end = pose(1);
    const PointArray v = random_field(mesh, 6 + k, 5);
    contact.begin_step(mesh.positions(), v, 0.01, begin, end);
    EXPECT_TRUE(contact.num_examined() == num_samples || contact.num_examined() == 0);
    if (contact.num_examined() > 0) continue;
    ++left_out;
    for (const SurfaceSamples::Sample& sample : contact.samples().samples) {
      const Vec3 p = sample.at(mesh.positions()), from = begin.to_own(p), to = end.to_own(p + 0.01 * sample.at(v));
      for (int check = 0; check <= 50; ++check)
        ASSERT_GT(solid.distance(from + check / 50.0 * (to - from)).value, 0.01) << k;
    }
  }
  EXPECT_GT(left_out, 30);
  EXPECT_LT(left_out, 270);

  InstrumentContact inactive(solid, {.stiffness = 1e5, .is_active = false}, SurfaceSamples::on(mesh, {}, 0.05, 64));
  inactive.begin_step(mesh.positions(), PointArray::Zero(mesh.num_nodes(), 3), 0.01, {}, {});
  EXPECT_EQ(inactive.num_examined(), 0);
}

/// A plate over the whole top of a block, .001 m deep. Nodes of the rim carry the area of the sides' upper halves too.
struct Plate {
  static constexpr double k = 1e4, mu = 0.5, kStep = 0.01, N = k * 0.001 * (0.2 * 0.2 + 4 * 0.2 * 0.1 / 2);
  HexMesh mesh = block();
  PointArray x = mesh.positions(), v = PointArray::Zero(mesh.num_nodes(), 3);
  InstrumentContact contact{Solid::box({1, 1, 0.1}),
                            {.stiffness = k, .tangential_stiffness = k, .friction = mu},
                            SurfaceSamples::on(mesh, {}, 0.1, 1)};

  void begin_step(double from, double to) {
    const auto shifted = [](double by) { return Pose{.position = {0.1 + by, 0.1, 0.149}}; };
    contact.begin_step(x, v, kStep, shifted(from), shifted(to));
  }
  Vec3 force_after(double from, double to) {
    begin_step(from, to);
    contact.end_step(x);
    return contact.force();
  }
};

TEST(InstrumentContact, SticksAndSlips) {
  Plate plate;
  const double N = Plate::N, mu = Plate::mu;
  EXPECT_NEAR(plate.force_after(0, 0).z(), N, 1e-12);
  EXPECT_NEAR(plate.force_after(0, 0).x(), 0, 1e-12);
  EXPECT_NEAR(plate.force_after(0, 0.0002).x(), -N * 0.2, 1e-12) << "k_t A u = N u / .001";
  EXPECT_EQ(plate.contact.num_slipping(), 0);
  EXPECT_NEAR(plate.force_after(0.0002, 0.002).x(), -mu * N, 1e-12);
  EXPECT_GT(plate.contact.num_slipping(), 0);
  // back by less than twice what it holds: it sticks, from where it slipped to
  EXPECT_NEAR(plate.force_after(0.002, 0.0018).x(), -(mu - 0.2) * N, 1e-12);
  EXPECT_NEAR(plate.force_after(0.0018, 0).x(), mu * N, 1e-12);
  plate.contact.reset();
  EXPECT_NEAR(plate.force_after(0, 0).x(), 0, 1e-12);
}

// What begins to slip has moved farther at the end of the step than was expected: it still feels mu N, not more.
TEST(InstrumentContact, WhatBeginsToSlipFeelsNoMoreThanFriction) {
  Plate plate;
  const double N = Plate::N, mu = Plate::mu;
  plate.force_after(0, 0);
  plate.v.col(0).setConstant(0.06);  // just beyond what sticks, .0005 m
  plate.begin_step(0, 0);
  const auto moved = [&](double shift, double rise) {
    return PointArray(plate.x.rowwise() + Eigen::RowVector3d(shift, 0, rise));
  };
  const auto force_at = [&](double shift, double rise = 0) {
    PointArray f = PointArray::Zero(plate.x.rows(), 3);
    plate.contact.terms().add_force(moved(shift, rise), plate.v, f);
    return Vec3(f.colwise().sum());
  };
  const auto corrects_at = [&](double shift, double rise = 0) {
    return plate.contact.release(moved(shift, rise), plate.v);
  };
  EXPECT_NEAR(force_at(0.003).x(), -mu * N, 1e-9);
  EXPECT_NEAR(force_at(0.004).x(), -mu * N, 1e-9);
  EXPECT_FALSE(corrects_at(0.004));
  EXPECT_TRUE(corrects_at(0.004, 0.0005)) << "pressed by half more than in the step before";
  EXPECT_NEAR(force_at(0.004, 0.0005).x(), -1.5 * mu * N, 1e-9);
  EXPECT_TRUE(corrects_at(-0.0001)) << "it turns back";
  EXPECT_NEAR(force_at(-0.0001).x(), 0.1 * N, 1e-9) << "the spring";
  EXPECT_EQ(plate.contact.num_slipping(), 0);
}

// So does TissueContact.
TEST(InstrumentContact, RefusesWhatCannotBe) {
  const SurfaceSamples samples = SurfaceSamples::on(block(), {}, 0.1, 1);
  const Solid ball = Solid::sphere(1);
  EXPECT_THROW(InstrumentContact(ball, {.stiffness = 0}, samples), InputError);
  EXPECT_THROW(InstrumentContact(ball, {.stiffness = 1, .tangential_stiffness = -1}, samples), InputError);
  EXPECT_THROW(InstrumentContact(ball, {.stiffness = 1, .friction = -0.1}, samples), InputError);
  EXPECT_THROW(InstrumentContact(ball, {.stiffness = 1, .distance = -1}, samples), InputError);
  EXPECT_THROW(InstrumentContact(ball, {.stiffness = 1, .damping = std::nan("")}, samples), InputError);
}

}  // namespace
