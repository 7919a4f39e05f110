// SPDX-License-Identifier: LGPL-2.1-or-later
// Sweeps in parts, against the same sweep in one process.
#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <vector>

#include "support/command.hpp"
#include "support/csv.hpp"
#include "support/pulled_bar.hpp"

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Csv;
using hexaplast::support::Outcome;

class SweepShards : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("bar.scn", hexaplast::support::flowing_bar());
  }

  Csv table(const std::string& directory) { return Csv(content(directory_ / directory / "sweep.csv")); }

  /// Everything but wall times.
  std::map<std::string, std::string> files(const std::string& directory) {
    std::map<std::string, std::string> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_ / directory))
      if (entry.path().filename() != "sweep_times.csv")
        found[entry.path().filename().string()] = entry.is_directory() ? "directory" : content(entry.path());
    return found;
  }

  /// Carries out all shards of a sweep, into `name`_1 and so on. Returns what --merge takes.
  std::string carry_out(const std::string& sweep, int count, const std::string& name = "part") {
    std::string all;
    for (int i = 1; i <= count; ++i) {
      const std::string part = name + "_" + std::to_string(i);
      all += " " + part;
      const Outcome outcome =
          hexaplast(sweep + " --shard " + std::to_string(i) + "/" + std::to_string(count) + " --out " + part);
      EXPECT_TRUE(outcome.code == 0 || outcome.code == 3 || outcome.code == 4) << outcome.err;
    }
    return all;
  }
};

const std::string kSweep = "sweep bar.scn --vary body.yieldStress=40,60,90,150 --vary body.plasticFlowRate=1:3:3";

TEST_F(SweepShards, MergedHaveTheBytesOfOneProcess) {
  const std::string sweep = kSweep + " --fields displacement,plasticStrain,contactForce --every 4";
  ASSERT_EQ(hexaplast(sweep + " --out one --jobs 2").code, 0);
  const std::string parts = carry_out(sweep, 3);
  const Outcome merged = hexaplast("sweep --out merged --merge" + parts);
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_EQ(merged.out, "bar: 12 of 12 runs done, 0 failed: merged/sweep.csv\n");
  const auto one = files("one");
  EXPECT_EQ(one.size(), 12u + 4);  // a data set each; plan, table, picture, overview of the data sets
  EXPECT_EQ(files("merged"), one);

  // every run was carried out once
  std::set<std::string> runs;
  for (const std::string part : {"part_1", "part_2", "part_3"}) {
    const Csv its = table(part);
    EXPECT_GT(its.num_rows(), 0u);
    for (std::size_t row = 0; row < its.num_rows(); ++row) EXPECT_TRUE(runs.insert(its.text(row, "run")).second);
  }
  EXPECT_EQ(runs.size(), 12u);

  // the merged sweep is the sweep: it has nothing left to do
  const Outcome again = hexaplast(sweep + " --out merged");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out.find("run 1 of"), std::string::npos) << again.out;
  EXPECT_EQ(files("merged"), one);
  const Csv times(content(directory_ / "merged/sweep_times.csv"));
  ASSERT_EQ(times.num_rows(), 12u);
  EXPECT_GT(times.number(11, "step_ms"), 0);
}

// A value more leaves all runs where they were.
TEST_F(SweepShards, ARunBelongsToAShardByItsValues) {
  std::map<std::string, std::string> shard_of;
  for (const auto& [values, name] : {std::pair{"40,60,90", "few"}, {"20,40,50,60,90,95", "more"}}) {
    carry_out(std::string("sweep bar.scn --steps 1 --vary body.yieldStress=") + values, 3, name);
    for (const std::string i : {"1", "2", "3"}) {
      const Csv its = table(std::string(name) + "_" + i);
      for (std::size_t row = 0; row < its.num_rows(); ++row) {
        const auto [known, is_new] = shard_of.try_emplace(its.text(row, "body.yieldStress"), i);
        EXPECT_EQ(known->second, i) << known->first;
      }
    }
  }
  EXPECT_EQ(shard_of.size(), 6u);
}

TEST_F(SweepShards, RunsThatFailAreRowsOfTheWhole) {
  const std::string sweep = "sweep bar.scn --vary body.plasticFlowRate=1,100,2,200";  // two of which are refused
  EXPECT_EQ(hexaplast(sweep + " --out one").code, 4);
  const Outcome merged = hexaplast("sweep --out merged --merge" + carry_out(sweep, 2));
  EXPECT_EQ(merged.code, 4);
  EXPECT_EQ(merged.err, "bar: error: 2 of 4 runs failed\n");
  EXPECT_EQ(files("merged"), files("one"));
  EXPECT_NE(content(directory_ / "merged/messages_2.txt").find("plasticFlowRate"), std::string::npos);
}

TEST_F(SweepShards, WhatIsMissingIsSaidAndComesLater) {
  const std::string parts = carry_out(kSweep, 2);
  const Csv second = table("part_2");
  const Outcome half = hexaplast("sweep --out merged --merge part_1");
  EXPECT_EQ(half.code, 5);
  EXPECT_EQ(half.err, "merged: error: " + std::to_string(second.num_rows()) +
                          " of 12 runs are missing: complete the shards and merge again\n");
  EXPECT_EQ(table("merged").num_rows(), 12 - second.num_rows());
  EXPECT_EQ(hexaplast("sweep --out merged --merge part_2").code, 0);
  ASSERT_EQ(hexaplast(kSweep + " --out one").code, 0);
  EXPECT_EQ(files("merged"), files("one"));
}

TEST_F(SweepShards, WhatDoesNotBelongTogetherIsRefused) {
  const std::string parts = carry_out(kSweep + " --steps 2", 2);
  const auto refused = [&](const std::string& arguments, int code, const std::string& message) {
    const Outcome outcome = hexaplast("sweep " + arguments);
    EXPECT_EQ(outcome.code, code) << arguments;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << arguments << "\n" << outcome.err;
  };
  for (const char* shard : {"0/2", "3/2", "1", "1/", "/2", "1/2x", "-1/2", "1/200000"})
    refused("bar.scn --out no --vary body.yieldStress=1,2 --shard " + std::string(shard), 2,
            "must be i/n with i from 1 to n, and n at most 100000");
  refused("--out no", 2, "SCENE is required, or --merge");
  refused("bar.scn --out no", 2, "--vary is required, or --merge");
  refused("bar.scn --out no --merge part_1", 2, "--merge takes --out and --force alone");
  for (const char* option : {"--strict", "--jobs 2", "--threads 2", "--set body.yieldStress=1", "--mesh-path ."})
    refused("--out no --merge part_1 part_2 " + std::string(option), 2, "--merge takes --out and --force alone");
  refused("bar.scn --out no --vary body.yieldStress=1,2 --vary /body.yieldStress=3,4", 2,
          "--vary /body.yieldStress: this attribute is varied already, as body.yieldStress");
  refused("bar.scn --out no --vary body.yieldStress=1,2 --every 2", 2, "--every requires --fields");
  refused("bar.scn --out no --vary body.yieldStress=1,2 --fields displacement,strane", 2, "'strane' is none of");
  refused("bar.scn --out no --vary body.yieldStress=1,2 --fields strain,strain", 2, "'strain' is given twice");
  EXPECT_FALSE(fs::exists(directory_ / "no"));

  refused("bar.scn --steps 2 --out part_1 --shard 2/2 " + kSweep.substr(14), 5, "the shard differs");
  ASSERT_EQ(hexaplast(kSweep + " --steps 3 --shard 1/2 --out other").code, 0);
  refused("--out merged --merge part_2 other", 5, "are not of one sweep: the number of steps differs");
  refused("--out part_1 --merge part_1 part_2", 5, "part_1");
  refused("--out merged --merge absent", 5, "absent/sweep.json");
  write("bad/sweep.json", "");
  fs::create_directory(directory_ / "bad");
  for (const char* text : {"{", "[]", "{\"vary\": 3}", "{}"}) {
    write("bad/sweep.json", text);
    refused("--out merged --merge bad", 5, "bad/sweep.json");
  }

  const std::string plan = content(directory_ / "part_1/sweep.json");
  for (const char* key : {"units", "labels"})
    for (const nlohmann::json& damaged : {nlohmann::json::array(), nlohmann::json(3)}) {
      auto found = nlohmann::ordered_json::parse(plan);
      found[key] = damaged;
      write("bad/sweep.json", found.dump());
      refused("--out merged --merge bad", 5, std::string(key) + " must have as many entries as vary");
    }
  for (const auto& [key, message] :
       {std::pair{"version", "the version of Hexaplast differs"}, std::pair{"simd", "the instruction set differs"}}) {
    auto found = nlohmann::ordered_json::parse(plan);
    found[key] = "other";
    write("bad/sweep.json", found.dump());
    refused("--out merged --merge part_2 bad", 5, std::string("are not of one sweep: ") + message);
    refused(kSweep.substr(6) + " --steps 2 --shard 1/2 --out bad", 5, std::string("holds another sweep: ") + message);
  }

  // another result of the same run
  fs::copy(directory_ / "part_1", directory_ / "changed");
  std::string rows = content(directory_ / "changed/sweep.csv");
  rows[rows.size() - 2] = rows[rows.size() - 2] == '0' ? '1' : '0';  // last digit of a hash
  write("changed/sweep.csv", rows);
  refused("--out merged --merge part_1 changed part_2", 5, "has other results in changed than in part_1");
}

// The run of a sweep that is killed goes with it, and is the only one that is lost.
TEST_F(SweepShards, AKilledSweepGoesOn) {
  const std::string sweep = "sweep bar.scn --jobs 1 --vary RunSettings1.steps=1,2,3,40000,4 --out found";
  std::thread killer([&] {
    for (int i = 0; i < 2000 && content(directory_ / "found/sweep.csv").find("\n3,") == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::ignore = std::system(("kill -KILL $(cat '" + (directory_ / "id").string() + "')").c_str());
  });
  const Outcome killed = shell("sh -c 'echo $$ > id; exec \"" + std::string(HEXAPLAST_COMMAND) + "\" " + sweep + "'");
  killer.join();
  EXPECT_NE(killed.code, 0);
  ASSERT_EQ(table("found").num_rows(), 3u);
  int num_left = 1;
  for (int i = 0; i < 400 && num_left > 0; ++i) {
    num_left = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
      std::error_code none;
      num_left += fs::read_symlink(entry.path() / "cwd", none) == directory_;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(num_left, 0) << "its run goes on";
  const Outcome resumed = hexaplast(sweep);
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_NE(resumed.out.find("3 of 5 runs are done already"), std::string::npos) << resumed.out;
  EXPECT_EQ(table("found").num_rows(), 5u);
}

// The row of a run whose data set is gone is not believed.
TEST_F(SweepShards, ALostDataSetIsMadeAgain) {
  const std::string sweep = kSweep + " --steps 3 --fields plasticStrain --out found";
  ASSERT_EQ(hexaplast(sweep).code, 0);
  const auto before = files("found");
  fs::remove(directory_ / "found/run_5.h5");
  const Outcome again = hexaplast(sweep);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.out.find("11 of 12 runs are done already"), std::string::npos) << again.out;
  EXPECT_EQ(files("found"), before);
  const Outcome other = hexaplast(sweep + " --every 2");
  EXPECT_EQ(other.code, 5);
  EXPECT_NE(other.err.find("--fields or --every differ"), std::string::npos) << other.err;
}

TEST_F(SweepShards, ARunWritesADataSetOnlyWhenItIsComplete) {
  const Outcome needs = hexaplast("run bar.scn --data found.h5");
  EXPECT_EQ(needs.code, 2);
  EXPECT_NE(needs.err.find("--data requires --fields"), std::string::npos) << needs.err;
  EXPECT_EQ(hexaplast("run bar.scn --quiet --data found.h5 --fields velocity --every 5").code, 0);
  const std::string whole = content(directory_ / "found.h5");
  EXPECT_EQ(whole.substr(1, 3), "HDF");
  // a run that fails leaves the file of the one before it
  EXPECT_EQ(hexaplast("run bar.scn --quiet --data found.h5 --fields velocity --set pull.forces='0 0 0 1e200 0 0 1e200 "
                      "0 0 0 0 0'")
                .code,
            4);
  EXPECT_EQ(content(directory_ / "found.h5"), whole);
  EXPECT_FALSE(fs::exists(directory_ / "found.h5.part"));
  const Outcome full = hexaplast("run bar.scn --quiet --data /dev/full --fields velocity");
  EXPECT_EQ(full.code, 5);
  EXPECT_NE(full.err.find("/dev/full: is not a regular file"), std::string::npos) << full.err;
}

}  // namespace
