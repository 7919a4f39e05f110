// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "hexaplast/material/material.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "layout/coarse_mesh.hpp"
#include "layout/partition.hpp"

namespace hexaplast {

struct History;

/// What changes after a body is built only where joints open: nodes are split then.
struct Model {
  HexMesh mesh;                     ///< present nodes, at their initial positions
  NodeCopies copies;                ///< of the initial nodes
  std::vector<Material> materials;  ///< one, or one per element
  Settings settings;
  std::vector<Lame> lame;      ///< [Pa] per element
  std::vector<double> volume;  ///< [m^3] V0, initial volume per element

  std::shared_ptr<const Partition> partition;  ///< of the mesh, for the kernels
  AlignedVector<double> lame_blocks;           ///< [Pa] [block][mu, lambda][element]
  double length = 1;                           ///< [m] unit of the kernels: a power of two near the edges' length

  bool can_stretch = false;             ///< some element has a yield stress and a flow rate
  bool can_rotate = false;              ///< some element has a rotation flow rate, and the mode uses it
  bool is_plain = false;                ///< the plain implementation computes it
  bool tracks_plastic_stretch = false;  ///< some element breaks by its plastic stretch, so that it must be remembered

  /// Whether Gauss-Newton steps of the averaging leave the rotations of the isolated shapes free, in place of those of
  /// the joined ones (theory.md 5.5): bodies tilt. Set by tests of the plain implementation alone, whose reference
  /// numbers were computed so.
  bool turns_isolated_shapes = false;

  /// Throws InputError for materials or settings outside their ranges, or a material count that is neither 1 nor
  /// num_elements.
  Model(HexMesh mesh, std::vector<Material> materials, Settings settings);

  /// The same mesh, partition and settings, made of something else. Throws like the constructor above.
  Model(const Model& other, std::vector<Material> materials);

  const HexMesh& initial_mesh() const { return initial_ ? *initial_ : mesh; }

  /// What holds the hexahedra together in the initial mesh, found when it is first asked for.
  const Joints& joints() const;

  /// Splits nodes where the joints of `history` are open, its calls before `first_call` being in the mesh already.
  /// Returns per new node the one that it was split from.
  std::vector<int> open(const History& history, int first_call);

  /// Back to the initial mesh.
  void close();

  /// Rotation maps that each element carries: one, or one per corner in the paper's modes.
  int maps_per_element() const {
    return settings.rotation_plasticity == RotationPlasticity::kVertex ||
                   settings.rotation_plasticity == RotationPlasticity::kCentre
               ? kCorners
               : 1;
  }

  bool can_flow() const { return can_stretch || can_rotate; }
  /// Whether joined rest shapes may become others than the initial ones.
  bool has_rest_shapes() const { return is_plain && settings.rest_shape == RestShape::kJoined; }
  bool can_flow_isolated() const { return can_flow() && settings.rest_shape == RestShape::kIsolated; }

  ElementPoints initial_shape(int element) const;                   ///< [m] corners about their mean
  std::array<double, kCorners> corner_jacobian(int element) const;  ///< [m^3] det J_i(X)

  const Material& material(int element) const { return materials[materials.size() == 1 ? 0 : element]; }

  /// Per element, whether it is so thin beside `length` that its coefficients, that length over its thickness, may
  /// leave half precision. Found when they are first asked for.
  const std::vector<unsigned char>& is_thin() const;

  /// The meshes below `mesh` for multigrid, found when they are first asked for.
  const std::vector<CoarseMesh>& coarse_meshes() const;

 private:
  void take_materials();  // what follows from `materials`
  void take_mesh(HexMesh changed);
  void fill_lame_blocks();

  /// Found when it is first asked for, by this model or a copy of it.
  template <class T>
  struct Shared {
    std::once_flag found;
    std::optional<T> value;
  };
  std::shared_ptr<const HexMesh> initial_;  // once nodes have been split
  std::shared_ptr<Shared<Joints>> joints_ = std::make_shared<Shared<Joints>>();
  std::shared_ptr<Shared<std::vector<unsigned char>>> thin_ = std::make_shared<Shared<std::vector<unsigned char>>>();
  std::shared_ptr<Shared<Charts>> charts_ = std::make_shared<Shared<Charts>>();  // of the initial mesh
  std::shared_ptr<Shared<std::vector<CoarseMesh>>> coarse_ = std::make_shared<Shared<std::vector<CoarseMesh>>>();
};

}  // namespace hexaplast
