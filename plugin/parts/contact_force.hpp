// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/contact/contact_terms.hpp"
#include "parts/contact_options.hpp"
#include "parts/force.hpp"

namespace hexaplast::parts {

/// What all contacts of bodies are: forces that are linear in a step, of which those that would pull at its end are
/// released.
class ContactForce : public Force {
 public:
  static constexpr bool kIsContact = true;
  static void outputs(const auto& visit) {
    visit("force", [](const auto& part) { return part.contact().force(); });
    visit("depth", [](const auto& part) { return part.contact().depth(); });
    visit("touching", [](const auto& part) { return part.contact().num_touching(); });
    visit("slipping", [](const auto& part) { return part.contact().num_slipping(); });
  }

  /// The contacts of the present step.
  virtual const ContactTerms& terms() const = 0;

  virtual bool is_active() const = 0;

  /// Whether the bodies have the stiffness that the latest step began with.
  virtual bool is_of_present_bodies() const = 0;

  /// Without what the integrator adds by its Rayleigh stiffness.
  void add_force(double /*time*/, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) override {
    terms().add_force(x, v, f);
    if (rayleigh_stiffness_ != 0) terms().add_stiffness_product(-rayleigh_stiffness_, v, f);
  }
  void add_load(double /*time*/, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v,
                Pair<Points> f) const override {
    terms().add_force(x, v, f);
  }
  void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    terms().add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const override {
    terms().add_stiffness_blocks(factor, A, first_nodes);
  }
  void add_damping_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    terms().add_damping_product(factor, dx, df);
  }
  void add_damping_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const override {
    terms().add_damping_blocks(factor, A, first_nodes);
  }
  bool is_in_matrix() const override { return !terms().empty(); }
  bool is_one_sided() const override { return true; }
  double rayleigh_stiffness() const override { return -rayleigh_stiffness_; }

 protected:
  double rayleigh_stiffness_ = 0;  // [s] of the integrator, in the present step
};

}  // namespace hexaplast::parts
