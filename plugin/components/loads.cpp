// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "attributes/hexaplast.hpp"
#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

/// Prescribed forces: they do not depend on velocity and have no stiffness.
class Load : public scene::ForceField {
 public:
  using ForceField::ForceField;

  std::span<const int> loaded_nodes() const override { return loaded_; }
  bool to_kernels(double, KernelSystem&) const override { return true; }  // nothing to add
  void refresh() override { init(); }

 protected:
  void note_loaded(std::vector<int> nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    loaded_ = std::move(nodes);
  }

  int num_nodes() { return needed_ready<scene::MechanicalState>().num_nodes(); }

  /// `times`, ascending, with one entry of `forces` each.
  std::vector<double> key_times(std::size_t num_forces) {
    std::vector<double> times = reals("times");
    if (times.empty()) reject("times", "is empty, must hold at least one time");
    if (times.size() != num_forces)
      reject("forces", fmt::format("{} forces given for {} times, must be as many", num_forces, times.size()));
    const auto fault = std::adjacent_find(times.begin(), times.end(), std::greater_equal<>());
    if (fault != times.end())
      reject("times", fmt::format("{} is followed by {}, must be ascending", fault[0], fault[1]));
    return times;
  }

 private:
  std::vector<int> loaded_;
};

class ConstantForceField final : public Load {
 public:
  ConstantForceField() : Load(attributes::kConstantForceField) {}

  void init() override {
    const int count = num_nodes();
    nodes_ = indices("indices", count);
    if (!is_given("indices")) {
      nodes_.resize(count);
      std::iota(nodes_.begin(), nodes_.end(), 0);
    }
    forces_ = forces_of_nodes();
    note_loaded(nodes_);
  }

  void add_force(double, ConstPoints, ConstPoints, Points f) override {
    for (std::size_t i = 0; i < nodes_.size(); ++i) f.row(nodes_[i]) += forces_.row(static_cast<Eigen::Index>(i));
  }

 private:
  PointArray forces_of_nodes() {
    const auto count = static_cast<Eigen::Index>(nodes_.size());
    if (is_given("forces")) {
      if (is_given("totalForce")) remark(scene::Severity::kWarning, "totalForce", "is ignored: forces counts");
      const PointArray given = vectors3("forces");
      if (given.rows() == 1) return given.replicate(count, 1);
      if (given.rows() != count)
        reject("forces", fmt::format("{} forces given for {} nodes, must be one or as many", given.rows(), count));
      return given;
    }
    if (!is_given("totalForce")) reject("forces", "is not given, and totalForce neither: one of them is needed");
    return (vector3("totalForce") / static_cast<double>(count)).transpose().replicate(count, 1);
  }

  std::vector<int> nodes_;
  PointArray forces_;  // [N] one row per node
};

class LinearForceField final : public Load {
 public:
  LinearForceField() : Load(attributes::kLinearForceField) {}

  void init() override {
    nodes_ = indices("points", num_nodes());
    forces_ = vectors3("forces");
    times_ = key_times(static_cast<std::size_t>(forces_.rows()));
    factor_ = real("force");
    note_loaded(nodes_);
  }

  void add_force(double time, ConstPoints, ConstPoints, Points f) override {
    const KeyPhase phase = phase_at(times_, time);
    if (phase.key < 0) return;
    const bool is_over = phase.key + 1 == forces_.rows();  // then SOFA leaves the factor out
    const Eigen::RowVector3d force = (is_over ? 1 : factor_) * interpolate(phase, forces_);
    for (const int node : nodes_) f.row(node) += force;
  }

 private:
  std::vector<int> nodes_;
  std::vector<double> times_;  // [s]
  PointArray forces_;          // [N] one row per time
  double factor_ = 1;
};

class TangentialForceField final : public Load {
 public:
  TangentialForceField() : Load(attributes::kTangentialForceField) {}

  void init() override {
    nodes_ = indices("indices", num_nodes());
    group_size_ = integer("groupSize");
    if (nodes_.size() % static_cast<std::size_t>(group_size_) != 0)
      reject("indices", fmt::format("{} nodes do not form groups of {}", nodes_.size(), group_size_));
    axis_ = vector3("axis");
    if (axis_.isZero(0)) reject("axis", "is zero, must have a direction");
    centre_ = vector3("centre");
    forces_ = reals("forces");
    times_ = key_times(forces_.size());
    note_loaded(nodes_);
  }

  void add_force(double time, ConstPoints x, ConstPoints, Points f) override {
    const KeyPhase phase = phase_at(times_, time);
    if (phase.key < 0) return;
    add_tangential_forces(nodes_, group_size_, axis_, centre_, interpolate(phase, forces_), x, f);
  }

 private:
  std::vector<int> nodes_;
  int group_size_ = 1;
  Vec3 axis_ = Vec3::UnitZ(), centre_ = Vec3::Zero();
  std::vector<double> times_, forces_;  // [s], [N]
};

}  // namespace

void add_loads(scene::Factory& factory) {
  factory.add<ConstantForceField>(attributes::kConstantForceField);
  factory.add<LinearForceField>(attributes::kLinearForceField);
  factory.add<TangentialForceField>(attributes::kTangentialForceField);
}

}  // namespace hexaplast::components
