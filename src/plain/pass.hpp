// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "state/history.hpp"

/// Loops over the elements of a body, as many at once as a register of the instruction set has numbers. What each
/// element gives goes into an entry of its own; add_at_nodes adds these up in the order of the mesh, so that results do
/// not depend on threads.
namespace hexaplast::plain {

/// to += factor times the sum of what the elements give at each node. counts: per element, 0 where it gives nothing.
void add_at_nodes(const HexMesh& mesh, const std::vector<unsigned char>& counts,
                  const std::vector<ElementPoints>& of_elements, double factor, Points to);

/// A field at the corners of the elements, which it borrows.
struct CornerField {
  CornerField(const ConstPoints& of_nodes) : nodal(of_nodes.data()) {}  // NOLINT: a field is what it is
  CornerField(const PointArray& of_nodes) : nodal(of_nodes.data()) {}   // NOLINT
  CornerField(const ElementPoints& of_all) : alike(&of_all) {}          // NOLINT: the same in all elements

  const double* nodal = nullptr;
  const ElementPoints* alike = nullptr;
};

/// [J] per element, 0 where it is gone.                                                    eq. 18, E5, E14, P17
void find_energies(const Model& model, const History& history, ConstPoints x, const Branches& branches,
                   std::vector<double>& energies);

/// Elements at one set of current positions.
class PlacedElements {
 public:
  virtual ~PlacedElements() = default;

  virtual void place(const Model& model, const History& history, ConstPoints x, const Branches& branches) = 0;
  /// [N] per element; those that are gone keep what stands there.                eq. 15, E3, E6, E13, E15, P14
  virtual void find_forces(const HexMesh& mesh, std::vector<ElementPoints>& forces) const = 0;
  /// [N] of these increments of the positions, rotations fixed.                              eq. 16, E4, E7, E20
  virtual void find_force_increments(const HexMesh& mesh, const CornerField& dx,
                                     std::vector<ElementPoints>& increments) const = 0;
};
std::unique_ptr<PlacedElements> make_placed_elements();

/// What is left of an element's step once it is in the next history.
struct ElementOutcome {
  bool yielded = false, inverted = false, skipped = false, repaired = false;
  double volume_error = 0;  ///< [-] |beta - 1| before the step
  double dissipated = 0;    ///< [J]
};

/// Stretch, rotation, hardening, rest shape and volume of every element by itself: before -> next.   theory.md 5.1 to
/// 5.4. frames: B of the paper's rotation modes, per element; empty: the axes.
void flow_elements(const Model& model, ConstPoints x, double dt, const std::vector<Mat3>& frames, const History& before,
                   History& next, std::vector<ElementOutcome>& outcomes);

/// The same of one element. frame: null: the axes.
ElementOutcome flow_alone(const Model& model, ConstPoints x, double dt, const Mat3* frame, const History& before,
                          int element, History& next);

inline constexpr double kRegularisation = 1e-7;  ///< of P in eq. 31: keeps turns of a connected part definite

/// The fit of the averaging, and the operators of its steps, of some elements:                       theory.md 5.5
///
///   E(x) = sum_k min_Pi sum_i |Pi y_i - (x_i - c_k(x))|^2          c_k: mean of the element's corners      (eq. 30)
///
/// Gauss-Newton: with t_i = Pi y_i for the best rotations at the old x, solve
///
///   (H + 1e-7 P) dx = -g,   H_k = P - B (B^T B)^-1 B^T,   g = assembled x_i - c_k - t_i                    (eq. 31)
///
/// P removes an element's mean, B the infinitesimal rotations of x - c. The local/global step solves P dx = -g.
class AveragedElements {
 public:
  virtual ~AveragedElements() = default;

  struct Misfit {
    double E = 0;     ///< [m^2]                                                                               eq. 30
    double size = 0;  ///< [m^2] sum |t|^2
  };

  /// Best rotations of the rest shapes at the plastic rest positions, into the rotation maps unless these are the
  /// mode's own. gradients: x_i - c - t_i per element, with which the operators of these positions are made; or null.
  /// counts: per element, whether it is one of them.
  virtual Misfit fit(const Model& model, const std::vector<unsigned char>& counts, History& history,
                     std::vector<ElementPoints>* gradients) = 0;

  /// P u or, with `projects`, (1 + 1e-7) P u - B (B^T B)^-1 B^T u with B_i = -[arm_i]x.                     eq. 31, 32
  virtual void find_products(const CornerField& u, bool projects, std::vector<ElementPoints>& products) const = 0;
};
std::unique_ptr<AveragedElements> make_averaged_elements();

}  // namespace hexaplast::plain
