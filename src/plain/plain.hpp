// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "backend.hpp"
#include "element/samples.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "plain/pass.hpp"
#include "state/history.hpp"

/// The method for a whole body, to be read beside the paper (R. Gao, J. Peters, "Improving hexahedral-FEM-based
/// plasticity in surgery simulation") and docs/theory.md, in double precision: what an element does is one text,
/// element-inl.hpp and flow-inl.hpp, for one element in each lane of a register and for one element. It has every
/// option, those of the paper that the kernels do not have among them (Settings::implementation), and the kernels are
/// tested against it. It allocates as it likes. Section 7 of docs/theory.md names the function for each equation of the
/// paper.
namespace hexaplast::plain {

/// One hexahedron at one set of current positions.
class Element {
 public:
  /// Corners [m]. plastic_inverse: the G_i of isolated rest shapes, null of joined ones; branches: of the element.
  Element(const ElementPoints& plastic_rest, const ElementPoints& current, const Lame& lame, const Settings& settings,
          const CornerTensors* plastic_inverse = nullptr, const Branches& branches = {});
  ~Element();

  double energy() const;                                         ///< [J]                        eq. 18, E5, E14, P17
  ElementPoints force() const;                                   ///< [N] per corner  eq. 15, E3, E6, E13, E15, P14
  ElementPoints force_increment(const ElementPoints& dx) const;  ///< [N] rotations fixed    eq. 16, E4, E7, E20
  const ElementSamples& samples() const { return samples_; }     ///< of isolated rest shapes: of F^e

  /// [1/m] g~_ia, one row per corner a: dF~_i = sum_a dx_a (x) g~_ia, but for strain that is assumed.            eq. 7
  std::array<ElementPoints, kCorners> sample_gradients() const;
  ElementPoints mean_gradient() const;  ///< [1/m] Gm_a = (1/V) int grad N_a dV, exactly                         eq. 9

 private:
  struct Numbers;
  std::unique_ptr<const Numbers> numbers_;
  ElementSamples samples_;
};

/// The method for a body. Its matrices and its diagonal are those of df/dx, rotations fixed.      eq. 15 to 18, 30, E25
std::unique_ptr<Backend> make_backend(const Model& model, History& history, const std::vector<BranchStep>& branches);

/// One plastic step of one element before the averaging, with what flows.            theory.md sections 5.1 to 5.4
struct ElementStep {
  bool inverted = false;                             ///< inverted at some corner (det F~ < 0)
  bool skipped = false;                              ///< without flow: inverted or nearly so
  bool repaired = false;                             ///< the rest shape was moved towards the initial one
  bool yielded = false;                              ///< stretch or rotation flowed at some corner
  CornerValues stretch_fraction, rotation_fraction;  ///< gamma, eta                                    eq. 21, 25
  CornerTensors stretch, rotation;                   ///< S^p, R^p                                      eq. 22, 26
  double volume_ratio = 1;                           ///< beta [-]
  double dissipated = 0;                             ///< [J]
  ElementHistory next;                               ///< the element's history after the step
};

/// plastic_rest, current: corners [m]; frame: B, what the paper's rotation modes are measured against.
ElementStep flow_element(const Model& model, int element, const ElementPoints& plastic_rest,
                         const ElementPoints& current, const Mat3& frame, const ElementHistory& before, double dt);

/// What averaging is solved with.
PreconditionedConjugateGradients averaging_solver(const Model& model);

/// Moves history.plastic_rest_positions towards the positions that fit the isolated rest shapes best, by
/// settings.averaging_steps steps, and finds the rotation maps of the elements.                  theory.md 5.5, eq. 30
/// changed: per element, not 0 where the rest shape is another than before. Connected parts without such an element
/// stay.
AveragingReport join_rest_shapes(const Model& model, const std::vector<unsigned char>& changed, LinearSolver& solver,
                                 History& history);

/// One plastic step at the accepted current positions x (num_nodes x 3) [m].                              theory.md 5
/// Throws NumericalError naming the element whose history, or the node whose plastic rest position, is not finite; the
/// history is then as before.
FlowReport flow(const Model& model, ConstPoints x, double dt, LinearSolver& solver, History& history,
                std::span<const BranchStep> branches = {});

}  // namespace hexaplast::plain
