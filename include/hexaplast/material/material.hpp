// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "hexaplast/base/rows.hpp"

namespace hexaplast {

/// Lame's constants [Pa].
struct Lame {
  double mu = 0;
  double lambda = 0;
};

/// mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu)(1 - 2 nu)).                         theory.md eq. 10
Lame lame(double young_modulus, double poisson_ratio);

/// What one hexahedron is made of. The defaults make it purely elastic. Each member has a row (material/rows.hpp).
struct Material {
  double young_modulus = 5000;                                    ///< E [Pa], > 0
  double poisson_ratio = 0.45;                                    ///< [-], in [0, 0.5)
  double yield_stress = std::numeric_limits<double>::infinity();  ///< tau [Pa], >= 0; infinite: never yields
  double flow_rate = 0;           ///< nu [1/s], >= 0: fraction of the excess deviatoric stretch that flows per second
  double rotation_yield = 0;      ///< tau^R [rad], in [0, pi]
  double rotation_flow_rate = 0;  ///< nu^R [1/s], >= 0
  double hardening = 0;           ///< kappa [-], <= 1e6: growth of both thresholds with flow; < 0 softens, down to 0
  double fracture_stress = std::numeric_limits<double>::infinity();   ///< [Pa] the element breaks when tau passes it
  double fracture_stretch = std::numeric_limits<double>::infinity();  ///< [-] > 1: it breaks when plastic stretch does
  double fracture_energy = 0;  ///< G [J/m^2] >= 0 that a crack takes per area, of Fracture::kFace; 0: strength alone
};

/// How the deformation gradients of the eight samples follow from the corners. All carry V/8 per sample.
enum class Bending {
  kBlended,        ///< mean of corner and centre, shifted to the exact mean: passes the patch test; stiff; plain
                   ///< implementation
  kAssumedCorner,  ///< about corners, with an assumed strain that bends freely
  kVertex,         ///< corners alone: stiff; plain implementation
  kCentre          ///< the centre alone, eight times: soft, with hourglass modes; plain implementation
};

/// What resists a change of volume.
enum class Volumetric {
  kSample,      ///< every sample: locks towards Poisson's ratio 1/2; plain implementation
  kVolumeRatio  ///< the exact volume of the hexahedron, and a bounded modulus for what samples deviate from their mean
};

/// How stress follows from stretch. All agree with Hooke's law in the small.
enum class ElasticLaw {
  kCorotated,         ///< linear in the stretch, but for the pressure of kVolumeRatio
  kNeoHookean,        ///< mu / 2 |F|^2, and a term of det F
  kStableNeoHookean,  ///< the same with a logarithm that keeps it from resting in a point
  kMooneyRivlin       ///< with |cof F|^2 besides
};

/// What unfolds folded elements.
enum class RecoveryMode {
  kNone,    ///< nothing: folded elements may stay folded
  kCluster  ///< springs about the best rigid placement of every connected cluster of folded elements
};

/// Norm of the stress that is compared with the yield stress. All three give the tensile stress in uniaxial tension.
enum class YieldNorm {
  kVonMises,   ///< sqrt(3/2) |dev sigma|_F: does not feel pressure
  kFrobenius,  ///< |sigma|_F
  kSpectral    ///< largest |principal stress|
};

/// Which stress is compared with the yield stress.
enum class YieldStressMeasure {
  kBiot,   ///< the stress of the law, in the rotated frame
  kCauchy  ///< true stress in the rotated frame; kIsolated alone
};

/// Where permanent deformation lives.
enum class RestShape {
  kJoined,   ///< one mesh fits the rest shapes of all elements best: no residual stress; flows in the plain
             ///< implementation
  kIsolated  ///< each sample keeps its own: residual stress                                       theory.md section 5.9
};

/// How rotation within an element becomes permanent.
enum class RotationPlasticity {
  kObjective,  ///< relative rotation of corner and centre, carried by the rest shape
  kVertex,     ///< the paper's eq. 5 and 8: a rotation map per corner; plain implementation
  kCentre,     ///< the paper's eq. 6 and 8: the rotation of the centre; plain implementation
  kNone        ///< only stretch flows
};

/// What the paper's modes measure rotations against.
enum class RotationFrame {
  kBestFit,  ///< the rotation of the whole connected part: objective
  kWorld     ///< the axes, as printed: the pose of the body matters
};

/// How the isolated rest shapes become one plastic rest shape.
enum class AveragingMethod {
  kGaussNewton,  ///< one Gauss-Newton step that leaves the rotations of the joined elements free  theory.md eq. 31
  kJacobi        ///< one sweep of averages, as printed in the paper: depends on the mesh size; plain implementation
};

/// What becomes of a hexahedron that breaks.
enum class Fracture {
  kCell,  ///< it is removed, with its volume and surface
  kFace   ///< it stays, and comes apart from others along its faces: FlowReport::torn (theory.md section 10)
};

/// Numbers that the stiffness product, what follows from it, and what a plastic step adds are computed with. Positions,
/// forces, rotations of the elastic forces and the history are always double.                    theory.md section 9.6
enum class Precision {
  kDouble,
  kMixed  ///< products and the vectors of solvers in single precision, coefficients in half where the machine has it
};

/// What computes a body.
enum class Implementation {
  kAuto,  ///< the kernels, in double and mixed precision, with multigrid, where they have what is asked for
  kPlain  ///< the paper to be read, with all of its variants, in double precision and without multigrid
};

/// What holds for a whole body. Each member has a row (material/rows.hpp).
struct Settings {
  Bending bending = Bending::kAssumedCorner;
  double blend_weight = 0.5;  ///< [-] of the corner in kBlended, in (0, 1)
  Volumetric volumetric = Volumetric::kVolumeRatio;
  ElasticLaw law = ElasticLaw::kCorotated;
  double mooney_fraction = 0.2;         ///< [-] m2 / mu of kMooneyRivlin, in [0, 1]
  std::vector<double> relaxation = {};  ///< "g1 t1 g2 t2 ...": moduli g mu [-] that relax with the times t [s], all > 0
  RecoveryMode recovery = RecoveryMode::kCluster;
  double recovery_strength = 3;  ///< [-] of the springs, > 0
  double recovery_from = 0.05;   ///< [-] corner ratio below which springs act
  double recovery_full = -1;     ///< [-] at and below which they have their full strength, at most 0
  YieldNorm yield_norm = YieldNorm::kVonMises;
  YieldStressMeasure yield_stress_measure = YieldStressMeasure::kBiot;
  RestShape rest_shape = RestShape::kIsolated;
  RotationPlasticity rotation_plasticity = RotationPlasticity::kObjective;
  RotationFrame rotation_frame = RotationFrame::kBestFit;  ///< of the modes kVertex and kCentre
  AveragingMethod averaging =
      AveragingMethod::kGaussNewton;  ///< kVertex and kCentre hold their rotation maps fixed in it
  int averaging_steps = 1;            ///< per time step, in [1, 1000]
  double averaging_tolerance = 1e-6;  ///< relative residual of its linear systems, > 0
  Precision precision = Precision::kDouble;
  Implementation implementation = Implementation::kAuto;
  double volume_restitution = 1;     ///< c [1/s], >= 0; c dt < 2/3
  double inversion_threshold = 0.1;  ///< elements whose smallest det F or det J ratio lies below do not flow; in [0, 1)
  Fracture fracture = Fracture::kCell;

  /// Of viscoelasticity.
  int num_branches() const { return static_cast<int>(relaxation.size() / 2); }

  bool operator==(const Settings&) const = default;
};

/// The element of the paper's figures and of all that is compared with them: theory.md sections 2 and 3 alone. It locks
/// towards Poisson's ratio 0.5, is stiff in bending, and may stay folded.
inline Settings published_element() {
  return {.bending = Bending::kBlended,
          .volumetric = Volumetric::kSample,
          .recovery = RecoveryMode::kNone,
          .rest_shape = RestShape::kJoined};
}

/// Whether stretch, or rotation, of a hexahedron can ever become permanent.
bool can_stretch(const Material& material);
bool can_rotate(const Material& material, const Settings& settings);
/// Whether one of the two can in some hexahedron of a body.
bool can_flow(const std::vector<Material>& materials, const Settings& settings);

/// Whether the plain implementation computes a body: where it is asked for, and where the kernels do not have what is.
bool is_plain(const std::vector<Material>& materials, const Settings& settings);

/// [byte] of memory per hexahedron of such a body in a running scene: the body, its state, a solver with multigrid and
/// what a run writes. Measured (docs/performance.md). A sparse direct solver takes more, and ever more the larger the
/// body is.
double bytes_per_hexahedron(const std::vector<Material>& materials, const Settings& settings);

/// Throws InputError naming the first value outside its range and the element it belongs to, or the option that needs
/// another precision.
void validate(const std::vector<Material>& materials, Names names = Names::kMembers);
void validate(const Settings& settings, Names names = Names::kMembers);
/// Throws InputError where something flows with RestShape::kIsolated and settings that it has not, a flow of rotation
/// among them, or with RestShape::kJoined beside Settings::relaxation or Precision::kMixed.
void validate(const std::vector<Material>& materials, const Settings& settings, Names names = Names::kMembers);

/// Of Settings::relaxation.
inline constexpr int kMaxBranches = 8;

/// Largest admissible products with the time step, and those above which results lose accuracy.
inline constexpr double kLargestFlowPerStep = 1.0;               // more than all of the excess cannot flow
inline constexpr double kRecommendedFlowPerStep = 0.05;          // 2 % error of the plastic result
inline constexpr double kLargestRestitutionPerStep = 2.0 / 3.0;  // volume error is multiplied by 1 - 3 c dt per step
inline constexpr double kRecommendedRestitutionPerStep = 0.3;

/// Checks nu dt, nu^R dt, c dt and those of any further rate, unless nothing can flow: none of them acts then. Throws
/// InputError where a limit is passed, otherwise returns one sentence per recommended limit that is passed. With
/// RestShape::kIsolated c does not act, and nu dt has no limit but 1 - 2 nu_P with Volumetric::kSample.
std::vector<std::string> check_time_step(const std::vector<Material>& materials, const Settings& settings, double dt,
                                         Names names = Names::kMembers);

/// A material of which a hexahedron holds a fraction (0, 1], the rest of it being empty: at the same strain it carries
/// that fraction of the stress, and it yields and tears at the same strains.
Material filled(Material material, double fraction);

}  // namespace hexaplast
