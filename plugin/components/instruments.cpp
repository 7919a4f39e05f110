// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "attributes/hexaplast.hpp"
#include "components/components.hpp"
#include "components/key_times.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/grip.hpp"
#include "hexaplast/solve/loads.hpp"
#include "scene/interfaces.hpp"
#include "scene/load.hpp"
#include "scene/potential.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

class GraspForceField final : public scene::ForceField,
                              public scene::Load,
                              public scene::Instrument,
                              public scene::Potential {
 public:
  GraspForceField() : ForceField(attributes::kGraspForceField) {}

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    candidates_ = indices("indices", state_->num_nodes());
    if (!is_given("indices")) {
      candidates_.resize(state_->num_nodes());
      std::iota(candidates_.begin(), candidates_.end(), 0);
    }
    positions_ = vectors3("positions");
    times_ = key_times(*this, "keyTimes", "positions", static_cast<std::size_t>(positions_.rows()));
    grasp_time_ = real("graspTime");
    release_time_ = real_if_given("releaseTime").value_or(std::numeric_limits<double>::infinity());
    if (!(grasp_time_ < release_time_))
      reject("releaseTime", fmt::format("is {}, must be after graspTime {}", release_time_, grasp_time_));
    radius_ = real("radius");
    grip_.stiffness = real("stiffness");
    grip_.most_force = real_if_given("maxForce").value_or(std::numeric_limits<double>::infinity());
    grip_.damping = real("damping");
    rayleigh_stiffness_ = real("rayleighStiffness");
  }

  // A grip that is closed stays so.
  void refresh() override { init(); }

  // The grip closes and opens on accepted positions, once per step; between two steps it is the same for everyone.
  void begin_step() override {
    const double time = node().clock().time;
    if (!has_closed_ && time >= grasp_time_ && time < release_time_) close(time);
    if (time >= release_time_) open();
  }

  void reset() override {
    open();
    has_closed_ = false;
  }

  void serialize(Archive& archive) override {
    archive(grip_.nodes, grip_.arms, has_closed_, lags_, drag_.x(), drag_.y(), drag_.z());
    const auto num_held = static_cast<Eigen::Index>(grip_.nodes.size());
    if (grip_.arms.rows() != num_held || lags_.rows() != num_held ||
        std::ranges::any_of(grip_.nodes, [&](int node) { return node < 0 || node >= state_->num_nodes(); }))
      throw InputError("a grip is saved on nodes that are not there");
  }

  void add_force(double time, ConstPoints x, ConstPoints v, Points f) override {
    grip_.lags_at(tool_at(time), x, lags_);
    grip_.add_force(tool_at(time), x, f);
    drag_ = grip_.add_damping_force(tool_velocity_at(time), v, f);
  }
  void add_load(double time, ConstPoints x, ConstPoints, Points f) const override {
    grip_.add_force(tool_at(time), x, f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    grip_.add_stiffness_product(lags_, factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    grip_.add_stiffness_blocks(lags_, factor, A);
  }
  bool is_in_matrix() const override { return !grip_.nodes.empty(); }
  bool to_kernels(double factor, KernelSystem& system) const override {
    return grip_.add_stiffness_diagonal(lags_, factor, system.diagonal);
  }
  void add_damping_product(double factor, ConstPoints dx, Points df) const override {
    grip_.add_damping_product(factor, dx, df);
  }
  void add_damping_blocks(double factor, BlockMatrix& A) const override { grip_.add_damping_blocks(factor, A); }
  void add_damping_diagonal(double factor, Points diagonal) const override {
    grip_.add_damping_diagonal(factor, diagonal);
  }
  double potential_energy(double time, ConstPoints x) const override { return grip_.energy(tool_at(time), x); }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  std::optional<Vec3> place(double time) const override {
    if (grip_.nodes.empty()) return {};
    return tool_at(time);
  }

  void provide(scene::Data& output) override {
    if (output.attribute().name == "grasped")
      output.set(std::vector<std::int64_t>(grip_.nodes.begin(), grip_.nodes.end()));
    if (output.attribute().name == "force") {
      const Vec3 force = grip_.total_force(lags_) + drag_;
      output.set(std::vector<double>(force.begin(), force.end()));
    }
  }

 private:
  /// Before the first key time the tool waits where it begins.
  Vec3 tool_at(double time) const {
    return interpolate(phase_at(times_, std::max(time, times_.front())), positions_).transpose();
  }

  Vec3 tool_velocity_at(double time) const {
    const KeyPhase phase = phase_at(times_, time);
    const bool is_on_its_way = phase.key >= 0 && phase.key + 1 < static_cast<int>(times_.size());
    return is_on_its_way ? Vec3(slope(phase, times_, positions_).transpose()) : Vec3::Zero();
  }

  void close(double time) {
    has_closed_ = true;
    const Vec3 tool = tool_at(time);
    std::vector<int> held = nodes_near(state_->positions(), candidates_, tool, radius_);
    if (held.empty())
      remark(
          scene::Severity::kWarning, "radius",
          fmt::format("the grip closes on nothing: no node within {:.6g} m of ({:.6g}, {:.6g}, {:.6g}) at t = {:.6g} s",
                      radius_, tool[0], tool[1], tool[2], time));
    grip_.close(std::move(held), tool, state_->positions());
    lags_ = PointArray::Zero(grip_.arms.rows(), 3);
  }

  void open() {
    grip_.open();
    lags_.resize(0, 3);
    drag_.setZero();
  }

  scene::MechanicalState* state_ = nullptr;
  std::vector<int> candidates_;
  std::vector<double> times_;  // [s]
  PointArray positions_;       // [m] of the tool, one row per time
  double grasp_time_ = 0, release_time_ = 0, radius_ = 0;
  double rayleigh_stiffness_ = 0;

  Grip grip_;
  bool has_closed_ = false;
  PointArray lags_ = PointArray(0, 3);  // at the positions of the latest forces
  Vec3 drag_ = Vec3::Zero();            // [N] of the dashpots, with them
};

}  // namespace

void add_instruments(scene::Factory& factory) { factory.add<GraspForceField>(attributes::kGraspForceField); }

}  // namespace hexaplast::components
