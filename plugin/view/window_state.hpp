// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <utility>

#include "picture/page.hpp"
#include "view/camera.hpp"
#include "view/figure.hpp"
#include "view/rate.hpp"
#include "view/trace.hpp"
#include "view/window.hpp"

namespace hexaplast::view {

/// What the parts of a window share: the session, what is seen of it at the moment, and how it is looked at.
struct WindowState {
  explicit WindowState(WindowCall& call);

  void take(double clock);  ///< the newest snapshot, at a time of the wall clock [s]
  void toggle_running();
  void reset();
  void undo();
  void fit();  ///< looks at the whole body
  void set_pace();
  void show_ghost(Ghost ghost);
  output::Drawing page() const;  ///< what is shown, as `render` draws it

  Source& source;
  Session* session;  ///< null: what is shown is a run that is finished
  Replay* replay;    ///< null: it is a scene in motion
  Snapshot now;
  Figure figure;
  Camera camera;
  float left = 0, width = 1, height = 1;  ///< [pixels] of the part of the window that shows the body

  Look look;
  output::Scale scale{Quantity::kPlasticStrain};  ///< of all that was shown since the beginning
  HandSettings hand;
  Names names;
  int cut_axis = -1;                       ///< what lies before a plane across this axis is cut off; -1: nothing is
  double cut_place = 0.5;                  ///< of the plane: fraction of the way through the initial shape
  std::optional<Figure::Seen> pointed_at;  ///< under the mouse
  output::Strongest strongest;             ///< of what was shown since the beginning
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
};

}  // namespace hexaplast::view
