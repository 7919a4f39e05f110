// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "record/history_table.hpp"
#include "support/command.hpp"
#include "support/pulled_bar.hpp"

namespace {

using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Outcome;
using Json = nlohmann::json;

/// Fits to a run that noise was added to.
class FitConfidence : public Command {
 protected:
  void run_truth(const std::string& set) {
    write("bar.scn", hexaplast::support::flowing_bar());
    ASSERT_EQ(hexaplast("run bar.scn --quiet --steps 40 --frames 0 --out truth " + set).code, 0);
  }

  /// time and elongations of the truth; noise as fractions of the largest value, of which the next row keeps a part.
  void write_noisy(int seed, double noise, double kept, double plastic_noise) {
    hexaplast::output::HistoryTable table(directory_ / "truth/history.csv");
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    std::string curve = "time,elongation,plastic_elongation\n";
    const int current = table.find("world_elongation"), plastic = table.find("plastic_elongation");
    double present = normal(random);
    for (std::span<const double> row = table.next(); !row.empty(); row = table.next()) {
      curve += std::to_string(row[1]) + "," + std::to_string(row[static_cast<std::size_t>(current)] + noise * present) +
               "," + std::to_string(row[static_cast<std::size_t>(plastic)] + plastic_noise * normal(random)) + "\n";
      present = kept * present + std::sqrt(1 - kept * kept) * normal(random);
    }
    write("curve.csv", curve);
  }

  Json fit(const std::string& more) {
    const Outcome outcome = hexaplast("fit bar.scn --target curve.csv --out found --force --jobs 1 " + more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    messages_ = outcome.err;
    printed_ = outcome.out;
    return Json::parse(content(directory_ / "found/fit.json"));
  }

  std::string messages_, printed_;
};

constexpr const char* kBoth = "--free body.yieldStress=20:400 --free body.plasticFlowRate=0.1:8";

// The fifty fits are scripts/fit_coverage (docs/reliability.md).
TEST_F(FitConfidence, IntervalsHoldWhatARunWasMadeWith) {
  run_truth("--set body.yieldStress=110 --set body.plasticFlowRate=1.3");
  constexpr int kFits = 8;
  int covered[2] = {0, 0};
  double half_width[2] = {0, 0}, square_error[2] = {0, 0};
  for (int seed = 0; seed < kFits; ++seed) {
    write_noisy(seed, 0.002, 0, 0);
    const Json found = fit(std::string("--compare elongation ") + kBoth);
    EXPECT_NEAR(found["columns"][0]["noise"], 0.002, 0.001);
    for (int p = 0; p < 2; ++p) {
      const Json& parameter = found["parameters"][p];
      const double truth = p == 0 ? 110 : 1.3, from = parameter["confidence_from"], to = parameter["confidence_to"];
      EXPECT_LE(from, parameter["value"]);
      covered[p] += from <= truth && truth <= to;
      half_width[p] += std::log(to / from) / 2 / kFits;
      square_error[p] += std::pow(std::log(double(parameter["value"]) / truth), 2) / kFits;
    }
  }
  for (int p = 0; p < 2; ++p) {
    EXPECT_GE(covered[p], 6);
    EXPECT_LT(half_width[p], 5 * std::sqrt(square_error[p])) << "absurdly wide";
  }
}

TEST_F(FitConfidence, CurvesOfDifferentNoiseCountByTheirOwn) {
  run_truth("--set body.yieldStress=110 --set body.plasticFlowRate=1.3");
  write_noisy(3, 0.0002, 0, 0.01);
  const Json both = fit(kBoth);
  EXPECT_NEAR(both["columns"][0]["noise"], 0.0002, 0.0001);
  EXPECT_NEAR(both["columns"][1]["noise"], 0.01, 0.004);
  // the noisy curve takes nothing away from the other one
  const Json one = fit(std::string("--compare elongation ") + kBoth);
  for (int p = 0; p < 2; ++p)
    EXPECT_NEAR(
        both["parameters"][p]["value"], one["parameters"][p]["value"],
        0.5 * (double(one["parameters"][p]["confidence_to"]) - double(one["parameters"][p]["confidence_from"])));
}

TEST_F(FitConfidence, DifferencesThatAreAlikeFromRowToRowAreSaid) {
  run_truth("--set body.yieldStress=110 --set body.plasticFlowRate=1.3");
  write_noisy(5, 0.002, 0.9, 0);
  const Json slow = fit(std::string("--compare elongation ") + kBoth);
  EXPECT_GT(slow["columns"][0]["noise_correlation"], 0.4);
  EXPECT_NE(messages_.find("the differences in elongation are alike from row to row"), std::string::npos) << messages_;
  EXPECT_NE(printed_.find("95 %: "), std::string::npos) << printed_;
}

TEST_F(FitConfidence, LimitsAndCombinationsThatAreNotDeterminedAreNamed) {
  write("bar.scn", hexaplast::support::pulled_bar());
  write("curve.csv", "time,elongation\n0.2,0.02\n0.5,0.051\n0.8,0.079\n1,0.1\n");
  const Json found = fit("--free body.youngModulus=2500:5000");
  EXPECT_NE(messages_.find("body.youngModulus is at its limit"), std::string::npos) << messages_;
  EXPECT_TRUE(found["parameters"][0]["at_limit"]);
  EXPECT_TRUE(found["parameters"][0]["confidence_from"].is_null());

  std::string scene = hexaplast::support::pulled_bar();
  scene.replace(scene.find("</Node>"), 7,
                "<MaterialRegion name='near' indices='0' youngModulus='2000'/>"
                "<MaterialRegion name='far' indices='1' youngModulus='2000'/></Node>");
  write("bar.scn", scene);
  const Json two = fit("--free near.youngModulus=200:200000 --free far.youngModulus=200:200000");
  ASSERT_EQ(two["undetermined"].size(), 1u) << messages_;
  EXPECT_LT(double(two["undetermined"][0][0]) * double(two["undetermined"][0][1]), 0);
  EXPECT_NE(messages_.find("the curve does not determine "), std::string::npos) << messages_;
  EXPECT_NE(messages_.find(" together with "), std::string::npos) << messages_;

  // as many rows as values: any noise could be part of them
  run_truth("--set body.yieldStress=110 --set body.plasticFlowRate=1.3");
  hexaplast::output::HistoryTable table(directory_ / "truth/history.csv");
  const auto current = static_cast<std::size_t>(table.find("world_elongation"));
  std::string curve = "time,elongation\n";
  for (std::span<const double> row = table.next(); !row.empty(); row = table.next())
    if (row[0] == 12 || row[0] == 25) curve += std::to_string(row[1]) + "," + std::to_string(row[current]) + "\n";
  write("curve.csv", curve);
  const Json bare = fit(kBoth);
  EXPECT_NE(messages_.find("not more rows than parameters"), std::string::npos) << messages_;
  EXPECT_TRUE(bare["columns"][0]["noise"].is_null());
}

}  // namespace
