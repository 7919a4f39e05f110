// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/material/material.hpp"

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
  const char* name;
  double Material::*member;
  std::vector<double> values;
};

TEST(Material, RefusesValuesOutsideTheirRangesAndNamesTheElement) {
  const std::vector<Bad> cases{
      {"youngModulus", &Material::young_modulus, {0, -1, kNan, kInf}},
      {"poissonRatio", &Material::poisson_ratio, {-0.1, 0.5, 1, kNan}},
      {"yieldStress", &Material::yield_stress, {-1, kNan}},
      {"plasticFlowRate", &Material::flow_rate, {-1, kNan, kInf}},
      {"rotationYield", &Material::rotation_yield, {-0.1, 3.2, kNan}},
      {"rotationFlowRate", &Material::rotation_flow_rate, {-1, kNan, kInf}},
      {"hardening", &Material::hardening, {kNan, kInf}},
  };
  for (const Bad& bad : cases) {
    for (const double value : bad.values) {
      std::vector<Material> materials(8);
      materials[5].*bad.member = value;
      EXPECT_TRUE(refuses<InputError>([&] { validate(materials); }, {bad.name, "element 5", "must lie in"}))
          << bad.name << " " << value;
    }
  }
  EXPECT_NO_THROW(validate(std::vector<Material>(3)));
}

TEST(Material, MessagesStateTheValue) {
  Material m;
  m.poisson_ratio = 0.625;
  EXPECT_TRUE(refuses<InputError>([&] { validate({m}); }, {"poissonRatio", "0.625", "[0, 0.5)"}));
}

// Of one material, and of a body of which no element can be carried past its limit. Where some can, it is theirs.
TEST(Material, RefusesAFractureStressBelowTheYieldStress) {
  Material m;
  m.yield_stress = 500;
  m.fracture_stress = 400;
  EXPECT_TRUE(refuses<InputError>([&] { validate({m}); }, {"fractureStress = 400", "must lie in [500, inf] Pa"}));
  std::vector<Material> materials(3, m);
  materials[2].yield_stress = 450;
  EXPECT_TRUE(
      refuses<InputError>([&] { validate(materials); }, {"fractureStress = 400 of element 2", "[450, inf] Pa"}));
  for (const double accepted : {400.0, 300.0, kInf}) {  // at the limit; below it; no yield, that is no growth
    materials[1].yield_stress = accepted;
    EXPECT_NO_THROW(validate(materials));
  }
}

TEST(Material, IsOneOrOnePerElement) {
  EXPECT_TRUE(refuses<InputError>(
      [] {
        Body(support::block({2, 2, 2}, 0.1), std::vector<Material>(3));
      },
      {"3 materials", "8 hexahedra"}));
  EXPECT_NO_THROW(Body(support::block({2, 2, 2}, 0.1), std::vector<Material>(8)));
}

TEST(Settings, RefuseValuesOutsideTheirRanges) {
  for (const double bad : {-1.0, kNan, kInf}) {
    Settings settings;
    settings.volume_restitution = bad;
    EXPECT_TRUE(refuses<InputError>([&] { validate(settings); }, {"volumeRestitution"}));
  }
  for (const double bad : {-0.1, 1.0, kNan}) {
    Settings settings;
    settings.inversion_threshold = bad;
    EXPECT_TRUE(refuses<InputError>([&] { validate(settings); }, {"inversionThreshold"}));
  }
}

TEST(CheckTimeStep, RefusesWhatIsUnstableAndAdvisesAgainstWhatIsInaccurate) {
  Material m;
  Settings settings;
  m.flow_rate = 4;
  m.rotation_flow_rate = 2;
  EXPECT_TRUE(check_time_step({m}, settings, 0.01).empty());
  EXPECT_EQ(check_time_step({m}, settings, 0.02).size(), 1u);  // nu dt = .08
  EXPECT_TRUE(refuses<InputError>([&] { check_time_step({m}, settings, 0.3); }, {"plasticFlowRate", "1.2"}));

  m.flow_rate = 0;
  m.rotation_flow_rate = 200;
  EXPECT_TRUE(refuses<InputError>([&] { check_time_step({m}, settings, 0.01); }, {"rotationFlowRate", "2"}));

  m.rotation_flow_rate = 0;
  settings.volume_restitution = 50;
  EXPECT_EQ(check_time_step({m}, settings, 0.01).size(), 1u);  // c dt = .5
  settings.volume_restitution = 100;
  EXPECT_TRUE(refuses<InputError>([&] { check_time_step({m}, settings, 0.01); }, {"volumeRestitution", "0.666667"}));
}

}  // namespace
}  // namespace hexaplast
