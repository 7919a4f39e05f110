// SPDX-License-Identifier: LGPL-2.1-or-later
#include <limits>

#include "plain/plain.hpp"
#include "plastic/averaging.hpp"
#include "plastic/rest_shape.hpp"

namespace hexaplast::plain {

namespace {

Mat3 cross_matrix(const Vec3& r) { return Mat3{{0, -r.z(), r.y()}, {r.z(), 0, -r.x()}, {-r.y(), r.x(), 0}}; }

/// One step of the averaging, of the elements of the connected parts that move.
class Joining final : public LinearSystem {
 public:
  Joining(const Model& model, const std::vector<unsigned char>& changed, History& history)
      : model_(model), history_(history), parts_(connected_parts(model.mesh, history.alive)), moves_(parts_.count, 0) {
    const auto part_of = [&](int e) { return parts_.part_of_node[model.mesh.hexahedra()[e][0]]; };
    for (int e = 0; e < model.mesh.num_elements(); ++e)
      if (history.alive[e] && changed[e]) moves_[part_of(e)] = 1;
    count_.assign(model.mesh.num_nodes(), 0);
    for (int e = 0; e < model.mesh.num_elements(); ++e) {
      if (!history.alive[e] || !moves_[part_of(e)]) continue;
      elements_.push_back(e);
      for (const int n : model.mesh.hexahedra()[e]) ++count_[n];
    }
    arms_.resize(elements_.size());
    inverse_inertia_.resize(elements_.size());
    for (int n = 0; n < num_nodes(); ++n)
      if (count_[n] == 0) history.averaging_increment.row(n).setZero();
  }

  void step(LinearSolver& solver, AveragingReport& report) {
    double size = 0;  // sum |t|^2
    PointArray gradient = PointArray::Zero(num_nodes(), 3);
    const double E = fit(&gradient, &size);
    if (!(E > kFitted * size)) return;
    report.skipped = false;
    remove_means(gradient);  // which are rounding, and outside the range of H and P
    const PointArray before = history_.plastic_rest_positions;

    if (model_.settings.averaging == AveragingMethod::kJacobi) {
      PointArray dx = PointArray::Zero(num_nodes(), 3);
      precondition(-gradient, dx);
      move(before, dx);
    } else if (model_.maps_per_element() > 1) {
      solve(before, gradient, false, solver, report);
    } else {
      solve(before, gradient, true, solver, report);
      if (fit() <= E) return;
      report.fell_back = true;  // far from the fit the step may overshoot; the local/global step never raises E
      history_.plastic_rest_positions = before;
      fit();
      solve(before, gradient, false, solver, report);
    }
  }

 private:
  // ---- the fit                                                                                             eq. 30

  /// Best rotations at the present positions into the rotation maps, unless these are the mode's own; returns E. Adds
  /// g = sum_k (x_i - c_k - t_i) and sum |t|^2 where given.
  double fit(PointArray* gradient = nullptr, double* size = nullptr) {
    const std::size_t maps = model_.maps_per_element();
    double E = 0;
    for (std::size_t k = 0; k < elements_.size(); ++k) {
      const std::size_t e = elements_[k];
      const Hexahedron& corners = model_.mesh.hexahedra()[e];
      const ElementPoints x = about_mean(gather(history_.plastic_rest_positions, corners));
      const ElementPoints& y = history_.rest_shape[e];
      if (maps == 1) history_.rotation_map[e] = fit_rotation(y, x);
      ElementPoints t;
      for (int i = 0; i < kCorners; ++i) {
        const Mat3& Pi = history_.rotation_map[e * maps + (maps == 1 ? 0 : i)];
        t.row(i) = (Pi * y.row(i).transpose()).transpose();
      }
      t = about_mean(t);
      E += (x - t).squaredNorm();
      if (!gradient) continue;
      *size += t.squaredNorm();
      for (int i = 0; i < kCorners; ++i) gradient->row(corners[i]) += x.row(i) - t.row(i);
      arms_[k] = model_.turns_isolated_shapes ? t : x;
      // B^T B; the floor keeps the free turn of a shape out that is flattened to a line
      const Mat3 spread = arms_[k].transpose() * arms_[k];
      inverse_inertia_[k] = (spread.trace() * (1 + 1e-14) * Mat3::Identity() - spread).inverse();
    }
    return E;
  }

  // ---- the step                                                                                       eq. 31, 32

  void solve(const PointArray& before, const PointArray& gradient, bool projects, LinearSolver& solver,
             AveragingReport& report) {
    projects_ = projects;
    PointArray& dx = history_.averaging_increment;  // the latest one is a good guess
    const SolveReport solved = solver.solve_from_guess(*this, -gradient, dx);
    report.iterations += solved.iterations;
    report.residual = solved.residual;
    report.converged = report.converged && solved.converged;
    move(before, dx);
  }

  /// x = before + dx, less the mean of dx over every connected part and, of a Gauss-Newton step, its rotation.
  void move(const PointArray& before, PointArray& dx) {
    remove_means(dx);
    if (projects_ && !model_.turns_isolated_shapes) remove_rotations(before, dx);
    history_.plastic_rest_positions = before + dx;
  }

  /// Sum of f(node) over the nodes of each connected part.
  template <class T, class F>
  std::vector<T> sums(const T& zero, const F& f) const {
    std::vector<T> sum(parts_.count, zero);
    for (int n = 0; n < num_nodes(); ++n)
      if (const int part = parts_.part_of_node[n]; part >= 0) sum[part] += f(n, part);
    return sum;
  }

  void remove_means(PointArray& field) const {
    const auto count = sums(0, [](int, int) { return 1; });
    const auto sum = sums(Vec3(Vec3::Zero()), [&](int n, int) -> Vec3 { return field.row(n).transpose(); });
    for (int n = 0; n < num_nodes(); ++n) {
      const int part = parts_.part_of_node[n];
      if (part < 0)
        field.row(n).setZero();
      else
        field.row(n) -= (sum[part] / count[part]).transpose();
    }
  }

  void remove_rotations(const PointArray& x, PointArray& dx) const {
    const auto count = sums(0, [](int, int) { return 1; });
    const auto sum = sums(Vec3(Vec3::Zero()), [&](int n, int) -> Vec3 { return x.row(n).transpose(); });
    const auto arm = [&](int n, int part) -> Vec3 { return x.row(n).transpose() - sum[part] / count[part]; };
    const auto moment =
        sums(Vec3(Vec3::Zero()), [&](int n, int part) -> Vec3 { return arm(n, part).cross(Vec3(dx.row(n))); });
    const auto inertia = sums(Mat3(Mat3::Zero()), [&](int n, int part) -> Mat3 {
      const Mat3 r = cross_matrix(arm(n, part));
      return -r * r;
    });
    std::vector<Vec3> turn;
    for (int part = 0; part < parts_.count; ++part) turn.emplace_back(inertia[part].ldlt().solve(moment[part]));
    for (int n = 0; n < num_nodes(); ++n)
      if (const int part = parts_.part_of_node[n]; part >= 0) dx.row(n) -= turn[part].cross(arm(n, part)).transpose();
  }

  // ---- H + 1e-7 P, or P, as a linear system

  int num_nodes() const override { return model_.mesh.num_nodes(); }

  /// Of one element: P u, or (1 + 1e-7) P u - B (B^T B)^-1 B^T u with B_i = -[arm_i]x.                          eq. 32
  ElementPoints element_product(std::size_t k, const ElementPoints& u) const {
    ElementPoints Au = about_mean(u);  // P u
    if (!projects_) return Au;
    Vec3 moment = Vec3::Zero();  // B^T u
    for (int i = 0; i < kCorners; ++i) moment += Vec3(arms_[k].row(i)).cross(Vec3(Au.row(i)));
    const Vec3 turn = inverse_inertia_[k] * moment;
    Au *= 1 + kRegularisation;
    for (int i = 0; i < kCorners; ++i) Au.row(i) -= turn.cross(Vec3(arms_[k].row(i))).transpose();
    return Au;
  }

  void apply(ConstPoints p, Points Ap) const override {
    Ap.setZero();
    for (std::size_t k = 0; k < elements_.size(); ++k) {
      const Hexahedron& corners = model_.mesh.hexahedra()[elements_[k]];
      const ElementPoints product = element_product(k, gather(p, corners));
      for (int a = 0; a < kCorners; ++a) Ap.row(corners[a]) += product.row(a);
    }
  }

  // pinned: nodes that do not move, and the first one of each part, which may be translated
  void assemble(BlockMatrix& A) const override {
    for (std::size_t k = 0; k < elements_.size(); ++k) {
      const Hexahedron& corners = model_.mesh.hexahedra()[elements_[k]];
      for (int b = 0; b < kCorners; ++b) {
        std::array<Mat3, kCorners> column;
        for (int axis = 0; axis < 3; ++axis) {
          ElementPoints unit = ElementPoints::Zero();
          unit(b, axis) = 1;
          const ElementPoints product = element_product(k, unit);
          for (int a = 0; a < kCorners; ++a) column[a].col(axis) = product.row(a).transpose();
        }
        for (int a = 0; a < kCorners; ++a) A.add(corners[a], corners[b], column[a]);
      }
    }
    std::vector<bool> pinned(parts_.count, false);
    for (int n = 0; n < num_nodes(); ++n) {
      const int part = parts_.part_of_node[n];
      if (count_[n] > 0 && pinned[part]) continue;
      A.add(n, n, Mat3::Identity());
      if (count_[n] > 0) pinned[part] = true;
    }
  }

  void precondition(ConstPoints r, Points z) const override {
    for (int n = 0; n < num_nodes(); ++n)
      if (count_[n] > 0)
        z.row(n) = r.row(n) / count_[n];
      else
        z.row(n).setZero();
  }

  // b adds eight differences of positions at each node
  double rounding() const override {
    return 4 * std::numeric_limits<double>::epsilon() * history_.plastic_rest_positions.norm();
  }

  const Model& model_;
  History& history_;
  ConnectedParts parts_;
  std::vector<unsigned char> moves_;  // per connected part
  std::vector<int> elements_;         // of the parts that move
  std::vector<int> count_;            // of these elements around a node
  // per one of these elements
  std::vector<ElementPoints> arms_;    // [m]
  std::vector<Mat3> inverse_inertia_;  // [1/m^2] (B^T B)^-1
  bool projects_ = false;              // H + 1e-7 P, not P
};

}  // namespace

AveragingReport join_rest_shapes(const Model& model, const std::vector<unsigned char>& changed, LinearSolver& solver,
                                 History& history) {
  AveragingReport report;
  Joining joining(model, changed, history);
  for (int step = 0; step < model.settings.averaging_steps; ++step) joining.step(solver, report);
  return report;
}

}  // namespace hexaplast::plain
