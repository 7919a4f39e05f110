// SPDX-License-Identifier: LGPL-2.1-or-later
// Numbers beyond all bounds end a run in the step that makes them, and no file ever holds one; a solver that comes to
// no end is stopped, counted and reported.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace {

using namespace hexaplast;

class Overflow : public support::Command {
 protected:
  support::Outcome run(const std::string& overrides) {
    return hexaplast("run '" HEXAPLAST_SOURCE_DIR
                     "/scenes/bar_stretch_low.scn' --out run --force --frames 0 --quiet "
                     "--steps 12 --checkpoint every=1 " +
                     overrides);
  }

  /// Every number that the run has left as text; only "nan" and "inf" have letters n.
  std::string numbers() const {
    const std::string table = support::content(directory_ / "run/history.csv");
    return table.substr(table.find('\n'));
  }
};

TEST_F(Overflow, EndsTheRunAndIsNeverWritten) {
  for (const char* overrides :
       {"--set '.gravity=0 0 1e110'", "--set '.gravity=0 0 1e155'", "--set '.gravity=0 0 1e300'",
        "--set 'bar/pullUp.forces=0 0 0 0 0 1e120 0 0 1e120 0 0 0'", "--set bar/material.youngModulus=1e308"}) {
    const support::Outcome outcome = run(overrides);
    EXPECT_EQ(outcome.code, 4) << overrides << ": " << outcome.err;
    EXPECT_NE(outcome.err.find("not finite"), std::string::npos) << overrides << ": " << outcome.err;
    EXPECT_EQ(numbers().find('n'), std::string::npos) << overrides;
  }
}

// The force grows without bounds from step 7 on.
TEST_F(Overflow, LeavesACheckpointOfTheLastGoodStep) {
  const support::Outcome outcome =
      run("--set 'bar/pullUp.times=-0.01 0.045 0.055' --set 'bar/pullUp.forces=0 0 0 0 0 1 0 0 1e140'");
  EXPECT_EQ(outcome.code, 4);
  const std::string failed = outcome.err.substr(outcome.err.find("step "), 7);
  EXPECT_NE(failed, "step 1 ") << outcome.err;
  EXPECT_EQ(numbers().find('n'), std::string::npos);
  const support::Outcome resumed = hexaplast("resume run --quiet");
  EXPECT_EQ(resumed.code, 4);
  EXPECT_NE(resumed.err.find(failed), std::string::npos) << resumed.err << outcome.err;
}

class Stall : public support::Command {};

TEST_F(Stall, IsCountedAndReported) {
  std::string scene = support::content(HEXAPLAST_SOURCE_DIR "/scenes/bar_stretch_low.scn");
  const std::string direct = "<SparseLDLSolver template=\"CompressedRowSparseMatrixMat3x3d\"/>";
  ASSERT_NE(scene.find(direct), std::string::npos);
  scene.replace(scene.find(direct), direct.size(), "<CGLinearSolver iterations='2' tolerance='1e-12' threshold='0'/>");
  write("stalls.scn", scene);
  const support::Outcome outcome = hexaplast("run stalls.scn --steps 7 --summary summary.json");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("the linear solver stopped before its tolerance in 7 of 7 steps"), std::string::npos)
      << outcome.err;
  std::ifstream in(directory_ / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(in);
  EXPECT_EQ(summary["stalled_solves"], 7);
  EXPECT_EQ(summary["preconditioner"], "none");
}

}  // namespace
