// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <utility>

#include "picture/renderer.hpp"
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
  void undo();
  void fit();  ///< looks at the whole body
  void set_pace();
  output::Drawing page() const;  ///< what is shown, as `render` draws it

  const Colouring& colouring() const { return kColourings[static_cast<std::size_t>(now.quantity)]; }

  /// Values at the ends of the colour bar: of all that was shown since the beginning; none where nothing had a value.
  std::optional<std::pair<double, double>> scale() const;

  Source& source;
  Session* session;  ///< null: what is shown is a run that is finished
  Replay* replay;    ///< null: it is a scene in motion
  Snapshot now;
  Figure figure;
  Camera camera;
  float left = 0, width = 1, height = 1;  ///< [pixels] of the part of the window that shows the body

  Look look;
  HandSettings hand;
  Names names;
  int cut_axis = -1;                       ///< what lies before a plane across this axis is cut off; -1: nothing is
  double cut_place = 0.5;                  ///< of the plane: fraction of the way through the initial shape
  std::optional<Figure::Seen> pointed_at;  ///< under the mouse
  Figure::Strongest strongest;             ///< of what was shown since the beginning
  std::optional<Vec3> grabbed;             ///< [m] where the mouse took hold of the tissue; none: it holds nothing
  Pace pace;
  double speed;  ///< in real time
  Traces traces;
  Rate frames, steps;
  double seconds_per_second = 0;  ///< simulated, by the clock
  std::string message;
  bool wants_picture = false;  ///< of the window
  bool wants_page = false;     ///< of what it shows, as `render` draws it

 private:
  void place_cut();

  Quantity shown_quantity_ = Quantity::kPlasticStrain;
  Eigen::AlignedBox1d greatest_;  // values shown since the beginning
};

}  // namespace hexaplast::view
