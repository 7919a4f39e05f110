// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/springs.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "attributes/stock.hpp"
#include "components/between_states.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

/// The greatest v.B v / v.A v, or one that is `enough`, and the v that has it, from v on: by locally optimal conjugate
/// directions (Knyazev 2001). A and B: products with symmetric matrices; `inverse`: about that of A.
template <class ProductB, class ProductA, class Inverse>
double greatest_quotient(const ProductB& B, const ProductA& A, const Inverse& inverse, PointArray& v, double enough) {
  constexpr int kMinSteps = 5, kMaxSteps = 50;
  constexpr double kSettled = 1e-3, kDependent = 1e-6;
  const auto dot = [](const PointArray& a, const PointArray& b) { return a.cwiseProduct(b).sum(); };
  PointArray along, across;  // the latest way, and the way of steepest ascent
  double quotient = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    std::vector<PointArray> basis, with_A, with_B;  // orthonormal by A
    for (const PointArray* candidate : {&v, &along, &across}) {
      if (candidate->size() == 0 || candidate->isZero(0)) continue;
      PointArray x = *candidate / candidate->norm();
      for (std::size_t j = 0; j < basis.size(); ++j) x -= dot(with_A[j], x) * basis[j];
      if (!(x.norm() > kDependent)) continue;
      const PointArray Ax = A(x);
      const double squared = dot(x, Ax);
      if (!(squared > 0)) continue;
      basis.push_back(x / std::sqrt(squared));
      with_A.push_back(Ax / std::sqrt(squared));
      with_B.push_back(B(basis.back()));
    }
    if (basis.empty()) return 0;
    const auto count = std::ssize(basis);
    Eigen::MatrixXd products(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j < count; ++j)
        products(i, j) = dot(basis[static_cast<std::size_t>(i)], with_B[static_cast<std::size_t>(j)]);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(products);
    const double before = std::exchange(quotient, eigen.eigenvalues()[count - 1]);
    const Eigen::VectorXd weights = eigen.eigenvectors().col(count - 1);
    v.setZero();
    PointArray residual = v;
    for (std::size_t j = 0; j < basis.size(); ++j) {
      const double weight = weights[static_cast<Eigen::Index>(j)];
      v += weight * basis[j];
      residual += weight * (with_B[j] - quotient * with_A[j]);
    }
    along = v - weights[0] * basis[0];
    across = inverse(residual);
    if (quotient >= enough || (step >= kMinSteps && quotient < (1 + kSettled) * before)) break;
  }
  return quotient;
}

/// Springs between nodes of its state, or of two states of which not both are it.
class SpringForceField final : public scene::ForceField,
                               public scene::Interaction,
                               public scene::Changeable,
                               public scene::ShowsSprings {
 public:
  SpringForceField() : ForceField(attributes::kSpringForceField) {}

  std::array<scene::MechanicalState*, 2> states() const override { return states_; }

  void init() override {
    const std::array given = {&linked<scene::MechanicalState>("object1"), &linked<scene::MechanicalState>("object2")};
    const auto* own = node().nearest<scene::MechanicalState>();
    rayleigh_stiffness_ = real("rayleighStiffness");
    if (given[0] != own || given[1] != own)
      states_ = given;
    else
      make_springs();
  }

  // When both states have their nodes, which may stand behind it.
  void bwd_init() override {
    if (states_[0]) {
      require_one_integrator(*this, states_);
      make_springs();
    }
    warn_of_damping();
  }

  void refresh(std::span<const std::string_view>) override {
    rayleigh_stiffness_ = real("rayleighStiffness");
    make_springs();
    warn_of_damping();
  }

  void add_force(double, ConstPoints x, ConstPoints v, Points f) override { springs_.add_force(x, v, f); }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    springs_.add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override { springs_.add_stiffness_blocks(factor, A); }
  void add_force(double, const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) override {
    springs_.add_force(x, v, f);
  }
  void add_stiffness_product(double factor, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const override {
    springs_.add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const override {
    springs_.add_stiffness_blocks(factor, A, first_nodes);
  }
  bool is_in_matrix() const override { return !springs_.springs().empty(); }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  std::vector<scene::SpringLine> spring_lines() const override {
    auto* own = node().nearest<scene::MechanicalState>();
    const SpringEnds first(states_[0] ? *states_[0] : *own), second(states_[1] ? *states_[1] : *own);
    std::vector<scene::SpringLine> lines;
    for (const Spring& spring : springs_.springs()) {
      const std::optional from = first.at(spring.a), to = second.at(spring.b);
      if (from && to) lines.push_back({*from, *to, (*to - *from).norm() < (1 - kTaut) * spring.rest_length});
    }
    return lines;
  }

 private:
  static constexpr double kShift = 1e-7;  // of the size: as a difference quotient
  static constexpr double kTaut = 1e-6;   // of the rest length: rounding does not make a spring slack

  void make_springs() {
    if (!states_[0]) {
      const int num_nodes = needed_ready<scene::MechanicalState>().num_nodes();
      springs_ = Springs(make({num_nodes, num_nodes}), num_nodes);
    } else {
      const std::array num_nodes = {states_[0]->num_nodes(), states_[1]->num_nodes()};
      springs_ = Springs(make(num_nodes), num_nodes);
    }
  }

  /// Of dampers that throw nodes back harder in every step. They act by the velocities at its beginning,
  ///   (M + h (h + beta) K) v' = (M - h D) v - h K u,   u' = u + h v',
  /// which grows where v.h D v > 2 v.A v for some motion v, A = M + h (h + 2 beta) / 4 K: by Jury's criterion for one.
  /// Nodes whose dampers take less than their momentum in a step are not looked at any further: Gershgorin's bound of h
  /// D is twice the sum of the dampers of a node.
  void warn_of_damping() {
    for (const scene::Component* component : node().root().all<scene::Component>())
      if (component->stage() == Stage::kFailed) return;  // its errors come first
    auto* own = node().nearest<scene::MechanicalState>();
    const std::array ends = {states_[0] ? states_[0] : own, states_[1] ? states_[1] : own};
    const bool is_of_one = ends[0] == ends[1];
    const int num_first = ends[0]->num_nodes(), count = num_first + (is_of_one ? 0 : ends[1]->num_nodes());
    const double h = node().clock().dt;
    std::vector<double> damping(static_cast<std::size_t>(count));
    for (const Spring& spring : springs_.springs()) {
      damping[spring.a] += spring.damping;
      damping[(is_of_one ? 0 : num_first) + spring.b] += spring.damping;
    }

    // one state behind the other; what nothing moves, and what follows, has no mass here
    const auto rows_of = [&](PointArray& field, int end) -> Points {
      return field.middleRows(end == 0 ? 0 : num_first, ends[end]->num_nodes());
    };
    const auto of_two = [&](PointArray& field) {
      return OfTwo<Points>(rows_of(field, 0), rows_of(field, is_of_one ? 0 : 1));
    };
    const auto read_only = [&](PointArray& field) {
      return OfTwo<ConstPoints>(rows_of(field, 0), rows_of(field, is_of_one ? 0 : 1));
    };
    const PointArray zero = PointArray::Zero(count, 3);
    PointArray x = zero, mass = zero, none = zero;
    double size = 0, beta = 0;
    for (int end = 0; end < (is_of_one ? 1 : 2); ++end) {
      const PointArray& positions = ends[end]->positions();
      rows_of(x, end) = positions;
      size = std::max(size, (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).norm());
      auto* integrator = ends[end]->node().nearest<scene::OdeSolver>();
      if (!integrator) continue;
      if (integrator->find_data("rayleighStiffness")) beta = integrator->real("rayleighStiffness");
      for (const scene::Mass* part : scene::masses_of(node().root(), *ends[end]))
        part->add_diagonal(1, rows_of(mass, end));
    }
    bool may_grow = false;
    for (int n = 0; n < count; ++n) may_grow = may_grow || (mass(n, 0) > 0 && h * damping[n] > mass(n, 0));
    if (!may_grow) return;

    const auto held = [&](PointArray field) {
      for (int n = 0; n < count; ++n)
        if (mass(n, 0) == 0) field.row(n).setZero();
      for (const scene::ProjectiveConstraint* constraint : node().root().all<scene::ProjectiveConstraint>())
        for (int end = 0; end < (is_of_one ? 1 : 2); ++end)
          if (scene::acts_on(*constraint, *ends[end])) constraint->project(rows_of(field, end));
      return field;
    };
    const auto times_damping = [&](PointArray v) {
      PointArray f = zero, at_rest = zero;
      springs_.add_force(read_only(x), read_only(v), of_two(f));
      springs_.add_force(read_only(x), read_only(none), of_two(at_rest));
      return held(h * (at_rest - f));
    };
    const auto times_inertia = [&](PointArray v) {
      PointArray Av = mass.cwiseProduct(v);
      springs_.add_stiffness_product(-h * (h + 2 * rayleigh_stiffness_) / 4, read_only(v), of_two(Av));
      const double shift = kShift * size / v.cwiseAbs().maxCoeff();  // bodies by a difference quotient
      for (const double sign : {-1, 1}) {
        PointArray shifted = x + sign * shift * v, f = zero;
        for (scene::ForceField* field : node().root().all<scene::ForceField>())
          for (int end = 0; end < (is_of_one ? 1 : 2); ++end)
            if (field->body() && scene::acts_on(*field, *ends[end]))
              field->add_force(0, rows_of(shifted, end), rows_of(none, end), rows_of(f, end));
        Av -= sign * h * (h + 2 * beta) / 4 / (2 * shift) * f;
      }
      return held(Av);
    };
    const auto divided_by_mass = [&](const PointArray& r) {
      return held((mass.array() > 0).select(r.array() / mass.array(), 0));
    };
    PointArray start(count, 3);
    for (Eigen::Index i = 0; i < start.size(); ++i) start.data()[i] = std::sin(1.0 + static_cast<double>(i * i));
    PointArray v = divided_by_mass(times_damping(start));
    if (greatest_quotient(times_damping, times_inertia, divided_by_mass, v, 2) < 2) return;
    Eigen::Index worst = 0;
    v.rowwise().squaredNorm().maxCoeff(&worst);
    const int end = worst < num_first ? 0 : 1;
    remark(scene::Severity::kWarning, is_given("spring") ? "spring" : "damping",
           fmt::format("springs damp node {} of '{}' with {:.3g} N s/m: they throw it back harder in every step, as "
                       "damping acts by the velocities at the beginning of a step",
                       worst - (end == 0 ? 0 : num_first), ends[end]->name(), damping[worst]));
  }

  std::vector<Spring> make(std::array<int, 2> num_nodes) {
    std::vector<Spring> springs = from_lists(num_nodes);
    if (is_given("spring")) springs = whole(num_nodes);
    for (Spring& spring : springs) spring.only_pulls = boolean("elongationOnly");
    return springs;
  }

  std::vector<Spring> whole(std::array<int, 2> num_nodes) {
    const std::vector<double>& numbers = reals("spring");
    if (numbers.size() % 5 != 0) reject("spring", fmt::format("{} numbers given, must be groups of 5", numbers.size()));
    std::vector<Spring> springs;
    for (auto n = numbers.begin(); n != numbers.end(); n += 5) {
      for (int end = 0; end < 2; ++end)
        if (n[end] != std::floor(n[end]) || n[end] < 0 || n[end] >= num_nodes[end])
          reject("spring",
                 fmt::format("{} is not a node{}, must be a whole number from 0 to {}", n[end],
                             states_[end] ? fmt::format(" of '{}'", states_[end]->name()) : "", num_nodes[end] - 1));
      for (int i = 2; i < 5; ++i)
        if (n[i] < 0) reject("spring", fmt::format("{} must be at least 0", n[i]));
      springs.push_back({static_cast<int>(n[0]), static_cast<int>(n[1]), n[2], n[3], n[4]});
    }
    return springs;
  }

  std::vector<Spring> from_lists(std::array<int, 2> num_nodes) {
    const std::vector<int> first = indices("indices1", num_nodes[0]), second = indices("indices2", num_nodes[1]);
    if (first.size() != second.size())
      reject("indices2",
             fmt::format("{} nodes given for {} of indices1, must be as many", second.size(), first.size()));
    std::vector<Spring> springs(first.size());
    const auto stiffness = values("stiffness", first.size()), damping = values("damping", first.size()),
               lengths = values("lengths", first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      springs[i] = {first[i], second[i], stiffness[i], damping[i], lengths[i]};
    return springs;
  }

  std::vector<double> values(const char* name, std::size_t count) {
    std::vector<double> given = reals(name);
    if (given.size() == 1) given.resize(count, given[0]);
    if (given.size() != count)
      reject(name, fmt::format("{} values given for {} springs, must be one or as many", given.size(), count));
    return given;
  }

  std::array<scene::MechanicalState*, 2> states_ = {};  // null: one state, the nearest
  Springs springs_;
  double rayleigh_stiffness_ = 0;
};

/// To the rest positions, or to where another state is at the moment.
class RestShapeSpringsForceField final : public scene::ForceField,
                                         public scene::Changeable,
                                         public scene::ShowsSprings {
 public:
  RestShapeSpringsForceField() : ForceField(attributes::kRestShapeSpringsForceField) {}

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    nodes_ = indices("points", state_->num_nodes());
    if (nodes_.empty()) {
      nodes_.resize(static_cast<std::size_t>(state_->num_nodes()));
      std::iota(nodes_.begin(), nodes_.end(), 0);
    }
    stiffness_ = reals("stiffness");
    if (stiffness_.size() == 1) stiffness_.resize(nodes_.size(), stiffness_[0]);
    if (stiffness_.size() != nodes_.size())
      reject("stiffness",
             fmt::format("{} values given for {} nodes, must be one or as many", stiffness_.size(), nodes_.size()));
    rayleigh_stiffness_ = real("rayleighStiffness");
    if (is_given("external_points") && !is_given("external_rest_shape"))
      reject("external_points", "given without external_rest_shape, the state that has them");
  }

  // When the other state has its points, which may stand behind it.
  void bwd_init() override {
    if (!is_given("external_rest_shape")) return;
    external_ = &linked<scene::MechanicalState>("external_rest_shape");
    const int num_points = external_->num_nodes();
    anchors_ = indices("external_points", num_points);
    if (!is_given("external_points")) {
      anchors_.resize(static_cast<std::size_t>(num_points));
      std::iota(anchors_.begin(), anchors_.end(), 0);
    }
    if (anchors_.size() != nodes_.size())
      reject(is_given("external_points") ? "external_points" : "external_rest_shape",
             fmt::format("{} points of '{}' for {} nodes, must be as many", anchors_.size(), external_->name(),
                         nodes_.size()));
    rest_ = state_->rest_positions();
  }

  void refresh(std::span<const std::string_view>) override {
    init();
    bwd_init();
  }

  void add_force(double, ConstPoints x, ConstPoints, Points f) override {
    for (std::size_t i = 0; i < anchors_.size(); ++i) rest_.row(nodes_[i]) = external_->positions().row(anchors_[i]);
    add_anchor_forces(nodes_, stiffness_, external_ ? rest_ : state_->rest_positions(), x, f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    for (std::size_t i = 0; i < nodes_.size(); ++i) df.row(nodes_[i]) -= factor * stiffness_[i] * dx.row(nodes_[i]);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      A.add(nodes_[i], nodes_[i], -factor * stiffness_[i] * Mat3::Identity());
  }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  std::vector<scene::SpringLine> spring_lines() const override {
    const SpringEnds ends(*state_);
    std::vector<scene::SpringLine> lines;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Vec3 to =
          external_ ? Vec3(external_->positions().row(anchors_[i])) : Vec3(state_->rest_positions().row(nodes_[i]));
      if (const std::optional from = ends.at(nodes_[i])) lines.push_back({*from, to});
    }
    return lines;
  }

 private:
  scene::MechanicalState* state_ = nullptr;
  std::vector<int> nodes_;
  std::vector<double> stiffness_;               // [N/m] of each
  scene::MechanicalState* external_ = nullptr;  // null: the rest positions count
  std::vector<int> anchors_;                    // node of the external state for each of the nodes
  PointArray rest_;                             // [m] where the external state has them
  double rayleigh_stiffness_ = 0;
};

}  // namespace

void add_springs(scene::Factory& factory) {
  factory.add<SpringForceField>(attributes::kSpringForceField);
  factory.add<RestShapeSpringsForceField>(attributes::kRestShapeSpringsForceField);
}

}  // namespace hexaplast::components
