// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bench/bench.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "bench/bar.hpp"
#include "bench/batch.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"

namespace hexaplast::bench {
namespace {

TEST(BenchBar, IncrementIsTheNextStepsAndLeavesTheBarAlone) {
  Bar bar({.size = 100, .mode = Mode::kPlastic});
  PreconditionedConjugateGradients solver(1e-8, 500);
  bar.step(solver);
  const std::string hash = bar.hash();
  const PointArray v = bar.velocities(), dv = bar.increment(solver);
  EXPECT_EQ(bar.hash(), hash);
  bar.step(solver);
  EXPECT_LT((bar.velocities() - v - dv).norm(), 1e-12 * dv.norm());
  EXPECT_NE(bar.hash(), hash);
}

TEST(BenchBatch, ABodyWithOtherBitsIsNamed) {
  EXPECT_EQ(differing_bodies({"a", "b", "c"}, {"a", "b", "c"}), "");
  EXPECT_EQ(differing_bodies({"a", "b", "c"}, {"a", "x", "y"}),
            "2 of 3 bodies have another state than alone; body 2: x instead of b");
}

TEST(BenchBar, RelativeErrorIsTheNormOfKineticEnergy) {
  const Eigen::VectorXd masses = (Eigen::VectorXd(2) << 4, 1).finished();
  const PointArray exact = (PointArray(2, 3) << 0, 3, 0, 0, 0, 8).finished();  // norm squared 4 * 9 + 64 = 100
  PointArray found = exact;
  found(0, 0) = 1;  // 4 * 1
  EXPECT_NEAR(relative_error(masses, found, exact), .2, 1e-15);
}

TEST(BenchTimes, AreLeastMedianAndHundredth) {
  std::vector<double> ms(200);
  for (int k = 0; k < 200; ++k) ms[k] = 200 - k;
  const StepTimes times(ms);
  EXPECT_EQ(times.min, 1);
  EXPECT_EQ(times.p50, 100);
  EXPECT_EQ(times.p99, 198);
}

Record record_of(double ratio, double residual) {
  Record record;
  record.size = 72;
  record.mode = "plastic";
  record.precision = "mixed";
  record.solver = "cg";
  record.target = "25 its";
  record.ratio_to_dense_peer = ratio;
  record.residual = residual;
  record.state_hash = "00";
  return record;
}

TEST(BenchRecords, ComeBackFromTheirFile) {
  Record record = record_of(12.5, 1e-3);
  record.threads = 2;
  record.operator_ns = 17.25;
  const auto file = std::filesystem::path(testing::TempDir()) / "hexaplast_bench_records.json";
  std::ofstream(file) << to_json({record, record_of(1, 1)});
  const std::vector<Record> read = read_json(file);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].threads, 2);
  EXPECT_EQ(read[0].mode, "plastic");
  EXPECT_EQ(read[0].operator_ns, 17.25);
  EXPECT_EQ(read[0].ratio_to_dense_peer, 12.5);
  EXPECT_TRUE(std::isnan(read[0].flow_ns)) << "what was not measured is null";
  EXPECT_EQ(to_json(read), to_json({record, record_of(1, 1)}));

  std::ofstream(file) << R"([{"size": 3}])";
  EXPECT_THROW(read_json(file), InputError);
  EXPECT_THROW(read_json(file.string() + ".none"), InputError);
}

TEST(BenchRecords, FallBehindByRatioAndResidualOnly) {
  const std::vector<Record> baseline{record_of(10, 1e-3)};
  EXPECT_TRUE(compare({record_of(5.1, 1.05e-3)}, baseline, .5).empty());
  EXPECT_EQ(compare({record_of(4.9, 1e-3)}, baseline, .5).size(), 1u);
  EXPECT_EQ(compare({record_of(10, 1.2e-3)}, baseline, .5).size(), 1u);
  EXPECT_EQ(compare({record_of(4.9, 1.2e-3)}, baseline, .5).size(), 2u);

  Record both = record_of(10, 1e-3), slow = record_of(1, 1e-3);
  both.threads = slow.threads = 2;
  EXPECT_TRUE(compare({slow}, {both}, .5).empty()) << "several threads say what else the machine does";
  slow.residual = 1.2e-3;
  EXPECT_EQ(compare({slow}, {both}, .5).size(), 1u);

  Record other = record_of(1, 1);
  other.simd = "AVX2";
  EXPECT_EQ(compare({other}, baseline, .5).size(), 1u) << "nothing to compare with must not pass";
}

TEST(BenchRecords, HashesMustAgreeBetweenThreads) {
  Record one = record_of(1, 1), two = one;
  two.threads = 2;
  EXPECT_TRUE(differing_hashes({one, two}).empty());
  two.state_hash = "01";
  EXPECT_EQ(differing_hashes({one, two}).size(), 1u);
  two.mode = "elastic";
  EXPECT_TRUE(differing_hashes({one, two}).empty());
}

TEST(BenchRun, MeasuresWhatFlowCosts) {
  Options options{.sizes = {300}, .quick = true, .flow = true};
  const int before = num_threads();
  const Outcome outcome = run(options, [](const std::vector<Record>&) {});
  set_num_threads(before);
  EXPECT_EQ(outcome.failures, std::vector<std::string>());
  const std::vector<std::string> modes = {"elastic", "plastic_part", "plastic", "elastic"};  // the last one relaxes
  ASSERT_EQ(outcome.records.size(), 2 * 2 * modes.size());  // by precisions, threads and bars
  for (std::size_t k = 0; k < outcome.records.size(); ++k) {
    const Record& record = outcome.records[k];
    EXPECT_LE(record.velocity_error, .01);
    EXPECT_EQ(record.precision, k < 2 * modes.size() ? "double" : "mixed");
    EXPECT_EQ(record.mode, modes[k % modes.size()]);
    EXPECT_EQ(record.element.ends_with(" relaxing"), k % modes.size() == 3);
  }
}

TEST(BenchOfEveryCell, FindsNothingWrong) {
  Options options;
  options.sizes = {300};
  options.quick = true;
  const int before = num_threads();
  std::size_t reported = 0;
  const Outcome outcome = run(options, [&](const std::vector<Record>& records) { reported += records.size(); });
  set_num_threads(before);

  EXPECT_EQ(outcome.failures, std::vector<std::string>());
  EXPECT_EQ(outcome.records.size(), 2u * 3 * 2 * 2 + 2 * 2 + 2 * 2 + 2 * 2);
  // precisions, modes, solvers, threads; the paper's method, modes, threads; near incompressibility, solvers, threads;
  // free and on a plate, threads
  EXPECT_EQ(reported, outcome.records.size());
  for (const Record& record : outcome.records) {
    EXPECT_GT(record.hex_per_ms, 0);
    EXPECT_GT(record.linearize_ns, 0);
    const bool is_of_contact = record.target == "residual 1 %";
    EXPECT_EQ(std::isnan(record.ratio_to_dense_peer), record.poisson_ratio != .45 || is_of_contact);
    EXPECT_FALSE(record.ratio_to_dense_peer <= 0);
    EXPECT_GT(record.bytes_per_hex, 300);
    EXPECT_LT(record.bytes_per_hex, 30000);
    EXPECT_LE(record.p50_ms, record.p99_ms);
    if (record.target == "1 %") {
      EXPECT_LE(record.velocity_error, .01);
    } else if (is_of_contact) {
      EXPECT_LE(record.residual, .01);
    } else {
      EXPECT_EQ(record.iterations, 25);
    }
  }
}

}  // namespace
}  // namespace hexaplast::bench
