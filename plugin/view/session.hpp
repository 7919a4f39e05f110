// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "picture/bodies.hpp"
#include "record/measures.hpp"
#include "record/recorder.hpp"
#include "scene/parts.hpp"

/// The live window: a simulation that runs in a thread of its own, and what is seen of it.
namespace hexaplast::view {

/// What a session moves: a scene that is ready, with a body or several.
struct Subject {
  std::string title;  ///< the scene's name
  scene::Scene& scene;
  std::function<const output::StepRecord&()> step;  ///< one time step of the scene
  std::function<void()> reset;                      ///< back to the beginning
};

/// What the colours of the body tell.
enum class Quantity { kPlasticStrain, kStressNorm, kYieldStress, kVolumeRatio, kSpeed };

using MakeHand = std::function<std::unique_ptr<scene::Component>()>;

/// How fast the simulation goes on.
enum class Pace {
  kRealTime,  ///< as the clock on the wall, or slower where a step takes longer than it lasts
  kFree       ///< as fast as it can
};

/// How the hand holds tissue (solve/grip.hpp).
struct HandSettings {
  double radius = 0;     ///< [m] around the place that is taken hold of; the nearest node is held in any case
  double stiffness = 0;  ///< [N/m]
  double max_force = 0;  ///< [N]
  double damping = 0;    ///< [N s/m]
};

/// A number of a body's material, or one that a region of it has given, that may change while it moves; or whether a
/// contact is active, 1 or 0.
struct Parameter {
  const attributes::Attribute* attribute;
  scene::Component* component = nullptr;  ///< that has the attribute
  std::string name = {};                  ///< "youngModulus" of the only body, "liver.youngModulus" of one of several,
                                          ///< "tumour.youngModulus" of a region, "probe.active" of a contact
  std::optional<double> value;            ///< at first; none: not given
  std::vector<double> of_hexahedra = {};  ///< own values; the slider is then a factor on all of them, at first 1
  bool may_be_none = false;               ///< the body, or the region, can do without
  double min = 0, max = 0;                ///< where a slider begins and ends
  double suggested = 0;                   ///< for one that is not given
  bool is_logarithmic = false;            ///< equal ways of the slider are equal factors
};

/// Numbers that are plotted, of one moment.
struct Sample {
  double time = 0;  ///< [s]
  output::Measures measures;
  double greatest_plastic_strain = 0;  ///< [-] of a hexahedron
  double kinetic_energy = 0;           ///< [J]
  double elastic_energy = 0;           ///< [J]
  double dissipated_energy = 0;        ///< [J]
};

/// The simulation as it was between two steps. Nodal arrays have num_nodes rows, of several bodies those of one behind
/// those of another.
struct Snapshot {
  long step = 0;
  bool is_running = false;
  std::string failure;                ///< why it cannot go on before a reset; empty: it can
  std::vector<std::string> messages;  ///< that came since the last snapshot
  PointArray positions;               ///< [m]
  PointArray material;                ///< [m] what the body would be without forces
  std::vector<unsigned char> alive;   ///< per hexahedron
  Quantity quantity = Quantity::kPlasticStrain;
  std::vector<double> values;  ///< of the quantity, per node; infinite for the yield stress of what never yields
  std::vector<std::optional<double>> parameter_values;  ///< of each parameter, as it is now; none: not given
  std::vector<int> held;                                ///< nodes in the hand
  Vec3 grip_force = Vec3::Zero();                       ///< [N] of the hand on the body, in the latest step
  Sample sample;
  std::vector<float> step_ms;  ///< wall time of each step since the last snapshot
};

/// Runs a scene in its own thread. All verbs may be called from another thread at any time; they return at once and
/// take effect between two steps, in their order. The scene belongs to the session until `stop`.
class Session {
 public:
  /// make_hand: makes a GraspForceField that is not part of the scene yet; the session adds one for each body, with an
  /// open grip, which changes nothing. Throws SceneError.
  Session(Subject subject, const MakeHand& make_hand);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void run();
  void pause();
  void advance(long steps);  ///< so many steps, as fast as they go, then it pauses
  void reset();              ///< the state of the beginning, with the material as it is now; pauses
  void set_pace(Pace pace);
  void show(Quantity quantity);

  /// Takes hold of the surface of the body nearest to a place [m] around it; what was held before is let go.
  void grab(const Vec3& place, const HandSettings& settings);
  void drag(const Vec3& place);  ///< moves the hand [m]
  void release();

  /// Changes a parameter by its name, or the factor of one that each hexahedron has for
  /// itself; none: as if it had never been given. What the body does not admit becomes a message, and nothing changes.
  void set(std::string_view name, std::optional<double> value);

  /// Takes the newest snapshot, if there is one that was not taken yet, and asks for the next one.
  bool take(Snapshot& snapshot);

  /// Waits until all that was asked for is done and ends the thread. Nothing has an effect afterwards.
  void stop();

  /// Why the simulation cannot go on; empty: it can. After `stop`.
  const std::string& failure() const { return failure_; }

  // what does not change while it runs
  const std::string& title() const { return subject_.title; }
  const HexMesh& mesh() const { return shown_.mesh(); }  ///< of all bodies (output::Bodies)
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const HandSettings& suggested_hand() const { return suggested_hand_; }
  double dt() const { return dt_; }  ///< [s]

 private:
  using Clock = std::chrono::steady_clock;

  void post(std::function<void()> command);

  // of the thread
  void work();
  bool is_due() const;
  void step();
  void change(scene::Component& component, std::string_view attribute, std::optional<scene::Value> value);
  void open_hand();
  const PointArray& gather(PointArray& (scene::MechanicalState::*field)(), PointArray& all) const;
  void publish();
  std::vector<double> values_of(Quantity quantity, const ElementFields& fields);

  Subject subject_;
  std::vector<scene::SceneBody> bodies_;
  output::Bodies shown_;
  std::vector<scene::Component*> hands_;  // of each body
  scene::Component* hand_ = nullptr;      // the one that was used last
  int first_held_ = 0;                    // where the nodes of its body begin
  double dt_ = 0;
  std::vector<Parameter> parameters_;
  HandSettings suggested_hand_;

  // read and written by the thread alone
  output::Measurement measurement_;
  PointArray positions_, velocities_;  // of several bodies
  output::StepRecord latest_;
  bool is_running_ = false;
  long steps_asked_ = 0;
  Pace pace_ = Pace::kRealTime;
  Clock::time_point due_ = {};  // of the next step, in real time
  std::string failure_;
  std::vector<std::string> messages_;
  std::vector<float> step_ms_;
  Quantity quantity_ = Quantity::kPlasticStrain;
  bool has_changed_ = true;  // since the latest snapshot
  Snapshot back_;

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
