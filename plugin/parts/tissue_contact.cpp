// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/tissue_contact.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "attributes/contact.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {
namespace {

constexpr double kOverlap = 0.1;  // of an edge: bodies may overlap at the beginning

}  // namespace

const attributes::Description& Tissues::description() { return attributes::kTissueContactForceField; }

Tissues::Tissues(const ContactOptions& options, const Surroundings& around)
    : bodies_(around.bodies), edges_{mean_edge(*bodies_[0]), mean_edge(*bodies_[1])} {
  set_options(options);
}

void Tissues::set_options(const ContactOptions& options) {
  OptionRanges(description(), options).throw_all();
  const double stiffness = default_stiffness();
  const ContactSettings settings = accepted_settings(options, stiffness);
  std::optional<TissueContact> other;
  if (!contact_ || options.max_subdivision != options_.max_subdivision) {
    try {
      other.emplace(bodies_[0]->mesh(), bodies_[1]->mesh(), settings, options.max_subdivision);
    } catch (const InputError& error) {  // too many samples for the memory
      throw OptionError("max_subdivision", error.what());
    }
    set_surface(*other);
    if (!contact_) other->reset();  // nothing has changed since it was made
    if (bodies_[0]->copies().is_split()) other->begin_where_they_are();
  }
  // contact is looked for in the cells around a point
  if (const double edge = (other ? *other : *contact_).edge(); edge > 0) options.check_distance(edge);
  options_ = options;
  default_stiffness_ = stiffness;
  if (!contact_ || options.active) young_moduli_ = young_moduli();
  if (other) {
    contact_ = std::move(other);
    revisions_ = revisions();
  } else {
    contact_->set_settings(settings);
  }
}

/// Of stiffnesses that were accepted before, a refusal says what has changed since.
ContactSettings Tissues::accepted_settings(const ContactOptions& options, double stiffness) const {
  try {
    return options.settings(stiffness);
  } catch (const OptionError& refusal) {
    if (!contact_ || !options.has_stiffness_of(options_)) throw;
    const std::array now = young_moduli();
    const std::size_t k = now[0] / edges_[0] < now[1] / edges_[1] ? 0 : 1;  // that has the lesser stiffness
    throw softened(refusal, k == 0 ? "the body of object1" : "the body of object2", young_moduli_[k], now[k]);
  }
}

double Tissues::default_stiffness() const {
  return std::min(default_contact_stiffness(*bodies_[0], edges_[0]), default_contact_stiffness(*bodies_[1], edges_[1]));
}

void Tissues::follow_surface() {
  if (revisions() == revisions_) return;
  revisions_ = revisions();
  set_surface(*contact_);
}

void Tissues::nodes_changed(int state, const NodeCopies& copies, std::span<const int> split_from) {
  if (split_from.empty()) return;  // reset and serialize follow
  const bool with_itself = bodies_[0] == bodies_[1];
  if (with_itself && state == 1) return;  // told of both
  std::array<SplitNodes, 2> split;
  split[static_cast<std::size_t>(state)] = {copies.num_nodes() - static_cast<int>(split_from.size()), split_from};
  if (with_itself) split[1] = split[0];
  revisions_ = revisions();
  set_surface(*contact_, split);
}

std::array<double, 2> Tissues::young_moduli() const {
  return {greatest_young_modulus(*bodies_[0]), greatest_young_modulus(*bodies_[1])};
}

void Tissues::look_at_start(double /*time*/, const Pair<ConstPoints>& x) {
  if (!options_.active) return;
  look("", x);
  has_looked_at_start_ = true;
}

void Tissues::look(const char* to_touch, const Pair<ConstPoints>& x) {
  has_looked_ = true;
  const double depth = contact_->depth_at(x);
  if (!(depth > kOverlap * contact_->edge())) return;
  if (bodies_[0] == bodies_[1])
    warn("object1", fmt::format("the body begins{} {:.3g} m deep in itself", to_touch, depth));
  else
    warn("object2", fmt::format("the bodies begin{} {:.3g} m deep in each other", to_touch, depth));
}

void Tissues::warn_of_same_pair(std::string_view other) {
  warn("object2", fmt::format("'{}' is between the same bodies: both act, and their stiffnesses add up", other));
}

void Tissues::begin_step(const Step& step, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) {
  follow_surface();
  default_stiffness_ = default_stiffness();
  contact_->set_settings(accepted_settings(options_, default_stiffness_));
  options_.check_damping(default_stiffness_, step.dt);
  rayleigh_stiffness_ = step.rayleigh_stiffness;
  if (options_.active && !has_looked_) look(" to touch", x);
  contact_->begin_step(x, v, step.dt);
}

void Tissues::reset() {
  has_looked_ = has_looked_at_start_;
  follow_surface();
  contact_->reset();
}

void Tissues::serialize(Archive& archive) {
  if (archive.reads()) {  // as many may have gone, and others
    revisions_ = revisions();
    set_surface(*contact_);
    has_looked_ = options_.active;
  }
  follow_surface();
  contact_->serialize(archive);
}

}  // namespace hexaplast::parts
