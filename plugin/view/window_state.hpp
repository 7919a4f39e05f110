// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <utility>

#include "view/camera.hpp"
#include "view/figure.hpp"
#include "view/rate.hpp"
#include "view/trace.hpp"
#include "view/window.hpp"

namespace hexaplast::view {

/// A quantity that colours show.
struct Colouring {
  Quantity quantity;
  const char* name;
  const char* unit;
  bool begins_at_zero;
};
inline constexpr std::array kColourings{Colouring{Quantity::kPlasticStrain, "plastic strain", "-", true},
                                        Colouring{Quantity::kStressNorm, "stress norm", "Pa", true},
                                        Colouring{Quantity::kYieldStress, "yield stress", "Pa", false},
                                        Colouring{Quantity::kVolumeRatio, "volume ratio", "-", false},
                                        Colouring{Quantity::kSpeed, "speed", "m/s", true}};

/// What the parts of a window share: the session, what is seen of it at the moment, and how it is looked at.
struct WindowState {
  explicit WindowState(WindowCall& call);

  void take(double clock);  ///< the newest snapshot, at a time of the wall clock [s]
  void toggle_running();
  void reset();
  void fit();  ///< looks at the whole body

  const Colouring& colouring() const { return kColourings[static_cast<std::size_t>(now.quantity)]; }

  /// Values at the ends of the colour bar: of all that was shown since the beginning; none where nothing had a value.
  std::optional<std::pair<double, double>> scale() const;

  Session session;
  Snapshot now;
  Figure figure;
  Camera camera;
  float left = 0, width = 1, height = 1;  ///< [pixels] of the part of the window that shows the body

  Look look;
  HandSettings hand;
  std::optional<Vec3> grabbed;  ///< [m] where the mouse took hold of the tissue; none: it holds nothing
  Pace pace;
  Traces traces;
  Rate frames, steps;
  std::string message;
  bool wants_picture = false;

 private:
  Quantity shown_quantity_ = Quantity::kPlasticStrain;
  Eigen::AlignedBox1d greatest_;  // values shown since the beginning
};

}  // namespace hexaplast::view
