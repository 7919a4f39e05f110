// SPDX-License-Identifier: LGPL-2.1-or-later
#include "released_shape.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "kinematics/polar.hpp"

namespace hexaplast {

namespace {

constexpr int kMaxSolves = 100;
constexpr int kMaxHalvings = 6;
constexpr std::size_t kAndersonVectors = 6;
constexpr double kTolerance = 1e-4;        // of Model::length: change of a node at which iterations end
constexpr double kLinearTolerance = 1e-3;  // of a linear system: the next one corrects what it leaves
constexpr double kRegularisation = 1e-6;   // of the stiffness: holds the free motions, which no force drives

// Energies that are admitted, of the one before. Steps of Newton turn hexahedra by lengthening them, which the next one
// repairs: where they had to lower the energy, a bar of Poisson's ratio .499 that was bent by 3 rad took more than 30.
constexpr double kIncreaseByAnderson = 1.001;
constexpr double kIncreaseByNewton = 10;

/// - df/dx, with a little stiffness of every node against its place.
class FreeStiffness final : public LinearSystem {
 public:
  FreeStiffness(const Body& body, const std::vector<double>& nodal) : body_(body), nodal_(nodal) {}

  int num_nodes() const override { return body_.mesh().num_nodes(); }
  void apply(ConstPoints p, Points Ap) const override {
    for (int n = 0; n < num_nodes(); ++n) Ap.row(n) = nodal_[n] * p.row(n);
    body_.add_stiffness_product(-1, p, Ap);
  }
  bool matrix_free(MatrixFreeSystem& system) const override {
    system.diagonal.resize(num_nodes(), 3);
    for (int n = 0; n < num_nodes(); ++n) system.diagonal.row(n).setConstant(nodal_[n]);
    system.constraints.reset(num_nodes());
    body_.add_operator(-1, system);
    return true;
  }

 private:
  const Body& body_;
  const std::vector<double>& nodal_;  // [N/m]
};

/// Stiffness E L of the hexahedra around each node, times the regularisation [N/m].
std::vector<double> regularisation(const Model& model) {
  std::vector<double> nodal(model.mesh.num_nodes(), 0);
  double greatest = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const double stiffness = model.material(e).young_modulus * std::cbrt(model.volume[e]);
    greatest = std::max(greatest, stiffness);
    for (const int n : model.mesh.hexahedra()[e]) nodal[n] += kRegularisation * stiffness / kCorners;
  }
  for (double& of_node : nodal)
    if (of_node == 0) of_node = kRegularisation * greatest;  // which has no hexahedron
  return nodal;
}

/// Lays each connected part on its initial positions, as well as a rigid motion can; other nodes lie there.
class RigidGauge {
 public:
  RigidGauge(const HexMesh& mesh, std::span<const unsigned char> alive)
      : X_(mesh.positions()), parts_(connected_parts(mesh, alive)) {}

  void place(PointArray& x) const {
    struct Part {
      double count = 0;
      Vec3 from = Vec3::Zero(), to = Vec3::Zero();
      Mat3 moment = Mat3::Zero(), R;
    };
    std::vector<Part> parts(parts_.count);
    const auto for_each = [&](const auto& act) {
      for (Eigen::Index n = 0; n < x.rows(); ++n)
        if (const int part = parts_.part_of_node[n]; part >= 0)
          act(n, parts[part]);
        else
          x.row(n) = X_.row(n);
    };
    for_each([&](Eigen::Index n, Part& part) {
      ++part.count;
      part.from += x.row(n);
      part.to += X_.row(n);
    });
    for (Part& part : parts) part.from /= part.count, part.to /= part.count;
    for_each([&](Eigen::Index n, Part& part) {
      part.moment += (X_.row(n).transpose() - part.to) * (x.row(n) - part.from.transpose());
    });
    for (Part& part : parts) part.R = polar(part.moment).R;
    for_each([&](Eigen::Index n, Part& part) {
      x.row(n) = (part.to + part.R * (x.row(n).transpose() - part.from)).transpose();
    });
  }

 private:
  const PointArray& X_;
  ConnectedParts parts_;
};

/// Anderson's acceleration of x <- x + r(x): the combination of the latest steps that leaves the least r.
class Anderson {
 public:
  /// x + r, as far as the steps before tell where it leads.
  PointArray next(const PointArray& x, const PointArray& r) {
    if (before_x_.rows() > 0) {
      dx_.push_back(x - before_x_);
      dr_.push_back(r - before_r_);
      if (dx_.size() > kAndersonVectors) dx_.pop_front(), dr_.pop_front();
    }
    before_x_ = x;
    before_r_ = r;
    PointArray next = x + r;
    if (dx_.empty()) return next;
    Eigen::MatrixXd changes(r.size(), static_cast<Eigen::Index>(dr_.size()));
    for (std::size_t k = 0; k < dr_.size(); ++k)
      changes.col(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::VectorXd>(dr_[k].data(), r.size());
    const Eigen::VectorXd weights =
        changes.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(r.data(), r.size()));
    for (std::size_t k = 0; k < dr_.size(); ++k) next -= weights[static_cast<Eigen::Index>(k)] * (dx_[k] + dr_[k]);
    return next;
  }

  void forget() {
    dx_.clear();
    dr_.clear();
    before_x_.resize(0, 3);
  }

 private:
  std::deque<PointArray> dx_, dr_;
  PointArray before_x_ = PointArray(0, 3), before_r_;
};

/// Moves x to the equilibrium of a body that nothing holds, or to the least energy on the way there.
ReleaseReport release(Body& body, PointArray& x) {
  const Model& model = body.state().model;
  const RigidGauge gauge(model.mesh, body.alive());
  const std::vector<double> nodal = regularisation(model);
  PreconditionedConjugateGradients solver(kLinearTolerance, 500, Preconditioner::kMultigrid);
  Anderson anderson;
  ReleaseReport report;
  gauge.place(x);  // parts may be others than when it was found
  PointArray force, step(x.rows(), 3), best = x;
  double energy = body.energy(x), least = energy;
  const auto admits = [&](const PointArray& trial, double increase) {
    const double reached = trial.allFinite() ? body.energy(trial) : std::numeric_limits<double>::infinity();
    if (!(reached <= increase * energy)) return false;
    energy = reached;
    return true;
  };
  // the next x; false where there is none
  const auto advance = [&] {
    body.linearize(x);
    force.setZero(x.rows(), 3);
    body.add_force(force);
    solver.solve(FreeStiffness(body, nodal), force, step);
    PointArray next = x + step;
    gauge.place(next);
    report.change = std::sqrt((next - x).rowwise().squaredNorm().maxCoeff());
    report.converged = report.change <= kTolerance * model.length;

    PointArray trial = anderson.next(x, next - x);
    gauge.place(trial);
    if (!admits(trial, kIncreaseByAnderson)) {
      anderson.forget();
      trial = std::move(next);
      for (int halvings = 0; !admits(trial, kIncreaseByNewton); ++halvings) {
        if (halvings == kMaxHalvings) return false;
        step /= 2;
        trial = x + step;
        gauge.place(trial);
      }
    }
    x = std::move(trial);
    return true;
  };

  try {
    while (!report.converged && report.solves < kMaxSolves && advance()) {
      ++report.solves;
      if (energy >= least) continue;
      least = energy;
      best = x;
    }
  } catch (const NumericalError&) {  // of the linear solver
    report.converged = false;
  }
  if (!report.converged) x = best;
  return report;
}

Body elastic(const Model& model) {
  std::vector<Material> materials;
  materials.reserve(model.materials.size());
  for (const Material& material : model.materials)
    materials.push_back({.young_modulus = material.young_modulus, .poisson_ratio = material.poisson_ratio});
  Settings settings = model.settings;
  settings.precision = Precision::kDouble;
  settings.relaxation.clear();  // which is over
  settings.implementation = Implementation::kAuto;
  return {model.mesh, std::move(materials), settings};
}

}  // namespace

const PointArray& ReleasedShape::positions(const Model& model, const History& history) {
  if (version_ == history.version) return positions_;
  Body body = elastic(model);
  History& held = body.state().history;
  held.plastic_inverse = history.plastic_inverse;
  held.has_flowed = history.has_flowed;
  held.alive = history.alive;
  ++held.version;
  positions_ = model.mesh.positions();  // not the latest one: the same bits after a resume
  report_ = release(body, positions_);
  version_ = history.version;
  return positions_;
}

}  // namespace hexaplast
