// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/types.hpp"
#include "hexaplast/contact/contact_terms.hpp"
#include "hexaplast/contact/surface_samples.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// Contact of the surfaces of two deformable bodies, or of one body with itself.        theory.md eq. C1-C4, C6-C8
///
/// Samples of each surface are looked up in the hexahedra of the other one, where it is expected at the end of the
/// step: each side with half of the stiffness, so that two surfaces that overlap press with k depth. A sample that lies
/// in a hexahedron touches; q is the place of the present surface that is nearest to it, found from the one that is
/// nearest in the initial shape, or from that of the step before, and n the direction from the sample to q. Where that
/// place lies on another side than the one that the sample came through, near an edge or in a thin body, q lies on its
/// own side, unless the nearest one faces the sample much more. Forces act at the sample on both bodies, by the weights
/// of the face that it lies on and by the shape functions of the hexahedron that it lies in: neither a net force nor a
/// net moment is left. They are linear in the step, as those of InstrumentContact, and contacts that would pull are
/// released in the same way.
///
/// A body does not touch itself within two hexahedra, counted through faces that they have in common at present: the
/// walls of a cut touch each other, but near its end.
///
/// Where a body that touches itself opens, or hexahedra go, samples around begin to touch at their present distance, so
/// that a cut exerts no force. While a sample does not press, that distance grows with the largest one at the
/// beginnings of steps, up to that of the settings: no energy appears.
///
/// Bodies that move by more than half of their smallest thickness against each other in a step, that of a hexahedron
/// at the surface, are looked at in between as well. Where their boxes are apart, samples are not looked at. Nodes that
/// no hexahedron has any more count nowhere.
///
/// State: per sample its anchor, a place in a hexahedron of the other body, N, the face of the side that it came
/// through, and the distance at which it begins to touch, or that this is to be found; whether the body has opened.
class TissueContact {
 public:
  /// Of two bodies. The meshes must outlive it. max_parts: of the edge of a face, between samples. Throws InputError
  /// for settings that are not allowed.
  TissueContact(const HexMesh& first, const HexMesh& second, ContactSettings settings, int max_parts);
  /// Of one body with itself.
  TissueContact(const HexMesh& body, ContactSettings settings, int max_parts);
  ~TissueContact();
  TissueContact(TissueContact&&) noexcept;
  TissueContact& operator=(TissueContact&&) noexcept;

  void set_settings(ContactSettings settings);

  /// Which hexahedra are left of each body; empty: all. The meshes may have other nodes than before: split, of each.
  /// Samples that were there before keep their state, each copy of them. Of one body: give what split twice.
  void set_alive(std::span<const unsigned char> first, std::span<const unsigned char> second,
                 const std::array<SplitNodes, 2>& split = {});

  /// [m] How deep a sample lies in the other body at x, at most; 0: none does.
  double depth_at(const Pair<ConstPoints>& x);

  /// Finds the contacts of the step to come, of h [s]. x, v: at its beginning. Of one body: give it twice, as a Pair.
  /// Throws NumericalError where bodies that may meet move by more than 500 edges against each other in the step.
  void begin_step(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, double h);

  /// The contacts of the present step.
  const ContactTerms& terms() const { return terms_; }

  /// Releases the contacts that would pull at x and v. Returns whether there were any.
  bool release(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) { return terms_.release(x, v); }

  /// The step has ended at x: anchors follow, and forces are those by which it was solved.
  void end_step(const Pair<ConstPoints>& x);

  /// Samples of a body that touches itself begin to touch where they are: for contact that is made where it is cut.
  void begin_where_they_are();

  /// As it was made: nothing has touched yet, or come apart.
  void reset();

  /// Throws InputError for the state of other samples, or of hexahedra that are not there; it is then as before.
  void serialize(Archive& archive);

  /// In the present step; of a state that was just loaded, in the step before it.
  int num_touching() const { return terms_.empty() ? totals_.touching : static_cast<int>(terms_.terms.size()); }
  int num_slipping() const { return terms_.empty() ? totals_.slipping : terms_.num_slipping(); }
  /// Samples that were looked at in the present step, in all checks; 0: the bodies are too far from each other.
  long num_examined() const { return num_examined_; }
  double edge() const;     ///< [m] the smaller one of the mean edges of the two surfaces; 0: there is none
  double spacing() const;  ///< [m] the largest distance between neighbouring samples

  /// [N] On the first body, [m] the deepest place of a sample, [J] in the springs, by the contacts of the latest step.
  /// Of one body with itself the force is zero.
  const Vec3& force() const { return totals_.force; }
  double depth() const { return totals_.depth; }
  double energy() const { return totals_.energy; }

 private:
  struct Side;
  double num_checks(const Pair<ConstPoints>& v, double h) const;
  void find_distances(ConstPoints x);

  std::array<const HexMesh*, 2> meshes_;  // the same twice: with itself
  ContactSettings settings_;
  int max_parts_;
  std::array<double, 2> wanted_ = {};         // [m] between the samples of each surface
  std::array<std::vector<int>, 2> nodes_;     // of the hexahedra that are left of each body
  std::vector<std::unique_ptr<Side>> sides_;  // samples of the first body in the second one, and the other way round
  bool has_touching_ = false;                 // some sample may have a state
  bool has_opened_ = false;                   // a body that touches itself
  long num_examined_ = 0;
  ContactTerms terms_;
  ContactTotals totals_;
  std::vector<int> first_sample_;  // per side, in ContactTerm::sample
  std::array<PointArray, 2> expected_;
};

}  // namespace hexaplast
