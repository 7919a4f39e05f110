// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/contact/tissue_contact.hpp"
#include "parts/contact_options.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// A warning of another contact between the same bodies.
Remark same_pair(std::string_view other);

/// Two bodies that touch, or one that touches itself. In scenes: TissueContactForceField.
class Tissues {
 public:
  /// Throws OptionError. The bodies must outlive it; one body twice touches itself.
  Tissues(const ContactOptions& options, const Body& first, const Body& second);

  /// Other options for the same bodies. What sticks goes on sticking, unless max_subdivision is another one. Throws
  /// OptionError.
  void set_options(const ContactOptions& options);

  /// Remarks bodies that overlap at the beginning, if it is active. x [m].
  void look_at_start(const OfTwo<ConstPoints>& x);

  /// What it remarked on the way here.
  std::vector<Remark> take_warnings() { return std::exchange(warnings_, {}); }

  /// Finds the contacts of a step of dt [s], by what the bodies are at present. Remarks bodies that overlap in the
  /// first step in which it is active. rayleigh_stiffness [s]: that of the time integrator, which does not act on
  /// contact. Throws OptionError for a stiffness far beyond that of the bodies, or a damping.
  void begin_step(double dt, double rayleigh_stiffness, const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v);

  void end_step(const OfTwo<ConstPoints>& x) { contact_->end_step(x); }

  void reset();
  void serialize(Archive& archive);

  /// f += forces [N] of the present step, without what the integrator adds by its Rayleigh stiffness.
  void add_force(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) const;

  const TissueContact& contact() const { return *contact_; }
  TissueContact& contact() { return *contact_; }

  /// Whether the bodies have the stiffness that the latest step began with.
  bool is_of_present_bodies() const { return default_stiffness() == default_stiffness_; }

  /// To be given for this force field to the system matrix: it takes back what the integrator adds.
  double rayleigh_stiffness() const { return -rayleigh_stiffness_; }

 private:
  void set_surface(TissueContact& contact) const { contact.set_alive(bodies_[0]->alive(), bodies_[1]->alive()); }
  std::array<std::size_t, 2> num_removed() const {
    return {bodies_[0]->removed().size(), bodies_[1]->removed().size()};
  }
  void follow_surface();  // where hexahedra have gone since the last call
  void look(const char* to_touch, const OfTwo<ConstPoints>& x);
  ContactSettings accepted_settings(const ContactOptions& options, double stiffness) const;
  double default_stiffness() const;
  std::array<double, 2> young_moduli() const;  // [Pa] the greatest of each body

  std::array<const Body*, 2> bodies_;
  std::array<double, 2> edges_;              // [m] of their hexahedra
  double default_stiffness_ = 0;             // [Pa/m] in the settings of the contact
  std::array<double, 2> young_moduli_ = {};  // [Pa] when the options were accepted
  std::array<std::size_t, 2> num_removed_ = {};
  ContactOptions options_;
  std::optional<TissueContact> contact_;
  double rayleigh_stiffness_ = 0;
  bool has_looked_ = false;  // whether they overlap when it is first active
  bool has_looked_at_start_ = false;
  std::vector<Remark> warnings_;
};

}  // namespace hexaplast::parts
