// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "picture/bodies.hpp"
#include "record/recorder.hpp"
#include "scene/parts.hpp"
#include "view/hand.hpp"
#include "view/pacing.hpp"
#include "view/snapshot.hpp"

/// The live window: a simulation that runs in a thread of its own, and what is seen of it.
namespace hexaplast::view {

/// What a session moves: a scene that is ready, with a body or several.
struct Subject {
  std::string title;  ///< the scene's name
  scene::Scene& scene;
  std::function<const output::StepRecord&()> step;                   ///< one time step of the scene
  std::function<void()> reset;                                       ///< back to the beginning
  std::function<void(Archive&)> serialize;                           ///< between two steps
  std::function<output::BoundaryConditions()> conditions = nullptr;  ///< of the present state; null: not shown
};

/// A number of a body's material, or one that a region of it has given, that may change while it moves; or whether a
/// contact is active, 1 or 0.
struct Parameter {
  const attributes::Attribute* attribute;
  scene::Component* component = nullptr;  ///< that has the attribute
  std::string name = {};                  ///< "youngModulus" of the only body, "liver.youngModulus" of one of several,
                                          ///< "tumour.youngModulus" of a region, "probe.active" of a contact; unique
  std::optional<double> value;            ///< at first; none: not given
  std::vector<double> of_hexahedra = {};  ///< own values; the slider is then a factor on all of them, at first 1
  bool may_be_none = false;               ///< the body, or the region, can do without
  double min = 0, max = 0;                ///< where a slider begins and ends
  double suggested = 0;                   ///< for one that is not given
  bool is_logarithmic = false;            ///< equal ways of the slider are equal factors
};

/// Runs a scene in its own thread. All verbs may be called from another thread at any time; they return at once and
/// take effect between two steps, in their order. The scene belongs to the session until `stop`.
class Session {
 public:
  static constexpr std::size_t kMaxUndo = 8;  ///< states that are kept

  /// make: makes the instruments of the hand (Hand). Throws SceneError.
  Session(Subject subject, MakeComponent make);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void run();
  void pause();
  void advance(long steps);  ///< so many, as fast as they go, then it pauses
  void reset();              ///< to the beginning; pauses, and the material stays as it is now

  /// speed: seconds of the simulation per second of the clock, in real time.
  void set_pace(Pace pace, double speed = 1);
  void show(Quantity quantity);

  /// Whether the plastic rest shape is looked at. With isolated rest shapes it is not found otherwise while the scene
  /// moves: its positions are the initial ones then, and its measures no numbers.
  void show_plastic_rest(bool shows);

  /// Takes hold of the surface of the body nearest to the place; what was held before is let go.
  void grab(const Touch& touch, const HandSettings& settings);
  void drag(const Vec3& place);  ///< moves the hand: where the place that was taken hold of is to go [m]
  void release();

  /// Back to the state before the hand took hold last, material included; what came since is as if it had not been.
  /// May be repeated up to kMaxUndo times.
  void undo();

  /// Changes a parameter by its name, or the factor of one that each hexahedron has for
  /// itself; none: as if it had never been given. What the body does not admit becomes a message, and nothing changes.
  void set(std::string_view name, std::optional<double> value);

  /// Takes the newest snapshot, if there is one that was not taken yet, and asks for the next one.
  bool take(Snapshot& snapshot);

  /// Waits until all that was asked for is done and ends the thread. Nothing has an effect afterwards.
  void stop();

  /// Why the simulation cannot go on; empty: it can. After `stop`.
  const std::string& failure() const { return failure_; }

  /// What was done to the scene since the beginning. After `stop`.
  UserActions actions() const { return {latest_.step, hand_.motions(), changes_}; }

  // what does not change while it runs
  const std::string& title() const { return subject_.title; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const HandSettings& suggested_hand() const { return suggested_hand_; }
  const std::string& touch_refusal() const { return hand_.touch_refusal(); }
  double dt() const { return dt_; }  ///< [s]

  /// Of all bodies (output::Bodies), as in the snapshot that was taken last; its nodes may be others after `take`.
  const HexMesh& mesh() const { return mesh_; }

 private:
  using Clock = Pacing::Clock;

  /// The state before a hold.
  struct Saved {
    std::vector<std::byte> bytes;
    output::StepRecord latest;
    Hand::Saved hand;
    std::vector<scene::Data::Given> parameters;
    std::vector<Change> changes;
  };

  void post(std::function<void()> command);

  // of the thread
  void work();
  bool is_due() const;
  bool is_late() const;
  void step();
  template <class Call>
  void attempt(const Call& call);
  void save();
  void restore(const Saved& saved);
  void note_change(const Parameter& parameter);
  std::vector<scene::Data::Given> given_parameters() const;
  void publish();
  bool wants_plastic_rest() const;
  void publish_values(const ElementFields& fields);
  output::BoundaryConditions conditions() const;

  Subject subject_;
  std::vector<scene::SceneBody> bodies_;
  std::vector<scene::MechanicalState*> states_;  // of the bodies
  output::Bodies shown_;
  double dt_ = 0;
  std::vector<Parameter> parameters_;
  std::vector<scene::Data::Given> first_parameters_;  // as the scene gives them
  HandSettings suggested_hand_;
  Hand hand_;

  // read and written by the thread alone
  output::Measurement measurement_;
  PointArray positions_, velocities_;  // of several bodies
  output::StepRecord latest_;
  bool is_running_ = false;
  long steps_asked_ = 0;
  Pace pace_ = Pace::kRealTime;
  Pacing pacing_;  // of real time
  std::string failure_;
  std::vector<std::string> messages_;
  std::vector<float> step_ms_;
  Quantity quantity_ = Quantity::kPlasticStrain;
  bool shows_plastic_rest_ = false;
  bool has_changed_ = true;  // since the latest snapshot
  std::deque<Saved> saved_;  // the latest at the end
  std::vector<Change> changes_;
  std::shared_ptr<const HexMesh> present_mesh_;
  std::shared_ptr<const OpenFaces> open_;  // of it
  Snapshot back_;

  // read and written by the caller alone
  std::shared_ptr<const HexMesh> taken_mesh_;
  HexMesh mesh_;  // the same

  std::mutex mutex_;  // over what follows
  std::condition_variable wake_;
  std::vector<std::function<void()>> commands_;
  Snapshot front_;
  bool is_fresh_ = false;   // front_ was not taken yet
  bool is_wanted_ = false;  // the next snapshot
  bool is_ending_ = false;

  std::thread thread_;  // last: everything else is there when it begins
};

}  // namespace hexaplast::view
