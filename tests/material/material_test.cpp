// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/material/material.hpp"

#include <fmt/format.h>

#include <limits>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::refuses;

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
  Material m;
  m.yield_stress = 500;
  m.fracture_stress = 400;
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
        Body(support::block({2, 2, 2}, 0.1), std::vector<Material>(3));
      },
      {"3 materials", "8 hexahedra"}));
  EXPECT_NO_THROW(Body(support::block({2, 2, 2}, 0.1), std::vector<Material>(8)));
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

TEST(CheckTimeStep, RefusesWhatIsUnstableAndAdvisesAgainstWhatIsInaccurate) {
  Material m;
  Settings settings{.rest_shape = RestShape::kJoined};
  m.yield_stress = 300;
  m.flow_rate = 4;
  m.rotation_flow_rate = 2;
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

}  // namespace
}  // namespace hexaplast
