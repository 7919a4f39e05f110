// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/parts.hpp"
#include "view/user_actions.hpp"

namespace hexaplast::view {

/// What the hand has in it: a grip that holds nodes (GraspForceField), a rigid instrument that touches
/// (InstrumentContactForceField), or a scalpel (BladeController).
enum class Tool { kGrip, kSphere, kCapsule, kBox, kScalpel };
inline constexpr std::array kToolNames{"grip", "sphere", "capsule", "box", "scalpel"};

struct HandSettings {
  Tool tool = Tool::kGrip;

  // of the grip (solve/grip.hpp)
  double radius = 0;     ///< [m] around the place that is taken hold of; the nearest node is held in any case
  double stiffness = 0;  ///< [N/m]
  double max_force = 0;  ///< [N]
  double damping = 0;    ///< [N s/m]

  // of what touches
  double size = 0;  ///< [m] diameter of sphere and capsule, edge of the box; a capsule is three times as long as thick
  double friction = 0.3;

  double depth = 0;  ///< [m] of a cut
};

/// Where the user takes hold: a place of the surface [m], the direction away from the body there, and the direction to
/// the viewer. Both are unit vectors.
struct Touch {
  Vec3 place = Vec3::Zero();
  Vec3 outwards = Vec3::UnitZ();
  Vec3 towards = Vec3::UnitZ();
};

/// Makes a component of a class that is not part of the scene yet.
using MakeComponent = std::function<std::unique_ptr<scene::Component>(std::string_view class_name)>;

/// Gives an attribute of a component another value, none: as if it had never been given, and lets the component look at
/// its inputs. What it refuses becomes a message, and nothing changes: false.
bool change(scene::Component& component, std::string_view attribute, std::optional<scene::Value> value,
            std::vector<std::string>& messages);

/// The instruments that the user of a session moves: components of the scene, one for each body. They follow the target
/// along a path that has a key time at each step, within kFollow; so a scene with the same path moves alike. All verbs
/// are for the thread that makes the steps, between two of them.
class Hand {
 public:
  static constexpr double kFollow = 0.03;  ///< [s] in which the instrument comes nearer to its target by a factor of e

  /// Adds an open grip for each body, which changes nothing. reach [m]: the size of the scene. Throws SceneError.
  Hand(scene::Scene& scene, std::vector<scene::SceneBody> bodies, MakeComponent make, double reach);

  /// Why no body can be touched, for people; empty: all can.
  const std::string& touch_refusal() const { return touch_refusal_; }

  /// Called before a grab, when nothing has changed yet.
  std::function<void()> before_grab = [] {};

  /// Called when components have been added to the scene: states that were saved before do not fit.
  std::function<void()> has_grown = [] {};

  /// Takes hold; what was held before is let go. An instrument that touches comes from the viewer within one step, and
  /// goes back there within one. So does a scalpel, along its edge, which opens nothing; it cuts the body nearest to
  /// the place. Throws SceneError where the scene refuses an instrument; it is then of no more use.
  void grab(const Touch& touch, const HandSettings& settings);
  void drag(const Vec3& place);  ///< where the place that was taken hold of is to go [m]
  void release();

  void begin_step();  ///< prescribes the instrument's motion, before each step
  void end_step();    ///< after it

  /// Empty-handed, at the beginning of the scene; nothing has been done. Throws SceneError, as restore does, after the
  /// scene has refused an instrument: a part of it is there.
  void reset();

  /// Nodes in the grip, of body held_body(), and [N] what the instrument does to all bodies.
  std::vector<int> held() const;
  int held_body() const { return held_body_; }
  Vec3 force() const;

  /// Whether a component is one of the hand's that neither holds nor touches anything now.
  bool is_idle(const scene::Component& component) const;

  /// Whether a warning is about where an instrument of the hand begins: away, from where it comes as the mouse goes.
  static bool is_way_of_tool(const scene::Message& message);

  std::vector<std::string> take_messages() { return std::exchange(messages_, {}); }

  // for a state that is saved and restored: the hand is empty in it
  struct Saved {
    std::vector<scene::Value> values;  // of the attributes of what touches
    std::size_t num_motions = 0;
  };
  Saved save() const;
  void restore(const Saved& saved);  ///< before the components are restored

  /// All since the beginning; the last ones may go on.
  const std::vector<InstrumentMotion>& motions() const { return motions_; }

 private:
  enum class State { kIdle, kHolding, kLeaving };

  void begin_grab(const Touch& touch, const HandSettings& settings);
  void close_grip(const Vec3& place, const HandSettings& settings);
  void bring_tool(const Touch& touch, const HandSettings& settings);
  void bring_scalpel(const Touch& touch, const HandSettings& settings);
  void bring(Tool tool, const Vec3& start, const Vec3& away);
  std::size_t nearest_body(const Vec3& place) const;
  void add_tools(const HandSettings& settings);
  void add_scalpel(std::size_t body, const HandSettings& settings);
  std::vector<scene::Component*> tools_and_scalpels() const;
  void require_whole() const;
  void put_path(std::initializer_list<double> times, std::initializer_list<Vec3> places);
  void begin_motions();
  void add_key(double time, const Vec3& place);
  void drop_motions_without_step();

  scene::Scene& scene_;
  std::vector<scene::SceneBody> bodies_;
  MakeComponent make_;
  double reach_;
  std::string touch_refusal_;
  std::string damage_;                            // why an instrument was refused that is in the scene; empty: none was
  std::vector<scene::Component*> grips_, tools_;  // of each body; no tools before they are needed
  std::vector<scene::Component*> scalpels_;       // of each body; null before it is needed
  std::vector<std::string> messages_;

  State state_ = State::kIdle;
  std::vector<scene::Component*> active_;  // whose motion is prescribed now
  int held_body_ = 0;
  Tool tool_ = Tool::kGrip;                    // that is active
  bool is_coming_ = false;                     // it is to be at its target after the next step
  Vec3 offset_ = Vec3::Zero();                 // [m] of the instrument from the place that is dragged
  Vec3 at_ = Vec3::Zero();                     // [m] of the instrument
  Vec3 target_ = Vec3::Zero(), away_ = at_;    // [m] where it goes, and where it is out of the way
  Vec3 out_ = Vec3::Zero();                    // [m] by which a scalpel leaves
  std::array<double, 4> turn_ = {0, 0, 0, 1};  // quaternion of what touches or cuts

  struct Request {
    Touch touch;
    HandSettings settings;
    std::optional<Vec3> place;  // dragged to
  };
  std::optional<Request> request_;  // for when the instrument has gone

  std::vector<InstrumentMotion> motions_;
  std::size_t num_open_motions_ = 0;  // the last ones, of what is active
};

}  // namespace hexaplast::view
