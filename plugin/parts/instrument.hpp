// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/contact/instrument_contact.hpp"
#include "parts/contact_force.hpp"

namespace hexaplast::parts {

/// In scenes: InstrumentContactForceField.
struct InstrumentOptions {
  enum class Shape { kSphere, kCapsule, kCylinder, kBox, kSurface };

  Shape shape = Shape::kSphere;
  std::optional<double> radius = std::nullopt;      ///< [m] of sphere, capsule, cylinder
  std::optional<double> length = std::nullopt;      ///< [m] of capsule, cylinder
  std::optional<Vec3> size = std::nullopt;          ///< [m] of box
  PointArray surface_positions = PointArray(0, 3);  ///< [m] of surface
  std::vector<Triangle> surface_triangles = {};
  PointArray embedded_positions = PointArray(0, 3);  ///< [m] of a surface that is embedded in the body and touched in
                                                     ///< place of its faces
  std::vector<Triangle> embedded_triangles = {};     ///< empty: the body's own faces are touched
  bool is_prescribed = false;                        ///< the host tells its poses; there is no path then
  std::vector<double> key_times = {};                ///< [s] of its path, ascending
  PointArray positions = PointArray(0, 3);           ///< [m] one row per key time
  std::vector<double> orientations = {};             ///< quaternions x y z w, one per key time, or none
  ContactOptions contact = {};

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(shape);
    HEXAPLAST_OPTION(radius);
    HEXAPLAST_OPTION(length);
    HEXAPLAST_OPTION(size);
    HEXAPLAST_OPTION(surface_positions);
    HEXAPLAST_OPTION(surface_triangles);
    HEXAPLAST_OPTION(embedded_positions);
    HEXAPLAST_OPTION(embedded_triangles);
    HEXAPLAST_OPTION(key_times);
    HEXAPLAST_OPTION(positions);
    HEXAPLAST_OPTION(orientations);
    ContactOptions::each(options.contact, visit);
  }
};

/// Where a pose gets to that keeps its velocities [m/s, rad/s] for a duration [s].
Pose moved(const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity, double duration);

/// A rigid instrument that moves along a path and touches a body.
class Instrument final : public ContactForce {
 public:
  using Options = InstrumentOptions;
  static const attributes::Description& description();
  static void outputs(const auto& visit) {
    ContactForce::outputs(visit);
    visit("torque", [](const Instrument& part) { return part.contact().torque(); });
  }

  /// Throws OptionError.
  Instrument(InstrumentOptions options, const Surroundings& around);

  /// Other options for the same body. What sticks goes on sticking, unless the shape is another one. Throws
  /// OptionError.
  void set_options(InstrumentOptions options);

  /// Warns where it is within the body, if it is active.
  void look_at_start(double time, const Pair<ConstPoints>& x) override;

  /// It goes on in the place of another one: where it is when it is first active is nothing to warn of.
  void go_on() { has_looked_ = has_looked_at_start_ = true; }

  /// Poses at the beginning and at the end of the steps that begin from now on, for one whose motion is prescribed.
  void prescribe(const Pose& from, const Pose& to) { prescribed_ = {from, to}; }

  /// Finds the contacts, by what the body is at present. Warns where it is within the body, in the first step in which
  /// it is active. Throws OptionError for a stiffness far beyond that of the body, or a damping.
  void begin_step(const Step& step, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) override;

  /// What touched goes on touching, on each side of what has opened.
  void nodes_changed(int state, const NodeCopies& copies, std::span<const int> split_from) override;

  /// Warns, once, that it is deeper than contact can hold it.
  void end_step(const Pair<ConstPoints>& x) override;

  void reset() override;
  void serialize(Archive& archive) override;

  const ContactTerms& terms() const override { return contact_->terms(); }
  bool is_active() const override { return options_.contact.active; }
  bool is_of_present_bodies() const override { return default_contact_stiffness(body_, edge_) == default_stiffness_; }
  bool release(const Pair<ConstPoints>& x_end, const Pair<ConstPoints>& v_end) override {
    return contact_->release(x_end.first, v_end.first);
  }

  const InstrumentOptions& options() const { return options_; }
  const InstrumentContact& contact() const { return *contact_; }

  Pose pose_at(double time) const;  ///< along its path

 private:
  ContactSettings accepted_settings(const ContactOptions& options, double stiffness) const;
  SurfaceSamples planned_samples(const Solid& solid) const;
  void make_samples(const SplitNodes& split = {});
  bool comes_near(ConstPoints x, ConstPoints v, double dt, const Pose& from, const Pose& to) const;
  bool path_comes_near(ConstPoints x) const;
  void look(const char* option, const char* begins, const Pose& pose, ConstPoints x);
  void follow_surface();  // where the body has another one since the last call

  const Body& body_;
  double edge_;                   // [m] of its hexahedra
  double default_stiffness_ = 0;  // [Pa/m] in the settings of the contact
  double young_modulus_ = 0;      // [Pa] of the body when the options were accepted
  long revision_ = 0;             // of the body, that the surface is of
  InstrumentOptions options_;
  std::optional<InstrumentContact> contact_;
  bool has_samples_ = false;  // made when it first comes near: they may be millions
  bool has_looked_ = false;   // where it is when it is first active
  bool has_looked_at_start_ = false;
  bool is_too_deep_ = false;  // and that was warned of
  std::array<Pose, 2> prescribed_ = {};
};

}  // namespace hexaplast::parts
