// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deque>
#include <vector>

#include "view/snapshot.hpp"

namespace hexaplast::view {

/// The latest part of a curve: values over an abscissa that never falls.
class Trace {
 public:
  explicit Trace(double span) : span_(span) {}

  void add(double at, double value);  ///< what lies more than the span before it is forgotten

  void forget_after(double at);  ///< as if it had not been

  bool empty() const { return points_.empty(); }
  double latest() const { return points_.back().value; }
  double latest_time() const { return points_.back().at; }

  /// Widens [min, max] by the values at and after `begin`.
  void extend_range(double begin, double& min, double& max) const;

  /// Value that a fraction of all values does not exceed; 0 where there are none.
  double quantile(double fraction) const;

  template <class Visit>
  void for_each_since(double begin, const Visit& visit) const {
    for (const Point& point : points_)
      if (point.at >= begin) visit(point.at, point.value);
  }

 private:
  struct Point {
    double at, value;
  };
  double span_;
  std::deque<Point> points_;
};

/// What the plots show of a session.
struct Traces {
  static constexpr double kSpan = 8;     ///< [s] of simulated time
  static constexpr double kSteps = 400;  ///< of the plot of step times

  void add(const Snapshot& snapshot);

  Trace current_elongation{kSpan}, plastic_elongation{kSpan};  ///< [%]
  Trace plastic_strain{kSpan};                                 ///< [-]
  Trace current_volume{kSpan}, plastic_rest_volume{kSpan};     ///< error [%]
  Trace kinetic{kSpan}, elastic{kSpan}, dissipated{kSpan};     ///< [J]
  Trace step_ms{kSteps};                                       ///< [ms], over the number of the step
  std::vector<Trace> probes = {};                              ///< in the order of the scene
};

}  // namespace hexaplast::view
