// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

struct ContactSettings {
  double stiffness = 0;             ///< k [Pa/m] pressure per depth
  double tangential_stiffness = 0;  ///< k_t [Pa/m] shear stress per displacement while it sticks
  double friction = 0;              ///< mu
  double distance = 0;              ///< d [m] contact begins there
  double damping = 0;               ///< c [Pa s/m] pressure per speed of approach
  bool is_active = true;            ///< otherwise nothing touches

  /// Throws InputError for what is negative or not finite, or a stiffness that is 0; `whose` begins the message.
  void require_valid(const char* whose) const;
};

/// One contact in one step: springs and a damper on r = sum_a w_a x_a, a point of the first body, less one of the
/// second body where there is one. Its forces are linear in x and v.                    theory.md eq. C2, C3, C6
///
///   g = n.(r - place),                   f_n = -(k A g + c A n.(dr/dt - velocity)) n
///   u = (I - n n^T)(r - anchor),         f_t = -tangential (u - (slip.u) slip) - limit slip
///
/// slip is 0 where it sticks.
///
/// w_a (f_n + f_t) acts on node a.
struct ContactTerm {
  std::array<int, 2 * kCorners> nodes = {};
  std::array<double, 2 * kCorners> weights = {};  ///< those of the second body are negative
  int num_first = 0;                              ///< nodes of the first body, which come first
  int num_nodes = 0;
  int sample = 0;  ///< that it belongs to

  Vec3 normal = Vec3::UnitZ();
  Vec3 place = Vec3::Zero();     ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s] of `place`
  Vec3 anchor = Vec3::Zero();    ///< [m]
  double stiffness = 0;          ///< k A [N/m]
  double damping = 0;            ///< c A [N s/m]
  double tangential = 0;         ///< [N/m] k_t A, or mu N / |u| where it slips
  double stick = 0;              ///< k_t A [N/m]
  double friction = 0;           ///< mu
  double normal_before = 0;      ///< [N] normal force of the step before, 0 of a new contact
  double negligible = 0;         ///< [N] normal force, or pull, that is none: surfaces that lie on one another
  double limit = 0;              ///< mu N [N]
  Vec3 slip = Vec3::Zero();      ///< direction of u where it slips: mu N acts against it
  bool slips = false;
  Vec3 begin = Vec3::Zero();  ///< [m] r at the beginning of the step
  Vec3 end = Vec3::Zero();    ///< [m] r where the step was solved

  void add_node(int node, double weight) {
    nodes[num_nodes] = node;
    weights[num_nodes++] = weight;
  }

  /// Of the first body alone: where the contact is.
  Vec3 place_on_first(ConstPoints x) const {
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < num_first; ++a) sum += weights[a] * x.row(nodes[a]).transpose();
    return sum;
  }

  /// r, dr/dt or a change of r.
  Vec3 at(const Pair<ConstPoints>& field) const {
    Vec3 sum = place_on_first(field.first);
    for (int a = num_first; a < num_nodes; ++a) sum += weights[a] * field.second.row(nodes[a]).transpose();
    return sum;
  }

  double gap(const Vec3& r) const { return normal.dot(r - place); }
  Vec3 displacement(const Vec3& r) const {
    const Vec3 u = r - anchor;
    return u - normal.dot(u) * normal;
  }
  double normal_force(const Vec3& r, const Vec3& change) const {
    return -stiffness * gap(r) - damping * normal.dot(change - velocity);
  }
  Vec3 tangential_force(const Vec3& r) const {
    const Vec3 u = displacement(r);
    return -tangential * (u - slip.dot(u) * slip) - limit * slip;
  }
  Vec3 force(const Vec3& r, const Vec3& change) const { return normal_force(r, change) * normal + tangential_force(r); }

  /// -df/dr times a change of r, and as a matrix.
  Vec3 stiffness_times(const Vec3& dr) const {
    const double along = normal.dot(dr);
    return stiffness * along * normal + tangential * (dr - along * normal - slip.dot(dr) * slip);
  }
  Mat3 stiffness_matrix() const {
    const Mat3 across = Mat3::Identity() - normal * normal.transpose() - slip * slip.transpose();
    return stiffness * normal * normal.transpose() + tangential * across;
  }

  /// Friction for the normal force N [N]. expected: the r that the step may lead to.
  void set_friction(double N, const Vec3& expected);

  /// Sets it to what N and the displacement at the end of the step stand for, unless it is that to 1 % of mu N.
  /// Returns by how much the force differs [N].
  double correct_friction(const Vec3& r, const Vec3& change);
};

/// Of the contacts of the latest step, which may be over: in saved states.
struct ContactTotals {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  ///< [N], [N m]
  double depth = 0, energy = 0;                      ///< [m], [J]
  double work = 0, friction_loss = 0;                ///< [J] so far
  int touching = 0, slipping = 0;                    ///< where the terms of the step are not there any more

  /// Throws InputError for numbers that contacts of so many samples cannot have.
  void require_of(std::size_t num_samples) const;
};

/// What acts on the nodes by the contacts of one step.
class ContactTerms {
 public:
  std::vector<ContactTerm> terms;
  bool empty() const { return terms.empty(); }
  int num_slipping() const;

  /// At the beginning of a step of h [s] from x, for contacts with all but `tangential`, `limit` and `slip`. expected:
  /// positions that the step may lead to.
  void begin_step(const Pair<ConstPoints>& x, const Pair<ConstPoints>& expected, double h);

  /// r and dr/dt of a term at the end of a step that has ended at x: those by which its force acted. Prescribed motion
  /// may have moved nodes since the step was solved, and the velocities of its end may have been damped.
  struct End {
    Vec3 r, change;
  };
  End end_of(const ContactTerm& term, const Pair<ConstPoints>& x) const;

  /// f += forces [N]. K = df/dx, B = df/dv are constant.
  void add_force(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) const;
  void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const;
  void add_damping_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const;

  /// first_nodes: where the nodes of each body begin in A.
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes = {}) const;
  void add_damping_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes = {}) const;

  /// Takes out the contacts that would pull at x and v. If there are none, corrects the friction that is not what N and
  /// the displacements there stand for, if it is more than 10 % of all; in four calls of a step at most. Returns
  /// whether anything was done: the step is to be solved again.
  bool release(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v);

 private:
  template <class Block>
  void add_blocks(BlockMatrix& A, std::array<int, 2> first_nodes, const Block& block_of) const;

  void set_friction(const Pair<ConstPoints>& expected);

  double h_ = 1;                        // [s] of the step
  bool is_solved_ = false;              // terms know their ends
  int num_corrections_ = 0;             // of friction in the step
  std::vector<ContactTerm> corrected_;  // scratch
};

}  // namespace hexaplast
