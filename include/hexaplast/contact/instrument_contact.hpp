// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/types.hpp"
#include "hexaplast/contact/contact_terms.hpp"
#include "hexaplast/contact/solid.hpp"
#include "hexaplast/contact/surface_samples.hpp"

namespace hexaplast {

/// Where a rigid solid is, and how it is turned.
struct Pose {
  Vec3 position = Vec3::Zero();  ///< [m] of the origin of its frame
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();

  Vec3 to_world(const Vec3& own) const { return position + orientation * own; }
  Vec3 to_own(const Vec3& world) const { return orientation.conjugate() * (world - position); }

  /// At a fraction of the way from a to b.
  static Pose between(const Pose& a, const Pose& b, double fraction) {
    return {(1 - fraction) * a.position + fraction * b.position, a.orientation.slerp(fraction, b.orientation)};
  }
};

/// Contact of the surface of a body with a rigid instrument that moves.                    theory.md eq. C1-C5
///
/// A sample p with the area A touches in a step if its distance from the instrument is below d at the beginning, or
/// that of the place that it is expected at, x_n + h v_n, at the end; q is the nearest place of the instrument, n the
/// direction to p. In the step
///
///   g = n.(p - q) - d,            f_n = -A (k g + c dg/dt) n                      normal
///   u = (I - n n^T)(p - anchor),  f_t = -k_t A u               k_t A |u| <= mu N     sticks
///                                     = -mu N u / |u_p|        beyond                slips; u_p: expected u
///
/// with places of the instrument at the end of the step. n, q, u_p and N are those of the beginning of the step, so
/// that forces are linear in x and the step of an implicit integrator ends with them. Contacts that would pull at the
/// end of a step are released, those whose friction differs from that of the u there are corrected, and the step is
/// solved again. When a step is accepted, the anchors of samples that slip
/// follow them until k_t A |u| = mu N.
///
/// A sample that passes the instrument within a step is found by poses in between. Where boxes tell that nothing can
/// touch, samples are not looked at.
///
/// The nearest place may lie on another side than the one that the sample came through, near an edge, or deeper than
/// half of the thickness. Then q is where the sample leaves the instrument straight towards its own side, unless the
/// nearest one faces the sample much more.
///
/// State: per sample its anchor, in the frame of the instrument, N, and n.
class InstrumentContact {
 public:
  /// Throws InputError for settings that are negative or not finite, or a stiffness that is 0.
  InstrumentContact(Solid solid, ContactSettings settings, SurfaceSamples samples);

  const Solid& solid() const { return solid_; }
  const SurfaceSamples& samples() const { return samples_; }
  void set_settings(ContactSettings settings);

  /// Other samples of the same body, as after hexahedra have gone or nodes have split. Samples that were there before
  /// keep their state, each copy of them.
  void set_samples(SurfaceSamples samples, const SplitNodes& split = {});

  /// Whether boxes tell that something may touch in such a step: that of the nodes that move samples, or of all where
  /// there are no samples.
  bool can_touch(ConstPoints x, ConstPoints v, double h, const Pose& begin, const Pose& end) const;

  /// Finds the contacts of the step to come, of h [s]. x, v: at its beginning.
  void begin_step(ConstPoints x, ConstPoints v, double h, const Pose& begin, const Pose& end);

  /// The contacts of the present step; the body is the first one of the terms, and there is no second.
  const ContactTerms& terms() const { return terms_; }

  /// Releases the contacts that would pull at x and v, and corrects the friction of those whose force is not what their
  /// displacement there stands for. Returns whether there were any: the step is to be solved again.
  bool release(ConstPoints x, ConstPoints v) { return terms_.release(x, v); }

  /// The step has ended at x: anchors follow, and forces on the instrument are those by which it was solved.
  void end_step(ConstPoints x);

  /// As it was made: nothing has touched yet.
  void reset();

  /// Throws InputError for the state of other samples.
  void serialize(Archive& archive);

  /// In the present step; of a state that was just loaded, in the step before it.
  int num_touching() const { return terms_.empty() ? totals_.touching : static_cast<int>(terms_.terms.size()); }
  int num_slipping() const { return terms_.empty() ? totals_.slipping : terms_.num_slipping(); }

  /// Samples that were looked at in the present step; 0: the body is too far away.
  int num_examined() const { return num_examined_; }

  /// On the instrument, by the contacts of the latest step.
  const Vec3& force() const { return totals_.force; }    ///< [N]
  const Vec3& torque() const { return totals_.torque; }  ///< [N m] about the origin of its frame

  /// [m] The deepest place of a sample, and [J] in the springs, at the end of the latest step.
  double depth() const { return totals_.depth; }
  double energy() const { return totals_.energy; }

  /// [J] What the instrument has done by its motion, and what friction has taken, so far. What is left of the work
  /// after friction and the energy of the springs is what the body has received, or damping.
  double work() const { return totals_.work; }
  double friction_loss() const { return totals_.friction_loss; }

 private:
  struct SampleState {
    Vec3 anchor = Vec3::Zero();  // [m] in the frame of the instrument
    double normal_force = 0;     // N [N] at the end of the latest step; 0: does not touch, and has no anchor
    Vec3 normal = Vec3::Zero();  // in that frame, of the side that it came through; 0: it was not within

    bool is_within() const { return !normal.isZero(0); }
  };

  void take_samples(SurfaceSamples samples);

  Solid solid_;
  ContactSettings settings_;
  SurfaceSamples samples_;
  std::vector<int> nodes_;           // that move samples
  double spread_ = 1;                // greatest sum of |weights| of a sample: more than 1 of one outside of its nodes
  std::vector<SampleState> states_;  // per sample
  bool has_touching_ = false;        // some sample may be within
  Pose pose_before_, pose_;          // at the beginning and at the end of the present step

  struct Found {
    bool touches = false;
    Vec3 place;                // in the frame of the instrument
    Vec3 side = Vec3::Zero();  // normal in that frame, also of a sample that was within and is not expected to touch
    Vec3 first;                // where the sample was, in that frame, when it came to touch
  };
  std::vector<Found> found_;  // scratch, per sample
  int num_examined_ = 0;
  ContactTerms terms_;
  ContactTotals totals_;
  PointArray expected_;  // scratch
};

}  // namespace hexaplast
