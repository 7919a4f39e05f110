// SPDX-License-Identifier: LGPL-2.1-or-later
#include <limits>

#include "plain/plain.hpp"

namespace hexaplast::plain {

namespace {

constexpr double kFitted = 1e-26;  // E below this fraction of sum |t|^2 is rounding

Mat3 cross_matrix(const Vec3& r) { return Mat3{{0, -r.z(), r.y()}, {r.z(), 0, -r.x()}, {-r.y(), r.x(), 0}}; }

/// One step of the averaging, of the elements of the connected parts that move.
class Joining final : public LinearSystem {
 public:
  Joining(const Model& model, const std::vector<unsigned char>& changed, History& history)
      : model_(model), history_(history), parts_(connected_parts(model.mesh, history.alive)), moves_(parts_.count, 0) {
    const auto part_of = [&](int e) { return parts_.part_of_node[model.mesh.hexahedra()[e][0]]; };
    for (int e = 0; e < model.mesh.num_elements(); ++e)
      if (history.alive[e] && changed[e]) moves_[part_of(e)] = 1;
    chosen_ = history.alive;
    count_.assign(model.mesh.num_nodes(), 0);
    for (int e = 0; e < model.mesh.num_elements(); ++e) {
      chosen_[e] = history.alive[e] && moves_[part_of(e)];
      for (const int n : model.mesh.hexahedra()[e]) count_[n] += chosen_[e];
    }
    of_elements_.resize(chosen_.size());
    for (int n = 0; n < num_nodes(); ++n)
      if (count_[n] == 0) history.averaging_increment.row(n).setZero();
  }

  void step(LinearSolver& solver, AveragingReport& report) {
    const auto [E, size] = elements_->fit(model_, chosen_, history_, &of_elements_);
    if (!(E > kFitted * size)) return;
    PointArray gradient = PointArray::Zero(num_nodes(), 3);
    add_at_nodes(model_.mesh, chosen_, of_elements_, 1, gradient);
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
  /// Best rotations at the present positions into the rotation maps, unless these are the mode's own; returns E.
  ///                                                                                                           eq. 30
  double fit() { return elements_->fit(model_, chosen_, history_, nullptr).E; }

  // ---- the step                                                                                       eq. 31, 32

  void solve(const PointArray& before, const PointArray& gradient, bool projects, LinearSolver& solver,
             AveragingReport& report) {
    projects_ = projects;
    PointArray& dx = history_.averaging_increment;  // the latest one is a good guess
    SolverMemory none;
    const SolveReport solved = solver.solve_from_guess(*this, -gradient, dx, none);
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

  void apply(ConstPoints p, Points Ap) const override {
    Ap.setZero();
    elements_->find_products(p, projects_, of_elements_);
    add_at_nodes(model_.mesh, chosen_, of_elements_, 1, Ap);
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
  std::vector<unsigned char> moves_;   // per connected part
  std::vector<unsigned char> chosen_;  // per element: it is there, and its part moves
  std::vector<int> count_;             // of these elements around a node
  std::unique_ptr<AveragedElements> elements_ = make_averaged_elements();
  mutable std::vector<ElementPoints> of_elements_;  // scratch
  bool projects_ = false;                           // H + 1e-7 P, not P
};

}  // namespace

PreconditionedConjugateGradients averaging_solver(const Model& model) {
  constexpr int kMaxIterations = 10000;
  return {model.settings.averaging_tolerance, kMaxIterations, Preconditioner::kDiagonal};
}

AveragingReport join_rest_shapes(const Model& model, const std::vector<unsigned char>& changed, LinearSolver& solver,
                                 History& history) {
  AveragingReport report;
  Joining joining(model, changed, history);
  for (int step = 0; step < model.settings.averaging_steps; ++step) joining.step(solver, report);
  return report;
}

}  // namespace hexaplast::plain
