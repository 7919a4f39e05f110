// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/tissue_contact.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "attributes/contact.hpp"
#include "components/between_states.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

class TissueContactForceField final : public scene::OneSidedInteraction,
                                      public scene::Changeable,
                                      public scene::Stateful {
 public:
  TissueContactForceField() : OneSidedInteraction(attributes::kTissueContactForceField) {}

  std::array<scene::MechanicalState*, 2> states() const override { return states_; }

  void init() override {
    states_[0] = &linked<scene::MechanicalState>("object1");
    states_[1] = is_given("object2") ? &linked<scene::MechanicalState>("object2") : states_[0];
  }

  // Bodies and integrators may stand behind it.
  void bwd_init() override {
    for (std::size_t k = 0; k < 2; ++k) {
      const std::string_view object = k == 0 ? "object1" : "object2";
      body_fields_[k] = body_field_on(*states_[k]);
      if (!body_fields_[k])
        reject(object, fmt::format("leads to '{}', on which there is no body: contact is that of a body's surface",
                                   states_[k]->name()));
      for (const scene::Mapping* mapping : node().root().all<scene::Mapping>())
        if (mapping->output() == states_[k])
          reject(object, fmt::format("leads to '{}', which follows another state: must lead to one that an integrator "
                                     "moves",
                                     states_[k]->name()));
    }
    integrator_ = states_[0]->node().nearest<scene::OdeSolver>();
    if (integrator_ != states_[1]->node().nearest<scene::OdeSolver>())
      reject("object2", fmt::format("leads to '{}', which another integrator moves than '{}': bodies that touch need "
                                    "one EulerImplicitSolver and one linear solver in a node above both",
                                    states_[1]->name(), states_[0]->name()));
    require_implicit_euler(*this, integrator_, "above the bodies");
    accepted(*this, [&] { tissues_.emplace(options(), *body_fields_[0]->body(), *body_fields_[1]->body()); });
    tissues_->look_at_start(positions());
    pass_on(*this, tissues_->take_warnings());
    warn_of_same_pair();
  }

  void refresh(std::span<const std::string_view>) override {
    accepted(*this, [&] { tissues_->set_options(options()); });
    warn_of_same_pair();
  }

  void begin_step() override {
    accepted(*this, [&] {
      tissues_->begin_step(node().clock().dt, integrator_->real("rayleighStiffness"), positions(), velocities());
    });
    pass_on(*this, tissues_->take_warnings());
  }
  void end_step(double) override { tissues_->end_step(positions()); }
  void reset() override { tissues_->reset(); }
  void serialize(Archive& archive) override { tissues_->serialize(archive); }

  void add_force(double, const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) override {
    tissues_->add_force(x, v, f);
  }
  void add_stiffness_product(double factor, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const override {
    tissues_->contact().terms().add_stiffness_product(factor, dx, df);
  }
  void add_damping_product(double factor, const OfTwo<ConstPoints>& dx, OfTwo<Points> df) const override {
    tissues_->contact().terms().add_damping_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const override {
    tissues_->contact().terms().add_stiffness_blocks(factor, A, first_nodes);
  }
  void add_damping_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const override {
    tissues_->contact().terms().add_damping_blocks(factor, A, first_nodes);
  }
  bool is_in_matrix() const override { return !tissues_->contact().terms().empty(); }
  double rayleigh_stiffness() const override { return tissues_->rayleigh_stiffness(); }
  bool release(const OfTwo<ConstPoints>& x_end, const OfTwo<ConstPoints>& v_end) override {
    return tissues_->contact().release(x_end, v_end);
  }

  void provide(scene::Data& output) override {
    if (!tissues_) return;
    const TissueContact& contact = tissues_->contact();
    const std::string_view name = output.attribute().name;
    if (name == "force") output.set(std::vector<double>(contact.force().begin(), contact.force().end()));
    if (name == "depth") output.set(std::vector<double>{contact.depth()});
    if (name == "touching") output.set(std::vector<double>{1.0 * contact.num_touching()});
    if (name == "slipping") output.set(std::vector<double>{1.0 * contact.num_slipping()});
  }

 private:
  /// Once, of another active contact between the same bodies that was there before.
  void warn_of_same_pair() {
    if (has_warned_of_pair_ || !boolean("active")) return;
    for (auto* other : node().root().all<TissueContactForceField>()) {
      if (other == this || !other->tissues_ || other->has_warned_of_pair_ || !other->boolean("active") ||
          !std::ranges::is_permutation(states_, other->states_))
        continue;
      has_warned_of_pair_ = true;
      pass_on(*this, {parts::same_pair(other->name())});
      return;
    }
  }

  OfTwo<ConstPoints> positions() const {
    return {ConstPoints(states_[0]->positions()), ConstPoints(states_[1]->positions())};
  }
  OfTwo<ConstPoints> velocities() const {
    return {ConstPoints(states_[0]->velocities()), ConstPoints(states_[1]->velocities())};
  }
  parts::ContactOptions options() { return read_options<parts::ContactOptions>(*this); }

  std::array<scene::MechanicalState*, 2> states_ = {};
  std::array<scene::ForceField*, 2> body_fields_ = {};  // that have the bodies
  scene::OdeSolver* integrator_ = nullptr;
  std::optional<parts::Tissues> tissues_;
  bool has_warned_of_pair_ = false;
};

}  // namespace

void add_tissue_contact(scene::Factory& factory) {
  factory.add<TissueContactForceField>(attributes::kTissueContactForceField);
}

}  // namespace hexaplast::components
