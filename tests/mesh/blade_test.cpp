// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/blade.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "mesh/trilinear.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"
#include "support/golden.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using namespace support;

/// A body that is cut step by step.
struct Cut {
  explicit Cut(const HexMesh& initial) : mesh(initial) {}

  /// The joints that open in a step, whose initial nodes move from x to x_after. Copies move as they do.
  std::vector<int> step(const PointArray& x, const PointArray& x_after, const std::vector<BladeAt>& blade) {
    const std::vector<int> opened = cut.opened(hexahedra, present(x), present(x_after), blade, is_open);
    std::vector<double> volumes;
    for (const Hexahedron& corners : mesh.hexahedra()) volumes.push_back(volume(gather(mesh.positions(), corners)));
    copies.split(mesh, joints, opened, std::vector{static_cast<int>(opened.size())}, is_open, volumes, hexahedra);
    return opened;
  }

  PointArray present(const PointArray& x) const { return x(copies.initial(), Eigen::all); }

  ConnectedParts pieces() const {
    const std::vector<unsigned char> alive(hexahedra.size(), 1);
    return connected_parts(HexMesh(present(mesh.positions()), hexahedra), alive);
  }

  const HexMesh mesh;
  const Joints joints{mesh};
  BladeCut cut{mesh, joints};
  NodeCopies copies{mesh.num_nodes()};
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  std::vector<unsigned char> is_open = std::vector<unsigned char>(joints.count(), 0);
};

std::vector<BladeAt> straight(const PointArray& from, const PointArray& to) { return {{0, from}, {1, to}}; }

PointArray points(const std::vector<Vec3>& rows) {
  PointArray points(rows.size(), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) points.row(k) = rows[k].transpose();
  return points;
}

Vec3 centre(const HexMesh& mesh, int e) {
  return gather(mesh.positions(), mesh.hexahedra()[e]).colwise().mean().transpose();
}

// Links of a grid that stands still, and a plane that a blade sweeps: where they cross is a quotient of distances.
TEST(Blade, TellsWhereItCrosses) {
  const HexMesh mesh = block({4, 3, 2}, 0.01);
  const Joints joints(mesh);
  BladeCut cut(mesh, joints);
  const std::vector<unsigned char> is_open(joints.count(), 0);
  const Vec3 normal = Vec3(3, 1, -1).normalized(), on_plane(0.0183, 0.0149, 0.0101);
  const Vec3 along = normal.unitOrthogonal(), forward = normal.cross(along);
  const auto edge = [&](double way) {
    return points({on_plane + way * forward - 0.1 * along, on_plane + way * forward + 0.1 * along});
  };
  const PointArray& x = mesh.positions();
  const std::vector<int> opened = cut.opened(mesh.hexahedra(), x, x, straight(edge(-0.1), edge(0.1)), is_open);
  ASSERT_GT(opened.size(), 6u);
  ASSERT_EQ(cut.crossings().size(), opened.size());
  for (std::size_t k = 0; k < opened.size(); ++k) {
    const std::span<const int> pair = joints.hexahedra(opened[k]);
    const auto distance = [&](int e) { return normal.dot(centre(mesh, e) - on_plane); };
    EXPECT_NEAR(cut.crossings()[k], distance(pair[0]) / (distance(pair[0]) - distance(pair[1])), 1e-3);
  }
}

/// tests/data/cutting/sweep_*.json: the conventions stand in its README.
class SweepingBlade : public testing::TestWithParam<std::string> {
 protected:
  const Json data = test_data("cutting", "sweep_" + GetParam());
  const HexMesh mesh{matrix(data["positions"]), hexahedra(data["hexahedra"])};

  PointArray x(std::size_t time) const {
    return data["motion"].empty() ? mesh.positions() : PointArray(matrix(data["motion"][time]));
  }
  PointArray blade(std::size_t time) const { return matrix(data["blade"][time]); }

  static std::vector<int> numbers(const Joints& joints, const Json& open) {
    std::vector<int> numbers;
    for (const Json& face : open["faces"]) numbers.push_back(joints.find(Joints::Face{face[0], face[1]}));
    for (const Json& hinge : open["hinges"]) numbers.push_back(joints.find(Joints::Hinge{hinge[0], hinge[1]}));
    return numbers;
  }
};

TEST_P(SweepingBlade, OpensTheJointsOfTheReference) {
  Cut cut(mesh);
  for (std::size_t k = 0; k < data["steps"].size(); ++k)
    EXPECT_EQ(cut.step(x(k), x(k + 1), straight(blade(k), blade(k + 1))), numbers(cut.joints, data["steps"][k]["cut"]))
        << "step " << k;
  EXPECT_EQ(cut.copies.num_nodes(), data["after"]["num_nodes"]);
  EXPECT_EQ(cut.hexahedra, hexahedra(data["after"]["hexahedra"]));
  EXPECT_EQ(cut.pieces().count, data["after"]["num_pieces"]);
}

TEST_P(SweepingBlade, OpensTheSameJointsInPartsOfSteps) {
  for (const int parts : {2, 16, 64}) {
    Cut cut(mesh);
    for (std::size_t k = 0; k < data["steps"].size(); ++k) {
      std::vector<int> opened;
      const auto between = [&](const PointArray& from, const PointArray& to, int part) {
        return PointArray(from + (to - from) * (double(part) / parts));
      };
      for (int part = 0; part < parts; ++part)
        for (const int joint :
             cut.step(between(x(k), x(k + 1), part), between(x(k), x(k + 1), part + 1),
                      straight(between(blade(k), blade(k + 1), part), between(blade(k), blade(k + 1), part + 1))))
          opened.push_back(joint);
      std::ranges::sort(opened);
      EXPECT_EQ(opened, numbers(cut.joints, data["steps"][k]["cut"])) << "step " << k << " in " << parts;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Blade, SweepingBlade,
                         testing::Values("along_links", "centres", "curved", "fast", "hinge", "moving_tissue",
                                         "nothing", "plane", "random", "stops_on_links", "tip_on_link", "turning"),
                         [](const auto& test) { return test.param; });

Sweep::Point random_point(Random& random, int count) {
  Sweep::Point point;
  for (std::int64_t& coordinate : point) coordinate = static_cast<int>(random.uniform(0, count));
  return point;
}

Sweep random_sweep(Random& random, int count) {
  return {{random_point(random, count), random_point(random, count)},
          {random_point(random, count), random_point(random, count)}};
}

Sweep scaled(const Sweep& sweep, std::int64_t factor, const Sweep::Point& displacement = {}) {
  Sweep scaled = sweep;
  for (Sweep::Point* point : {&scaled.p.before, &scaled.p.after, &scaled.q.before, &scaled.q.after})
    for (int i = 0; i < 3; ++i) (*point)[i] = (*point)[i] * factor + displacement[i];
  return scaled;
}

/// Expects `meet` to say what another way does of many a link and segment of a lattice, some of which meet.
template <class Other>
void expect_met(int seed, int lattice, const Other& other) {
  Random random(seed);
  int num_met = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    const Sweep link = random_sweep(random, lattice), segment = random_sweep(random, lattice);
    const bool is_met = meet(link, segment);
    EXPECT_EQ(is_met, other(link, segment));
    num_met += is_met;
  }
  EXPECT_GT(num_met, 1000);
}

// On a lattice of 3 x 3 x 3 points nearly all are ties. Differences are at most 2, determinants 48 and their minors 8
// at most: of the displacement 2^-10, 2^-20, 2^-30 of a spacing, each term outweighs all after it.
TEST(BladePredicate, IsThatOfADisplacedBlade) {
  expect_met(1, 3, [](const Sweep& link, const Sweep& segment) {
    const std::int64_t spacing = std::int64_t{1} << 34;
    return meet(scaled(link, spacing), scaled(segment, spacing, {spacing >> 10, spacing >> 20, spacing >> 30}));
  });
}

// From one end of it to the other: determinants of 184 bits.
TEST(BladePredicate, IsExactToTheEndOfItsRange) {
  expect_met(2, 8, [](const Sweep& link, const Sweep& segment) {
    constexpr std::int64_t kEnd = std::int64_t{1} << 60, kFactor = 2 * kEnd / 7;
    return meet(scaled(link, kFactor, {-kEnd, -kEnd, -kEnd}), scaled(segment, kFactor, {-kEnd, -kEnd, -kEnd}));
  });
}

// Of lines that keep their direction, the one is seen from the other: a link at rest, and a segment that sweeps a
// parallelogram. They meet where p + s (q - p) = a + u (b - a) + t w with s, u, t between 0 and 1.
TEST(BladePredicate, OfLinesThatKeepTheirDirectionIsALinearSystem) {
  Random random(3);
  int num_met = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    constexpr int kSize = 1 << 20;
    const Sweep::Point p = random_point(random, kSize), q = random_point(random, kSize);
    const Sweep::Point a = random_point(random, kSize), b = random_point(random, kSize);
    const Sweep::Point of_link = random_point(random, kSize), of_blade = random_point(random, kSize);
    const auto vector = [](const Sweep::Point& from, const Sweep::Point& to) {
      return Vec3(double(to[0] - from[0]), double(to[1] - from[1]), double(to[2] - from[2]));
    };
    const auto sum = [](const Sweep::Point& one, const Sweep::Point& other) {
      return Sweep::Point{one[0] + other[0], one[1] + other[1], one[2] + other[2]};
    };
    Mat3 A;
    A << vector(p, q), -vector(a, b), -vector(of_link, of_blade);
    const Vec3 solution = A.inverse() * vector(p, a);
    const bool is_met = solution.minCoeff() > 0 && solution.maxCoeff() < 1;
    EXPECT_EQ(meet({{p, sum(p, of_link)}, {q, sum(q, of_link)}}, {{a, sum(a, of_blade)}, {b, sum(b, of_blade)}}),
              is_met);
    num_met += is_met;
  }
  EXPECT_GT(num_met, 1000);
}

/// A chain across a block of `edge` cells, wider than it is, at x and at heights up to `waves` from `height`.
PointArray across(double x, double height, double waves, Random& random) {
  PointArray chain(5, 3);
  for (int k = 0; k < 5; ++k)
    chain.row(k) << x + random.uniform(-waves, waves), 2.0 * k - 2, height + random.uniform(-waves, waves);
  return chain;
}

// By parity: whichever way leads from below to above, a link of it is met.
TEST(BladeCut, ThatPassesABodyLeavesNoPieceOnBothSides) {
  for (int trial = 0; trial < 60; ++trial) {
    Random random(trial);
    const bool has_ties = trial % 2 == 0;  // the blade lies in the centres, and stops there
    const HexMesh mesh = has_ties ? block({5, 4, 4}, 1) : distorted_block({5, 4, 4}, 1, 0.15, trial);
    Cut cut(mesh);
    PointArray x = mesh.positions();
    const double height = has_ties ? 1.5 : random.uniform(1.6, 2.4), waves = has_ties ? 0 : 0.3;
    PointArray blade = across(-1, height, waves, random);
    for (int step = 0; step < 8; ++step) {
      PointArray x_after = x, blade_after = across(-1 + (step + 1), height, waves, random);
      if (has_ties) {
        blade_after.col(0).array() -= 0.5;
      } else {
        x_after = mesh.positions() + random.field(mesh.num_nodes(), 0.1);
      }
      cut.step(x, x_after, straight(blade, blade_after));
      x = x_after;
      blade = blade_after;
    }
    const ConnectedParts pieces = cut.pieces();
    std::set<int> below, above;
    for (int e = 0; e < mesh.num_elements(); ++e)
      for (const int n : cut.hexahedra[e]) {
        if (e < 20) below.insert(pieces.part_of_node[n]);
        if (e >= 60) above.insert(pieces.part_of_node[n]);
      }
    for (const int piece : below) EXPECT_FALSE(above.contains(piece)) << "trial " << trial;
  }
}

// A blade of eight edges that turns by forty degrees while it passes ten cells of moving tissue, in a step and in 64 of
// them. Triangles of a whole step would be 1.5 edges away from what it sweeps. Lines of blade and tissue bend by a
// tenth in parts of a step: only links with an end within two tenths may differ.
TEST(BladeCut, InOneStepIsThatInManyUpToTheBend) {
  int num_opened = 0, num_different = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Random random(trial);
    const HexMesh mesh = distorted_block({10, 4, 5}, 1, 0.2, trial);
    const PointArray x = mesh.positions(), x_after = x + random.field(mesh.num_nodes(), 0.5);
    const PointArray from = points({{-1, -2, 1}, {-1, 6, 4}}), to = points({{11, -2, 4}, {11, 6, 1}});
    const auto opened = [&](int parts) {
      Cut cut(mesh);
      std::set<int> joints;
      for (int part = 0; part < parts; ++part) {
        const double begin = double(part) / parts, end = double(part + 1) / parts;
        for (const int joint : cut.step(x + (x_after - x) * begin, x + (x_after - x) * end,
                                        straight(from + (to - from) * begin, from + (to - from) * end)))
          joints.insert(joint);
      }
      return joints;
    };
    // how high the centre of a hexahedron lies above the blade when that passes it
    const auto height = [&](int e) {
      const Vec3 before = gather(x, mesh.hexahedra()[e]).colwise().mean();
      const Vec3 way = Vec3(gather(x_after, mesh.hexahedra()[e]).colwise().mean()) - before;
      const double time = (before[0] + 1) / (12 - way[0]);
      const Vec3 at = before + time * way;
      return at[2] - (1 + 3 * time + (at[1] + 2) / 8 * (3 - 6 * time));
    };
    const Joints joints(mesh);
    const std::set<int> once = opened(1), often = opened(64);
    for (int joint = 0; joint < joints.count(); ++joint) {
      num_opened += often.contains(joint);
      if (once.contains(joint) == often.contains(joint)) continue;
      ++num_different;
      EXPECT_LT(std::min(std::abs(height(joints.hexahedra(joint)[0])), std::abs(height(joints.hexahedra(joint)[1]))),
                0.2);
    }
  }
  EXPECT_GT(num_opened, 1000);
  EXPECT_GT(num_different, 0);
}

TEST(BladeCut, FollowsAllMomentsOfAStep) {
  const HexMesh mesh = block({2, 1, 1}, 1);
  Cut cut(mesh);
  const PointArray far = points({{1, -1, 2}, {1, 2, 2}}), through = points({{1, -1, -1}, {1, 2, -1}});
  EXPECT_TRUE(cut.step(mesh.positions(), mesh.positions(), {{0, far}, {1, far}}).empty());
  EXPECT_EQ(cut.step(mesh.positions(), mesh.positions(), {{0, far}, {0.5, through}, {1, far}}), std::vector<int>{0});
}

TEST(BladeCut, MovesTheTissueWithTheMoments) {
  const HexMesh mesh = block({2, 1, 1}, 1);
  const PointArray x = mesh.positions(), x_after = mapped(x, Mat3::Identity(), Vec3(0, 0, 10));
  // the blade passes at a height where the link is at half of the step
  const PointArray before = points({{1, -1, 5.5}, {1, 2, 5.5}}), left = points({{-1, -1, 5.5}, {-1, 2, 5.5}});
  const PointArray right = points({{2, -1, 5.5}, {2, 2, 5.5}});
  EXPECT_EQ(Cut(mesh).step(x, x_after, {{0, before}, {1, before}}), std::vector<int>{0});
  EXPECT_EQ(Cut(mesh).step(x, x_after, {{0, left}, {0.4, left}, {0.6, before}, {1, right}}), std::vector<int>{});
  EXPECT_EQ(Cut(mesh).step(x, x_after, {{0, left}, {0.4, before}, {0.6, before}, {1, right}}), std::vector<int>{0});
}

TEST(BladeCut, OfAnyLengthOpensTheSame) {
  const HexMesh mesh = distorted_block({3, 3, 3}, 1, 0.2, 5);
  const PointArray& x = mesh.positions();
  const auto opened = [&](double reach) {
    const Vec3 on_plane(1.4, 1.6, 1.5), along(0.5, 2, 1), way(1, -0.5, 0.25);
    const auto edge = [&](double s) {
      return points({on_plane + reach * (s * way - along), on_plane + reach * (s * way + along)});
    };
    return Cut(mesh).step(x, x, straight(edge(-1), edge(1)));
  };
  const std::vector<int> expected = opened(4);
  EXPECT_GT(expected.size(), 4u);
  for (const double reach : {40.0, 4e2, 4e4, 4e6}) EXPECT_EQ(opened(reach), expected) << reach;
}

TEST(BladeCut, OpensNothingWithoutMotionOrLength) {
  const HexMesh mesh = distorted_block({3, 3, 3}, 1, 0.2, 5);
  Cut cut(mesh);
  const PointArray x = mesh.positions(), within = points({{-1, 1.4, 1.6}, {4, 1.5, 1.3}});
  const PointArray a_point = points({{-1, 1.4, 1.6}, {-1, 1.4, 1.6}}), moved = points({{4, 1.5, 1.3}, {4, 1.5, 1.3}});
  EXPECT_TRUE(cut.step(x, x, straight(within, within)).empty());
  EXPECT_TRUE(cut.step(x, x, straight(a_point, moved)).empty());
  EXPECT_TRUE(cut.step(x, x, straight(a_point.topRows(1), moved.topRows(1))).empty());
  EXPECT_TRUE(cut.step(x, x, straight(PointArray(0, 3), PointArray(0, 3))).empty());
  EXPECT_TRUE(cut.step(x, x, {}).empty());
}

TEST(BladeCut, MeetsAllHexahedraOfAFace) {
  const HexMesh two = block({2, 1, 1}, 1);
  PointArray positions(16, 3);
  positions << two.positions(),
      mapped(two.positions()(std::vector{2, 5, 8, 11}, Eigen::all).eval(), Mat3::Identity(), Vec3(0, 0, 4));
  std::vector<Hexahedron> hexahedra = two.hexahedra();
  hexahedra.push_back(hexahedra.back());  // with the same four nodes on its left
  for (int& n : hexahedra.back())
    for (const auto& [from, to] : {std::pair{2, 12}, {5, 13}, {8, 14}, {11, 15}})
      if (n == from) n = to;
  const HexMesh mesh(positions, hexahedra);
  // from the first centre (0.5, 0.5, 0.5) to (1.5, 0.5, 0.5), and to (1.5, 0.5, 2.5)
  const auto opened = [&](const Vec3& from, const Vec3& to) {
    const Vec3 wide(0, 2, 0);
    return Cut(mesh).step(positions, positions,
                          straight(points({from - wide, from + wide}), points({to - wide, to + wide})));
  };
  EXPECT_EQ(opened({1.2, 0, 0}, {1.2, 0, 1}), std::vector<int>{0});
  EXPECT_EQ(opened({1.2, 0, 1}, {1.2, 0, 3}), std::vector<int>{0});
  EXPECT_EQ(opened({1.2, 0, 0}, {1.2, 0, 3}), std::vector<int>{0});
  EXPECT_EQ(opened({1.9, 0, 0}, {1.9, 0, 3}), std::vector<int>{});
}

std::string refusal(const HexMesh& mesh, const PointArray& x, const PointArray& from, const PointArray& to) {
  return error_of<InputError>([&] { Cut(mesh).step(x, x, straight(from, to)); });
}

TEST(BladeCut, RefusesWhatIsNotFiniteOrTooFar) {
  const HexMesh mesh = block({2, 2, 2}, 1);
  const PointArray x = mesh.positions(), from = points({{-1, -1, 1}, {-1, 3, 1}}), to = points({{3, -1, 1}, {3, 3, 1}});
  PointArray bad = to;
  bad(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(has(refusal(mesh, x, from, bad), "blade: point 1 is at 3 3 nan m"));
  PointArray bad_x = x;
  bad_x(26, 0) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(has(refusal(mesh, bad_x, from, to), "centre of hexahedron 7 is at inf"));

  // 2^60 spacings of 2^-31 m are 5.4e8 m
  EXPECT_EQ(refusal(mesh, x, from, points({{5e8, -1, 1}, {5e8, 3, 1}})), "");
  EXPECT_TRUE(
      has(refusal(mesh, x, from, points({{6e8, -1, 1}, {6e8, 3, 1}})), "must be finite and nearer than 5.37e+08"));
}

}  // namespace
}  // namespace hexaplast
