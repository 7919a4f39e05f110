// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "element/samples.hpp"
#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/plastic/flow_report.hpp"
#include "state/history.hpp"
#include "state/recovery.hpp"

/// The method for a whole body, to be read beside the paper (R. Gao, J. Peters, "Improving hexahedral-FEM-based
/// plasticity in surgery simulation") and docs/theory.md: one element after the other, in double precision, on one
/// thread. It has every option, those of the paper that the kernels do not have among them (Settings::implementation),
/// and the kernels are tested against it. It allocates as it likes. Section 7 of docs/theory.md names the function for
/// each equation of the paper.
namespace hexaplast::plain {

/// The strain of `assumedCorner`: its part linear in a coordinate n is tangential to the faces of that coordinate.
/// Linear in nodal values u while R is held fixed.                                                     theory.md 2.1
class AssumedStrain {
 public:
  /// Corners [m]; weight: c; mean_plastic_inverse: Gm of isolated rest shapes.                                eq. P2
  AssumedStrain(const ElementPoints& plastic_rest, const ElementPoints& current, double weight,
                const Mat3& mean_plastic_inverse);

  /// c sum_n s_n A_n (x) J^n of u, at sample i.                                                         eq. E10, E11c
  Mat3 gradient(const ElementPoints& u, int sample) const;

  /// The transpose: what stresses P_i act with on u, per corner.
  ElementPoints transpose(const std::array<Mat3, kCorners>& P) const;

  /// The same by way of R, which turns with u.                                                         eq. E12, E13
  ElementPoints turning(const std::array<Mat3, kCorners>& P, const ElementPoints& u) const;

 private:
  Mat3 hourglass(const ElementPoints& u) const { return u.transpose() * gamma_; }  // columns q_l
  Mat3 assumed(const Mat3& q) const;                                               // columns A_n
  Mat3 on_assumed(const std::array<Mat3, kCorners>& P) const;                      // columns g_n
  Mat3 on_hourglass(const Mat3& g) const;                                          // columns h'_l

  double weight_;
  Mat3 J_inverse_;               // rows J^n [1/m]
  ElementPoints mean_gradient_;  // Gm_a [1/m]
  Mat3 G_;                       // mean_plastic_inverse
  Mat3 R_, S_;                   // of the mean gradient F_m, times G_
  ElementPoints gamma_;          // column l: gamma_l                                                          eq. E8
  Mat3 of_hourglass_[3][3];      // A_n = sum_l of_hourglass_[n][l] q_l                                       eq. E10
};

/// One hexahedron at one set of current positions.
class Element {
 public:
  /// Corners [m]. plastic_inverse: the G_i of isolated rest shapes, null of joined ones; branches: of the element.
  Element(const ElementPoints& plastic_rest, const ElementPoints& current, const Lame& lame, const Settings& settings,
          const CornerTensors* plastic_inverse = nullptr, const Branches& branches = {});

  double energy() const;                                         ///< [J]                        eq. 18, E5, E14, P17
  ElementPoints force() const;                                   ///< [N] per corner  eq. 15, E3, E6, E13, E15, P14
  ElementPoints force_increment(const ElementPoints& dx) const;  ///< [N] rotations fixed    eq. 16, E4, E7, E20
  const ElementSamples& samples() const { return samples_; }     ///< of isolated rest shapes: of F^e

 private:
  std::array<Mat3, kCorners> gradients(const ElementPoints& u) const;
  ElementPoints transpose(const std::array<Mat3, kCorners>& P) const;
  std::array<Mat3, kCorners> on_gradients(std::array<Mat3, kCorners> P) const;  // P^e -> P                     eq. P4
  void add(const Branches& branches);

  Lame lame_;
  ElasticLaw law_;
  double mooney_fraction_;
  ElementPoints current_;
  std::array<ElementPoints, kCorners> gradient_;  // g~_ia [1/m]
  std::optional<AssumedStrain> assumed_;
  ElementSamples samples_;             // F, R, S, and the stress that yields
  std::vector<Mat3> plastic_inverse_;  // G_i of isolated rest shapes, none of joined ones

  CornerValues dilatation_;                      // theta_i
  std::array<Mat3, kCorners> along_dilatation_;  // d theta_i / d F_i
  CornerValues guard_;                           // beta_i [Pa]                                                eq. E21
  double mean_dilatation_ = 0;
  double k0_, own_, shared_ = 0;  // pressures k_i = k0 + own theta_i + shared mean theta [Pa]
  double free_;                   // lambda_f [Pa]                                                           eq. E2
  double of_volume_ = 0;          // modulus of the volume ratio [Pa]
  double volume_excess_ = 0;      // beta^ - 1
  ElementPoints volume_gradient_ = ElementPoints::Zero();  // b_a [1/m] eq. E6

  // of viscoelastic branches
  CornerTensors branch_stress_ = no_tensors();  // [Pa] what R takes to their part of P^e                     eq. P14
  double branch_modulus_ = 0;                   // mu_b [Pa]
  double branch_energy_ = 0;                    // [J/m^3] mean of the samples                               eq. P17
};

/// Elasticity of a body at one set of current positions.
class Elasticity {
 public:
  /// x: num_nodes x 3 [m].
  Elasticity(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> branches = {});

  double energy() const;                                                       ///< [J]              eq. 18, E25
  void add_force(Points f) const;                                              ///< f += [N]        eq. 15, E25
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const;  ///< df += factor df/dx dx eq. 16
  void add_stiffness_blocks(double factor, BlockMatrix& K) const;              ///< K += factor df/dx     eq. 17
  void add_stiffness_diagonal(double factor, Points diagonal) const;           ///< of the same
  const Recovery& recovery() const { return recovery_; }

 private:
  std::vector<Hexahedron> hexahedra_;
  std::vector<std::optional<Element>> elements_;  // none where removed
  Recovery recovery_;
};

/// factor df/dx, for solvers.
struct StiffnessTerm final : NodalOperator {
  const Elasticity* of = nullptr;
  double factor = 0;

  void add_product(ConstPoints p, Points Fp) const override { of->add_stiffness_product(factor, p, Fp); }
  bool has_diagonal() const override { return true; }
  void add_diagonal(Points diagonal) const override { of->add_stiffness_diagonal(factor, diagonal); }
};

/// Moves history.plastic_rest_positions towards the positions that fit the isolated rest shapes best, by
/// settings.averaging_steps steps, and finds the rotation maps of the elements.                  theory.md 5.5, eq. 30
/// changed: per element, not 0 where the rest shape is another than before. Connected parts without such an element
/// stay.
AveragingReport join_rest_shapes(const Model& model, const std::vector<unsigned char>& changed, LinearSolver& solver,
                                 History& history);

/// The same without a mesh of plastic rest positions: each sample keeps its own deformation, and what its branches
/// hold.                                                                                         theory.md 5.9, 5.10
FlowReport flow_isolated(const Model& model, ConstPoints x, double dt, History& history,
                         std::span<const BranchStep> branches);

/// One plastic step at the accepted current positions x (num_nodes x 3) [m].                              theory.md 5
/// Throws NumericalError naming the element whose history, or the node whose plastic rest position, is not finite; the
/// history is then as before.
FlowReport flow(const Model& model, ConstPoints x, double dt, LinearSolver& solver, History& history,
                std::span<const BranchStep> branches = {});

}  // namespace hexaplast::plain
