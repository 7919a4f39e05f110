// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "hexaplast/body.hpp"
#include "support/bar_scene.hpp"
#include "support/scene.hpp"
#include "view/session.hpp"

/// Sessions of the live window, without a window.
namespace hexaplast::support {

inline const Vec3 kTop(0.05, 0.05, 0.3);

/// A scene in motion, as the command steps it.
class Played {
 public:
  explicit Played(const std::string& text = kBar) : text_(text), scene_(read_and_init(text)) {}

  const output::StepRecord& step() {
    scene_.step();
    ++record_.step;
    return record_;
  }
  void reset() {
    scene_.reset();
    record_ = {};
  }
  view::Subject subject() {
    return {.title = "bar",
            .scene = scene_,
            .step = [this]() -> const output::StepRecord& { return step(); },
            .reset = [this] { reset(); },
            .serialize =
                [this](Archive& archive) {
                  archive(record_.step);
                  scene_.serialize(archive);
                }};
  }
  const std::string& text() const { return text_; }
  scene::Scene& scene() { return scene_; }
  const PointArray& positions() { return nodes(scene_); }
  const Body& body() { return *at<scene::ForceField>(scene_, "body").body(); }
  std::string hash() {
    auto& state = at<scene::MechanicalState>(scene_, "nodes");
    return output::state_hash(record_.step, state.positions(), state.velocities(), &body());
  }
  std::string hash_after(int steps) {
    for (int k = 0; k < steps; ++k) step();
    return hash();
  }

 private:
  std::string text_;
  scene::Scene scene_;
  output::StepRecord record_;
};

/// The first snapshot that is as wanted; fails where none comes for long.
template <class Wanted>
view::Snapshot wait_for(view::Session& session, const Wanted& wanted) {
  view::Snapshot snapshot;
  for (int k = 0; k < 20'000; ++k) {
    if (session.take(snapshot) && wanted(snapshot)) return snapshot;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ADD_FAILURE() << "the session does not get there, but to step " << snapshot.step << " " << snapshot.failure;
  return snapshot;
}

inline view::Snapshot wait_for_step(view::Session& session, long step) {
  return wait_for(session, [&](const view::Snapshot& at) { return at.step == step && !at.is_running; });
}

inline std::unique_ptr<scene::Component> make(std::string_view class_name) { return factory().make(class_name); }

/// A session on the bar, whose steps are waited for.
class BarSession : public testing::Test {
 protected:
  view::Snapshot advance(long steps) {
    session.advance(steps);
    return wait_for_step(session, step += steps);
  }

  Played played;
  view::Session session{played.subject(), make};
  long step = 0;
};

}  // namespace hexaplast::support
