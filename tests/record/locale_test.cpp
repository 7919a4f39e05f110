// SPDX-License-Identifier: LGPL-2.1-or-later
// Hosts take their users' locale; what is read and written here does not.
#include <cstdio>

#include "record/recorder.hpp"
#include "support/german_locale.hpp"
#include "support/output.hpp"

namespace hexaplast {
namespace {

namespace fs = std::filesystem;
using support::GermanLocale;
using support::Scratch;

/// Everything that a run writes, by file names.
std::map<std::string, std::string> written_by_a_run(const fs::path& directory) {
  const Body body = support::yielding_block();
  const PointArray x = support::stretched(body.mesh().positions(), 0.1), v = support::some_velocities(body);
  output::Recorder recorder(directory, body, support::plan(4, 2));
  recorder.record({}, x, v);
  for (long step = 1; step <= 4; ++step)
    recorder.record({.step = 1000 * step,
                     .time = 0.0125 * static_cast<double>(step),
                     .kinetic_energy = 1234.5,
                     .solver_iterations = 7,
                     .residual = 1e-6 / 3,
                     .step_ms = 1234.5},
                    x, v);
  recorder.finish();
  output::write_final(directory / "final.json", 4000, 0.05, x, v, body);
  return support::files_in(directory);
}

TEST(Locale, OfTheHostChangesNoByteOfWhatARunWrites) {
  const Scratch scratch;
  const auto expected = written_by_a_run(scratch / "plain");
  ASSERT_GE(expected.size(), 4u);
  EXPECT_NE(expected.at("history.csv").find("1234.5"), std::string::npos);
  EXPECT_NE(expected.at("history.csv").find("\n4000,0.05,"), std::string::npos);

  std::map<std::string, std::string> found;
  bool is_made = false;
  {
    const GermanLocale german;
    is_made = german.is_made();
    char number[16];
    std::snprintf(number, sizeof number, "%.1f", 1.5);
    EXPECT_STREQ(number, is_made ? "1,5" : "1.5");
    std::ostringstream stream;
    stream << 1234.5;
    EXPECT_EQ(stream.str(), "1.234,5");
    found = written_by_a_run(scratch / "german");
  }
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_TRUE(found.at(name) == bytes) << name << " differs";
  }
  EXPECT_EQ(found.size(), expected.size());
  if (!is_made) GTEST_SKIP() << "only C++ streams were tried: localedef has no de_DE here";
}

}  // namespace
}  // namespace hexaplast
