// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "record/recorded_run.hpp"
#include "view/source.hpp"

namespace hexaplast::view {

/// A run that is finished, as its files hold it. A step leads from one state that was saved to the next.
class Replay final : public Source {
 public:
  explicit Replay(output::RecordedRun run);

  void run() override;
  void pause() override;
  void advance(long steps) override;
  void reset() override;
  void set_pace(Pace pace, double speed = 1) override;
  void show(Quantity quantity) override;

  /// Reads the state that is due. One that cannot be read is a failure, which a reset leads out of.
  bool take(Snapshot& snapshot) override;

  const std::string& title() const override { return run_.name(); }
  const HexMesh& mesh() const override { return run_.mesh(); }
  double dt() const override { return dt_; }

  const std::filesystem::path& directory() const { return run_.directory(); }
  int num_states() const { return static_cast<int>(run_.entries().size()); }
  int state() const { return state_; }
  double time(int state) const { return run_.entries()[static_cast<std::size_t>(state)].time; }  ///< [s]
  void go_to(int state);                                                                         ///< from 0; pauses

 private:
  using Clock = std::chrono::steady_clock;

  void follow_clock();
  int state_at(double time) const;
  void start_clock();

  output::RecordedRun run_;
  double dt_ = 0;  // [s] between the first states
  int state_ = 0;
  bool is_running_ = false;
  Pace pace_ = Pace::kRealTime;
  double speed_ = 1;
  Clock::time_point begun_ = {};  // when it showed the time begun_at_
  double begun_at_ = 0;           // [s]
  Quantity quantity_ = Quantity::kPlasticStrain;
  bool has_changed_ = true;
};

}  // namespace hexaplast::view
