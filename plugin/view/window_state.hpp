// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <utility>

#include "picture/page.hpp"
#include "view/camera.hpp"
#include "view/figure.hpp"
#include "view/trace.hpp"
#include "view/window.hpp"

namespace hexaplast::view {

/// Counts events per second.
class Rate {
 public:
  void count(long events, double now) {
    events_ += events;
    if (now - begin_ < kSpan) return;
    per_second_ = static_cast<double>(events_) / (now - begin_);
    events_ = 0;
    begin_ = now;
  }
  double per_second() const { return per_second_; }

 private:
  static constexpr double kSpan = 0.25;  // [s] over which events are counted

  long events_ = 0;
  double begin_ = 0, per_second_ = 0;
};

inline constexpr float kBarStrip = 82;  ///< [pixels] at the lower border, which the colour bar has for itself

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
  const output::Regions& regions() const { return figure.staging().regions; }

  Session& session;
  Snapshot now;
  Figure figure;
  Camera camera;
  float left = 0, width = 1, height = 1;  ///< [pixels] of the part of the window that shows the body

  Look look;
  output::Scale scale{Quantity::kPlasticStrain};  ///< of all that was shown since the beginning
  HandSettings hand;
  std::vector<output::Bodies::Entry> bodies;
  std::vector<output::ProbeRecord> probes;
  int cut_axis = -1;                       ///< what lies before a plane across this axis is cut off; -1: nothing is
  double cut_place = 0.5;                  ///< of the plane: fraction of the way through the initial shape
  std::optional<Figure::Seen> pointed_at;  ///< under the mouse
  output::Strongest strongest;             ///< of what was shown since the beginning
  std::optional<Vec3> grabbed;             ///< [m] where the mouse took hold of the tissue; none: it holds nothing
  int turning = -1;                        ///< button that moves the camera; -1: none
  Pace pace;
  double speed;  ///< in real time
  Traces traces;
  Rate frames, steps;
  std::string message;
  bool wants_picture = false;  ///< of the window

 private:
  void place_cut();
  output::Scale empty_scale() const { return output::Scale(now.quantity, {}, regions().names); }
};

void draw_controls(WindowState& window);       ///< what can be changed
void draw_plots(const WindowState& window);    ///< what is measured
void draw_overlay(const WindowState& window);  ///< what is written over the body: rates, colour bar, marks of the hand

/// What the mouse does beside the panels, which take it first: pulls at tissue, and moves the camera. Once per frame.
void follow_mouse(WindowState& window);

}  // namespace hexaplast::view
