// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hexaplast/solve/grip.hpp"
#include "parts/force.hpp"

namespace hexaplast::parts {

/// In scenes: GraspForceField.
struct GraspOptions {
  bool is_prescribed = false;  ///< the host moves the tool, closes and opens it: neither path nor times are given then
  std::vector<double> key_times = {};                 ///< [s] of the tool's path, ascending
  PointArray positions = PointArray(0, 3);            ///< [m] of the tool, one row per key time
  double grasp_time = 0;                              ///< [s]
  std::optional<double> release_time = std::nullopt;  ///< [s] never, where it is not given
  std::optional<double> radius = std::nullopt;        ///< [m] has to be given; where it is prescribed, it or indices
  std::optional<std::vector<int>> indices = std::nullopt;  ///< nodes that can be held; all where not given
  double stiffness = 1000;                                 ///< [N/m] of the grip as a whole
  std::optional<double> max_force = std::nullopt;          ///< [N] of the grip as a whole; no limit where not given
  double damping = 0;                                      ///< [N s/m] of the grip as a whole

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(key_times);
    HEXAPLAST_OPTION(positions);
    HEXAPLAST_OPTION(grasp_time);
    HEXAPLAST_OPTION(release_time);
    HEXAPLAST_OPTION(radius);
    HEXAPLAST_OPTION(indices);
    HEXAPLAST_OPTION(stiffness);
    HEXAPLAST_OPTION(max_force);
    HEXAPLAST_OPTION(damping);
  }
};

/// An instrument that takes hold of the nodes around it, moves along a path and lets go.
class Grasp final : public Force {
 public:
  using Options = GraspOptions;
  static const attributes::Description& description();
  static void outputs(const auto& visit) {
    visit("grasped", &Grasp::held_nodes);
    visit("force", &Grasp::force);
    visit("torque", &Grasp::torque);
  }

  /// Throws OptionError.
  Grasp(GraspOptions options, const Surroundings& around);

  /// Other options for the same nodes; a grip that is closed stays so. Throws OptionError.
  void set_options(GraspOptions options);

  /// Where the tool is [m] at the beginning and at the end of the steps that begin from now on, and whether it is
  /// closed in them, where that is prescribed. Its springs pull to where it is at the end of a step, and the
  /// integrator's Rayleigh stiffness, which would damp the motion of tool and nodes together, does not act on them.
  void prescribe(const Vec3& from, const Vec3& to, bool is_closed) {
    prescribed_ = {from, to};
    is_to_be_closed_ = is_closed;
  }

  /// Closes or opens the grip. Warns where it closes on nothing.
  void begin_step(const Step& step, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) override;

  /// Where it is prescribed, forces become those by which the step was solved: at its end.
  void end_step(const Pair<ConstPoints>& x) override;

  /// Copies of nodes that are held are held too.
  void nodes_changed(int state, const NodeCopies& copies, std::span<const int> split_from) override;

  /// Open, as it was made.
  void reset() override;

  /// Throws InputError for a grip on nodes that are not there.
  void serialize(Archive& archive) override;

  /// Forces of springs and dashpots; those of the springs alone are a load.
  void add_force(double time, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) override;
  void add_load(double time, const Pair<ConstPoints>& x, const Pair<ConstPoints>& /*v*/,
                Pair<Points> f) const override {
    grip_.add_force(tool_at(time), x.first, f.first);
  }

  /// [J] in the springs.
  std::optional<double> potential_energy(double time, ConstPoints x) const override {
    return grip_.energy(tool_at(time), x);
  }

  void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    grip_.add_stiffness_product(elongations_, factor, dx.first, df.first);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> /*first_nodes*/) const override {
    grip_.add_stiffness_blocks(elongations_, factor, A);
  }
  bool add_stiffness_diagonal(double factor, Points diagonal) const override {
    return grip_.add_stiffness_diagonal(elongations_, factor, diagonal);
  }
  void add_damping_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    grip_.add_damping_product(factor, dx.first, df.first);
  }
  void add_damping_blocks(double factor, BlockMatrix& A, std::array<int, 2> /*first_nodes*/) const override {
    grip_.add_damping_blocks(factor, A);
  }
  void add_damping_diagonal(double factor, Points diagonal) const override {
    grip_.add_damping_diagonal(factor, diagonal);
  }
  bool is_in_matrix() const override { return is_closed(); }
  double rayleigh_stiffness() const override { return -rayleigh_stiffness_; }

  bool is_closed() const { return !grip_.nodes.empty(); }
  std::span<const int> held_nodes() const { return grip_.nodes; }

  /// [m] Before the first key time the tool waits where it begins.
  Vec3 tool_at(double time) const;

  /// [N] what the tool exerted on the body when forces were computed last; where it is prescribed, in the latest step.
  Vec3 force() const { return grip_.total_force(elongations_) + drag_; }

  /// [N m] the moment of that force about the tool.
  Vec3 torque() const { return grip_.total_moment(elongations_) + drag_moment_; }

 private:
  Vec3 tool_velocity_at(double time) const;
  void close(const Vec3& tool, double time, ConstPoints x);
  void open();

  void spread_candidates();
  void share_out();

  int num_initial_, num_nodes_;
  GraspOptions options_;
  std::vector<int> candidates_;         // nodes that can be held
  const NodeCopies* copies_ = nullptr;  // null: no node has ever split
  double release_time_ = 0;             // [s] infinite: never

  Grip grip_;
  bool has_closed_ = false;
  std::array<Vec3, 2> prescribed_ = {Vec3::Zero(), Vec3::Zero()};
  bool is_to_be_closed_ = false;
  double dt_ = 1;                              // [s] of the present step
  double rayleigh_stiffness_ = 0;              // [s] of the integrator in it, that is not to act
  PointArray elongations_ = PointArray(0, 3);  // [m] of the springs, at the positions of the latest forces
  Vec3 drag_ = Vec3::Zero();                   // [N] of the dashpots, with them
  Vec3 drag_moment_ = Vec3::Zero();            // [N m] of these; no part of a checkpoint: the next step finds it anew
};

}  // namespace hexaplast::parts
