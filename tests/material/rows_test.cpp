// SPDX-License-Identifier: LGPL-2.1-or-later
// Each member of Material and Settings has a row, and what goes through the rows sees it.
#include "hexaplast/material/rows.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/error.hpp"
#include "support/compare.hpp"
#include "support/rows.hpp"

namespace hexaplast {
namespace {

struct ThreeMembers {
  double first = 0;
  int second = 0;
  Precision third = {};
};
static_assert(num_members<ThreeMembers>() == 3);

template <class Options>
void expect_a_row_for_each_member(std::span<const Row<Options>> rows) {
  EXPECT_EQ(rows.size(), num_members<Options>());
  std::set<std::string_view> members, names;
  for (const Row<Options>& row : rows) {
    SCOPED_TRACE(row.member);
    EXPECT_TRUE(members.insert(row.member).second);
    EXPECT_TRUE(names.insert(row.name).second);
    EXPECT_EQ(std::ranges::count(kBodyGroups, row.group), 1);
    EXPECT_TRUE(row.help.ends_with('.'));
    EXPECT_EQ(row.words.empty(), row.at.type != MemberType::kWord);
    for (const double value : row.values({})) EXPECT_TRUE(row.admits(value)) << "the default";

    Options options;
    support::change(row, options);
    for (const Row<Options>& other : rows)
      EXPECT_EQ(other.values(options) == other.values({}), &other != &row) << other.member;
  }
}

TEST(Rows, ThereIsOneForEachMember) {
  expect_a_row_for_each_member(material_rows());
  expect_a_row_for_each_member(settings_rows());
}

template <class Options, class Validate>
void expect_validation(std::span<const Row<Options>> rows, const Validate& validate) {
  for (const Row<Options>& row : rows) {
    std::vector<double> wrong;
    if (row.at.type == MemberType::kWord) {
      wrong = {-1, static_cast<double>(row.words.size())};
    } else {
      for (const double bound : {row.range.min, row.range.max})
        if (std::isfinite(bound)) wrong.push_back(bound == row.range.min ? bound - 1 : bound + 1);
      if (row.at.type != MemberType::kInteger) {
        wrong.push_back(std::numeric_limits<double>::quiet_NaN());
        if (row.range.exclusive_min) wrong.push_back(row.range.min);
        if (row.range.exclusive_max) wrong.push_back(row.range.max);
      }
    }
    for (const double value : wrong) {
      Options options;
      row.set_values(options, std::vector<double>{value, 1});
      EXPECT_TRUE(support::refuses<InputError>([&] { validate(options, Names::kMembers); }, {std::string(row.member)}));
      EXPECT_TRUE(support::refuses<InputError>([&] { validate(options, Names::kScenes); }, {std::string(row.name)}));
    }
  }
}

TEST(Rows, ValidationGoesThroughThem) {
  expect_validation(material_rows(), [](const Material& material, Names names) { validate({material}, names); });
  expect_validation(settings_rows(), [](const Settings& settings, Names names) { validate(settings, names); });
}

TEST(Rows, AMemberIsArchivedAsItLiesInMemory) {
  Settings settings{.relaxation = {3, 0.1},
                    .rotation_plasticity = RotationPlasticity::kNone,
                    .averaging_steps = 7,
                    .volume_restitution = 3};
  std::vector<std::byte> bytes;
  Archive writing([&](const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
  });
  serialize(writing, settings_rows(), settings);
  std::size_t num_bytes = 0;
  for (const Row<Settings>& row : settings_rows())
    num_bytes += row.at.list ? 3 * sizeof(double) : row.at.type == MemberType::kReal ? sizeof(double) : sizeof(int);
  EXPECT_EQ(bytes.size(), num_bytes);
  Settings read;
  Archive reading{std::span<const std::byte>(bytes)};
  serialize(reading, settings_rows(), read);
  EXPECT_EQ(read, settings);
}

// An infinite yield stress times no time step is no number.
TEST(Rows, OnlyRatesAreJudgedByTheTimeStep) { EXPECT_TRUE(check_time_step({Material{}}, {}, 0).empty()); }

TEST(Rows, IntervalsShowWhichBoundsAreAdmissible) {
  EXPECT_EQ(interval({}, false), "(-inf, inf)");
  EXPECT_EQ(interval({.min = 0}, true), "[0, inf]");
  EXPECT_EQ(interval({.min = 0, .max = 1, .exclusive_min = true}, false), "(0, 1]");
  EXPECT_EQ(called("flow_rate", Names::kScenes), "plasticFlowRate");
  EXPECT_EQ(called("rotation_plasticity", Names::kScenes), "rotationPlasticity");
  EXPECT_TRUE(support::refuses<InputError>([] { return called("yieldStress", Names::kScenes); }, {"yieldStress"}));
}

}  // namespace
}  // namespace hexaplast
