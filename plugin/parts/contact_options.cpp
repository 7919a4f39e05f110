// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/contact_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hexaplast::parts {
namespace {

// of the default: a ball pressed into a body is held within 3e-6 of its force from step to step, and with 667 times the
// default it bounces by .4 of it, by whatever solver
constexpr double kMaxStiffness = 200;
constexpr double kMaxDistance = 0.5;  // of contact, in edges

}  // namespace

ContactSettings ContactOptions::settings(double default_stiffness) const {
  const double max = kMaxStiffness * default_stiffness;
  const auto check = [&](std::string_view option, const std::optional<double>& stiffness) {
    if (active && stiffness && *stiffness > max)
      throw OptionError(option, fmt::format("is {:.6g}, must be at most {:.3g} Pa/m, {:g} times the default of "
                                            "contactStiffness, 30 E / edge length",
                                            *stiffness, max, kMaxStiffness));
  };
  check("contact_stiffness", contact_stiffness);
  check("tangential_stiffness", tangential_stiffness);
  const double stiffness = contact_stiffness.value_or(default_stiffness);
  return {.stiffness = stiffness,
          .tangential_stiffness = tangential_stiffness.value_or(stiffness),
          .friction = friction,
          .distance = contact_distance,
          .damping = damping,
          .is_active = active};
}

// Implicit Euler takes damping / dt beside the stiffness.
void ContactOptions::check_damping(double default_stiffness, double dt) const {
  if (const double max = kMaxStiffness * default_stiffness * dt; active && damping > max)
    throw OptionError("damping", fmt::format("is {:.6g}, must be at most {:.3g} Pa s/m in steps of {:g} s, {:g} times "
                                             "the default of contactStiffness, 30 E / edge length, times the step",
                                             damping, max, dt, kMaxStiffness));
}

void ContactOptions::check_distance(double edge) const {
  if (const double max = kMaxDistance * edge; contact_distance > max)
    throw OptionError("contact_distance",
                      fmt::format("is {:.6g}, must be at most {:.3g} m, half of the mean edge", contact_distance, max));
}

OptionError softened(const OptionError& refusal, std::string_view body, double from, double to) {
  if (!(to < from)) return refusal;
  const Remark& reason = refusal.reasons().front();
  return {reason.attribute, fmt::format("{}; the greatest Young's modulus of {} was {:.6g} Pa when that was accepted, "
                                        "and is {:.6g} Pa now",
                                        reason.text, body, from, to)};
}

std::string integrator_lacks(std::string_view class_name, const std::function<bool(const char* scheme)>& has,
                             std::string_view where) {
  if (class_name != "EulerImplicitSolver") return fmt::format("needs an EulerImplicitSolver {}", where);
  for (const char* scheme : {"trapezoidalScheme", "firstOrder"})
    if (has(scheme)) return fmt::format("its EulerImplicitSolver has {}: contact needs implicit Euler", scheme);
  return {};
}

double greatest_young_modulus(const Body& body) {
  return std::ranges::max(body.materials(), {}, &Material::young_modulus).young_modulus;
}

double mean_edge(const Body& body) {
  double volume = 0;
  for (int e = 0; e < body.mesh().num_elements(); ++e) volume += body.initial_volume(e);
  return std::cbrt(volume / body.mesh().num_elements());
}

double default_contact_stiffness(const Body& body, double edge) { return 30 * greatest_young_modulus(body) / edge; }

}  // namespace hexaplast::parts
