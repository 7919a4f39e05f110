// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/geometry/cut_surface.hpp"

namespace hexaplast::output {

/// The bodies of a scene as pictures and files show them: one mesh, with the nodes and the hexahedra of one body behind
/// those of another. Nodal arguments are num_nodes x 3, of all bodies. A single body is its own mesh.
class Bodies {
 public:
  struct Entry {
    std::string name;  ///< different for each
    const Body* body = nullptr;
    int first_node = 0, first_hexahedron = 0;  ///< in the mesh of all
  };

  /// The bodies must outlive this object.
  Bodies(const Body& only);  // NOLINT(google-explicit-constructor): what takes several takes one
  explicit Bodies(std::vector<Entry> entries);

  std::span<const Entry> all() const {
    update();
    return entries_;
  }
  bool is_empty() const { return entries_.empty(); }
  bool is_one() const { return entries_.size() == 1; }

  const HexMesh& mesh() const {
    update();
    return is_one() ? entries_[0].body->mesh() : *mesh_;
  }

  /// Whether nodes have split.
  bool are_split() const;

  /// For those who draw walls. Null: no nodes have split.
  std::shared_ptr<const OpenFaces> open_faces() const;

  /// The same as those of Body, for all. Views are valid until the next call, or until a body changes.
  std::span<const unsigned char> alive() const;
  const PointArray& plastic_rest_positions() const;
  ElementFields fields(ConstPoints positions) const;
  double energy(ConstPoints positions) const;
  double dissipated_energy() const;
  double volume(ConstPoints positions) const;
  double initial_volume() const;
  std::size_t num_removed() const;
  std::size_t num_opened() const;  ///< joints

  /// Plastic rest positions are at hand: where isolated rest shapes can flow, they take linear systems.
  bool has_plastic_rest_at_hand() const;

  /// [m^3] of the remaining hexahedra without elastic deformation.
  double plastic_volume() const;

  /// The rows of one body, which is an entry of all().
  template <class Field>
  static auto rows(const Entry& entry, Field& field) {
    return field.middleRows(entry.first_node, entry.body->mesh().num_nodes());
  }

 private:
  void update() const;  // of several, where their nodes are others

  mutable std::vector<Entry> entries_;
  mutable std::vector<long> revisions_;  // of the bodies that mesh_ is of
  std::shared_ptr<HexMesh> mesh_;        // of several; stays where it is
  mutable std::vector<unsigned char> alive_;
  mutable PointArray plastic_rest_positions_;
};

}  // namespace hexaplast::output
