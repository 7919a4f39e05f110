// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <type_traits>
#include <vector>

#include "base/blocks.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// How a mesh is cut for the kernels: elements in blocks of kBlock, blocks in chunks that threads work on
/// independently, nodes in slots.
///
/// Elements have places, [block][element of the block]. Where the mesh has rows of four elements, a block holds four of
/// them, and the nodes along them lie in slots side by side: the kernels load these together.
///
/// A nodal vector of the kernels has four numbers per slot (x, y, z, unused). Slots [0, num_nodes) are the nodes, those
/// of one chunk side by side; a node that several chunks touch belongs to the first of them, and each of the others has
/// a ghost of it in a slot of its own behind, so that no two chunks write the same slot. The cut depends on the mesh
/// alone: results do not depend on the number of threads, bit for bit.
/// The last block is filled up with elements that are not there: their corners are the eight last slots.
struct Partition {
  Partition(int num_nodes, const std::vector<Hexahedron>& hexahedra);
  explicit Partition(const HexMesh& mesh) : Partition(mesh.num_nodes(), mesh.hexahedra()) {}

  int num_nodes = 0;
  int num_blocks = 0;
  int num_chunks = 0;
  int num_slots = 0;                  ///< nodes, ghosts, and the eight slots of elements that are not there
  std::vector<int> first_block;       ///< per chunk, and one more
  std::vector<int> first_node;        ///< per chunk, and one more: slots of the nodes that it owns
  std::vector<int> first_ghost;       ///< per chunk, and one more: slots of its ghost nodes
  std::vector<int> original;          ///< per ghost: slot of the node; index: slot - num_nodes
  std::vector<int> first_reduced;     ///< per chunk, and one more: into reduced_ghost
  std::vector<int> reduced_ghost;     ///< slots of the ghosts of nodes that a chunk owns, by ascending node
  std::vector<int> node_of_slot;      ///< per slot below num_nodes
  std::vector<int> slot_of_node;      ///< the inverse
  AlignedVector<int> corner;          ///< slots, [block][corner][element of the block]
  std::vector<unsigned char> is_run;  ///< per block: corner[place + 4] is the slot after corner[place], all corners
  std::vector<int> element_of_place;  ///< -1 where there is none, which is in the last block only
  std::vector<int> place_of_element;  ///< the inverse

  /// Element of the mesh in a block, or -1.
  int element(int block, int place) const { return element_of_place[block * kBlock + place]; }
  const int* corners(int block) const { return corner.data() + static_cast<std::size_t>(block) * kCorners * kBlock; }
  int absent_slot() const { return num_slots - kCorners; }  ///< first corner of the elements that are not there

  int num_elements = 0;
};

/// A nodal vector of the kernels, all zero.
template <class T>
AlignedVector<T> slot_vector(const Partition& partition) {
  return AlignedVector<T>(4 * static_cast<std::size_t>(partition.num_slots), T(0));
}

/// Two nodal vectors of the kernels, scratch of one call on a body: none relies on what an earlier one left there.
struct SlotScratch {
  AlignedVector<double> first, second;

  /// Makes room; 0 at the elements that are not there.
  void resize(const Partition& partition);
};

/// factor times a nodal field into the slots of its nodes, ghosts included.
template <class T>
void to_slots(const Partition& partition, ConstPoints field, AlignedVector<T>& slots, double factor = 1);

/// The four numbers of a slot, at once.
template <class T>
auto numbers_at(T* slots, int slot) {
  using Numbers = Eigen::Array<std::remove_const_t<T>, 4, 1>;
  return Eigen::Map<std::conditional_t<std::is_const_v<T>, const Numbers, Numbers>>(slots +
                                                                                    4 * static_cast<std::size_t>(slot));
}

/// The ghosts of a chunk from the nodes that they stand for.
template <class T>
void update_ghosts(const Partition& partition, int chunk, T* slots) {
  for (int slot = partition.first_ghost[chunk]; slot < partition.first_ghost[chunk + 1]; ++slot)
    numbers_at(slots, slot) = numbers_at(slots, partition.original[slot - partition.num_nodes]);
}

/// Adds what other chunks gathered in their ghosts to the nodes of a chunk, in a fixed order.
template <class T>
void reduce_ghosts(const Partition& partition, int chunk, T* slots) {
  for (int k = partition.first_reduced[chunk]; k < partition.first_reduced[chunk + 1]; ++k) {
    const int ghost = partition.reduced_ghost[k];
    numbers_at(slots, partition.original[ghost - partition.num_nodes]) += numbers_at(slots, ghost);
  }
}

}  // namespace hexaplast
