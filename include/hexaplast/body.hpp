// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/hash.hpp"
#include "hexaplast/material/material.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "hexaplast/plastic/flow_report.hpp"

namespace hexaplast {

struct MatrixFreeSystem;

/// What a picture or a table shows of a body: one value per hexahedron. A removed element keeps its plastic strain and
/// yield stress; its other values are 0.
struct ElementFields {
  std::vector<double> plastic_strain;  ///< [-] mean over the corners of the accumulated plastic strain
  std::vector<double> yield_stress;    ///< [Pa] maximum of the corners; infinite if it never yields
  std::vector<double> volume_ratio;    ///< [-] plastic volume / initial volume
  std::vector<double> stress_norm;     ///< [Pa] maximum of the corners, in the body's yield norm
  std::vector<double> strain;          ///< [-] largest |D - 1| of the corners
};

/// A deformable, plastically flowing body: Model, History and Backend behind a few verbs. The one place that
/// knows the order of the stages (docs/architecture.md). A copy goes on by itself, without linearization; a body that
/// has been moved from may only be assigned to or destroyed.
///
/// linearize, add_*, energy and fields evaluate: they never change the plastic history, and may be called at any
/// positions, any number of times. flow is called once per accepted time step.
///
///   call                                                  | before it
///   linearize, energy, flow of Settings::relaxation       | set_time_step
///   add_force, add_stiffness_*, add_operator              | linearize, and none of the calls below since then
///   flow, remove, open, set_materials, reset, load,       | nothing; they end the linearization
///   serialize, use_device                                 |
///   energy, fields, volume, save                          | nothing; they leave the linearization alone
///
/// Nodal arguments are num_nodes x 3 [m, N]. Every build throws InputError where the linearization is missing or an
/// argument has another size or a hexahedron is not there, and nothing has changed then. Not thread-safe; distinct
/// bodies may be used concurrently.
class Body {
 public:
  /// Throws InputError for materials or settings outside their ranges (material.hpp).
  Body(HexMesh mesh, std::vector<Material> materials, Settings settings = {});
  Body(const Body& other);
  Body(Body&& other) noexcept;
  Body& operator=(Body other) noexcept;
  ~Body();

  /// What follows is of a step of dt [s] >= 0; infinite: of an equilibrium, in which what relaxes has done so; 0: of a
  /// sudden change. Where nothing relaxes (Settings::relaxation) it is without effect. Otherwise another dt ends the
  /// linearization. Throws InputError for other numbers.
  void set_time_step(double dt);

  /// What computes the body: "cpu", "cuda" for a graphics card, "emulation" for its kernels on the CPU (docs/gpu.md).
  /// In single precision, and with solvers by conjugate gradients alone. Between two time steps; nothing that is saved
  /// knows of it. Throws InputError where there is no device, and for a body that it cannot compute, by the name of the
  /// setting; the body is then as before.
  void use_device(const std::string& name);
  std::string device() const;

  /// Fixes the positions that add_force, the stiffness verbs and add_operator refer to.
  void linearize(ConstPoints x);

  /// f += elastic force at the linearized positions. Sums to zero force and zero moment.
  void add_force(Points f) const;

  /// df += factor * (df/dx) dx, rotations held fixed; df/dx is symmetric and negative semi-definite.
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const;

  /// The same operator as 3x3 blocks: K += factor * df/dx. Blocks of elements that are gone are there, and zero.
  void add_stiffness_blocks(double factor, BlockMatrix& K) const;

  /// A += factor * df/dx for the solvers that work on the kernels' own vectors. `system` refers to the linearization,
  /// and is void together with it.
  void add_operator(double factor, MatrixFreeSystem& system) const;

  /// Elastic energy [J] at any positions; leaves the linearization alone. Its slope is the force. What branches of
  /// Settings::relaxation dissipate within the step counts until `flow`: after it, the energy is what is stored.
  double energy(ConstPoints x) const;

  /// [J] that the springs of `recovery` hold at x beyond what they would hold there with the strengths that they have
  /// in the linearization: what their coming and going brings into the body. Throws InputError without a linearization.
  double recovery_work(ConstPoints x) const;

  /// Plastic flow and relaxation over dt [s] at the accepted positions x: the only writer of the history. Throws
  /// InputError where c dt, nu dt or nu^R dt passes its limit, or something relaxes and the time step is another one
  /// (equilibria have any dt), NumericalError when x or the result is not finite; the history is then as
  /// before.
  FlowReport flow(ConstPoints x, double dt);

  /// Takes elements out, as if they had broken; those that are gone already are passed over. Between two time steps.
  void remove(std::span<const int> elements);

  /// Opens joints between hexahedra, which stay: nodes that no closed joint holds together any more are split. Between
  /// two time steps. The order of the numbers does not matter; those that are open already are passed over, and of one
  /// that comes several times, as where blades meet it in one step, the first counts.            theory.md section 10
  /// joints: numbers of `joints()`. crossings: where what opens each of them passed, from the centre of its lowest
  /// hexahedron (0) to that of the next one (1), for those who draw the walls; 1/2 where none are given. They change
  /// no force. Returns for each new node, behind the present ones, the one that it was split from:
  /// nodal fields grow by these rows (append_rows). A joint whose nodes other joints still hold together is open
  /// without effect. Throws InputError for a number that is not there and for other crossings; nothing has changed
  /// then.
  std::vector<int> open(std::span<const int> joints, std::span<const double> crossings = {});

  /// Makes the body of something else, between two time steps; what has flowed stays. Yield thresholds move by as much
  /// as those of the materials, down to 0; those that were or become infinite are the new material's. Plastic stretch
  /// is remembered while some material breaks by it. Throws InputError like the constructor; the body is then as
  /// before.
  void set_materials(std::vector<Material> materials);

  /// Back to the initial state, in which all joints are closed.
  void reset();

  /// Writes the history, and the materials that its thresholds belong to, so that a body that loads it goes on as this
  /// one does, bit for bit (base/saved_stream.hpp). The current state (positions, velocities) is the host's. Between
  /// two time steps. Throws InputError when the stream does not take it all.
  void save(std::ostream& out) const;

  /// Takes over what `save` wrote for a body of the same mesh and settings, materials included; reads no byte beyond.
  /// Throws InputError for what is damaged, of another format version or of another body; this body is then as before.
  void load(std::istream& in);

  /// Materials and history as they stand in such a stream, for hosts that know by themselves what belongs together and
  /// that it is undamaged. Throws InputError when they cannot be this body's; it is then as before.
  void serialize(Archive& archive);

  /// Present nodes at their initial positions. It stays where it is as long as the body lives, moved or not, and so do
  /// its arrays, until nodes are split or a reset or load joins them again.
  const HexMesh& mesh() const;
  const std::vector<Material>& materials() const;  ///< one, or one per hexahedron
  const Material& material(int hexahedron) const;
  const Settings& settings() const;
  bool can_flow() const;  ///< some hexahedron has what it takes: a yield stress and a rate, or a rotation's rate

  /// What has become of the body. Views are of the present state: the next call that changes the history ends them.
  ///
  /// [m] num_nodes x 3: where nodes would be without forces. With RestShape::kIsolated that is an equilibrium, found to
  /// about 1e-4 of an edge where something has flowed since it was asked for, by 4 to 12 linear solutions of most
  /// bodies, 50 to 100 of one that is about to snap through; each connected part is laid on its initial positions.
  /// Nothing else depends on it.                                                               theory.md section 5.9
  const PointArray& plastic_rest_positions() const;
  bool plastic_rest_has_converged() const;                 ///< if not, they are less exact: the best of 100 iterations
  std::span<const unsigned char> alive() const;            ///< per hexahedron: 0 once it is removed
  std::span<const int> removed() const;                    ///< in the order of their removal
  std::span<const CornerValues> yield_stress() const;      ///< [Pa] per hexahedron; infinite if it never yields
  std::span<const CornerValues> plastic_strain() const;    ///< [-] per hexahedron, accumulated
  const HexMesh& initial_mesh() const;                     ///< before nodes were split; until then it is mesh()
  const Joints& joints() const;                            ///< of the initial mesh, found when first asked for
  const NodeCopies& copies() const;                        ///< of the initial nodes
  std::span<const int> opened() const;                     ///< joints, in the order of the calls of `open`
  std::span<const double> crossings() const;               ///< [-] of these
  long revision() const;                                   ///< grows with remove, open, reset, load and set_materials
  double dissipated_energy() const;                        ///< [J] accumulated plastic work, and loss by relaxation
  ElementPoints element_rest_shape(int hexahedron) const;  ///< [m] its isolated one, Pi y, about its mean

  ElementFields fields(ConstPoints x) const;

  /// Volume [m^3] of the elements that are left, at any nodal positions (current or plastic rest) and in their
  /// initial shape.
  double volume(ConstPoints x) const;
  double initial_volume() const;
  double initial_volume(int hexahedron) const;  ///< also of one that is gone

  /// Adds every History array, in declaration order, as raw little-endian bytes.
  void add_to(StateHash& hash) const;

  /// Model, History and Backend themselves, for the library's own tests and measurements (src/body_state.hpp).
  struct State;
  State& state();
  const State& state() const;

 private:
  std::unique_ptr<State> state_;
};

// One value per hexahedron, each without the decompositions that Body::fields needs: in a time that does not count
// beside a step.

/// [-] ElementFields::plastic_strain.
std::vector<double> plastic_strains(const Body& body);

/// [Pa] ElementFields::yield_stress.
std::vector<double> present_yield_stresses(const Body& body);

/// [m^3] at any nodal positions (num_nodes x 3): the current ones, or body.plastic_rest_positions(). 0 for those that
/// are removed. Throws InputError for positions of another number of nodes.
std::vector<double> element_volumes(const Body& body, ConstPoints x);

/// [-] ElementFields::volume_ratio, up to rounding: volume at the plastic rest positions over the initial one.
std::vector<double> plastic_volume_ratios(const Body& body);

}  // namespace hexaplast
