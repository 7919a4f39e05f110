// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/contact/instrument_contact.hpp"
#include "hexaplast/mesh/blade.hpp"
#include "hexaplast/solve/mechanics.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// In scenes: BladeController.
struct BladeOptions {
  PointArray points = PointArray(0, 3);     ///< [m] of the edge, a chain, in the frame of the blade
  bool is_prescribed = false;               ///< the host tells its poses; there is no path then
  std::vector<double> key_times = {};       ///< [s] of its path, ascending
  PointArray positions = PointArray(0, 3);  ///< [m] one row per key time
  std::vector<double> orientations = {};    ///< quaternions x y z w, one per key time, or none
  bool active = true;

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(points);
    HEXAPLAST_OPTION(key_times);
    HEXAPLAST_OPTION(positions);
    HEXAPLAST_OPTION(orientations);
    HEXAPLAST_OPTION(active);
  }
};

/// A blade that moves along a path and cuts a body: at the end of a step it tells which joints open (BladeCut). Who
/// drives the step opens those of all blades together, by Body::open.
class Blade {
 public:
  using Options = BladeOptions;
  static const attributes::Description& description();

  /// The body must outlive it. Throws OptionError.
  Blade(BladeOptions options, const Body& body);

  void set_options(BladeOptions options);  ///< throws OptionError

  /// Poses at the beginning and at the end of the steps that begin from now on, for one whose motion is prescribed.
  void prescribe(const Pose& from, const Pose& to) { prescribed_ = {from, to}; }

  void begin_step(const Step& step, ConstPoints x);

  /// The joints that open in the step, which has ended at x; ascending, valid until the next call. Throws InputError
  /// (BladeCut::opened).
  const std::vector<int>& end_step(ConstPoints x);

  const std::vector<double>& crossings() const { return cut_.crossings(); }  ///< of these (Body::open)

  Pose pose_at(double time) const;  ///< along its path
  const BladeOptions& options() const { return options_; }

 private:
  Pose pose_at_fraction(double fraction) const;
  void find_moments();
  void add_moment(double fraction);

  const Body& body_;
  BladeCut cut_;
  double reach_ = 0;  // [m] of the points from the origin of their frame
  BladeOptions options_;
  std::array<Pose, 2> prescribed_ = {};
  long revision_ = -1;  // of the body that is_open_ was found for
  std::vector<unsigned char> is_open_;
  std::optional<Step> step_;  // none: not active
  PointArray x_before_;
  std::vector<BladeAt> moments_;
  std::size_t num_moments_ = 0;
  std::vector<int> none_;
};

}  // namespace hexaplast::parts
