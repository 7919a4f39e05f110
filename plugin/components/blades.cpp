// SPDX-License-Identifier: LGPL-2.1-or-later
#include <optional>

#include "components/body_field.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/blade.hpp"
#include "scene/blade.hpp"
#include "scene/scene.hpp"

namespace hexaplast::components {
namespace {

class BladeController final : public scene::Blade, public scene::Changeable {
 public:
  BladeController() : Blade(parts::Blade::description()) {}

  // Bodies may be declared later.
  void bwd_init() override {
    field_ = &needed_body(*this);
    if (!field_->body()) throw scene::DependencyFailure{};
    state_ = field_->node().nearest<scene::MechanicalState>();
    accepted(*this, [&] { part_.emplace(read_options<parts::BladeOptions>(*this), *field_->body()); });
    scene::require_followers(*field_);
  }

  void refresh(std::span<const std::string_view>) override {
    accepted(*this, [&] { part_->set_options(read_options<parts::BladeOptions>(*this)); });
  }

  void begin_step() override {
    const scene::Clock& clock = node().clock();
    part_->begin_step({.time = clock.time, .dt = clock.dt, .rayleigh_stiffness = 0}, state_->positions());
  }

  scene::ForceField& field() override { return *field_; }

  std::span<const int> joints() override {
    try {
      return part_->end_step(state_->positions());
    } catch (const InputError& error) {
      reject(error.what());
    }
  }

 private:
  scene::ForceField* field_ = nullptr;
  scene::MechanicalState* state_ = nullptr;
  std::optional<parts::Blade> part_;
};

}  // namespace

void add_blades(scene::Factory& factory) { factory.add<BladeController>(parts::Blade::description()); }

}  // namespace hexaplast::components
