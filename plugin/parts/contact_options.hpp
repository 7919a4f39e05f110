// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "hexaplast/body.hpp"
#include "hexaplast/contact/contact_terms.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// What all contacts of bodies have.
struct ContactOptions {
  std::optional<double> contact_stiffness = std::nullopt;  ///< [Pa/m] otherwise 30 E / edge length of the softer body
  std::optional<double> tangential_stiffness = std::nullopt;  ///< [Pa/m] otherwise contact_stiffness
  double friction = 0;
  double contact_distance = 0;  ///< [m]
  double damping = 0;           ///< [Pa s/m]
  int max_subdivision = 8;      ///< parts of the edge of a face, at most
  bool active = true;           ///< otherwise nothing touches

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(contact_stiffness);
    HEXAPLAST_OPTION(tangential_stiffness);
    HEXAPLAST_OPTION(friction);
    HEXAPLAST_OPTION(contact_distance);
    HEXAPLAST_OPTION(damping);
    HEXAPLAST_OPTION(max_subdivision);
    HEXAPLAST_OPTION(active);
  }

  /// default_stiffness [Pa/m]: of contact, where there is no contact_stiffness. Throws OptionError for a stiffness far
  /// beyond it, if the contact is active.
  ContactSettings settings(double default_stiffness) const;

  /// Throws OptionError for a damping that in steps of dt [s] holds more than the greatest stiffness, if it is active.
  void check_damping(double default_stiffness, double dt) const;

  /// Whether both have the same stiffnesses.
  bool has_stiffness_of(const ContactOptions& other) const {
    return contact_stiffness == other.contact_stiffness && tangential_stiffness == other.tangential_stiffness;
  }

  /// Throws OptionError for a contact_distance above half of a mean edge [m] of hexahedra.
  void check_distance(double edge) const;
};

/// What is said of a stiffness that was accepted and is refused in a run: which body has become softer than it was,
/// from and to which Young's modulus [Pa]. The refusal alone where it is not softer.
OptionError softened(const OptionError& refusal, std::string_view body, double from, double to);

/// What contact lacks of the time integrator of its bodies, which must be implicit Euler as SOFA's EulerImplicitSolver
/// is by default; empty: nothing. class_name: of the integrator, empty where there is none. has: whether it has a
/// scheme, by the name of its attribute. where: it is needed, "in its node or above".
std::string integrator_lacks(std::string_view class_name, const std::function<bool(const char* scheme)>& has,
                             std::string_view where);

/// [Pa] of a body as it is.
double greatest_young_modulus(const Body& body);

/// [m] of the hexahedra of a body, those that have gone among them.
double mean_edge(const Body& body);

/// [Pa/m] of contact by default: 30 E / edge, with the greatest Young's modulus of the body as it is and its mean edge,
/// so that a pressure of .3 E is held at a hundredth of an edge.
double default_contact_stiffness(const Body& body, double edge);

}  // namespace hexaplast::parts
