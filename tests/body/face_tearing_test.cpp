// SPDX-License-Identifier: LGPL-2.1-or-later
// Bodies that tear along faces: the way of the crack, what stays, what it takes.              theory.md section 10
#include <set>

#include "hexaplast/solve/newton_raphson.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

constexpr double kFaceCell = 0.0078125;  // [m] 2^-7: coordinates are exact

Material tears_by_stress() {
  return {.poisson_ratio = 0.3, .yield_stress = 300, .flow_rate = 20, .hardening = 0.5, .fracture_stress = 500};
}

/// Joints in the plane where a coordinate has this value, with centres of faces that lie within a range of another one.
std::vector<int> joints_in_plane(const Body& body, int axis, double at, int across, double from, double to) {
  std::vector<int> joints;
  const PointArray& X = body.initial_mesh().positions();
  for (int joint = 0; joint < body.joints().num_faces(); ++joint) {
    const std::span<const int> nodes = body.joints().nodes(joint);
    double centre = 0;
    for (const int n : nodes) centre += X(n, across) / 4;
    if (std::ranges::all_of(nodes, [&](int n) { return std::abs(X(n, axis) - at) < 1e-9; }) && centre > from &&
        centre < to)
      joints.push_back(joint);
  }
  return joints;
}

struct Sheet {
  std::array<int, 3> cells{12, 8, 1};
  int slit = 6;         // plane of nodes, along x, in which it lies
  int slit_length = 3;  // rows
  double pull = 0.13;   // [N] at each end, while it is whole
  Material material = tears_by_stress();
  double turned = 1;  // -1: the mirror image along x
};

/// Slit from y = 0, and pulled apart at its ends along x.
MovingBody pulled(const Sheet& of, std::shared_ptr<bool> is_let_go = std::make_shared<bool>(false)) {
  const HexMesh mesh = block(of.cells, kFaceCell);
  const double length = of.cells[0] * kFaceCell;
  const std::vector<int> lower = nodes_at(mesh, 0, 0), upper = nodes_at(mesh, 0, length);
  Motion motion;
  motion.euler = {.rayleigh_mass = 0, .rayleigh_stiffness = 0.02};
  motion.load = [=](double time, ConstPoints, Points f) {
    if (*is_let_go) return;
    const double fraction = of.pull * std::min(1.0, time / 0.2) / static_cast<double>(lower.size());
    for (const int n : lower) f(n, 0) -= fraction;
    for (const int n : upper) f(n, 0) += fraction;
  };
  MovingBody sheet(Body(mesh, {of.material}, {.fracture = Fracture::kFace}), std::move(motion));
  const double at = of.turned > 0 ? of.slit * kFaceCell : length - of.slit * kFaceCell;
  sheet.open(joints_in_plane(sheet.body, 0, at, 1, 0, of.slit_length * kFaceCell));
  return sheet;
}

int num_pieces(const Body& body) { return connected_parts(body.mesh(), body.alive()).count; }

/// Twice the centre of a face, in edges.
std::array<long, 3> place_of(const Body& body, int joint) {
  Vec3 sum = Vec3::Zero();
  for (const int n : body.joints().nodes(joint)) sum += body.initial_mesh().positions().row(n).transpose();
  return {std::lround(sum.x() / kFaceCell / 2), std::lround(sum.y() / kFaceCell / 2),
          std::lround(sum.z() / kFaceCell / 2)};
}

bool tear_apart(MovingBody& sheet, int steps = 400) {
  for (int k = 0; k < steps && num_pieces(sheet.body) == 1; ++k) sheet.step();
  return num_pieces(sheet.body) > 1;
}

TEST(FaceTearing, ContinuesASlitStraightAndKeepsAllTissue) {
  for (const int layers : {1, 2}) {
    Sheet of;
    of.cells[2] = layers;
    of.pull *= layers;
    const auto is_let_go = std::make_shared<bool>(false);
    MovingBody sheet = pulled(of, is_let_go);
    const double mass = std::accumulate(sheet.mass().begin(), sheet.mass().end(), 0.0);
    ASSERT_TRUE(tear_apart(sheet));
    EXPECT_EQ(num_pieces(sheet.body), 2);
    EXPECT_TRUE(sheet.body.removed().empty());
    EXPECT_EQ(std::accumulate(sheet.mass().begin(), sheet.mass().end(), 0.0), mass);
    std::vector<int> opened(sheet.body.opened().begin(), sheet.body.opened().end());
    std::ranges::sort(opened);
    EXPECT_EQ(opened, joints_in_plane(sheet.body, 0, of.slit * kFaceCell, 1, 0, 1)) << layers << " layers";
    *is_let_go = true;
    for (int k = 0; k < 100; ++k) EXPECT_TRUE(sheet.step().torn.empty()) << "crumbs, step " << k;
  }
}

TEST(FaceTearing, TakesTheMirroredWayInTheMirrorImage) {
  const auto crack_of = [](double turned) {
    Sheet of{.slit = 5, .turned = turned};
    MovingBody sheet = pulled(of);
    EXPECT_TRUE(tear_apart(sheet));
    std::set<std::array<long, 3>> faces;
    for (const int joint : sheet.body.opened()) {
      auto [x, y, z] = place_of(sheet.body, joint);
      faces.insert({turned > 0 ? x : 2 * of.cells[0] - x, y, z});
    }
    return faces;
  };
  EXPECT_EQ(crack_of(-1), crack_of(1));
}

TEST(FaceTearing, HasTheSameBitsForAnyNumberOfThreadsAndGoesOnFromASavedState) {
  const int before = num_threads();
  std::vector<std::string> hashes;
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    MovingBody sheet = pulled({});
    const std::size_t slit = sheet.body.opened().size();
    for (int k = 0; k < 400 && sheet.body.opened().size() == slit; ++k) sheet.step();
    ASSERT_EQ(num_pieces(sheet.body), 1) << "amid the tear";
    std::stringstream saved;
    sheet.save(saved);
    MovingBody other = pulled({});
    other.load(saved);
    for (MovingBody* one : {&sheet, &other}) {
      tear_apart(*one);
      hashes.push_back(one->state_hash());
    }
  }
  set_num_threads(before);
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes.front());
}

// The plastic step by itself opens nothing.
TEST(FaceTearing, IsLeftToTheCaller) {
  MovingBody sheet = pulled({});
  std::vector<int> torn;
  const PointArray stretched = [&] {
    PointArray x = sheet.positions;
    x.col(0) *= 1.4;
    return x;
  }();
  Body body = sheet.body;
  const int num_nodes = body.mesh().num_nodes();
  const std::size_t opened = body.opened().size();
  for (int k = 0; k < 100 && torn.empty(); ++k) torn = body.flow(stretched, 0.01).torn;
  EXPECT_FALSE(torn.empty());
  EXPECT_TRUE(std::ranges::is_sorted(torn));
  EXPECT_EQ(body.mesh().num_nodes(), num_nodes);
  EXPECT_EQ(body.opened().size(), opened);
}

/// Of a strip between grips that part along y, long beside its height H, slit along its middle. Without Poisson's ratio
/// a volume far ahead of the crack holds E e^2/2 and one far behind it nothing: a crack sets free G = E e^2 H/2,
/// whatever its length (Rivlin and Thomas, 1953).
struct Strip {
  int half;                 // hexahedra in half of its height
  int layers;               // through its thickness
  bool is_twofold = false;  // two of its upper half are on the slit, and below it is one row of hexahedra

  static constexpr double kHeight = 0.1, kYoung = 20000;
  double edge() const { return kHeight / (2 * half); }
  double slit_at() const { return is_twofold ? edge() : kHeight / 2; }
  double top() const { return slit_at() + kHeight / 2; }
  static double energy_at(double strain) { return kYoung * strain * strain * kHeight / 2; }

  HexMesh mesh() const {
    const int below = is_twofold ? 1 : half;
    const HexMesh once =
        regular_grid({8 * half, below + half, layers}, Vec3::Zero(), Vec3(4 * kHeight, top(), layers * edge()));
    if (!is_twofold) return once;
    std::vector<int> rows(static_cast<std::size_t>(once.num_nodes()));
    std::iota(rows.begin(), rows.end(), 0);
    std::vector<int> twin = rows;
    for (int n = 0; n < once.num_nodes(); ++n) {
      if (once.positions()(n, 1) < slit_at() + 1e-9) continue;
      twin[static_cast<std::size_t>(n)] = static_cast<int>(rows.size());
      rows.push_back(n);
    }
    std::vector<Hexahedron> hexahedra = once.hexahedra();
    for (const Hexahedron& corners : once.hexahedra()) {
      if (gather(once.positions(), corners).col(1).mean() < slit_at()) continue;
      Hexahedron& other = hexahedra.emplace_back(corners);
      for (int& node : other) node = twin[static_cast<std::size_t>(node)];
    }
    return {once.positions()(rows, Eigen::all), hexahedra};
  }

  /// With a flow of a millionth of what passes tau, which follows the stress at once: kappa nu dt = 1.
  Body body(double strength, double energy) const {
    const Material material{.young_modulus = kYoung,
                            .poisson_ratio = 0,
                            .yield_stress = 1,
                            .flow_rate = 1e-4,
                            .hardening = 1e6,
                            .fracture_stress = strength,
                            .fracture_energy = energy};
    Body slit(mesh(), {material}, {.fracture = Fracture::kFace});
    slit.open(joints_in_plane(slit, 1, slit_at(), 0, 0, 2 * kHeight));
    return slit;
  }

  /// The faces ahead of the crack.
  std::vector<int> front(const Body& body) const {
    return joints_in_plane(body, 1, slit_at(), 0, 2 * kHeight, 2 * kHeight + edge());
  }

  /// Grips hold this strain; returns the energy [J] in equilibrium.
  double pull(Body& body, double strain, PointArray& x) const {
    std::vector<int> held;
    const PointArray& X = body.mesh().positions();
    for (int n = 0; n < X.rows(); ++n) {
      if (X(n, 1) > 1e-9 && X(n, 1) < top() - 1e-9) continue;
      held.push_back(n);
      x(n, 1) = X(n, 1) * (1 + strain);
    }
    LoadedBody system(body, std::vector<double>(X.rows(), 0.0), held, {});
    CholeskySolver solver;
    NewtonRaphson newton(
        {.iterations = 30, .relative_successive = 0, .relative_initial = 0, .absolute_residual = 1e-9});
    newton.solve(system, solver, 0, x);
    return body.energy(x);
  }
};

bool contains(const std::vector<int>& torn, const std::vector<int>& joints) {
  return std::ranges::all_of(joints, [&](int joint) { return std::ranges::binary_search(torn, joint); });
}

TEST(FractureEnergy, ThatAFaceIsJudgedByIsWhatItsOpeningSetsFree) {
  constexpr double kStrain = 0.01;
  for (const Strip strip : {Strip{4, 1}, Strip{4, 2}, Strip{6, 3}, Strip{4, 2, true}}) {
    Body body = strip.body(1.02 * Strip::kYoung * kStrain, 1);
    PointArray x = body.mesh().positions();
    x.col(1) *= 1 + kStrain;
    const double before = strip.pull(body, kStrain, x);
    const std::vector<int> front = strip.front(body);

    double low = 0, high = 10;  // [J/m^2] by bisection: the energy at which it does not open any more
    for (int k = 0; k < 30; ++k) {
      const double energy = (low + high) / 2;
      Body tried = strip.body(1.02 * Strip::kYoung * kStrain, energy);
      (contains(tried.flow(x, 0.01).torn, front) ? low : high) = energy;
    }

    append_rows(body.open(front), x);
    const double area = strip.layers * strip.edge() * strip.edge();
    const double free = (before - strip.pull(body, kStrain, x)) / area;
    if (!strip.is_twofold) {
      EXPECT_NEAR(free / Strip::energy_at(kStrain), 1, 0.01);
    }
    EXPECT_NEAR(low / free, 1, 0.01) << strip.half << " " << strip.layers;
  }
}

/// Strain at which the crack begins to grow, by bisection.
double strain_at_tear(const Strip& strip, double strength, double energy) {
  double low = 0.002, high = 0.03;
  while (high / low > 1.01) {
    const double strain = std::sqrt(low * high);
    Body body = strip.body(strength, energy);
    PointArray x = body.mesh().positions();
    x.col(1) *= 1 + strain;
    strip.pull(body, strain, x);
    (contains(body.flow(x, 0.01).torn, strip.front(body)) ? high : low) = strain;
  }
  return high;
}

TEST(FractureEnergy, GivesGriffithsLoadAndWithoutItTheLoadDependsOnTheMesh) {
  constexpr double kStrain = 0.01;  // Griffith's
  const double strength = 1.15 * Strip::kYoung * kStrain;
  std::vector<double> with, without;
  for (const int half : {3, 6, 9}) {
    with.push_back(strain_at_tear({half, 1}, strength, Strip::energy_at(kStrain)) / kStrain);
    without.push_back(strain_at_tear({half, 1}, strength, 0) / kStrain);
  }
  EXPECT_NEAR(with.back(), 1, 0.02);
  EXPECT_LT(without.back(), 0.8 * without.front());
}

}  // namespace
}  // namespace hexaplast
