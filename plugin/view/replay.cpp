// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/replay.hpp"

#include <algorithm>
#include <utility>

#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::view {
Replay::Replay(output::RecordedRun run) : run_(std::move(run)) {
  if (num_states() > 1) dt_ = time(1) - time(0);
}

void Replay::run() {
  if (state_ + 1 == num_states()) state_ = 0;  // from the beginning again
  is_running_ = has_changed_ = true;
  start_clock();
}

void Replay::pause() {
  is_running_ = false;
  has_changed_ = true;
}

void Replay::advance(long steps) { go_to(static_cast<int>(std::clamp<long>(state_ + steps, 0, num_states() - 1))); }

void Replay::reset() { go_to(0); }

void Replay::go_to(int state) {
  state_ = std::clamp(state, 0, num_states() - 1);
  is_running_ = false;
  has_changed_ = true;
}

void Replay::set_pace(Pace pace, double speed) {
  pace_ = pace;
  speed_ = speed;
  start_clock();
}

void Replay::show(Quantity quantity) {
  quantity_ = quantity;
  has_changed_ = true;
}

void Replay::start_clock() {
  begun_ = Clock::now();
  begun_at_ = time(state_);
}

/// The last one that is not after a time.
int Replay::state_at(double at) const {
  int found = state_;
  while (found + 1 < num_states() && time(found + 1) <= at) ++found;
  return found;
}

void Replay::follow_clock() {
  if (!is_running_) return;
  const double seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
  const int due =
      pace_ == Pace::kFree ? std::min(state_ + 1, num_states() - 1) : state_at(begun_at_ + speed_ * seconds);
  has_changed_ = has_changed_ || due != state_;
  state_ = due;
  if (state_ + 1 < num_states()) return;
  is_running_ = false;
  has_changed_ = true;
}

bool Replay::take(Snapshot& snapshot) {
  follow_clock();
  if (!std::exchange(has_changed_, false)) return false;
  const output::RecordedRun::Entry& entry = run_.entries()[static_cast<std::size_t>(state_)];
  snapshot.messages.clear();
  snapshot.is_running = is_running_;
  snapshot.quantity = quantity_;
  try {
    output::RecordedRun::State state = run_.state(entry, quantity_);
    const bool is_of_nodes = output::entry_of(quantity_).of_nodes;
    snapshot.step = entry.step.value_or(state_);
    snapshot.sample = {.time = entry.time, .measures = {}};
    snapshot.of_hexahedra = is_of_nodes ? std::vector<double>() : state.values;
    snapshot.values = is_of_nodes ? std::move(state.values) : nodal_means(mesh(), state.values, state.alive);
    snapshot.positions = std::move(state.positions);
    snapshot.plastic_rest = std::move(state.plastic_rest);
    snapshot.alive = std::move(state.alive);
    snapshot.open = std::move(state.open);
    snapshot.conditions = std::move(state.conditions);
    snapshot.failure.clear();
  } catch (const std::exception& error) {
    snapshot.failure = error.what();
    snapshot.is_running = is_running_ = false;
    if (snapshot.positions.rows() == mesh().num_nodes()) return true;
    // nothing has been shown yet
    snapshot.positions = snapshot.plastic_rest = mesh().positions();
    snapshot.alive.assign(static_cast<std::size_t>(mesh().num_elements()), 1);
    snapshot.values.assign(static_cast<std::size_t>(mesh().num_nodes()), 0);
  }
  return true;
}

}  // namespace hexaplast::view
