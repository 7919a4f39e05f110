// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/plastic/averaging.hpp"

#include <Eigen/Cholesky>
#include <limits>
#include <numeric>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/plastic/rest_shape.hpp"

namespace hexaplast {

namespace {

constexpr double kFitted = 1e-26;         // E below this share of sum |t|^2 is rounding
constexpr double kRegularisation = 1e-7;  // of P: keeps free rotations of the whole body definite

/// sum_i t_i x d_i over the rows.
Vec3 moment(const ElementPoints& t, const ElementPoints& d) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < kCorners; ++i) sum += t.row(i).transpose().cross(d.row(i).transpose());
  return sum;
}

/// Rows w x t_i: the infinitesimal rotation B w.
ElementPoints rotated(const ElementPoints& t, const Vec3& w) {
  ElementPoints turned;
  for (int i = 0; i < kCorners; ++i) turned.row(i) = w.cross(t.row(i).transpose()).transpose();
  return turned;
}

/// (B^T B)^-1 = (sum_i |t_i|^2 I - t_i t_i^T)^-1; a shape flattened to a line has no inverse: its free turn is left
/// out.
Mat3 inverse_inertia(const ElementPoints& t) {
  const Mat3 inertia = t.squaredNorm() * Mat3::Identity() - t.transpose() * t;
  return inertia.ldlt().solve(Mat3::Identity());
}

}  // namespace

/// P or H of eq. 31 as a linear system: the per-element projections differ, all else is shared.
class Averaging::LocalGlobal : public LinearSystem {
 public:
  LocalGlobal(const Model& model, const Averaging& averaging, const History& history)
      : model_(model), averaging_(averaging), alive_(history.alive) {}

  int num_nodes() const override { return model_.mesh.num_nodes(); }

  void apply(ConstPoints p, Points Ap) const override {
    parallel_for(model_.mesh.num_elements(), [&](int e) {
      averaging_.corner_[e] = alive_[e] ? element_product(e, about_mean(gather(p, model_.mesh.hexahedra()[e])))
                                        : ElementPoints(ElementPoints::Zero());
    });
    Ap.setZero();
    scatter(model_.mesh, averaging_.corner_, Ap);
  }

  // column by column through apply's own element product; the translations of each part are pinned at its first node
  void assemble(BlockMatrix& A) const override {
    for (int e = 0; e < model_.mesh.num_elements(); ++e) {
      if (!alive_[e]) continue;
      const Hexahedron& corners = model_.mesh.hexahedra()[e];
      for (int b = 0; b < kCorners; ++b) {
        CornerTensors column;
        for (int axis = 0; axis < 3; ++axis) {
          ElementPoints unit = ElementPoints::Zero();
          unit(b, axis) = 1;
          const ElementPoints product = element_product(e, about_mean(unit));
          for (int a = 0; a < kCorners; ++a) column[a].col(axis) = product.row(a).transpose();
        }
        for (int a = 0; a < kCorners; ++a) A.add(corners[a], corners[b], column[a]);
      }
    }
    std::vector<bool> pinned(averaging_.parts_.count, false);
    for (int n = 0; n < num_nodes(); ++n) {
      const int part = averaging_.parts_.part_of_node[n];
      if (part >= 0 && pinned[part]) continue;
      A.add(n, n, Mat3::Identity());
      if (part >= 0) pinned[part] = true;
    }
  }

  void precondition(ConstPoints r, Points z) const override {
    parallel_for(num_nodes(), [&](int n) {
      const double weight = averaging_.node_weight_[n];
      if (weight > 0)
        z.row(n) = r.row(n) / weight;
      else
        z.row(n).setZero();
    });
  }

  // b adds differences of positions
  double rounding() const override { return std::numeric_limits<double>::epsilon() * averaging_.before_.norm(); }

 protected:
  /// centred: the element's rows about their mean.
  virtual ElementPoints element_product(int, const ElementPoints& centred) const { return centred; }

  const Model& model_;
  const Averaging& averaging_;
  const std::vector<unsigned char>& alive_;
};

class Averaging::GaussNewton final : public LocalGlobal {
 public:
  using LocalGlobal::LocalGlobal;

 protected:
  ElementPoints element_product(int e, const ElementPoints& centred) const override {
    const ElementPoints& t = averaging_.target_[e];
    const Vec3 spin = averaging_.inverse_inertia_[e] * moment(t, centred);
    return (1 + kRegularisation) * centred - rotated(t, spin);
  }
};

Averaging::Averaging(const Model& model)
    : num_removed_(std::numeric_limits<std::size_t>::max()),
      node_weight_(model.mesh.num_nodes()),
      target_(model.mesh.num_elements()),
      inverse_inertia_(model.mesh.num_elements()),
      corner_(model.mesh.num_elements()),
      misfit_(model.mesh.num_elements()),
      gradient_(model.mesh.num_nodes(), 3),
      increment_(model.mesh.num_nodes(), 3),
      before_(model.mesh.num_nodes(), 3) {}

const ConnectedParts& Averaging::parts(const Model& model, const History& history) {
  if (num_removed_ != history.removed.size()) {
    num_removed_ = history.removed.size();
    parts_ = connected_parts(model.mesh, history.alive);
    shift_.resize(parts_.count);
    for (int n = 0; n < model.mesh.num_nodes(); ++n) {
      node_weight_[n] = 0;
      for (const auto& [element, corner] : model.mesh.incident(n)) node_weight_[n] += history.alive[element];
    }
  }
  return parts_;
}

double Averaging::fit(const Model& model, History& history) {
  const bool fits_rotations = model.maps_per_element() == 1;
  parallel_for(model.mesh.num_elements(), [&](int e) {
    if (!history.alive[e]) {
      target_[e].setZero();
      corner_[e].setZero();
      misfit_[e] = 0;
      return;
    }
    const ElementPoints x = about_mean(gather(history.material, model.mesh.hexahedra()[e]));
    const ElementPoints& y = history.rest_shape[e];
    if (fits_rotations) {
      history.rotation_map[e] = fit_rotation(y, x);
      target_[e] = y * history.rotation_map[e].transpose();
    } else {
      for (int i = 0; i < kCorners; ++i)
        target_[e].row(i) = y.row(i) * history.rotation_map[e * kCorners + i].transpose();
      target_[e] = about_mean(target_[e]);
    }
    corner_[e] = x - target_[e];
    misfit_[e] = corner_[e].squaredNorm();
  });
  return std::accumulate(misfit_.begin(), misfit_.end(), 0.0);
}

double Averaging::misfit(const Model& model, const History& history) {
  parallel_for(model.mesh.num_elements(), [&](int e) {
    if (!history.alive[e]) return;
    const ElementPoints x = about_mean(gather(history.material, model.mesh.hexahedra()[e]));
    const ElementPoints& y = history.rest_shape[e];
    misfit_[e] = (y * fit_rotation(y, x).transpose() - x).squaredNorm();
  });
  return std::accumulate(misfit_.begin(), misfit_.end(), 0.0);
}

void Averaging::keep_means() {
  std::fill(shift_.begin(), shift_.end(), Shift{});
  for (int n = 0; n < increment_.rows(); ++n) {
    const int part = parts_.part_of_node[n];
    if (part < 0) continue;
    shift_[part].sum += increment_.row(n).transpose();
    ++shift_[part].count;
  }
  for (int n = 0; n < increment_.rows(); ++n) {
    const int part = parts_.part_of_node[n];
    if (part < 0)
      increment_.row(n).setZero();
    else
      increment_.row(n) -= (shift_[part].sum / shift_[part].count).transpose();
  }
}

void Averaging::step(const Model& model, LinearSolver& solver, History& history, AveragingReport& report) {
  const double E = fit(model, history);
  double size = 0;
  for (const ElementPoints& t : target_) size += t.squaredNorm();
  if (!(E > kFitted * size)) return;
  report.skipped = false;

  gradient_.setZero();
  scatter(model.mesh, corner_, gradient_);
  gradient_ *= -1;
  before_ = history.material;
  const auto move = [&] {
    keep_means();
    history.material = before_ + increment_;
    ++history.version;
    return misfit(model, history);
  };
  const auto solve = [&](const LinearSystem& system) {
    const SolveReport solved = solver.solve(system, gradient_, increment_);
    report.iterations += solved.iterations;
    report.residual = solved.residual;
    report.converged = report.converged && solved.converged;
    return move();
  };

  const LocalGlobal local_global(model, *this, history);
  const AveragingMethod method = model.settings.averaging;
  if (method == AveragingMethod::kJacobi) {
    local_global.precondition(gradient_, increment_);
    move();
  } else if (method == AveragingMethod::kLocalGlobal || model.maps_per_element() > 1) {
    solve(local_global);
  } else {
    parallel_for(model.mesh.num_elements(), [&](int e) { inverse_inertia_[e] = inverse_inertia(target_[e]); });
    if (solve(GaussNewton(model, *this, history)) > E) {
      // far from the fit the projected step may overshoot; the local/global step never raises E
      report.fell_back = true;
      solve(local_global);
    } else {
      // a turn of the whole part costs next to nothing in eq. 31 and comes out with little accuracy: the maps follow
      // it, so that rest shapes and thresholds do not feel it
      fit(model, history);
    }
  }
}

AveragingReport Averaging::advance(const Model& model, LinearSolver& solver, History& history) {
  parts(model, history);
  AveragingReport report;
  for (int step_number = 0; step_number < model.settings.averaging_steps; ++step_number)
    step(model, solver, history, report);
  return report;
}

}  // namespace hexaplast
