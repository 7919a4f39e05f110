// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/material/material.hpp"

#include <fmt/format.h>

#include <set>

#include "hexaplast/material/rows.hpp"
#include "support/core.hpp"
#include "support/rows.hpp"

namespace hexaplast {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Bad {
  const char *member, *name;
  double Material::*at;
  std::vector<double> values;
  const char* bounds;
};

TEST(Material, RefusesValuesOutsideTheirRangesAndNamesTheElement) {
  const std::vector<Bad> cases{
      {"young_modulus", "youngModulus", &Material::young_modulus, {0, -1, kNan, kInf}, "(0, inf) Pa"},
      {"poisson_ratio", "poissonRatio", &Material::poisson_ratio, {-0.1, 0.5, 1, kNan}, "[0, 0.5)"},
      {"yield_stress", "yieldStress", &Material::yield_stress, {-1, kNan}, "[0, inf] Pa"},
      {"flow_rate", "plasticFlowRate", &Material::flow_rate, {-1, kNan, kInf}, "[0, inf) 1/s"},
      {"rotation_yield", "rotationYield", &Material::rotation_yield, {-0.1, 3.2, kNan}, "[0, 3.141592654] rad"},
      {"rotation_flow_rate", "rotationFlowRate", &Material::rotation_flow_rate, {-1, kNan, kInf}, "[0, inf) 1/s"},
      {"hardening", "hardening", &Material::hardening, {kNan, 1e7, kInf, -kInf}, "(-inf, 1000000]"},
      {"fracture_stress", "fractureStress", &Material::fracture_stress, {-1, kNan}, "[0, inf] Pa"},
      {"fracture_stretch", "fractureStretch", &Material::fracture_stretch, {1, -1, kNan}, "(1, inf]"},
  };
  for (const Bad& bad : cases) {
    for (const double value : bad.values) {
      std::vector<Material> materials(8);
      materials[5].*bad.at = value;
      for (const auto& [names, name] : {std::pair{Names::kMembers, bad.member}, std::pair{Names::kScenes, bad.name}})
        EXPECT_TRUE(
            refuses<InputError>([&, names = names] { validate(materials, names); },
                                {fmt::format("{} = {} of element 5: must lie in {}", name, value, bad.bounds)}));
    }
  }
  EXPECT_NO_THROW(validate(std::vector<Material>(3)));
}

// Of one material, and of a body of which no element can be carried past its limit. Where some can, it is theirs.
TEST(Material, RefusesAFractureStressBelowTheYieldStress) {
  const Material m{.yield_stress = 500, .fracture_stress = 400};
  EXPECT_TRUE(refuses<InputError>([&] { validate({m}); },
                                  {"fracture_stress = 400: must lie in [500, inf] Pa, from yield_stress on"}));
  std::vector<Material> materials(3, m);
  materials[2].yield_stress = 450;
  EXPECT_TRUE(refuses<InputError>([&] { validate(materials, Names::kScenes); },
                                  {"fractureStress = 400 of element 2", "[450, inf] Pa, from yieldStress on"}));
  for (const double accepted : {400.0, 300.0, kInf}) {  // at the limit; below it; no yield, that is no growth
    materials[1].yield_stress = accepted;
    EXPECT_NO_THROW(validate(materials));
  }
}

TEST(Lame, HasTheHandValues) {
  const Lame k = lame(5000, 0.45);
  EXPECT_NEAR(k.mu, 5000 / 2.9, 1e-9);
  EXPECT_NEAR(k.lambda, 5000 * 0.45 / (1.45 * 0.1), 1e-9);
}

TEST(Material, IsOneOrOnePerElement) {
  EXPECT_TRUE(refuses<InputError>(
      [] {
        Body(block({2, 2, 2}, 0.1), std::vector<Material>(3));
      },
      {"3 materials", "8 hexahedra"}));
  EXPECT_NO_THROW(Body(block({2, 2, 2}, 0.1), std::vector<Material>(8)));
}

TEST(Settings, RefuseWhatIsNoEnumeratorAndNumbersOfStepsOutOfRange) {
  Settings settings;
  settings.precision = static_cast<Precision>(2);
  EXPECT_TRUE(refuses<InputError>([&] { validate(settings); }, {"precision = 2: must be double or mixed"}));
  for (const int bad : {0, -1, 1001}) {
    settings = {.averaging_steps = bad};
    EXPECT_TRUE(refuses<InputError>([&] { validate(settings, Names::kScenes); },
                                    {fmt::format("averagingSteps = {}: must lie in [1, 1000]", bad)}));
  }
  settings = {.volume_restitution = kInf};
  EXPECT_TRUE(refuses<InputError>([&] { validate(settings); }, {"volume_restitution"}));
}

/// What is wrong with a body of these settings, by the names of scenes.
std::string refusal(const Settings& settings, double flow_rate) {
  try {
    validate(settings, Names::kScenes);
    validate({Material{.yield_stress = 100, .flow_rate = flow_rate}}, settings, Names::kScenes);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Settings, NameWhatTheyNeed) {
  const std::vector<double> relaxing = {1, 0.2};
  const std::pair<Settings, const char*> always[] = {
      {{}, ""},
      {{.bending = Bending::kBlended}, ""},
      {{.rest_shape = RestShape::kJoined}, ""},
      {{.yield_stress_measure = YieldStressMeasure::kCauchy}, ""},
      {{.relaxation = relaxing}, ""},
      {{.yield_stress_measure = YieldStressMeasure::kCauchy, .rest_shape = RestShape::kJoined},
       "yieldStressMeasure = cauchy needs restShape = isolated"},
      {{.volumetric = Volumetric::kSample, .yield_stress_measure = YieldStressMeasure::kCauchy},
       "yieldStressMeasure = cauchy needs volumetric = volumeRatio"},
      {{.relaxation = {1, 0.2, 3}}, "relaxation: 3 numbers, must be pairs of a modulus and a time, at most 8"},
      {{.relaxation = std::vector<double>(18, 1)},
       "relaxation: 18 numbers, must be pairs of a modulus and a time, at most 8"},
      {{.relaxation = {1, 0}}, "relaxation = 0: must lie in (0, inf)"},
      {{.relaxation = {1, kInf}}, "relaxation = inf: must lie in (0, inf)"},
      {{.bending = Bending::kBlended, .relaxation = relaxing}, "relaxation needs bending = assumedCorner"},
      {{.volumetric = Volumetric::kSample, .relaxation = relaxing}, "relaxation needs volumetric = volumeRatio"},
      {{.law = ElasticLaw::kMooneyRivlin, .relaxation = relaxing}, "relaxation needs law = corotated"},
      {{.bending = Bending::kVertex, .precision = Precision::kMixed}, "bending = vertex needs precision = double"},
      {{.bending = Bending::kBlended, .precision = Precision::kMixed}, "bending = blended needs precision = double"},
      {{.volumetric = Volumetric::kSample, .precision = Precision::kMixed},
       "volumetric = sample needs precision = double"},
      {{.rotation_plasticity = RotationPlasticity::kCentre, .precision = Precision::kMixed},
       "rotationPlasticity = centre needs precision = double"},
      {{.averaging = AveragingMethod::kJacobi, .precision = Precision::kMixed},
       "averaging = jacobi needs precision = double"},
      {{.precision = Precision::kMixed, .implementation = Implementation::kPlain},
       "implementation = plain needs precision = double"}};
  for (const auto& [settings, message] : always)
    for (const double flow_rate : {0.0, 1.0}) EXPECT_EQ(refusal(settings, flow_rate), message);

  const std::pair<Settings, const char*> where_it_flows[] = {
      {{.law = ElasticLaw::kNeoHookean},
       "law = neoHookean of a body that flows needs restShape = joined: isolated rest shapes have corotated"},
      {{.bending = Bending::kCentre},
       "bending = centre of a body that flows needs restShape = joined: isolated rest shapes have assumedCorner and "
       "blended"},
      {{.rotation_plasticity = RotationPlasticity::kVertex},
       "rotationPlasticity = vertex of a body that flows needs restShape = joined: isolated rest shapes have no flow "
       "of "
       "rotation"},
      {{.rest_shape = RestShape::kJoined, .precision = Precision::kMixed},
       "restShape = joined of a body that flows needs precision = double"},
      {{.relaxation = relaxing, .rest_shape = RestShape::kJoined},
       "relaxation of a body that yields needs restShape = isolated"}};
  for (const auto& [settings, message] : where_it_flows) {
    EXPECT_EQ(refusal(settings, 1), message);
    EXPECT_EQ(refusal(settings, 0), "");
  }
  EXPECT_TRUE(refuses<InputError>(
      [] { validate({Material{.rotation_flow_rate = 2}}, Settings{}); },
      {"rotation_flow_rate = 2: must be 0 with rest_shape = isolated", "rest_shape = joined has it"}));
}

TEST(Settings, TellWhatThePlainImplementationComputes) {
  const Material elastic, flows{.yield_stress = 1, .flow_rate = 1};
  EXPECT_FALSE(is_plain({flows}, {}));
  EXPECT_FALSE(is_plain({elastic}, {.rest_shape = RestShape::kJoined}));
  EXPECT_TRUE(is_plain({flows}, {.rest_shape = RestShape::kJoined}));
  for (const Settings& settings : std::vector<Settings>{{.bending = Bending::kVertex},
                                                        {.bending = Bending::kBlended},
                                                        {.volumetric = Volumetric::kSample},
                                                        {.rotation_plasticity = RotationPlasticity::kCentre},
                                                        {.averaging = AveragingMethod::kJacobi},
                                                        {.implementation = Implementation::kPlain}})
    EXPECT_TRUE(is_plain({elastic}, settings));
}

// Any rate is plasticity, and c does not act, but for pressure at each sample.
TEST(CheckTimeStep, OfIsolatedRestShapesAdvisesAgainstFlowWithoutARate) {
  EXPECT_EQ(check_time_step({Material{.yield_stress = 1, .flow_rate = 500}}, {.volume_restitution = 100}, 0.01,
                            Names::kScenes),
            std::vector<std::string>{
                "plasticFlowRate = 500 1/s times dt = 0.01 s is 5: all of the excess flows in each step, at no rate"});

  const Settings sample{.volumetric = Volumetric::kSample};
  const Material stiff{.young_modulus = 1e6, .flow_rate = 500},
      soft{.poisson_ratio = 0.45, .yield_stress = 1, .flow_rate = 10.1};
  EXPECT_TRUE(refuses<InputError>(
      [&] {
        check_time_step({stiff, soft}, sample, 0.01, Names::kScenes);
      },
      {"plasticFlowRate = 10.1 of element 1: must be at most (1 - 2 poissonRatio) / dt = 10 1/s with restShape = "
       "isolated and volumetric = sample"}));
  check_time_step({stiff, soft}, sample, 0.0099);
}

TEST(CheckTimeStep, RefusesWhatIsUnstableAndAdvisesAgainstWhatIsInaccurate) {
  Material m{.yield_stress = 300, .flow_rate = 4, .rotation_flow_rate = 2};
  Settings settings{.rest_shape = RestShape::kJoined};
  EXPECT_TRUE(check_time_step({m}, settings, 0.01).empty());
  EXPECT_EQ(check_time_step({m}, settings, 0.02).size(), 1u);  // nu dt = .08
  EXPECT_TRUE(refuses<InputError>([&] { check_time_step({m}, settings, 0.3); },
                                  {"flow_rate = 4 1/s times dt = 0.3 s is 1.2: must be at most 1"}));

  m.flow_rate = 0;
  m.rotation_flow_rate = 200;
  EXPECT_TRUE(refuses<InputError>([&] { check_time_step({m}, settings, 0.01, Names::kScenes); },
                                  {"rotationFlowRate = 200 1/s", "is 2: must be at most 1"}));

  m.rotation_flow_rate = 0;
  m.flow_rate = 1;
  settings.volume_restitution = 50;
  EXPECT_EQ(check_time_step({m}, settings, 0.01).size(), 1u);  // c dt = .5
  settings.volume_restitution = 100;
  EXPECT_TRUE(refuses<InputError>([&] { check_time_step({m}, settings, 0.01); },
                                  {"volume_restitution", "must be below 0.666667"}));
  m.flow_rate = 0;
  EXPECT_TRUE(check_time_step({m}, settings, 1).empty()) << "nothing flows";
}

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
    change(row, options);
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
      EXPECT_TRUE(refuses<InputError>([&] { validate(options, Names::kMembers); }, {std::string(row.member)}));
      EXPECT_TRUE(refuses<InputError>([&] { validate(options, Names::kScenes); }, {std::string(row.name)}));
    }
  }
}

TEST(Rows, ValidationGoesThroughThem) {
  expect_validation(material_rows(), [](const Material& material, Names names) { validate({material}, names); });
  expect_validation(settings_rows(), [](const Settings& settings, Names names) { validate(settings, names); });
}

// An infinite yield stress times no time step is no number.
TEST(Rows, OnlyRatesAreJudgedByTheTimeStep) { EXPECT_TRUE(check_time_step({Material{}}, {}, 0).empty()); }

TEST(Rows, IntervalsShowWhichBoundsAreAdmissible) {
  EXPECT_EQ(interval({}, false), "(-inf, inf)");
  EXPECT_EQ(interval({.min = 0}, true), "[0, inf]");
  EXPECT_EQ(interval({.min = 0, .max = 1, .exclusive_min = true}, false), "(0, 1]");
  EXPECT_EQ(called("flow_rate", Names::kScenes), "plasticFlowRate");
  EXPECT_EQ(called("rotation_plasticity", Names::kScenes), "rotationPlasticity");
  EXPECT_TRUE(refuses<InputError>([] { return called("yieldStress", Names::kScenes); }, {"yieldStress"}));
}

}  // namespace
}  // namespace hexaplast
