// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace {

using hexaplast::support::Command;
using hexaplast::support::Outcome;
using Json = nlohmann::json;

TEST_F(Command, BenchWritesRecordsAndItsOwnBaselineHolds) {
  const Outcome outcome = succeeds("bench --quick --sizes 100 --threads 1,2 --json now.json");
  EXPECT_NE(outcome.out.find("state hash"), std::string::npos);
  std::ifstream file(directory_ / "now.json");
  const Json records = Json::parse(file);
  ASSERT_EQ(records.size(), 36u);
  for (const Json& record : records)
    for (const char* key : {"size", "mode", "precision", "solver", "iterations", "tolerance", "threads", "hex_per_ms",
                            "ratio_to_dense_peer", "bytes_per_hex", "residual", "state_hash"})
      EXPECT_TRUE(record.contains(key)) << key;

  // half of the lead is far beyond what noise takes; ten times of it is never there
  const std::string again = "bench --quick --sizes 100 --json - --baseline now.json --ratio ";
  const Outcome behind = hexaplast(again + "10");
  EXPECT_EQ(behind.code, 4);
  EXPECT_NE(behind.err.find("times the dense peer, less than 10 of the baseline's"), std::string::npos) << behind.err;
  EXPECT_EQ(Json::parse(behind.out).size(), 36u) << "records are written before the command fails";
  succeeds(again + "0.01");
}

TEST_F(Command, BenchMeasuresAScene) {
  write("bar.scn",
        "<Node><DefaultAnimationLoop/><RunSettings steps='6'/><EulerImplicitSolver/><CGLinearSolver iterations='7' "
        "tolerance='0' threshold='0'/><RegularGridTopology n='4 3 3' max='1 .5 .5'/><MechanicalObject/><DiagonalMass "
        "totalMass='2'/><HexahedronElastoplasticFEMForceField youngModulus='2000' yieldStress='1' "
        "plasticFlowRate='2'/></Node>");
  const Outcome outcome = succeeds("bench --scene bar.scn --threads 1,3 --json -");
  const Json records = Json::parse(outcome.out);
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0]["size"], 12);
  EXPECT_EQ(records[0]["iterations"], 7);
  EXPECT_EQ(records[0]["solver"], "CGLinearSolver");
  EXPECT_EQ(records[1]["threads"], 3);
  const Outcome ran = hexaplast("run bar.scn");
  EXPECT_NE(ran.out.find(records[0]["state_hash"].get<std::string>()), std::string::npos) << "a run ends in its state";
}

TEST_F(Command, BenchStepsABatchAtOnce) {
  const Outcome outcome = succeeds("bench --batch --quick --sizes 90 --bodies 4 --threads 1,2 --json batch.json");
  EXPECT_NE(outcome.out.find("together"), std::string::npos) << outcome.out;
  const Json records = Json::parse(hexaplast::support::content(directory_ / "batch.json"));
  ASSERT_EQ(records.size(), 8u);
  for (std::size_t k = 0; k < records.size(); k += 2) {
    EXPECT_EQ(records[k]["bodies"], 4);
    EXPECT_EQ(records[k]["state_hash"], records[k + 1]["state_hash"]) << "one and two threads";
    EXPECT_GT(records[k]["together"]["steps_per_core_second"], 0);
    EXPECT_EQ(records[k]["alone"]["speed_up"], 1);
  }
}

TEST_F(Command, BenchRefusesWhatMeansNothing) {
  for (const char* arguments :
       {"--sizes 0", "--sizes 3q", "--sizes 9999k", "--threads 0", "--simd SSE9", "--ratio 0.5",
        "--scene a.scn --quick", "--batch --scene a.scn", "--batch --baseline now.json", "--batch --bodies 0",
        "--bodies 5", "--batch --bodies 30000 --sizes 90", "--batch --bodies 60000 --sizes 23", "--batch --sizes 0"})
    EXPECT_EQ(hexaplast(std::string("bench ") + arguments).code, 2) << arguments;
  EXPECT_EQ(hexaplast("bench --quick --sizes 50 --baseline missing.json").code, 3);
  EXPECT_EQ(hexaplast("bench --quick --sizes 50 --json missing/now.json").code, 5);
}

}  // namespace
