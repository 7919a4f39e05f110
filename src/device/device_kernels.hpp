// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace hexaplast {

inline constexpr int kBrick = 32;       ///< hexahedra of a brick, a warp of a GPU
inline constexpr int kBrickNodes = 80;  ///< room for the nodes of a brick
/// J^-1 / 2 (9), volume [m^3], mu, lambda [Pa], flow rate [1/s], hardening, fracture stress [Pa] and stretch
inline constexpr int kBrickNumbers = 16;
inline constexpr int kHistoryNumbers =
    88;  ///< of a hexahedron: G, by entries, tau [Pa], accumulated strain; each of all samples
inline constexpr std::uint8_t kIsLeft = 1, kMayBreak = 4;  ///< bits of the status of a hexahedron

/// Hexahedra in bricks. Nodes have numbers of their own; arrays of nodes have four numbers per node.
struct LayoutArrays {
  int num_bricks, num_nodes;
  const std::uint8_t* local;     ///< [brick][corner][kBrick]: number of the node in the brick
  const std::uint8_t* sorted;    ///< [brick][8 kBrick]: corners (corner kBrick + hexahedron) by node, of what is there
  const std::uint16_t* begin;    ///< [brick][kBrickNodes + 1]: where those of a node begin
  const int* node;               ///< [brick][kBrickNodes], or -1
  const int* partial_begin;      ///< [node + 1]
  const int* partial;            ///< places [brick][kBrickNodes] of a node
  const std::uint32_t* present;  ///< [brick]: a bit per hexahedron that is there
};

/// A body.
struct BrickArrays {
  LayoutArrays at;
  const float* rest;  ///< [brick][kBrickNumbers][kBrick]
  float length;       ///< [m] unit of coefficients
};

/// NodalMap, of nodes of the device.
struct MapArrays {
  int num_rows;
  const int *first, *column;
  const float* weight;
};

/// A coarse mesh of multigrid: its cells in bricks, and what leads there from the finer mesh and back.
struct LevelArrays {
  LayoutArrays at;
  const float* rest;     ///< [brick][9][kBrick]: length times the inverse of the edges, as columns
  const float* moduli;   ///< [brick][16][kBrick]: mu V / length^2 of each child, and lambda V / length^2
  const int* child;      ///< [brick][8][kBrick]: places in the finer mesh, or -1
  const int* fine_node;  ///< [node]: the node of the finer mesh there, or -1
  MapArrays placement, restriction, prolongation;
};

/// SlotBlocks::Entry of a node, whose axes other terms couple. Matrices by rows.
struct BlockEntry {
  float axes[9], dual[9];
  float stiffness[3], inverse[3], rigid[3], loss[3];
  float alone[3];  ///< 1 where the row is not coupled, else 0
};

/// A step of Chebyshev's iteration: d = a d + b D^-1 r, x += d.
struct ChebyshevStep {
  float a, b;
};

/// The kernels of one body, on a device or on the CPU in its place; a library that is loaded when somebody asks for it.
/// Throws std::runtime_error with what the device says.
class DeviceKernels {
 public:
  struct Sums {
    double value = 0;
    int first = 0, second = 0;
  };
  struct Norms {
    double r_r = 0, r_z = 0;
  };
  /// Sums of factor diag(L) over the degrees of freedom: all; free ones; those where it is above break_even times the
  /// rest.
  struct Stiffness {
    double all = 0, free = 0, stiff = 0;
  };

  virtual ~DeviceKernels() = default;

  /// Another body, in which nothing is known.
  virtual void set_bricks(const BrickArrays& bricks) = 0;
  /// numbers: three arrays, one behind the other: G, tau, strain, each [brick][number][kBrick].
  virtual void set_history(const double* numbers) = 0;
  virtual void get_history(double* numbers) = 0;

  virtual void set_positions(const double* x) = 0;
  /// Returns how many hexahedra have a corner below thin_from.
  virtual int linearize(float thin_from) = 0;
  virtual void get_force(float* f) = 0;
  virtual void multiply(float factor, const float* dx, float* df) = 0;  ///< df = factor L dx; between two solves
  virtual Sums energy(float thin_from) = 0;                             ///< [J], and how many are so thin

  /// value [J] dissipated; how many hexahedra are left over; how many flow. Until take_flow the history is as before.
  virtual Sums flow(float dt, float least_det, bool is_true_stress) = 0;
  /// [brick][kBrick] of that step: kIsLeft; kMayBreak where a hexahedron has flowed to a limit, or near it.
  virtual void get_status(std::uint8_t* status) = 0;
  /// A hexahedron, by its place: before the step or, after take_flow, as it is; and after it.
  virtual void get_hexahedron(int place, double (&numbers)[kHistoryNumbers]) = 0;
  virtual void set_hexahedron(int place, const double (&numbers)[kHistoryNumbers]) = 0;
  virtual void take_flow() = 0;

  /// A = factor L + diagonal. rest: of the preconditioner beside the diagonal of L, infinite where fixed. is_scaled: it
  /// is the diagonal, until cycles are prepared.
  virtual Stiffness set_system(float factor, const float* diagonal, const float* rest, bool is_scaled,
                               float break_even) = 0;

  /// Blocks of nodes beside `rest`. diag(factor L) + rest of such nodes, four numbers each.
  virtual void get_diagonal(const int* nodes, int count, float* diagonal) = 0;
  virtual void set_blocks(const int* nodes, const BlockEntry* blocks, int count) = 0;

  /// Terms beside the body: row k, that of node[k], has the blocks [first[k], first[k + 1]), nine numbers each by rows,
  /// of the nodes `column`. They are in all products of the present system.
  virtual void set_terms(int num_rows, const int* node, const int* first, const int* column, const double* blocks) = 0;

  /// Cycles: the meshes below the body's, once; they are linearized with it. D of each mesh, for the present system.
  virtual void set_levels(const LevelArrays* levels, int count) = 0;
  virtual void prepare_cycles(bool has_others) = 0;  ///< has_others: false leaves out blocks, and what `rest` adds
  /// Lanczos' method for D^-1 A of a mesh, 0 being the finest (LanczosSpace): v is `first` times D^-1.
  virtual double start_lanczos(int level, const float* first) = 0;
  virtual double multiply_lanczos(int level, float scale) = 0;
  virtual double advance_lanczos(int level, float scale, float along, float before) = 0;
  virtual void set_smoother(int level, const ChebyshevStep* steps, int count) = 0;
  virtual double precondition() = 0;  ///< z by a cycle; r.z

  virtual Norms start(const float* r, const float* p) = 0;  ///< x = 0, r, p; p null: 0
  /// p = z + beta p, or p as it is; p.Ap. z: of the latest cycle, or the diagonal's. others: of p, by the host; null:
  /// nothing.
  virtual void set_direction(double beta, float* p) = 0;
  virtual double product(bool has_direction, double beta, const float* others) = 0;
  virtual Norms advance(double alpha) = 0;
  virtual void get_solution(float* x) = 0;
  virtual void get_residual(float* r) = 0;
};

inline constexpr int kDeviceVersion = 4;                   ///< of the class above
#define HEXAPLAST_DEVICE_ENTRY "hexaplast_device_kernels"  // DeviceKernels* (int version); null: another version

}  // namespace hexaplast
