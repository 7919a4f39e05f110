// SPDX-License-Identifier: LGPL-2.1-or-later
#include <memory>
#include <set>

#include "attributes/admissible.hpp"
#include "attributes/hexaplast.hpp"
#include "attributes/parts.hpp"
#include "attributes/stock.hpp"
#include "hexaplast/base/error.hpp"
#include "scene/interfaces.hpp"
#include "scene/value.hpp"
#include "support/german_locale.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;
using attributes::Attribute;
using attributes::Type;
using scene::read_value;

constexpr Attribute kReal{.name = "real", .type = Type::kReal};
constexpr Attribute kCount{.name = "count", .type = Type::kInteger};
constexpr Attribute kList{.name = "list", .type = Type::kIntegers};
constexpr Attribute kFraction{
    .name = "share", .type = Type::kReal, .range = {.min = 0, .max = 0.5, .exclusive_max = true}};

double real(std::string_view text) { return std::get<double>(read_value(kReal, text)); }
std::vector<std::int64_t> list(std::string_view text) {
  return std::get<std::vector<std::int64_t>>(read_value(kList, text));
}
std::string refusal(const Attribute& attribute, std::string_view text) {
  try {
    read_value(attribute, text);
    return "accepted";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(SceneValues, NumbersAreReadToTheLastBit) {
  EXPECT_EQ(real("0.1"), 0.1);
  EXPECT_EQ(real("  -1.7976931348623157e308\n"), -1.7976931348623157e308);
  EXPECT_EQ(real("+2.5"), 2.5);
  EXPECT_EQ(real("1e-320"), 1e-320);
}

TEST(SceneValues, NumbersDoNotDependOnTheLocale) {
  const GermanLocale german;
  EXPECT_EQ(real("1.5"), 1.5);
  EXPECT_EQ(refusal(kReal, "1,5"), "'1,5' is not a number");
  EXPECT_EQ(refusal(kReal, "1.234,5"), "'1.234,5' is not a number");
  if (!german.is_made()) GTEST_SKIP() << "only C++ streams were tried: localedef has no de_DE here";
}

TEST(SceneValues, WhatIsNoFiniteNumberIsRefused) {
  EXPECT_EQ(refusal(kReal, ""), "0 values given, must be one");
  EXPECT_EQ(refusal(kReal, "1 2"), "2 values given, must be one");
  EXPECT_EQ(refusal(kReal, "abc"), "'abc' is not a number");
  EXPECT_EQ(refusal(kReal, "nan"), "'nan' is not finite");
  EXPECT_EQ(refusal(kReal, "-inf"), "'-inf' is not finite");
  EXPECT_EQ(refusal(kReal, "1e400"), "'1e400' is out of range");
  EXPECT_EQ(refusal(kReal, "+-1"), "'+-1' is not a number");
  EXPECT_EQ(refusal(kReal, "0x10"), "'0x10' is not a number");
  EXPECT_EQ(refusal(kCount, "2.0"), "'2.0' is not a whole number");
  EXPECT_EQ(refusal(kCount, "9223372036854775808"), "'9223372036854775808' is out of range");
}

TEST(SceneValues, ARangeOfWholeNumbersStandsForItsNumbers) {
  EXPECT_EQ(list("7 2-5 10-20-4 -3"), (std::vector<std::int64_t>{7, 2, 3, 4, 5, 10, 14, 18, -3}));
  EXPECT_EQ(list("5-2 9-1--4 -1--3 4-4"), (std::vector<std::int64_t>{5, 4, 3, 2, 9, 5, 1, -1, -2, -3, 4}));
  EXPECT_EQ(list(" "), (std::vector<std::int64_t>{}));
  EXPECT_EQ(refusal(kList, "1-5-0"), "'1-5-0': a step of 0 does not lead from 1 to 5");
  EXPECT_EQ(refusal(kList, "5-1-2"), "'5-1-2': a step of 2 does not lead from 5 to 1");
  EXPECT_EQ(refusal(kList, "1-"), "'' is not a whole number");
  EXPECT_EQ(refusal(kList, "0-9000000000000000000"), "'0-9000000000000000000' stands for more than 16777216 numbers");
}

TEST(SceneValues, RangesNameTheirBounds) {
  EXPECT_EQ(refusal(kFraction, "0"), "accepted");
  EXPECT_EQ(refusal(kFraction, "0.5"), "0.5 must lie in [0, 0.5)");
  EXPECT_EQ(attributes::describe(attributes::kPositive), "must be > 0");
  EXPECT_EQ(attributes::describe(attributes::kNotNegative), "must be >= 0");
  EXPECT_EQ(attributes::describe(attributes::Range()), "");
}

TEST(SceneValues, WordsListTheirChoices) {
  const Attribute& norm = attributes::attribute_of(attributes::kHexahedronElastoplasticFEMForceField, "yieldNorm");
  EXPECT_EQ(refusal(norm, "frobenius"), "accepted");
  EXPECT_EQ(refusal(norm, "vonMiss"), "'vonMiss' must be vonMises, frobenius or spectral (did you mean 'vonMises'?)");
}

TEST(SceneValues, NearNamesAreFoundAtTwoEditsAtMost) {
  const std::vector<std::string_view> names = {"youngModulus", "yieldStress", "n"};
  EXPECT_EQ(scene::nearest("youngmodulus", names), "youngModulus");
  EXPECT_EQ(scene::nearest("yeildStres", names), "yieldStress");
  EXPECT_EQ(scene::nearest("yeldtress", names), "yieldStress");
  EXPECT_EQ(scene::nearest("hardening", names), "");
  EXPECT_EQ(scene::nearest("m", names), "");
}

// The table is the single source: every class that can be made is described, and every default can be read and lies in
// its range.
TEST(AttributeTable, DefaultsCanBeReadAndNamesAreUnique) {
  plugins();
  const std::vector<const attributes::Description*> all = factory().descriptions();
  EXPECT_GE(all.size(), 16u);
  for (const attributes::Description* description : all) {
    EXPECT_FALSE(description->help.empty()) << description->class_name;
    std::set<std::string_view> names;
    for (const Attribute& attribute : description->attributes) {
      EXPECT_TRUE(names.insert(attribute.name).second) << description->class_name << "." << attribute.name;
      EXPECT_FALSE(attribute.help.empty()) << description->class_name << "." << attribute.name;
      if (!attribute.initial.empty()) {
        EXPECT_NO_THROW(read_value(attribute, attribute.initial)) << description->class_name << "." << attribute.name;
      }
    }
    EXPECT_EQ(factory().make(description->class_name)->class_name(), description->class_name);
  }
}

/// Counts how often its output is computed.
class Counting final : public scene::Object {
 public:
  Counting() : Object(kDescription) {}
  void provide(scene::Data& output) override { output.set(std::vector<double>{1.0 * ++computed, 2}); }
  scene::Data& numbers() { return *find_data("numbers"); }

  int computed = 0;

 private:
  static constexpr Attribute kOutput[] = {
      {.name = "numbers", .type = Type::kReals, .access = attributes::Access::kOutput}};
  static constexpr attributes::Description kDescription{.class_name = "Counting", .attributes = kOutput};
};

// As probes of one array are; each moment has readings of its own.
TEST(Readings, AnOutputIsComputedOnceHoweverManyFollowIt) {
  Counting source;
  std::vector<std::unique_ptr<scene::Object>> readers;
  for (int k = 0; k < 100; ++k) {
    readers.push_back(std::make_unique<scene::Object>(attributes::kProbe));
    readers.back()->find_data("value")->follow(source.numbers(), "@source.numbers");
  }
  for (int moment = 1; moment <= 3; ++moment) {
    scene::Readings readings;
    for (const auto& reader : readers)
      EXPECT_EQ(readings.reals(*reader, "value"), (std::vector<double>{1.0 * moment, 2}));
    EXPECT_EQ(source.computed, moment);
  }
}

}  // namespace
