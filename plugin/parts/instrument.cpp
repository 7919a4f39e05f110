// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/instrument.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "attributes/contact.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "parts/path.hpp"

namespace hexaplast::parts {
namespace {

constexpr double kPerRadius = 0.5;  // distance of samples, in smallest radii of the instrument
constexpr double kDeep = 0.1;       // of that radius: an instrument may touch at the beginning

/// Eigen compares only what has as many rows.
bool are_same(const PointArray& first, const PointArray& second) {
  return first.rows() == second.rows() && first == second;
}

void check_motion(OptionRanges& ranges, const InstrumentOptions& options) {
  if (options.is_prescribed) {
    if (!options.key_times.empty() || options.positions.rows() > 0 || !options.orientations.empty())
      ranges.add(
          {"key_times", "a path is given besides a rigid frame that prescribes the motion: only one of them can"});
    return;
  }
  check_path(ranges, options.key_times, options.positions, options.orientations);
}

template <class Size>
const Size& given(const std::optional<Size>& size, std::string_view option, std::string_view shape) {
  if (!size) throw OptionError(option, fmt::format("is not given: a {} has one", shape));
  return *size;
}

Solid solid_of(const InstrumentOptions& options) {
  using enum InstrumentOptions::Shape;
  switch (options.shape) {
    case kCapsule:
      return Solid::capsule(given(options.radius, "radius", "capsule"), given(options.length, "length", "capsule"));
    case kCylinder:
      return Solid::cylinder(given(options.radius, "radius", "cylinder"), given(options.length, "length", "cylinder"));
    case kBox:
      return Solid::box(given(options.size, "size", "box"));
    case kSurface:
      try {
        return Solid::closed_surface(options.surface_positions, options.surface_triangles);
      } catch (const InputError& error) {
        throw OptionError("surface_triangles", error.what());
      }
    case kSphere:
      break;
  }
  return Solid::sphere(given(options.radius, "radius", "sphere"));
}

void check_triangles(OptionRanges& ranges, std::string_view option, const std::vector<Triangle>& triangles,
                     const PointArray& points) {
  ranges.collect([&] {
    for (const Triangle& triangle : triangles) check_nodes(option, triangle, static_cast<int>(points.rows()));
  });
}

void check(const InstrumentOptions& options) {
  OptionRanges ranges(Instrument::description(), options);
  check_triangles(ranges, "surface_triangles", options.surface_triangles, options.surface_positions);
  check_triangles(ranges, "embedded_triangles", options.embedded_triangles, options.embedded_positions);
  check_motion(ranges, options);
  if (options.embedded_positions.rows() > 0 && options.embedded_triangles.empty())
    ranges.add({"embedded_positions", "given without embeddedTriangles, which make a surface of them"});
  ranges.throw_all();
}

template <class Make>
SurfaceSamples fitting_samples(const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {  // too many for the memory
    throw OptionError("max_subdivision", error.what());
  }
}

}  // namespace

Pose moved(const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity, double duration) {
  const double angle = duration * angular_velocity.norm();
  const Eigen::AngleAxisd turn(angle, angle > 0 ? Vec3(angular_velocity.normalized()) : Vec3::UnitZ());
  return {pose.position + duration * velocity, Eigen::Quaterniond(turn) * pose.orientation};
}

const attributes::Description& Instrument::description() { return attributes::kInstrumentContactForceField; }

Instrument::Instrument(InstrumentOptions options, const Surroundings& around)
    : body_(*around.bodies[0]), edge_(mean_edge(body_)) {
  set_options(std::move(options));
}

void Instrument::set_options(InstrumentOptions options) {
  check(options);
  const double stiffness = default_contact_stiffness(body_, edge_);
  const ContactSettings settings = accepted_settings(options.contact, stiffness);
  options.contact.check_distance(edge_);
  const bool has_same_shape = contact_ && options.shape == options_.shape && options.radius == options_.radius &&
                              options.length == options_.length && options.size == options_.size &&
                              options.contact.max_subdivision == options_.contact.max_subdivision &&
                              options.surface_triangles == options_.surface_triangles &&
                              options.embedded_triangles == options_.embedded_triangles &&
                              are_same(options.embedded_positions, options_.embedded_positions) &&
                              are_same(options.surface_positions, options_.surface_positions);
  std::optional<Solid> other;
  if (!has_same_shape) other = solid_of(options);
  options_ = std::move(options);
  default_stiffness_ = stiffness;
  if (!contact_ || options_.contact.active) young_modulus_ = greatest_young_modulus(body_);
  if (has_same_shape) return contact_->set_settings(settings);
  const Solid& solid = *other;
  SurfaceSamples samples = planned_samples(solid);
  const double wanted = kPerRadius * solid.smallest_radius();
  if (samples.spacing > (1 + 1e-6) * wanted)
    warn("maxSubdivision",
         fmt::format("samples of the surface are up to {:.3g} m apart; {:.3g} m, half of the instrument's smallest "
                     "radius, would be needed so that nothing of it slips between them",
                     samples.spacing, wanted));
  revision_ = body_.revision();
  contact_.emplace(solid, settings, std::move(samples));
  has_samples_ = false;
}

/// Of stiffnesses that were accepted before, a refusal says what has changed since.
ContactSettings Instrument::accepted_settings(const ContactOptions& options, double stiffness) const {
  try {
    return options.settings(stiffness);
  } catch (const OptionError& refusal) {
    if (!contact_ || !options.has_stiffness_of(options_.contact)) throw;
    throw softened(refusal, "the body that it touches", young_modulus_, greatest_young_modulus(body_));
  }
}

SurfaceSamples Instrument::planned_samples(const Solid& solid) const {
  const double wanted = kPerRadius * solid.smallest_radius();
  const int max_parts = options_.contact.max_subdivision;
  return fitting_samples([&] {
    if (options_.embedded_triangles.empty())
      return SurfaceSamples::planned_on(body_.mesh(), body_.alive(), wanted, max_parts);
    return SurfaceSamples::planned_on_embedded(options_.embedded_positions, options_.embedded_triangles, wanted,
                                               max_parts);
  });
}

void Instrument::make_samples(const SplitNodes& split) {
  const double wanted = kPerRadius * contact_->solid().smallest_radius();
  const int max_parts = options_.contact.max_subdivision;
  if (!has_samples_) contact_->set_samples({});  // gives back the memory that was planned
  contact_->set_samples(fitting_samples([&] {
                          if (options_.embedded_triangles.empty())
                            return SurfaceSamples::on(body_.mesh(), body_.alive(), wanted, max_parts);
                          return SurfaceSamples::on_embedded(body_.mesh(), body_.alive(), options_.embedded_positions,
                                                             options_.embedded_triangles, wanted, max_parts);
                        }),
                        split);
  has_samples_ = true;
}

/// An embedded surface may reach beyond the nodes, whose box tells nothing of it.
bool Instrument::comes_near(ConstPoints x, ConstPoints v, double dt, const Pose& from, const Pose& to) const {
  return options_.contact.active && (!options_.embedded_triangles.empty() || contact_->can_touch(x, v, dt, from, to));
}

void Instrument::look_at_start(double time, const Pair<ConstPoints>& x) {
  if (!options_.contact.active) return;
  if (options_.is_prescribed) {
    look("rigid", "begins", prescribed_[0], x.first);
  } else {
    look("positions", "begins", pose_at(time), x.first);
    if (!path_comes_near(x.first))
      warn("positions",
           "the path never comes near the body as it is at the beginning: nothing is touched unless the body moves "
           "there; are both in metres?");
  }
  has_looked_at_start_ = true;
}

/// Whether some part of the path reaches the box around the surface.
bool Instrument::path_comes_near(ConstPoints x) const {
  const ConstPoints surface = options_.embedded_triangles.empty() ? x : ConstPoints(options_.embedded_positions);
  const double reach = contact_->solid().reach() + accepted_settings(options_.contact, default_stiffness_).distance;
  const Eigen::AlignedBox3d near(surface.colwise().minCoeff().transpose().array() - 1.01 * reach,
                                 surface.colwise().maxCoeff().transpose().array() + 1.01 * reach);
  const std::vector<double>& times = options_.key_times;
  for (std::size_t k = 0; k < times.size(); ++k) {
    Eigen::AlignedBox3d way(pose_at(times[k]).position);
    way.extend(pose_at(times[std::min(k + 1, times.size() - 1)]).position);
    if (way.intersects(near)) return true;
  }
  return false;
}

void Instrument::look(const char* option, const char* begins, const Pose& pose, ConstPoints x) {
  has_looked_ = true;
  if (!comes_near(x, x, 0, pose, pose)) return;
  if (!has_samples_) make_samples();
  const Solid& solid = contact_->solid();
  double depth = 0;
  for (const SurfaceSamples::Sample& sample : contact_->samples().samples) {
    const Vec3 own = pose.to_own(sample.at(x));
    if (own.norm() < solid.reach()) depth = std::max(depth, -solid.distance(own).value);
  }
  if (depth > kDeep * solid.smallest_radius()) {
    warn(option, fmt::format("it {} {:.3g} m deep in the body, which is pushed out", begins, depth));
  } else if (depth == 0 && options_.embedded_triangles.empty()) {  // the cage of an embedded surface reaches beyond it
    const PointArray place = pose.position.transpose();
    const auto beyond = (x.rowwise() - place.row(0)).array();
    if ((beyond.colwise().minCoeff() > 0).any() || (beyond.colwise().maxCoeff() < 0).any()) return;
    if (Embedding(x, body_.mesh().hexahedra(), place).num_outside() == 0)
      warn(option,
           fmt::format("it {} within the body and reaches no point of its surface: nothing pushes it out", begins));
  }
}

void Instrument::follow_surface() {
  if (body_.revision() == revision_) return;
  revision_ = body_.revision();
  if (has_samples_) make_samples();
}

void Instrument::nodes_changed(int /*state*/, const NodeCopies& copies, std::span<const int> split_from) {
  if (split_from.empty()) return;  // reset and serialize follow
  if (has_samples_) make_samples({copies.num_nodes() - static_cast<int>(split_from.size()), split_from});
  revision_ = body_.revision();
}

Pose Instrument::pose_at(double time) const {
  return pose_on_path(options_.key_times, options_.positions, options_.orientations, time);
}

void Instrument::begin_step(const Step& step, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) {
  const bool follows_path = !options_.is_prescribed;
  const Pose from = follows_path ? pose_at(step.time) : prescribed_[0],
             to = follows_path ? pose_at(step.time + step.dt) : prescribed_[1];
  follow_surface();
  default_stiffness_ = default_contact_stiffness(body_, edge_);
  contact_->set_settings(accepted_settings(options_.contact, default_stiffness_));
  options_.contact.check_damping(default_stiffness_, step.dt);
  rayleigh_stiffness_ = step.rayleigh_stiffness;
  if (options_.contact.active && !has_looked_) look("active", "becomes active", from, x.first);
  // once, as an event: no step after it allocates for them
  if (!has_samples_ && comes_near(x.first, v.first, step.dt, from, to)) make_samples();
  contact_->begin_step(x.first, v.first, step.dt, from, to);
}

void Instrument::end_step(const Pair<ConstPoints>& x) {
  contact_->end_step(x.first);
  const double radius = contact_->solid().smallest_radius();
  if (is_too_deep_ || !(contact_->depth() > radius)) return;
  is_too_deep_ = true;
  warn("contactStiffness", fmt::format("{:.3g} m of the instrument are within the body, more than half of its smallest "
                                       "thickness ({:.3g} m): a stiffer contact holds it farther out",
                                       contact_->depth(), radius));
}

void Instrument::reset() {
  has_looked_ = has_looked_at_start_;
  is_too_deep_ = false;
  contact_->reset();
  follow_surface();
}

void Instrument::serialize(Archive& archive) {
  bool has_samples = has_samples_;
  archive(has_samples);
  if (archive.reads()) {
    revision_ = body_.revision();
    has_looked_ = options_.contact.active;
    if (has_samples) {
      make_samples();
    } else {
      contact_->set_samples({});
      contact_->set_samples(planned_samples(contact_->solid()));
      has_samples_ = false;
    }
  }
  follow_surface();
  contact_->serialize(archive);
}

}  // namespace hexaplast::parts
