// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/tissue_contact.hpp"

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/contact/surface_samples.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "support/archive.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

constexpr ContactSettings kSettings = {.stiffness = 1e5, .tangential_stiffness = 5e4, .friction = 0.3, .damping = 100};

PointArray random_field(int rows, unsigned seed, double size) { return Random(seed).field(rows, size); }

/// On the nodes of both bodies.
struct Forces {
  PointArray on_below, on_above;
};
Forces forces(const TissueContact& contact, const PointArray& x0, const PointArray& x1, const PointArray& v0,
              const PointArray& v1) {
  Forces f{PointArray::Zero(x0.rows(), 3), PointArray::Zero(x1.rows(), 3)};
  contact.terms().add_force({x0, x1}, {v0, v1}, {Points(f.on_below), Points(f.on_above)});
  return f;
}

/// On the nodes of `above`, of bodies that rest at x0 and x1.
PointArray forces_at_rest(const HexMesh& below, const HexMesh& above, const PointArray& x0, const PointArray& x1) {
  const PointArray v0 = PointArray::Zero(x0.rows(), 3), v1 = PointArray::Zero(x1.rows(), 3);
  TissueContact contact(below, above, {.stiffness = 1e5}, 8);
  contact.begin_step({x0, x1}, {v0, v1}, 0.01);
  return forces(contact, x0, x1, v0, v1).on_above;
}

// A block of .2 x .2 x .1 m and one of .1 x .1 x .1 m on it, askew, which falls into it by less than 8 mm.
struct Stacked {
  HexMesh below = regular_grid({4, 4, 2}, Vec3::Zero(), {0.2, 0.2, 0.1});
  HexMesh above = regular_grid({3, 3, 3}, {0.04, 0.06, 0.1}, {0.14, 0.16, 0.2});
  PointArray x0 = below.positions() + random_field(below.num_nodes(), 1, 2e-3),
             x1 = above.positions() + random_field(above.num_nodes(), 2, 2e-3),
             v0 = random_field(below.num_nodes(), 3, 0.1), v1 = random_field(above.num_nodes(), 4, 0.1);
  TissueContact contact{below, above, kSettings, 8};

  Stacked() {
    v1.col(2).array() -= 0.5;
    contact.begin_step({x0, x1}, {v0, v1}, 0.01);
  }
  PointArray end0() const { return x0 + 0.01 * v0; }
  PointArray end1() const { return x1 + 0.01 * v1; }
};

TEST(TissueContact, ForcesBalance) {
  Stacked stacked;
  EXPECT_GT(stacked.contact.num_touching(), 50);
  // sideways in the next step
  stacked.contact.end_step({stacked.end0(), stacked.end1()});
  stacked.x0 = stacked.end0();
  stacked.x1 = stacked.end1();
  stacked.v1.rowwise() = Eigen::RowVector3d(0.5, 0, 0);
  stacked.contact.begin_step({stacked.x0, stacked.x1}, {stacked.v0, stacked.v1}, 0.01);
  EXPECT_GT(stacked.contact.num_slipping(), 20);
  const PointArray e0 = stacked.end0(), e1 = stacked.end1();
  const auto [f0, f1] = forces(stacked.contact, e0, e1, stacked.v0, stacked.v1);
  const Vec3 force = (f0.colwise().sum() + f1.colwise().sum()).transpose(),
             moment = support::moment(e0, f0) + support::moment(e1, f1);
  const double all = f0.rowwise().norm().sum() + f1.rowwise().norm().sum();
  EXPECT_GT(all, 1);
  EXPECT_LT(f0.col(2).sum(), -0.2 * all);  // pressed down
  EXPECT_LT(force.norm(), 1e-12 * all);
  EXPECT_LT(moment.norm(), 1e-11 * all);  // arms are shorter than 0.3 m

  // reported is the force that acted where the step was solved, wherever its end was moved then
  while (stacked.contact.release({e0, e1}, {stacked.v0, stacked.v1})) {
  }
  const PointArray acted = forces(stacked.contact, e0, e1, stacked.v0, stacked.v1).on_below;
  stacked.contact.end_step({e0.array() - 0.01, e1});
  EXPECT_LT((stacked.contact.force() - Vec3(acted.colwise().sum().transpose())).norm(), 1e-10 * acted.norm());
}

// Within a step forces are linear: K and B are their derivatives, by products and by blocks.
TEST(TissueContact, StiffnessAndDampingAreDerivatives) {
  Stacked stacked;
  const ContactTerms& terms = stacked.contact.terms();
  const int n0 = stacked.below.num_nodes(), n1 = stacked.above.num_nodes();
  const PointArray d = random_field(n0 + n1, 5, 1e-3);
  const auto top = [&](const PointArray& field) { return ConstPoints(field.topRows(n0)); };
  const auto bottom = [&](const PointArray& field) { return ConstPoints(field.bottomRows(n1)); };
  const auto force = [&](double dx, double dv) {
    PointArray x0 = stacked.x0 + dx * top(d), x1 = stacked.x1 + dx * bottom(d), v0 = stacked.v0 + dv * top(d),
               v1 = stacked.v1 + dv * bottom(d), f = PointArray::Zero(n0 + n1, 3);
    terms.add_force({x0, x1}, {v0, v1}, {Points(f.topRows(n0)), Points(f.bottomRows(n1))});
    return f;
  };
  PointArray K = PointArray::Zero(n0 + n1, 3), B = K;
  terms.add_stiffness_product(2, {top(d), bottom(d)}, {Points(K.topRows(n0)), Points(K.bottomRows(n1))});
  terms.add_damping_product(2, {top(d), bottom(d)}, {Points(B.topRows(n0)), Points(B.bottomRows(n1))});
  EXPECT_TRUE(agrees(K, 2 * (force(1, 0) - force(0, 0)), 1e-8));
  EXPECT_TRUE(agrees(B, 2 * (force(0, 1) - force(0, 0)), 1e-8));
  BlockMatrix K_blocks(n0 + n1), B_blocks(n0 + n1);
  terms.add_stiffness_blocks(2, K_blocks, {0, n0});
  terms.add_damping_blocks(2, B_blocks, {0, n0});
  EXPECT_TRUE(agrees(times(K_blocks, d), K, 1e-12));
  EXPECT_TRUE(agrees(times(B_blocks, d), B, 1e-12));
}

// Straight blocks that overlap by a depth: half of the pressure from the samples of either side, each on its own area.
TEST(TissueContact, PressureIsStiffnessTimesDepth) {
  const HexMesh below = regular_grid({4, 4, 2}, Vec3::Zero(), {0.2, 0.2, 0.1});
  const HexMesh above = regular_grid({3, 3, 4}, {0.03, 0.04, 0.1}, {0.18, 0.19, 0.3});
  const double depth = 1e-3;
  PointArray x1 = above.positions();
  x1.col(2).array() -= depth;
  double expected = 0;
  const auto add_from = [&](const HexMesh& mesh, double level) {
    for (const SurfaceSamples::Sample& sample : SurfaceSamples::on(mesh, {}, 0.025, 8).samples) {
      const Vec3 p = sample.at(mesh.positions());
      if (std::abs(p.z() - level) < 1e-9 && p.x() > 0.03 - 1e-9 && p.x() < 0.18 + 1e-9 && p.y() > 0.04 - 1e-9 &&
          p.y() < 0.19 + 1e-9)
        expected += 0.5 * 1e5 * depth * sample.area;
    }
  };
  add_from(above, 0.1);
  add_from(below, 0.1);
  const PointArray f1 = forces_at_rest(below, above, below.positions(), x1);
  EXPECT_NEAR(f1.col(2).sum(), expected, 1e-9 * expected);
  EXPECT_NEAR(f1.col(2).sum(), 1e5 * depth * 0.15 * 0.15, 0.3 * expected);  // of the sides' rims too
  EXPECT_LT(f1.leftCols<2>().norm(), 1e-9 * expected);
}

// A block that is sheared by .5: normals are those of the present faces.
TEST(TissueContact, NormalsArePresentOnes) {
  const HexMesh below = regular_grid({4, 4, 4}, Vec3::Zero(), {0.2, 0.2, 0.2});
  const HexMesh above = regular_grid({2, 2, 2}, {0.05, 0.05, 0.2}, {0.15, 0.15, 0.3});
  PointArray x0 = below.positions(), x1 = above.positions();
  x0.col(2) += 0.5 * below.positions().col(0);  // the top is steep
  x1.col(2) += 0.5 * above.positions().col(0);
  x1.col(2).array() -= 5e-3;
  const PointArray f1 = forces_at_rest(below, above, x0, x1);
  const Vec3 force = f1.colwise().sum().transpose(), normal = Vec3(-0.5, 0, 1).normalized();
  EXPECT_GT(force.dot(normal), 1);
  EXPECT_LT((force - force.dot(normal) * normal).norm(), 0.01 * force.dot(normal));
}

// Of contacts with 1 N and 3 N in the step before, and a new one.
TEST(TissueContact, FrictionGrowsAsTheBodiesPress) {
  const auto limits = [](double depth) {
    ContactTerms contact;
    for (const double before : {1.0, 3.0, 0.0})
      contact.terms.push_back({.stiffness = 1e3, .stick = 1e5, .friction = 0.5, .normal_before = before});
    for (int i = 0; i < 3; ++i) contact.terms[i].add_node(i, 1);
    PointArray expected = PointArray::Zero(3, 3);
    expected.col(2) << -depth, -depth, -depth;
    expected.col(0).array() = 1;  // slips
    contact.begin_step({expected, expected}, {expected, expected}, 0.01);
    return Vec3(contact.terms[0].limit, contact.terms[1].limit, contact.terms[2].limit);
  };
  EXPECT_TRUE(agrees(limits(2.6e-3), Vec3(0.65, 1.95, 1.3), 1e-12)) << "5.2 N are expected in place of 4 N";
  EXPECT_TRUE(agrees(limits(1.4e-3), Vec3(0.35, 1.05, 0.7), 1e-12));
  EXPECT_TRUE(agrees(limits(2.08e-3), Vec3(0.5, 1.5, 1.04), 1e-12)) << "a change of 4 % is none";
  EXPECT_TRUE(agrees(limits(9e-3), Vec3(1, 3, 4.5), 1e-12)) << "twice as much at most";
  EXPECT_TRUE(agrees(limits(-1e-3), Vec3(0.25, 0.75, 0), 1e-12)) << "half of it at least";
}

/// A block that falls on another body, both turned. What acts on it, in the directions of those that are not turned.
struct Falling {
  HexMesh below, above;
  Mat3 turn;
  TissueContact contact{below, above, {.stiffness = 1e5}, 8};
  PointArray x0 = below.positions() * turn.transpose(), x1 = above.positions() * turn.transpose();

  Vec3 force_after(double down) {
    const PointArray v0 = PointArray::Zero(x0.rows(), 3);
    PointArray v1 = PointArray::Zero(x1.rows(), 3);
    v1.rowwise() = Vec3(turn * Vec3(0, 0, -down / 0.01)).transpose();
    contact.begin_step({x0, x1}, {v0, v1}, 0.01);
    x1 += 0.01 * v1;
    const PointArray f = forces(contact, x0, x1, v0, v1).on_above;
    contact.end_step({x0, x1});
    return turn.transpose() * f.colwise().sum().transpose();
  }
};

const std::array<Mat3, 2> kTurns = {Mat3::Identity(),
                                    Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix()};

// A block of 2 cm that comes 1.46 mm deep in a step: samples of the other body 1 mm from its sides are nearest to
// these.
TEST(TissueContact, NewContactsKeepTheSideTheyCameThrough) {
  for (const Mat3& turn : kTurns) {
    Falling block{.below = regular_grid({4, 4, 2}, {-0.04, -0.04, 0}, {0.04, 0.04, 0.03}),
                  .above = regular_grid({2, 2, 2}, {-0.011, -0.012, 0.0305}, {0.009, 0.008, 0.0505}),
                  .turn = turn};
    const Vec3 first = block.force_after(0.00196);
    EXPECT_GT(first.z(), 1e5 * 0.00146 * 0.02 * 0.02);
    EXPECT_LT(first.head<2>().norm(), 1e-9 * first.norm());
    const Vec3 second = block.force_after(0);
    EXPECT_LT((second - first).norm(), 1e-9 * first.norm()) << "nor do they turn in the next step";
  }
}

// A block on a sheet of 1 mm with cells of 5 mm: through more than half of it in a step, and then out on the other
// side.
TEST(TissueContact, ThinBodiesAreNotPierced) {
  for (const Mat3& turn : kTurns) {
    Falling block{.below = regular_grid({8, 8, 1}, {-0.02, -0.02, 0}, {0.02, 0.02, 0.001}),
                  .above = regular_grid({2, 2, 2}, {-0.0087, -0.0092, 0.0012}, {0.0113, 0.0108, 0.0212}),
                  .turn = turn};
    double depth = -0.0002;
    for (const double down : {0.001, 0.0, 0.0005, 0.0002}) {
      depth += down;
      const Vec3 force = block.force_after(down);
      EXPECT_GT(force.z(), 1e5 * depth * 0.02 * 0.02) << depth;
      EXPECT_LT(force.z(), 1.7e5 * depth * 0.02 * 0.02) << "of the rims too, " << depth;
      EXPECT_LT(force.head<2>().norm(), 1e-9 * force.norm());
    }
  }
}

TEST(TissueContact, NodesWithoutHexahedraDoNotCount) {
  std::vector<unsigned char> alive(32, 1);
  alive[19] = 0;  // at the corner (.2, 0, .1)
  constexpr int kLoose = 54;
  const auto begun = [&](double speed) {
    Stacked stacked;
    stacked.contact.set_alive(alive, {});
    stacked.v0.row(kLoose) = Eigen::RowVector3d(0, 0, -speed);
    stacked.x0.row(kLoose) = Eigen::RowVector3d(0, 0, -speed);
    stacked.contact.begin_step({stacked.x0, stacked.x1}, {stacked.v0, stacked.v1}, 0.01);
    return std::pair(stacked.contact.num_examined(), stacked.contact.num_touching());
  };
  const auto still = begun(0);
  EXPECT_GT(still.second, 20);
  EXPECT_EQ(begun(1e4), still);
}

// A block on a ridge: points of its middle are as near to one side of it as to the other.
TEST(TissueContact, RoundingDoesNotDecideWhichFaceIsTouched) {
  const HexMesh below = regular_grid({2, 2, 1}, Vec3::Zero(), {0.2, 0.2, 0.1});
  const HexMesh above = regular_grid({2, 2, 2}, {0.04, 0.05, 0.1}, {0.16, 0.15, 0.2});
  PointArray x0 = below.positions();
  for (Eigen::Index n = 0; n < x0.rows(); ++n)
    if (std::abs(x0(n, 0) - 0.1) < 1e-9 && x0(n, 2) > 0.09) x0(n, 2) += 5e-3;
  PointArray first;
  for (const double shift : {0.0, 1e-15, -1e-15, 3e-15, -3e-15}) {
    PointArray x1 = above.positions();
    x1.col(0).array() += shift;
    x1.col(2).array() += 3e-3;
    const PointArray f1 = forces_at_rest(below, above, x0, x1);
    if (first.size() == 0) first = f1;
    EXPECT_GT(f1.col(2).sum(), 0.1);
    EXPECT_TRUE(agrees(f1, first, 1e-9)) << shift;
  }
}

// A strip that is bent until its ends lie on one another touches itself; as it was made it does not.
TEST(TissueContact, OfOneBodyWithItself) {
  const HexMesh strip = regular_grid({24, 3, 1}, Vec3::Zero(), {0.24, 0.03, 0.01});
  PointArray x = strip.positions();
  const PointArray v = PointArray::Zero(x.rows(), 3);
  TissueContact contact(strip, kSettings, 8);
  contact.begin_step(x, v, 0.01);
  EXPECT_EQ(contact.num_touching(), 0);
  // a half turn in the middle: the upper surface on itself
  for (Eigen::Index n = 0; n < x.rows(); ++n) {
    const double along = x(n, 0) - 0.1, up = x(n, 2);
    const double radius = 0.0195, turn = std::clamp(along / 0.04, 0.0, 1.0) * M_PI, past = std::max(along - 0.04, 0.0);
    x(n, 0) = along <= 0 ? x(n, 0) : 0.1 + std::sin(turn) * (radius - up) - past;
    if (along > 0) x(n, 2) = radius - std::cos(turn) * (radius - up);
  }
  contact.begin_step(x, v, 0.01);
  EXPECT_EQ(contact.num_touching(), 0);
  // the end that came round is pressed down by 20 mm: 39 mm above the lower one, of which 1 mm is left
  for (Eigen::Index n = 0; n < x.rows(); ++n)
    if (strip.positions()(n, 0) > 0.15) x(n, 2) -= 0.0195;
  contact.begin_step(x, v, 0.01);
  EXPECT_GT(contact.num_touching(), 20);
  PointArray f = PointArray::Zero(x.rows(), 3);
  contact.terms().add_force(x, v, Points(f));
  EXPECT_LT(f.colwise().sum().norm(), 1e-12 * f.rowwise().norm().sum());
  double up = 0;
  for (Eigen::Index n = 0; n < x.rows(); ++n)
    if (strip.positions()(n, 0) > 0.15) up += f(n, 2);
  EXPECT_GT(up, 0.4 * f.rowwise().norm().sum());
}

TEST(TissueContact, KeepsItsState) {
  const auto bytes_after = [](TissueContact& contact, const Stacked& stacked) {
    const PointArray x0 = stacked.end0(), x1 = stacked.end1();
    contact.begin_step({x0, x1}, {stacked.v0, stacked.v1}, 1e-3);
    contact.end_step({x0, x1});
    return written(contact);
  };
  Stacked stacked;
  const PointArray x0 = stacked.end0(), x1 = stacked.end1();
  stacked.contact.end_step({x0, x1});
  const std::vector<std::byte> saved = written(stacked.contact);
  const int touching = stacked.contact.num_touching(), slipping = stacked.contact.num_slipping();
  const std::vector<std::byte> expected = bytes_after(stacked.contact, stacked);
  EXPECT_GT(touching, 50);
  for (const int threads : {1, 2, 7}) {
    TissueContact other(stacked.below, stacked.above, kSettings, 8);
    read_from(saved, other);
    EXPECT_EQ(other.num_touching(), touching);
    EXPECT_EQ(other.num_slipping(), slipping);
    set_num_threads(threads);
    EXPECT_EQ(bytes_after(other, stacked), expected);
    set_num_threads(1);
  }
  TissueContact fewer(stacked.below, stacked.above, kSettings, 1);
  EXPECT_THROW(read_from(saved, fewer), InputError);
}

TEST(TissueContact, RefusesAnchorsInHexahedraThatAreGone) {
  // corners of the lower body, at the same number of samples: one that nothing touches, and one that is touched
  const auto without = [](TissueContact& contact, int hexahedron) {
    std::vector<unsigned char> alive(32, 1);
    alive[hexahedron] = 0;
    contact.set_alive(alive, {});
  };
  constexpr int kFar = 19, kTouched = 28;
  Stacked stacked;
  without(stacked.contact, kFar);
  stacked.contact.begin_step({stacked.x0, stacked.x1}, {stacked.v0, stacked.v1}, 0.01);
  stacked.contact.end_step({stacked.end0(), stacked.end1()});
  const std::vector<std::byte> saved = written(stacked.contact);
  TissueContact torn(stacked.below, stacked.above, kSettings, 8);
  without(torn, kTouched);
  const std::vector<std::byte> before = written(torn);
  EXPECT_TRUE(refuses<InputError>([&] { read_from(saved, torn); }, {"hexahedron 28", "which are not there"}));
  EXPECT_EQ(written(torn), before);
}

// Two sheets of one cell of 1 cm, which pass each other within a step: at any of some fifty places of it.
TEST(TissueContact, NothingIsMissedInAStep) {
  const HexMesh below = regular_grid({4, 4, 1}, Vec3::Zero(), {0.04, 0.04, 0.01});
  const PointArray rest = PointArray::Zero(below.num_nodes(), 3);
  Random random(8);
  for (int k = 0; k < 50; ++k) {
    const double begin = random.uniform(0.03, 0.6);
    const HexMesh above = regular_grid({2, 2, 1}, {0.013, 0.013, begin}, {0.033, 0.033, begin + 0.01});
    PointArray v = PointArray::Zero(above.num_nodes(), 3);
    v.col(2).array() = -70;
    TissueContact contact(below, above, kSettings, 2);
    contact.begin_step({below.positions(), above.positions()}, {rest, v}, 0.01);
    ASSERT_GT(contact.num_touching(), 0) << begin;
    const long all = contact.num_examined();
    EXPECT_LT(all, 4000) << "not at each of 140 places, as long as boxes are apart";
    v *= 10;
    EXPECT_THROW(contact.begin_step({below.positions(), above.positions()}, {rest, v}, 0.01), NumericalError);
    contact.begin_step({below.positions(), above.positions()}, {rest, -v}, 0.01);
    EXPECT_EQ(contact.num_examined(), 0) << "it moves away";
  }
}

TEST(TissueContact, RefusesNoSamples) {
  EXPECT_THROW(TissueContact(regular_grid({1, 1, 1}, Vec3::Zero(), Vec3::Ones()), {.stiffness = 1}, 0), InputError);
}

}  // namespace
