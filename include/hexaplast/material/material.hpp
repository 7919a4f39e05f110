// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace hexaplast {

/// Lame's constants [Pa].
struct Lame {
  double mu = 0;
  double lambda = 0;
};

/// mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu)(1 - 2 nu)).                         theory.md eq. 10
Lame lame(double young_modulus, double poisson_ratio);

/// What one hexahedron is made of. The defaults make it purely elastic.
struct Material {
  double young_modulus = 5000;                                    ///< E [Pa], > 0
  double poisson_ratio = 0.45;                                    ///< [-], in [0, 0.5)
  double yield_stress = std::numeric_limits<double>::infinity();  ///< tau [Pa], >= 0; infinite: never yields
  double flow_rate = 0;           ///< nu [1/s], >= 0: share of the excess deviatoric stretch that flows per second
  double rotation_yield = 0;      ///< tau^R [rad], in [0, pi]
  double rotation_flow_rate = 0;  ///< nu^R [1/s], >= 0
  double hardening = 0;           ///< kappa [-]: growth of both thresholds with flow; < 0 softens, down to 0
};

/// Norm of the stress that is compared with the yield stress. All three give the tensile stress in uniaxial tension.
enum class YieldNorm {
  kVonMises,   ///< sqrt(3/2) |dev sigma|_F: does not feel pressure
  kFrobenius,  ///< |sigma|_F
  kSpectral    ///< largest |principal stress|
};

/// How rotation within an element becomes permanent.
enum class RotationPlasticity {
  kObjective,  ///< relative rotation of corner and centre, carried by the rest shape
  kNone        ///< only stretch flows
};

/// What holds for a whole body.
struct Settings {
  YieldNorm yield_norm = YieldNorm::kVonMises;
  RotationPlasticity rotation = RotationPlasticity::kObjective;
  double volume_restitution = 1;     ///< c [1/s], >= 0; c dt < 2/3
  double inversion_threshold = 0.1;  ///< elements whose smallest det F or det J ratio lies below do not flow; in [0, 1)
};

/// Throws InputError naming the first value outside its range and the element it belongs to.
void validate(const std::vector<Material>& materials);
void validate(const Settings& settings);

/// Largest admissible products with the time step, and those above which results lose accuracy.
inline constexpr double kLargestFlowPerStep = 1.0;               // more than all of the excess cannot flow
inline constexpr double kAdvisedFlowPerStep = 0.05;              // 2 % error of the plastic result
inline constexpr double kLargestRestitutionPerStep = 2.0 / 3.0;  // volume error is multiplied by 1 - 3 c dt per step
inline constexpr double kAdvisedRestitutionPerStep = 0.3;

/// Checks nu dt, nu^R dt and c dt. Throws InputError where a limit is passed, otherwise returns one sentence per
/// advised limit that is passed.
std::vector<std::string> check_time_step(const std::vector<Material>& materials, const Settings& settings, double dt);

}  // namespace hexaplast
