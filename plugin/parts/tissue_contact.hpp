// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "hexaplast/body.hpp"
#include "hexaplast/contact/tissue_contact.hpp"
#include "parts/contact_force.hpp"

namespace hexaplast::parts {

/// Two bodies that touch, or one that touches itself. In scenes: TissueContactForceField.
class Tissues final : public ContactForce {
 public:
  using Options = ContactOptions;
  static constexpr int kNumStates = 2;
  static const attributes::Description& description();

  /// Throws OptionError. One body twice touches itself.
  Tissues(const ContactOptions& options, const Surroundings& around);

  /// Other options for the same bodies. What sticks goes on sticking, unless max_subdivision is another one. Throws
  /// OptionError.
  void set_options(const ContactOptions& options);

  /// Warns of bodies that overlap, if it is active.
  void look_at_start(double time, const Pair<ConstPoints>& x) override;

  /// Warns, once, that another one is active between the same bodies.
  void warn_of_same_pair(std::string_view other);

  /// Finds the contacts, by what the bodies are at present. Warns of bodies that overlap in the first step in which it
  /// is active. Throws OptionError for a stiffness far beyond that of the bodies, or a damping.
  void begin_step(const Step& step, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) override;
  void end_step(const Pair<ConstPoints>& x) override { contact_->end_step(x); }

  void nodes_changed(int state, const NodeCopies& copies, std::span<const int> split_from) override;

  void reset() override;
  void serialize(Archive& archive) override;

  const ContactTerms& terms() const override { return contact_->terms(); }
  bool is_active() const override { return options_.active; }
  bool is_of_present_bodies() const override { return default_stiffness() == default_stiffness_; }
  bool release(const Pair<ConstPoints>& x_end, const Pair<ConstPoints>& v_end) override {
    return contact_->release(x_end, v_end);
  }

  const TissueContact& contact() const { return *contact_; }

 private:
  void set_surface(TissueContact& contact, const std::array<SplitNodes, 2>& split = {}) const {
    contact.set_alive(bodies_[0]->alive(), bodies_[1]->alive(), split);
  }
  std::array<long, 2> revisions() const { return {bodies_[0]->revision(), bodies_[1]->revision()}; }
  void follow_surface();  // where a body has another one since the last call
  void look(const char* to_touch, const Pair<ConstPoints>& x);
  ContactSettings accepted_settings(const ContactOptions& options, double stiffness) const;
  double default_stiffness() const;
  std::array<double, 2> young_moduli() const;  // [Pa] the greatest of each body

  std::array<const Body*, 2> bodies_;
  std::array<double, 2> edges_;              // [m] of their hexahedra
  double default_stiffness_ = 0;             // [Pa/m] in the settings of the contact
  std::array<double, 2> young_moduli_ = {};  // [Pa] when the options were accepted
  std::array<long, 2> revisions_ = {};       // of the bodies, that the surfaces are of
  ContactOptions options_;
  std::optional<TissueContact> contact_;
  bool has_looked_ = false;  // whether they overlap when it is first active
  bool has_looked_at_start_ = false;
};

}  // namespace hexaplast::parts
