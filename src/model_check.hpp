// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/mesh/quality.hpp"

namespace hexaplast {

/// What can be known of a body before it moves.
struct ModelCheck {
  int num_parts = 0;           ///< unconnected ones
  Vec3 extent = Vec3::Zero();  ///< [m] of the box around it
  double volume = 0;           ///< [m^3]
  MeshQuality quality;
  double mass = 0;                                      ///< [kg]
  double density = 0;                                   ///< [kg/m^3] mean
  double min_young_modulus = 0, max_young_modulus = 0;  ///< [Pa] of the elements
  double min_poisson_ratio = 0, max_poisson_ratio = 0;
  bool is_plain = false;              ///< the plain implementation computes it
  bool locks = false;                 ///< each sample resists the change of its own volume: Volumetric::kSample
  double yield_stress = 0;            ///< [Pa] minimum of the elements; infinite: it never yields
  double yield_strain = 0;            ///< smallest tau / E of the elements; infinite: it never yields
  double rotation_yield = 0;          ///< [rad] smallest tau^R of the elements; infinite: rotation never flows
  double flow_per_step = 0;           ///< largest nu dt
  double rotation_flow_per_step = 0;  ///< largest nu^R dt
  double restitution_per_step = 0;    ///< c dt
  double wave_speed = 0;  ///< [m/s] of pressure waves, sqrt((lambda + 2 mu) / density), in the stiffest element; 0
                          ///< without mass
  double highest_frequency = 0;  ///< [rad/s] about that of the fastest vibration of the mesh with lumped masses, rather
                                 ///< more; 0 without mass. theory.md eq. 56
  double cfl_number = 0;         ///< CFL number: shortest edges that such a wave passes in a time step
  double steps_across = 0;       ///< time steps that it takes along the longest extent; 0 without mass
};

/// mass [kg] of the whole body, dt [s].
ModelCheck check_model(const Body& body, double mass, double dt);

/// One sentence for each choice that is legal but unwise. What concerns rates and the time step check_time_step says,
/// what concerns the mesh check_shapes.
std::vector<std::string> model_warnings(const ModelCheck& check, Names names = Names::kMembers);

/// One sentence for each size that no tissue has, as bodies have them whose coordinates are in millimetres.
/// gravity: [m/s^2].
std::vector<std::string> size_warnings(const ModelCheck& check, const Vec3& gravity);

/// One sentence for each limit of fracture that nothing can reach, or beyond which elements begin, or that Fracture
/// does not ask for.
std::vector<std::string> fracture_warnings(const std::vector<Material>& materials, const Settings& settings,
                                           Names names = Names::kMembers);

/// One sentence for each option that RestShape::kIsolated leaves without effect, and that has another value than the
/// default.
std::vector<std::string> idle_option_warnings(const Settings& settings, Names names = Names::kMembers);

}  // namespace hexaplast
