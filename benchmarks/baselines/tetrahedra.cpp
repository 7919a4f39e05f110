// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_tetrahedra SPLITTING LOAD FILE.json: a baseline for comparison, not part of the library. The bar of the
// shipped scenes bar_stretch_high and bar_twist_high, each cube split into linear tetrahedra, with the
// corotated law, and the library's flow law, hardening, time integration, masses and loads. A linear tetrahedron has
// one deformation gradient: nothing turns within it, so that only stretch can flow.
//
//   SPLITTING  five      five tetrahedra, mirrored from cube to cube as conforming needs
//              six       six around the same space diagonal in every cube
//              mirrored  six, the upper half of the bar being the mirror image of the lower one
//   LOAD       stretch, twist
#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "hexaplast/body.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/geometry/sections.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/implicit_euler.hpp"
#include "kinematics/polar.hpp"
#include "mesh/lumped_mass.hpp"
#include "plastic/point_flow.hpp"
#include "solve/loads.hpp"

namespace {

using namespace hexaplast;

using Tetrahedron = std::array<int, 4>;
using TetrahedronPoints = Eigen::Matrix<double, 4, 3>;

constexpr double kDt = 0.01, kDensity = 1000, kRayleigh = 0.1;
constexpr int kSteps = 500, kRampSteps = 50, kLastLoadedStep = 200;
constexpr int kAveragingSweeps = 20;  // local/global sweeps lag behind a twist unless there are several per step

Tetrahedron oriented(Tetrahedron t, const PointArray& x) {
  const Vec3 a = x.row(t[1]) - x.row(t[0]), b = x.row(t[2]) - x.row(t[0]), c = x.row(t[3]) - x.row(t[0]);
  if (a.cross(b).dot(c) < 0) std::swap(t[2], t[3]);
  return t;
}

/// The tetrahedra of one cube as corners; is_mirrored chooses the other of two mirror images (in z).
std::vector<Tetrahedron> split_cube(bool into_five, bool is_mirrored) {
  std::vector<Tetrahedron> parts;
  if (into_five) {
    parts = {{1, 3, 4, 6}, {0, 1, 3, 4}, {2, 1, 3, 6}, {5, 1, 4, 6}, {7, 3, 4, 6}};
  } else {
    for (const auto& [second, third] : {std::pair{1, 2}, {1, 5}, {3, 2}, {3, 7}, {4, 5}, {4, 7}})
      parts.push_back({0, second, third, 6});  // along the edges from corner 0 to corner 6
  }
  if (is_mirrored)
    for (Tetrahedron& part : parts)
      for (int& corner : part) corner = (corner + 4) % 8;
  return parts;
}

std::vector<Tetrahedron> split(const HexMesh& mesh, const std::string& splitting) {
  if (splitting != "five" && splitting != "six" && splitting != "mirrored")
    throw std::invalid_argument("SPLITTING is '" + splitting + "': must be five, six or mirrored");
  std::vector<Tetrahedron> tetrahedra;
  for (int e = 0; e < mesh.num_elements(); ++e) {
    const int i = e % 3, j = e / 3 % 3, k = e / 9;
    const bool is_mirrored = splitting == "five" ? (i + j + k) % 2 == 1 : splitting == "mirrored" && k >= 5;
    for (Tetrahedron part : split_cube(splitting == "five", is_mirrored)) {
      for (int& corner : part) corner = mesh.hexahedra()[e][corner];
      tetrahedra.push_back(oriented(part, mesh.positions()));
    }
  }
  return tetrahedra;
}

TetrahedronPoints gather(ConstPoints x, const Tetrahedron& nodes) {
  TetrahedronPoints at;
  for (int a = 0; a < 4; ++a) at.row(a) = x.row(nodes[a]);
  return at;
}

double volume(const TetrahedronPoints& at) {
  const Vec3 a = at.row(1) - at.row(0), b = at.row(2) - at.row(0), c = at.row(3) - at.row(0);
  return a.cross(b).dot(c) / 6;
}

/// Linear corotational tetrahedra with the library's flow of stretch, in the three spaces of the hexahedra: isolated
/// rest shapes, a joined plastic rest shape, the world.
class TetrahedralBody {
 public:
  TetrahedralBody(const HexMesh& mesh, std::vector<Tetrahedron> tetrahedra, const Material& material,
                  double restitution)
      : tetrahedra_(std::move(tetrahedra)),
        law_(material),
        lame_(lame(material.young_modulus, material.poisson_ratio)),
        restitution_(restitution),
        material_(mesh.positions()),
        yield_stress_(tetrahedra_.size(), material.yield_stress),
        parts_(tetrahedra_.size()) {
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(material_.rows(), material_.rows());
    P(0, 0) = 1;  // the node mean is restored anyway
    for (const Tetrahedron& t : tetrahedra_) {
      const TetrahedronPoints at = gather(material_, t);
      rest_shape_.push_back(at.rowwise() - at.colwise().mean());
      original_volume_.push_back(volume(at));
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) P(t[a], t[b]) += (a == b) - 0.25;
    }
    averaging_.compute(P);
  }

  const PointArray& material() const { return material_; }
  const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }

  void linearize(ConstPoints x) {
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      const TetrahedronPoints rest = gather(material_, tetrahedra_[e]);
      Mat3 edges;
      for (int d = 0; d < 3; ++d) edges.col(d) = rest.row(d + 1) - rest.row(0);
      Part& part = parts_[e];
      part.gradient.bottomRows<3>() = edges.inverse();
      part.gradient.row(0) = -part.gradient.bottomRows<3>().colwise().sum();
      part.volume = edges.determinant() / 6;
      part.F = gather(x, tetrahedra_[e]).transpose() * part.gradient;
      part.polar = polar(part.F);
    }
  }

  void add_force(Points f) const {
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      const Part& part = parts_[e];
      const Mat3 P = part.polar.R * stress(part);
      for (int a = 0; a < 4; ++a)
        f.row(tetrahedra_[e][a]) -= part.volume * (P * part.gradient.row(a).transpose()).transpose();
    }
  }

  void add_stiffness_blocks(double factor, BlockMatrix& K) const {
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      const Part& part = parts_[e];
      const TetrahedronPoints turned = part.gradient * part.polar.R.transpose();
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
          const Mat3 outer = turned.row(a).transpose() * turned.row(b);
          const double product = part.gradient.row(a).dot(part.gradient.row(b));
          const Mat3 block = lame_.mu * (product * Mat3::Identity() + outer.transpose()) + lame_.lambda * outer;
          K.add(tetrahedra_[e][a], tetrahedra_[e][b], -factor * part.volume * block);
        }
    }
  }

  void flow(ConstPoints x, double dt) {
    linearize(x);
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      const TetrahedronPoints at = gather(material_, tetrahedra_[e]);
      const double ratio = parts_[e].volume / original_volume_[e];
      if (parts_[e].F.determinant() >= kInversionThreshold && ratio >= kInversionThreshold) {
        const StretchFlow flowed = stretch_flow(parts_[e].polar.S, stress(parts_[e]), YieldNorm::kFrobenius,
                                                yield_stress_[e], law_.flow_rate, dt);
        const Mat3 turn = rotation_from_rest(e, at);
        rest_shape_[e] *= (turn.transpose() * flowed.increment * turn).transpose();
        yield_stress_[e] += law_.hardening * flowed.fraction * flowed.norm;
      }
      rest_shape_[e] *= 1 + restitution_ * dt * (1 - ratio);
    }
    for (int sweep = 0; sweep < kAveragingSweeps; ++sweep) average();
  }

 private:
  static constexpr double kInversionThreshold = 0.1;

  struct Part {
    TetrahedronPoints gradient;
    double volume = 0;
    Mat3 F;
    Polar polar;
  };

  /// [Pa] in the turning frame.                                                                  theory.md eq. 12
  Mat3 stress(const Part& part) const {
    const Mat3 strain = part.polar.S - Mat3::Identity();
    return 2 * lame_.mu * strain + lame_.lambda * strain.trace() * Mat3::Identity();
  }

  Mat3 rotation_from_rest(std::size_t e, const TetrahedronPoints& at) const {
    return polar((at.rowwise() - at.colwise().mean()).transpose() * rest_shape_[e]).R;
  }

  // one local/global sweep towards the joined shape that fits the isolated ones best
  void average() {
    PointArray misfit = PointArray::Zero(material_.rows(), 3);
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      const TetrahedronPoints at = gather(material_, tetrahedra_[e]);
      const TetrahedronPoints target = rest_shape_[e] * rotation_from_rest(e, at).transpose();
      const TetrahedronPoints gap = target - (at.rowwise() - at.colwise().mean());
      for (int a = 0; a < 4; ++a) misfit.row(tetrahedra_[e][a]) += gap.row(a);
    }
    const PointArray increment = averaging_.solve(misfit);
    material_ += increment.rowwise() - increment.colwise().mean();
  }

  std::vector<Tetrahedron> tetrahedra_;
  Material law_;
  Lame lame_;
  double restitution_;
  PointArray material_;
  std::vector<double> yield_stress_;
  std::vector<TetrahedronPoints> rest_shape_;
  std::vector<double> original_volume_;
  std::vector<Part> parts_;
  Eigen::LDLT<Eigen::MatrixXd> averaging_;
};

/// The bar that both bodies fill, its held nodes and its load.
struct Bar {
  HexMesh mesh = regular_grid({3, 3, 10}, {-.15, -.15, -.5}, {.15, .15, .5});
  bool is_twisted = false;

  bool is_held(int node) const { return std::abs(mesh.positions()(node, 2)) < 0.01; }

  void add_load(double fraction, ConstPoints x, Points f) const {
    static constexpr int kLower[] = {5, 6, 6, 10, 10, 9, 9, 5};  // the four edges of the central face
    static constexpr int kUpper[] = {165, 166, 166, 170, 170, 169, 169, 165};
    if (is_twisted) {
      add_tangential_forces(kUpper, 2, {0, 0, 1}, Vec3::Zero(), 20 * fraction, x, f);
      add_tangential_forces(kLower, 2, {0, 0, -1}, Vec3::Zero(), 20 * fraction, x, f);
    } else {
      for (const int node : {165, 166, 169, 170}) f(node, 2) += 22.5 * fraction;
      for (const int node : {5, 6, 9, 10}) f(node, 2) -= 22.5 * fraction;
    }
  }
};

class LoadedBar final : public MechanicalSystem {
 public:
  LoadedBar(const Bar& bar, TetrahedralBody& body)
      : bar_(bar), body_(body), mass_(kDensity * nodal_volumes(bar.mesh.positions(), bar.mesh.hexahedra())) {}

  int num_nodes() const override { return bar_.mesh.num_nodes(); }

  void compute_force(double time, ConstPoints x, ConstPoints, Points f) override {
    const long step = std::lround(time / kDt) + 1;
    body_.linearize(x);
    f.setZero();
    body_.add_force(f);
    if (step <= kLastLoadedStep) bar_.add_load(std::min(1.0, static_cast<double>(step) / kRampSteps), x, f);
  }

  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override {
    df += factors.mass * (mass_.asDiagonal() * dx);
    BlockMatrix K(num_nodes());
    body_.add_stiffness_blocks(factors.stiffness, K);
    for (int n = 0; n < num_nodes(); ++n)
      for (const BlockMatrix::Entry& entry : K.row(n))
        df.row(n) += (entry.block * dx.row(entry.column).transpose()).transpose();
  }

  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override {
    for (int n = 0; n < num_nodes(); ++n) A.add(n, n, factors.mass * mass_[n] * Mat3::Identity());
    body_.add_stiffness_blocks(factors.stiffness, A);
  }

  void project(Points field) const override {
    for (int n = 0; n < num_nodes(); ++n)
      if (bar_.is_held(n)) field.row(n).setZero();
  }

  void pin(BlockMatrix& A) const override {
    for (int n = 0; n < num_nodes(); ++n)
      for (int axis = 0; bar_.is_held(n) && axis < 3; ++axis) A.pin(n, axis);
  }

 private:
  const Bar& bar_;
  TetrahedralBody& body_;
  Eigen::VectorXd mass_;
};

/// Displacement under a small load: of anything that has stiffness blocks.
template <class AnyBody>
PointArray small_displacement(const Bar& bar, AnyBody& body, double fraction) {
  struct Stiffness final : LinearSystem {
    Stiffness(const Bar& held_bar, const AnyBody& any_body) : at(held_bar), of(any_body) {}
    int num_nodes() const override { return at.mesh.num_nodes(); }
    void apply(ConstPoints p, Points Ap) const override {
      BlockMatrix A(num_nodes());
      assemble(A);
      for (int n = 0; n < num_nodes(); ++n) {
        Ap.row(n).setZero();
        for (const BlockMatrix::Entry& entry : A.row(n))
          Ap.row(n) += (entry.block * p.row(entry.column).transpose()).transpose();
      }
    }
    void assemble(BlockMatrix& A) const override {
      of.add_stiffness_blocks(-1, A);
      for (int n = 0; n < num_nodes(); ++n)
        for (int axis = 0; at.is_held(n) && axis < 3; ++axis) A.pin(n, axis);
    }
    const Bar& at;
    const AnyBody& of;
  };

  const PointArray& x = bar.mesh.positions();
  body.linearize(x);
  PointArray f = PointArray::Zero(x.rows(), 3), u = f;
  bar.add_load(fraction, x, f);
  for (int n = 0; n < x.rows(); ++n)
    if (bar.is_held(n)) f.row(n).setZero();
  CholeskySolver().solve(Stiffness(bar, body), f, u);
  return u;
}

/// Elongation [-] or twist [rad] between the end sections.
double response(const Bar& bar, ConstPoints x) {
  const EndSections ends = end_sections(bar.mesh);
  return bar.is_twisted ? twist(bar.mesh, ends, x) : elongation(ends, x);
}

nlohmann::json rows(const PointArray& points) {
  nlohmann::json all = nlohmann::json::array();
  for (Eigen::Index n = 0; n < points.rows(); ++n) all.push_back({points(n, 0), points(n, 1), points(n, 2)});
  return all;
}

nlohmann::json simulate(const Bar& bar, const std::string& splitting) {
  const Material material{.yield_stress = 300, .flow_rate = bar.is_twisted ? 2.0 : 4.0, .hardening = .2};
  TetrahedralBody body(bar.mesh, split(bar.mesh, splitting), material, 1);

  constexpr double kSmall = 1e-4;  // fraction of the load
  Body hexahedra(bar.mesh, {material});
  const PointArray& X = bar.mesh.positions();
  const double softness = response(bar, X + small_displacement(bar, body, kSmall)) /
                          response(bar, X + small_displacement(bar, hexahedra, kSmall));

  LoadedBar system(bar, body);
  ImplicitEuler euler({.rayleigh_mass = kRayleigh, .rayleigh_stiffness = kRayleigh});
  CholeskySolver solver;
  PointArray x = X, v = PointArray::Zero(x.rows(), 3), peak;
  for (int step = 0; step < kSteps; ++step) {
    euler.step(system, solver, step * kDt, kDt, x, v);
    body.flow(x, kDt);
    if (step + 1 == kLastLoadedStep) peak = x;
  }
  double initial = 0, left = 0;
  for (const Tetrahedron& t : body.tetrahedra()) {
    initial += volume(gather(X, t));
    left += volume(gather(body.material(), t));
  }
  return {{"tetrahedra", body.tetrahedra()},
          {"peak", rows(peak)},
          {"material", rows(body.material())},
          {"softness", softness},
          {"volume_ratio", left / initial}};
}

}  // namespace

int main(int num_arguments, char** arguments) {
  if (num_arguments != 4) {
    std::cerr << "usage: hexaplast_tetrahedra SPLITTING LOAD FILE.json\n";
    return 2;
  }
  try {
    const std::string load = arguments[2];
    if (load != "stretch" && load != "twist")
      throw std::invalid_argument("LOAD is '" + load + "': must be stretch or twist");
    Bar bar;
    bar.is_twisted = load == "twist";
    const nlohmann::json result = simulate(bar, arguments[1]);
    std::ofstream out(arguments[3]);
    out << result << '\n';
    if (!out.flush()) throw std::runtime_error(std::string(arguments[3]) + ": cannot be written");
  } catch (const std::exception& error) {
    std::cerr << "hexaplast_tetrahedra: error: " << error.what() << '\n';
    return 5;
  }
  return 0;
}
