// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/grasp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "attributes/parts.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/key_times.hpp"
#include "parts/spread_nodes.hpp"
#include "solve/loads.hpp"

namespace hexaplast::parts {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void check(const GraspOptions& options, int num_nodes) {
  OptionRanges ranges(Grasp::description(), options);
  if (options.indices) ranges.collect([&] { check_nodes("indices", *options.indices, num_nodes); });
  if (!options.is_prescribed)
    ranges.collect([&] {
      check_key_times("key_times", options.key_times, "positions", static_cast<std::size_t>(options.positions.rows()));
    });
  if (ranges.accepts("grasp_time") && options.release_time && options.grasp_time >= *options.release_time)
    ranges.add(
        {"release_time", fmt::format("is {}, must be after graspTime {}", *options.release_time, options.grasp_time)});
  if (!options.radius && !(options.is_prescribed && options.indices)) ranges.add({"radius", "is not given"});
  ranges.throw_all();
}

}  // namespace

const attributes::Description& Grasp::description() { return attributes::kGraspForceField; }

Grasp::Grasp(GraspOptions options, const Surroundings& around)
    : num_initial_(around.num_nodes[0]), num_nodes_(num_initial_) {
  set_options(std::move(options));
}

void Grasp::set_options(GraspOptions options) {
  check(options, num_initial_);
  options_ = std::move(options);
  release_time_ = options_.release_time.value_or(kInfinity);
  spread_candidates();
  grip_.stiffness = options_.stiffness;
  grip_.max_force = options_.max_force.value_or(kInfinity);
  grip_.damping = options_.damping;
}

void Grasp::spread_candidates() {
  if (options_.indices) {
    candidates_ = spread(*options_.indices, copies_).nodes;
  } else {
    candidates_.resize(static_cast<std::size_t>(num_nodes_));
    std::iota(candidates_.begin(), candidates_.end(), 0);
  }
}

void Grasp::nodes_changed(int /*state*/, const NodeCopies& copies, std::span<const int> split_from) {
  const int num_before = copies.num_nodes() - static_cast<int>(split_from.size());
  copies_ = &copies;
  num_nodes_ = copies.num_nodes();
  spread_candidates();
  if (split_from.empty()) return open();  // what is read comes after
  for (std::size_t i = 0, num_held = grip_.nodes.size(); i < num_held; ++i)
    for (std::size_t k = 0; k < split_from.size(); ++k) {
      if (split_from[k] != grip_.nodes[i]) continue;
      grip_.nodes.push_back(num_before + static_cast<int>(k));
      for (PointArray* rows : {&grip_.arms, &elongations_}) {
        rows->conservativeResize(rows->rows() + 1, 3);
        rows->bottomRows(1) = rows->row(static_cast<Eigen::Index>(i)).eval();
      }
    }
  share_out();
}

// Where no node has split, a grip has the bits of one that knows of none.
void Grasp::share_out() {
  grip_.weights.clear();
  if (copies_ && copies_->is_split()) grip_.share_out(copies_->share());
}

void Grasp::begin_step(const Step& step, const Pair<ConstPoints>& x, const Pair<ConstPoints>& /*v*/) {
  dt_ = step.dt;
  if (options_.is_prescribed) {
    rayleigh_stiffness_ = step.rayleigh_stiffness;
    if (is_to_be_closed_ && !has_closed_) close(prescribed_[0], step.time, x.first);
    if (!is_to_be_closed_) reset();
    return;
  }
  const bool is_over = has_come(release_time_, step.time);
  if (!has_closed_ && has_come(options_.grasp_time, step.time) && !is_over)
    close(tool_at(step.time), step.time, x.first);
  if (is_over) open();
}

// In the step the nodes have moved by what their springs have become shorter, and dashpots act by that velocity.
void Grasp::end_step(const Pair<ConstPoints>& x) {
  if (!options_.is_prescribed) return;
  const PointArray begin = elongations_;
  grip_.elongations_at(prescribed_[1], x.first, elongations_);
  drag_.setZero();
  drag_moment_.setZero();
  if (grip_.nodes.empty()) return;
  const Vec3 tool_velocity = tool_velocity_at(0);
  for (Eigen::Index i = 0; i < begin.rows(); ++i) {
    const Vec3 velocity = (begin.row(i) - elongations_.row(i)).transpose() / dt_,
               force = grip_.part(grip_.damping, static_cast<std::size_t>(i)) * (tool_velocity - velocity);
    drag_ += force;
    drag_moment_ += (grip_.arms.row(i) - elongations_.row(i)).transpose().cross(force);
  }
}

void Grasp::reset() {
  open();
  has_closed_ = false;
}

void Grasp::serialize(Archive& archive) {
  std::vector<int> nodes = grip_.nodes;
  PointArray arms = grip_.arms, elongations = elongations_;
  Vec3 drag = drag_;
  bool has_closed = has_closed_;
  archive(nodes, arms, has_closed, elongations, drag.x(), drag.y(), drag.z());
  const auto num_held = static_cast<Eigen::Index>(nodes.size());
  if (arms.rows() != num_held || elongations.rows() != num_held ||
      std::ranges::any_of(nodes, [&](int node) { return node < 0 || node >= num_nodes_; }))
    throw InputError("a grip is saved on nodes that are not there");
  if (!arms.allFinite() || !elongations.allFinite() || !drag.allFinite())
    throw InputError("a grip is saved with numbers that are not finite");
  grip_.nodes = std::move(nodes);
  grip_.arms = std::move(arms);
  share_out();
  elongations_ = std::move(elongations);
  drag_ = drag;
  drag_moment_.setZero();
  has_closed_ = has_closed;
}

void Grasp::add_force(double time, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) {
  const Vec3 tool = tool_at(time);
  grip_.elongations_at(tool, x.first, elongations_);
  grip_.add_force(tool, x.first, f.first);
  const Vec3 tool_velocity = tool_velocity_at(time);
  drag_ = grip_.add_damping_force(tool_velocity, v.first, f.first);
  if (rayleigh_stiffness_ != 0) grip_.add_stiffness_product(elongations_, -rayleigh_stiffness_, v.first, f.first);
  drag_moment_ = grip_.damping_moment(elongations_, tool_velocity, v.first);
}

Vec3 Grasp::tool_at(double time) const {
  if (options_.is_prescribed) return prescribed_[1];
  const std::vector<double>& times = options_.key_times;
  return interpolate(phase_at(times, std::max(time, times.front())), options_.positions).transpose();
}

Vec3 Grasp::tool_velocity_at(double time) const {
  if (options_.is_prescribed) return (prescribed_[1] - prescribed_[0]) / dt_;
  const std::vector<double>& times = options_.key_times;
  const int key = static_cast<int>(num_come(times, time)) - 1;
  const bool is_on_its_way = key >= 0 && key + 1 < static_cast<int>(times.size());
  return is_on_its_way ? Vec3(slope({.key = key}, times, options_.positions).transpose()) : Vec3::Zero();
}

void Grasp::close(const Vec3& tool, double time, ConstPoints x) {
  std::vector<int> held = nodes_near(x, candidates_, tool, options_.radius.value_or(kInfinity));
  if (held.empty())
    warn("radius",
         fmt::format("the grip closes on nothing: no node within {:.6g} m of ({:.6g}, {:.6g}, {:.6g}) at t = {:.6g} s",
                     options_.radius.value_or(kInfinity), tool[0], tool[1], tool[2], time));
  grip_.close(std::move(held), tool, x);
  share_out();
  elongations_ = PointArray::Zero(grip_.arms.rows(), 3);
  has_closed_ = true;
}

void Grasp::open() {
  grip_.open();
  elongations_.resize(0, 3);
  drag_.setZero();
  drag_moment_.setZero();
}

}  // namespace hexaplast::parts
