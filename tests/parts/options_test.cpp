// SPDX-License-Identifier: LGPL-2.1-or-later
// Parts by themselves: options of C++ with the defaults and ranges of the attribute table, and errors that name them.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <type_traits>

#include "attributes/contact.hpp"
#include "attributes/parts.hpp"
#include "attributes/shapes.hpp"
#include "attributes/words.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "parts/attribute_change.hpp"
#include "parts/blade.hpp"
#include "parts/grasp.hpp"
#include "parts/grids.hpp"
#include "parts/instrument.hpp"
#include "parts/multigrid_cg.hpp"
#include "parts/option.hpp"
#include "parts/probe.hpp"
#include "parts/tangential_load.hpp"
#include "parts/tissue_contact.hpp"
#include "support/files.hpp"
#include "support/refused.hpp"
#include "support/shapes.hpp"

namespace hexaplast::parts {
namespace {

using namespace support;

const PointArray kPoints = (PointArray(4, 3) << 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3).finished();

/// A member as its attribute writes it.
std::string text_of(const attributes::Attribute& attribute, const auto& member) {
  using T = std::remove_cvref_t<decltype(member)>;
  if constexpr (std::is_enum_v<T>)
    return std::string(attributes::split_words(attribute.words).at(static_cast<std::size_t>(member)));
  else if constexpr (requires { member.has_value(); })
    return member ? text_of(attribute, *member) : "";
  else if constexpr (std::is_arithmetic_v<T>)
    return fmt::format("{}", member);
  else if constexpr (std::is_same_v<T, std::vector<Triangle>>)
    return std::string(member.size(), '?');
  else
    return fmt::format("{}", fmt::join(member.data(), member.data() + member.size(), " "));
}

/// Attributes of the table that are no options of the part: links, those of SOFA's base classes, and what a host does.
std::set<std::string_view> others_than(const auto& options, const attributes::Description& table) {
  std::set<std::string_view> others;
  for (const attributes::Attribute& attribute : table.attributes)
    if (attribute.access == attributes::Access::kInput && attribute.type != attributes::Type::kLink)
      others.insert(attribute.name);
  options.each(options, [&](std::string_view option, const auto& member) {
    const attributes::Attribute& attribute = attributes::attribute_of(table, attribute_name(option));
    EXPECT_EQ(text_of(attribute, member), attribute.initial) << table.class_name << "." << option;
    EXPECT_EQ(others.erase(attribute.name), 1u) << table.class_name << "." << option << " is visited once";
  });
  return others;
}

TangentialLoadOptions load() { return {.indices = {1, 2}, .times = {0, 1}, .forces = {0, 5}}; }
GraspOptions grasp() { return {.key_times = {0}, .positions = PointArray::Zero(1, 3), .radius = 0.5}; }

TEST(Options, AreThoseOfTheTableAndHaveItsDefaults) {
  using Names = std::set<std::string_view>;
  EXPECT_EQ(others_than(TangentialLoadOptions(), attributes::kTangentialForceField), Names());
  EXPECT_EQ(others_than(GraspOptions(), attributes::kGraspForceField), Names{"rayleighStiffness"});
  EXPECT_EQ(others_than(TubeGridOptions(), attributes::kTubeGridTopology), Names());
  EXPECT_EQ(others_than(SheetGridOptions(), attributes::kSheetGridTopology), Names());
  EXPECT_EQ(others_than(SpherePatchGridOptions(), attributes::kSpherePatchGridTopology), Names());
  EXPECT_EQ(others_than(MultigridCGOptions(), attributes::kMultigridCGLinearSolver), Names());
  EXPECT_EQ(others_than(InstrumentOptions(), attributes::kInstrumentContactForceField), Names());
  EXPECT_EQ(others_than(BladeOptions(), attributes::kBladeController), Names());
  EXPECT_EQ(others_than(ContactOptions(), attributes::kTissueContactForceField), Names());
  EXPECT_EQ(others_than(ProbeOptions(), attributes::kProbe), (Names{"value", "points"}));
}

template <class Part>
void expect_outputs_of_the_table() {
  std::multiset<std::string_view> visited, expected;
  Part::outputs([&](std::string_view name, const auto&) { visited.insert(name); });
  for (const attributes::Attribute& attribute : Part::description().attributes)
    if (attribute.access == attributes::Access::kOutput) expected.insert(attribute.name);
  EXPECT_EQ(visited, expected) << Part::description().class_name;
}

TEST(Forces, ShowEachOutputOfTheTable) {
  expect_outputs_of_the_table<TangentialLoad>();
  expect_outputs_of_the_table<Grasp>();
  expect_outputs_of_the_table<Instrument>();
  expect_outputs_of_the_table<Tissues>();
}

TEST(Options, ThatAreWrongAreNamedTogetherAndEachOnce) {
  OptionErrors errors;
  EXPECT_NO_THROW(errors.throw_all());
  errors.add({"group_size", "0 must be >= 1"});
  errors.collect([] { throw OptionError("groupSize", "again"); });
  errors.collect([] { throw OptionError("axis", "is zero"); });
  EXPECT_FALSE(errors.accepts("group_size"));
  EXPECT_TRUE(errors.accepts("centre"));
  EXPECT_EQ(refused([&] { errors.throw_all(); }), "groupSize: 0 must be >= 1; axis: is zero");
  EXPECT_THROW(errors.collect([] { throw InputError("of something else"); }), InputError);
  try {
    errors.throw_all();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "group_size: 0 must be >= 1\naxis: is zero");
  }
}

TEST(Options, OutsideTheRangesOfTheTableAreRefused) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto tangential = [](auto change) {
    TangentialLoadOptions options = load();
    change(options);
    return refused([&] { TangentialLoad(options, {.num_nodes = {4, 4}}); });
  };
  EXPECT_EQ(tangential([](auto&) {}), "nothing");
  EXPECT_EQ(tangential([](auto& o) {
              o.group_size = 0;
              o.indices = {7};
              o.forces = {};
            }),
            "groupSize: 0 must lie in [1, 2147483646]; indices: 7 must lie in [0, 4); "
            "forces: 0 forces given for 2 times, must be as many");
  EXPECT_EQ(tangential([](auto& o) { o.group_size = 3; }), "indices: 2 nodes do not form groups of 3");
  EXPECT_EQ(tangential([](auto& o) { o.centre[1] = kInfinity; }), "centre: inf is not finite");

  const auto grip = [](auto change) {
    GraspOptions options = grasp();
    change(options);
    return refused([&] { Grasp(options, {.num_nodes = {4, 4}}); });
  };
  EXPECT_EQ(grip([](auto&) {}), "nothing");
  EXPECT_EQ(grip([](auto& o) { o.radius = {}; }), "radius: is not given");
  EXPECT_EQ(grip([](auto& o) { o.damping = std::nan(""); }), "damping: nan is not finite");
  EXPECT_EQ(grip([](auto& o) { o.grasp_time = o.release_time.emplace(2); }),
            "releaseTime: is 2, must be after graspTime 2");

  const auto instrument = [](const InstrumentOptions& options) {
    return refused([&] { OptionRanges(attributes::kInstrumentContactForceField, options).throw_all(); });
  };
  EXPECT_EQ(instrument({.positions = PointArray::Constant(1, 3, kInfinity)}), "positions: inf is not finite");
  EXPECT_EQ(instrument({.contact = {.friction = -1, .max_subdivision = 65}}),
            "friction: -1 must be >= 0; maxSubdivision: 65 must lie in [1, 64]");

  EXPECT_EQ(refused([] { make_grid(SheetGridOptions{.cells = {1, 2}}); }), "cells: 2 numbers given, must be three");
  EXPECT_EQ(refused([] { make_grid(SheetGridOptions{.size = {1}}); }), "size: 1 numbers given, must be two");
  EXPECT_EQ(refused([] { make_grid(TubeGridOptions{.cells = {0, 3, 1}}); }), "cells: 0 must lie in [1, 1000000]");
  EXPECT_THROW(make_grid(TubeGridOptions{.inner_radius = 2, .outer_radius = 1}), InputError) << "the core's own check";
  EXPECT_EQ(refused([] { MultigridCG({.tolerance = 0}); }), "tolerance: 0 must lie in (0, 1]");
  const auto& words = attributes::attribute_of(attributes::kMultigridCGLinearSolver, "preconditioner");
  EXPECT_EQ(static_cast<Preconditioner>(place_of_word(words, "diagonal")), Preconditioner::kDiagonal);
  EXPECT_EQ(refused([&] { place_of_word(words, "Multigrid"); }),
            "preconditioner: 'Multigrid' must be auto, multigrid or diagonal (did you mean 'multigrid'?)");
}

TEST(Probe, RefusesEntriesThatAreNotThere) {
  const std::vector<double> values = {1, 2};
  const auto refusal = [&](const std::vector<int>& indices) {
    return refused([&] { Probe({.indices = indices}, 1).read(values); });
  };
  EXPECT_EQ(refusal({2}), "indices: holds 2, must lie in [0, 2)");
  EXPECT_EQ(refusal({-1}), "indices: holds -1, must lie in [0, 2)");
  EXPECT_EQ(refusal({}), "indices: holds none, must hold at least one of the entries");
  EXPECT_EQ(refused([&] { Probe({}, 3).read(std::vector<double>(7)); }),
            "value: holds 7 numbers, must be 3 for each entry");
}

TEST(Grasp, KeepsItsGripWhereOptionsChange) {
  Grasp tool(grasp(), {.num_nodes = {4, 4}});
  tool.begin_step({.time = 0}, kPoints, kPoints);
  EXPECT_TRUE(tool.take_warnings().empty());
  ASSERT_EQ(tool.held_nodes().size(), 1u);
  PointArray x = kPoints;
  x.row(0) += Eigen::RowVector3d(0.01, 0, 0);
  EXPECT_DOUBLE_EQ(*tool.potential_energy(0, x), 1000 * 1e-4 / 2);
  GraspOptions stiffer = grasp();
  stiffer.stiffness = 3000;
  tool.set_options(stiffer);
  EXPECT_EQ(tool.held_nodes().size(), 1u);
  EXPECT_DOUBLE_EQ(*tool.potential_energy(0, x), 3000 * 1e-4 / 2);
  stiffer.stiffness = -1;
  EXPECT_THROW(tool.set_options(stiffer), OptionError);
  EXPECT_DOUBLE_EQ(*tool.potential_energy(0, x), 3000 * 1e-4 / 2) << "as before";
  tool.reset();
  EXPECT_FALSE(tool.is_closed());
}

// They may be millions, of which one that is far away or not active needs none.
TEST(Instrument, HasSamplesFromWhenItFirstComesNear) {
  const Body body(regular_grid({2, 2, 2}, {0, 0, 0}, {1, 1, 1}), {Material()}, Settings());
  const PointArray& x = body.mesh().positions();
  const PointArray v = PointArray::Zero(x.rows(), 3);
  InstrumentOptions options{.radius = 0.2, .key_times = {0, 1, 2}, .positions = PointArray(3, 3)};
  options.positions << 0.5, 0.5, 9, 0.5, 0.5, 9, 0.5, 0.5, 1.1;
  for (const bool is_active : {false, true}) {
    options.contact.active = is_active;
    Instrument tool(options, {.bodies = {&body, &body}});
    const auto num_samples = [&] { return tool.contact().samples().samples.size(); };
    tool.look_at_start(0, x);
    tool.begin_step({.time = 0, .dt = 0.1}, x, v);
    EXPECT_EQ(num_samples(), 0U);
    tool.begin_step({.time = 1.9, .dt = 0.1}, x, v);
    EXPECT_EQ(num_samples() > 0, is_active);
    EXPECT_EQ(tool.contact().num_touching() > 0, is_active);
  }
}

// SOFA reads " false" as no value of a bool.
TEST(AttributeChange, HasValuesWithoutBlanksAroundThem) {
  using Values = std::vector<std::optional<std::string_view>>;
  EXPECT_EQ(values_of_changes(" true; false ;; 1 2\n"), (Values{"true", "false", std::nullopt, "1 2"}));
  EXPECT_EQ(values_of_changes(""), Values{std::nullopt});
}

constexpr double kStep = 0.1;  // [s]

PointArray points(const std::vector<Vec3>& rows) {
  PointArray points(rows.size(), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) points.row(k) = rows[k].transpose();
  return points;
}

/// Four layers of hexahedra of 1 m.
class BladePart : public testing::Test {
 protected:
  /// The joints that open in steps from a time on, the blade being the only one.
  std::set<int> opened(Blade& blade, double time, int num_steps) {
    std::set<int> all;
    for (int step = 0; step < num_steps; ++step, time += kStep) {
      blade.begin_step({.time = time, .dt = kStep, .rayleigh_stiffness = 0}, body.mesh().positions());
      const std::vector<int> joints = blade.end_step(body.mesh().positions());
      body.open(joints);
      all.insert(joints.begin(), joints.end());
    }
    return all;
  }

  /// Joints between hexahedra below and above the plane z = 2.
  std::set<int> between_layers() const {
    std::set<int> joints;
    for (int joint = 0; joint < body.joints().count(); ++joint)
      if (body.joints().hexahedra(joint)[0] < 32 && body.joints().hexahedra(joint)[1] >= 32) joints.insert(joint);
    return joints;
  }

  Body body{block({4, 4, 4}, 1), {{.young_modulus = 5000}}};
  const PointArray edge = points({{0, -1, 0}, {0, 2, 0}, {0, 5, 0}});
};

TEST_F(BladePart, CutsWherePathLeadsIt) {
  Blade blade({.points = edge, .key_times = {0.25, 1.25}, .positions = points({{-1, 0, 2.1}, {5, 0, 2.1}})}, body);
  EXPECT_EQ(opened(blade, 0, 3).size(), 0u) << "0.3 m after the first key time it is 0.7 m away from the first centres";
  EXPECT_EQ(opened(blade, 0.3, 12), between_layers());
  EXPECT_EQ(connected_parts(body.mesh(), body.alive()).count, 2);
  EXPECT_TRUE(opened(blade, 0, 12).empty()) << "what is open is passed over";
  body.reset();
  EXPECT_EQ(opened(blade, 0, 15), between_layers());
}

// It leaves a corner of its path out unless it stops there within the step.
TEST_F(BladePart, PassesItsKeyTimesWithinAStep) {
  Blade blade(
      {.points = edge, .key_times = {0, 0.05, 0.1}, .positions = points({{-1, 0, 2.1}, {5, 0, 2.1}, {-1, 0, 2.1}})},
      body);
  EXPECT_EQ(opened(blade, 0, 1), between_layers());
}

// Half a turn about the axis x = z = 2 in one step: from far left to far right, through the lower half alone.
TEST_F(BladePart, TurnsOnAnArc) {
  const double half = std::sqrt(0.5);
  Blade blade({.points = points({{0, -3, -1.4}, {0, 3, -1.4}}),
               .key_times = {0, kStep},
               .positions = points({{2, 2, 2}, {2, 2, 2}}),
               .orientations = {0, half, 0, half, 0, -half, 0, half}},
              body);
  std::set<int> expected;
  for (int joint = 0; joint < body.joints().count(); ++joint) {
    const auto is_inside = [&](int hexahedron) {
      const Vec3 centre = gather(body.mesh().positions(), body.mesh().hexahedra()[hexahedron]).colwise().mean();
      return std::hypot(centre[0] - 2, centre[2] - 2) < 1.4;
    };
    const int first = body.joints().hexahedra(joint)[0], second = body.joints().hexahedra(joint)[1];
    if (is_inside(first) != is_inside(second) && first < 32 && second < 32) expected.insert(joint);
  }
  EXPECT_EQ(expected.size(), 16u);
  EXPECT_EQ(opened(blade, 0, 1), expected);
}

TEST_F(BladePart, NamesTheOptionsThatItRefuses) {
  EXPECT_EQ(refused([&] { Blade({}, body); }),
            "points: 0 given, must be at least two; keyTimes: is empty, must hold at least one time");
  EXPECT_EQ(
      refused([&] {
        Blade(
            {.points = edge.topRows(1), .key_times = {0, 1}, .positions = PointArray::Zero(1, 3), .orientations = {1}},
            body);
      }),
      "points: 1 given, must be at least two; positions: 1 positions given for 2 times, must be as many; "
      "orientations: 1 numbers given, must be a quaternion (4) for each of 2 key times");
}

}  // namespace
}  // namespace hexaplast::parts
