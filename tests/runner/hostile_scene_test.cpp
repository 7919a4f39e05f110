// SPDX-License-Identifier: LGPL-2.1-or-later
// Scene files made to hurt: refused with a message, at once, in little memory, and never by a crash.
#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "hexaplast/material/material.hpp"
#include "support/cost.hpp"

namespace {

using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Cost;
using hexaplast::support::cost_of;
using hexaplast::support::kMegabytesMore;
using hexaplast::support::kSlower;

class HostileScene : public Command {
 protected:
  Cost run(const std::string& scene) { return cost_of({"run", directory_ / scene, "--steps=1"}, directory_ / "err"); }

  /// `text` is refused with `message` within 50 ms, or four times what this machine takes to start the command, in
  /// 20 MB and twice the file's own size.
  void expect_refused(const std::string& text, const std::string& message) {
    write("hostile.scn", text);
    Cost cost = run("hostile.scn");
    const std::string shown = content(directory_ / "err");
    double limit = 0.05 * kSlower;
    // a shared machine: the quickest of a few runs counts, beside the quickest of as many starts
    double start = 1e9;
    for (int again = 0; again < 20 && cost.seconds >= limit; ++again) {
      cost.seconds = std::min(cost.seconds, run("hostile.scn").seconds);
      start = std::min(start, cost_of({"--version"}, directory_ / "no_err").seconds);
      if (again >= 4) limit = std::max(limit, 4 * start);
    }
    EXPECT_EQ(cost.code, 3) << shown;
    EXPECT_NE(shown.find(message), std::string::npos) << shown;
    EXPECT_LT(cost.seconds, limit) << message;
    EXPECT_LT(cost.megabytes, 20 + kMegabytesMore + 2e-6 * static_cast<double>(text.size())) << message;
  }
};

/// A body as the scene file has it and as the guard sees it.
struct BodyKind {
  const char* name;
  std::string attributes;
  hexaplast::Material material;
  hexaplast::Settings settings;
};

std::vector<BodyKind> body_kinds() {
  const hexaplast::Material elastic, flows{.yield_stress = 1, .flow_rate = 1};
  hexaplast::Material tears = flows;
  tears.fracture_stretch = 100;
  const hexaplast::Settings in_double, mixed{.precision = hexaplast::Precision::kMixed};
  const std::string flowing = "yieldStress='1e-9' plasticFlowRate='2' rotationFlowRate='1' ";
  const std::string tearing = flowing + "fractureStretch='100' ", in_mixed = "precision='mixed'";
  return {{"ElasticDouble", "", elastic, in_double},    {"ElasticMixed", in_mixed, elastic, mixed},
          {"FlowingDouble", flowing, flows, in_double}, {"FlowingMixed", flowing + in_mixed, flows, mixed},
          {"TearingDouble", tearing, tears, in_double}, {"TearingMixed", tearing + in_mixed, tears, mixed}};
}

void PrintTo(const BodyKind& kind, std::ostream* out) { *out << kind.name; }

/// What a run of a grid takes at most, with all that it writes and a step after the first.
class BodyMemory : public Command, public testing::WithParamInterface<BodyKind> {
 protected:
  double megabytes(int cells) {
    const std::string nodes = std::to_string(cells + 1);
    write("body.scn",
          "<Node dt='0.01' gravity='0 0 -5'><EulerImplicitSolver/><MultigridCGLinearSolver/>"
          "<RegularGridTopology n='" +
              nodes + " " + nodes + " " + nodes +
              "'/><MechanicalObject/>"
              "<DiagonalMass massDensity='1000'/><BoxROI name='foot' box='-1 -1 -.001 2 2 .001'/>"
              "<FixedProjectiveConstraint indices='@foot.indices'/><HexahedronElastoplasticFEMForceField " +
              GetParam().attributes + "/></Node>");
    const Cost cost = cost_of({"run", directory_ / "body.scn", "--steps=3", "--out", directory_ / "run", "--force"},
                              directory_ / "err");
    EXPECT_EQ(cost.code, 0) << content(directory_ / "err");
    return cost.megabytes;
  }
};

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST_F(HostileScene, DocumentTypesAndEntities) {
  expect_refused("<!DOCTYPE x SYSTEM 'file:///etc/passwd'>\n<Node/>", "hostile.scn:1: error: document types");
  expect_refused("\n<!DOCTYPE x [<!ENTITY a 'ha'><!ENTITY b '&a;&a;&a;&a;'>]><Node/>", ":2: error: document types");
  expect_refused("<Node>\n<BoxROI name='&lol;'/></Node>", ":2: error: unknown entity");
}

TEST_F(HostileScene, NestingAndSize) {
  expect_refused(repeated("<Node>", 1'000'000), ":1: error: more than 98 levels of elements");
  expect_refused("<Node>" + repeated("<BoxROI/>", 100'000) + "</Node>", ":1: error: more than 10000 elements");
  std::string attributes;
  for (int i = 0; i < 100'000; ++i) attributes += " a" + std::to_string(i) + "=''";
  expect_refused("<Node" + attributes + "/>", ":1: error: an element has more than 1000 attributes");
  expect_refused("<Node>" + repeated("\n<Nonsense/>", 9'000) + "</Node>", "at least 80 further errors are not shown");
}

TEST_F(HostileScene, WhatIsNoText) {
  expect_refused(std::string("<Node>\n\n\0</Node>", 16), ":3: error: the file contains a NUL byte");
  expect_refused("<Node>\n\xFF</Node>", ":2: error: the file is not valid UTF-8");
  expect_refused("<Node/>\n<Node/>", ":2: error: content outside the root element");
  expect_refused("<Node>\n<Node dt='1' dt='2'/></Node>", ":2: error: Node.dt: is given twice");
}

TEST_F(HostileScene, IncludesOfThemselvesAndOfTooMany) {
  expect_refused("<Node>\n<include href='hostile.scn'/></Node>",
                 ":2: error: include.href: 'hostile.scn' includes itself");
  write("other.xml", "<Node><include href='hostile.scn'/></Node>");
  expect_refused("<Node>\n<include href='other.xml'/></Node>",
                 "other.xml:1: error: include.href: 'hostile.scn' includes itself");
  for (int i = 1; i <= 16; ++i)
    write("level" + std::to_string(i), "<Node><include href='level" + std::to_string(i + 1) + "'/></Node>");
  write("level17", "<Node/>");
  expect_refused("<Node><include href='level1'/></Node>", "more than 16 levels of includes");
}

TEST_F(HostileScene, LinksInCirclesAndChains) {
  expect_refused("<Node>\n<BoxROI name='a' box='@b.box'/><BoxROI name='b' box='@a.box'/></Node>",
                 ":2: error: BoxROI.box: link '@b.box' leads back to itself");
  std::string chain = "<BoxROI name='r0' position='0 0 0'/>";
  for (int i = 1; i < 5'000; ++i)
    chain =
        "<BoxROI name='r" + std::to_string(i) + "' position='@r" + std::to_string(i - 1) + ".pointsInROI'/>" + chain;
  write("hostile.scn", "<Node>" + chain + "</Node>");
  const Cost cost = run("hostile.scn");
  EXPECT_EQ(cost.code, 3);
  EXPECT_NE(content(directory_ / "err").find("more than 100 components follow one another"), std::string::npos);
  EXPECT_LT(cost.seconds, 2 * kSlower);
}

TEST_F(HostileScene, NumbersThatWouldBeAllocated) {
  expect_refused("<Node>\n<RegularGridTopology n='100000 100000 100000'/></Node>",
                 ":2: error: RegularGridTopology.n: 1e+15 cells");
  for (const char* index : {"-1", "2147483648", "9223372036854775808"})
    expect_refused("<Node>\n<FixedProjectiveConstraint indices='" + std::string(index) + "'/></Node>",
                   ":2: error: FixedProjectiveConstraint.indices: ");
  expect_refused("<Node>\n<FixedProjectiveConstraint indices='0-2147483646'/></Node>", "stands for more than");
}

// What keeps a body that the machine cannot hold from being begun must not count less than it takes. Of a small body
// pictures of its surface take more.
TEST_P(BodyMemory, IsWhatTheGuardCounts) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "sanitizers hold memory of their own";
#endif
  const int few = 20, many = 32;
  const double hexahedra = many * many * many - few * few * few;
  const double counted = hexaplast::bytes_per_hexahedron({GetParam().material}, GetParam().settings);
  const double taken = 1e6 * (megabytes(many) - megabytes(few)) / hexahedra;
  EXPECT_LT(taken, 1.05 * counted);  // pages of the allocator come and go
  EXPECT_GT(taken, 0.6 * counted);
}

INSTANTIATE_TEST_SUITE_P(Kinds, BodyMemory, testing::ValuesIn(body_kinds()),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
