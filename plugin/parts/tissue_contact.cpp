// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/tissue_contact.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "attributes/contact.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {
namespace {

constexpr double kMaxDistance = 0.5;  // of contact, in edges

}  // namespace

Tissues::Tissues(const ContactOptions& options, const Body& first, const Body& second) : bodies_{&first, &second} {
  set_options(options);
}

void Tissues::set_options(const ContactOptions& options) {
  OptionRanges(attributes::kTissueContactForceField, options).throw_all();
  const ContactSettings settings =
      options.settings(std::min(default_contact_stiffness(*bodies_[0]), default_contact_stiffness(*bodies_[1])));
  std::optional<TissueContact> other;
  if (!contact_ || options.max_subdivision != options_.max_subdivision) {
    try {
      other.emplace(bodies_[0]->mesh(), bodies_[1]->mesh(), settings, options.max_subdivision);
    } catch (const InputError& error) {  // too many samples for the memory
      throw OptionError("max_subdivision", error.what());
    }
    set_surface(*other);
  }
  // contact is looked for in the cells around a point
  if (const double max = kMaxDistance * (other ? *other : *contact_).edge(); max > 0 && options.contact_distance > max)
    throw OptionError("contact_distance",
                      fmt::format("= {:.6g}: must be at most {:.3g} m, half of the mean edge of the surfaces",
                                  options.contact_distance, max));
  options_ = options;
  if (other) {
    contact_ = std::move(other);
    num_removed_ = num_removed();
  } else {
    contact_->set_settings(settings);
  }
}

void Tissues::follow_surface() {
  if (num_removed() == num_removed_) return;
  num_removed_ = num_removed();
  set_surface(*contact_);
}

void Tissues::begin_step(double dt, double rayleigh_stiffness, const OfTwo<ConstPoints>& x,
                         const OfTwo<ConstPoints>& v) {
  follow_surface();
  rayleigh_stiffness_ = rayleigh_stiffness;
  contact_->begin_step(x, v, dt);
}

void Tissues::reset() {
  contact_->reset();
  follow_surface();
}

void Tissues::serialize(Archive& archive) {
  if (archive.reads()) {  // as many may have gone, and others
    num_removed_ = num_removed();
    set_surface(*contact_);
  }
  follow_surface();
  contact_->serialize(archive);
}

void Tissues::add_force(const OfTwo<ConstPoints>& x, const OfTwo<ConstPoints>& v, OfTwo<Points> f) const {
  contact_->terms().add_force(x, v, f);
  if (rayleigh_stiffness_ != 0) contact_->terms().add_stiffness_product(-rayleigh_stiffness_, v, f);
}

}  // namespace hexaplast::parts
