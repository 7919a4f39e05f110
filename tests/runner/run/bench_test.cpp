// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

TEST_F(Command, BenchWritesRecordsAndItsOwnBaselineHolds) {
  const Outcome outcome = succeeds("bench --quick --sizes 100 --threads 1,2 --json now.json");
  EXPECT_TRUE(has(outcome.out, "state hash"));
  ASSERT_EQ(json("now.json").size(), 36u);

  // half of the lead is far beyond what noise takes; ten times of it is never there
  const std::string again = "bench --quick --sizes 100 --json - --baseline now.json --ratio ";
  const Outcome behind = fails(again + "10", 4, "times the dense peer, less than 10 of the baseline's");
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
  EXPECT_TRUE(has(ran.out, records[0]["state_hash"].get<std::string>())) << "a run ends in its state";
}

// BenchBatch has what the records say.
TEST_F(Command, BenchStepsABatchAtOnce) {
  const Outcome outcome = succeeds("bench --batch --quick --sizes 90 --bodies 2 --threads 1 --json batch.json");
  EXPECT_TRUE(has(outcome.out, "together"));
  ASSERT_EQ(json("batch.json").size(), 4u);
  EXPECT_EQ(json("batch.json")[0]["bodies"], 2);
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
