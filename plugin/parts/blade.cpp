// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/blade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "attributes/parts.hpp"
#include "parts/path.hpp"

namespace hexaplast::parts {
namespace {

constexpr double kSame = 1e-9;  // of a step: a key time so near to its ends is one of them

}  // namespace

const attributes::Description& Blade::description() { return attributes::kBladeController; }

Blade::Blade(BladeOptions options, const Body& body) : body_(body), cut_(body.initial_mesh(), body.joints()) {
  set_options(std::move(options));
}

void Blade::set_options(BladeOptions options) {
  OptionRanges ranges(description(), options);
  if (ranges.accepts("points") && options.points.rows() < 2)
    ranges.add({"points", fmt::format("{} given, must be at least two", options.points.rows())});
  if (!options.is_prescribed) check_path(ranges, options.key_times, options.positions, options.orientations);
  ranges.throw_all();
  options_ = std::move(options);
  reach_ = options_.points.rowwise().norm().maxCoeff();
}

void Blade::begin_step(const Step& step, ConstPoints x) {
  step_.reset();
  if (!options_.active) return;
  step_ = step;
  x_before_ = x;
}

const std::vector<int>& Blade::end_step(ConstPoints x) {
  if (!step_ || body_.joints().count() == 0) return none_;
  if (revision_ != body_.revision()) {
    is_open_.assign(static_cast<std::size_t>(body_.joints().count()), 0);
    for (const int joint : body_.opened()) is_open_[static_cast<std::size_t>(joint)] = 1;
    revision_ = body_.revision();
  }
  find_moments();
  return cut_.opened(body_.mesh().hexahedra(), x_before_, x, std::span(moments_).first(num_moments_), is_open_);
}

Pose Blade::pose_at(double time) const {
  return pose_on_path(options_.key_times, options_.positions, options_.orientations, time);
}

Pose Blade::pose_at_fraction(double fraction) const {
  if (options_.is_prescribed) return Pose::between(prescribed_[0], prescribed_[1], fraction);
  return pose_at(fraction == 1 ? step_->time + step_->dt : step_->time + fraction * step_->dt);
}

/// At its key times within a step, and as often in between that points at the end of the blade move straight: on the
/// arc of an angle a and a radius r they are a^2 r / 8 away from that at most.
void Blade::find_moments() {
  num_moments_ = 0;
  add_moment(0);
  const auto turn_to = [&](double fraction) {
    const double from = moments_[num_moments_ - 1].fraction;
    const double angle = pose_at_fraction(from).orientation.angularDistance(pose_at_fraction(fraction).orientation);
    const double num_parts = std::max(1.0, std::ceil(angle * std::sqrt(reach_ / (8 * cut_.tolerance()))));
    for (double part = 1; part < num_parts; ++part) add_moment(from + (fraction - from) * (part / num_parts));
    add_moment(fraction);
  };
  if (!options_.is_prescribed)
    for (const double key : options_.key_times) {
      const double fraction = (key - step_->time) / step_->dt;
      if (fraction > kSame && fraction < 1 - kSame) turn_to(fraction);
    }
  turn_to(1);
}

void Blade::add_moment(double fraction) {
  if (num_moments_ == moments_.size()) moments_.emplace_back();
  BladeAt& moment = moments_[num_moments_++];
  moment.fraction = fraction;
  moment.points.resize(options_.points.rows(), 3);
  const Pose pose = pose_at_fraction(fraction);
  for (Eigen::Index k = 0; k < options_.points.rows(); ++k)
    moment.points.row(k) = pose.to_world(options_.points.row(k).transpose()).transpose();
}

}  // namespace hexaplast::parts
