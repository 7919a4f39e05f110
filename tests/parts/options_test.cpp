// SPDX-License-Identifier: LGPL-2.1-or-later
// Parts by themselves: options of C++ with the defaults and ranges of the attribute table, and errors that name them.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "attributes/contact.hpp"
#include "attributes/parts.hpp"
#include "attributes/shapes.hpp"
#include "attributes/words.hpp"
#include "parts/grasp.hpp"
#include "parts/grids.hpp"
#include "parts/instrument.hpp"
#include "parts/multigrid_cg.hpp"
#include "parts/option.hpp"
#include "parts/probe.hpp"
#include "parts/tangential_load.hpp"
#include "parts/tissue_contact.hpp"
#include "support/refused.hpp"

namespace hexaplast::parts {
namespace {

using support::refused;

const PointArray kPoints = (PointArray(4, 3) << 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3).finished();

/// The numbers of an attribute's default.
std::vector<double> initial(const attributes::Description& table, std::string_view name) {
  std::istringstream text{std::string(attributes::attribute_of(table, name).initial)};
  std::vector<double> numbers;
  for (double number = 0; text >> number;) numbers.push_back(number);
  return numbers;
}
std::vector<double> numbers(double number) { return {number}; }
std::vector<double> numbers(const Vec3& v) { return {v.begin(), v.end()}; }
template <class T>
std::vector<double> numbers(const std::vector<T>& list) {
  return {list.begin(), list.end()};
}
template <class T>
std::vector<double> numbers(const std::optional<T>& option) {
  return option ? numbers(*option) : std::vector<double>();
}

bool is_initially(const attributes::Description& table, std::string_view name) {
  return attributes::attribute_of(table, name).initial == "true";
}

/// The place of the default among the words of an attribute.
template <class Word>
Word initial_word(const attributes::Description& table, std::string_view name) {
  const attributes::Attribute& attribute = attributes::attribute_of(table, name);
  const std::vector<std::string_view> words = attributes::split_words(attribute.words);
  return static_cast<Word>(std::ranges::find(words, attribute.initial) - words.begin());
}

/// What both kinds of contact have.
template <class Options>
void expect_defaults_of_contact(const attributes::Description& table) {
  EXPECT_EQ(numbers(Options().contact_stiffness), initial(table, "contactStiffness"));
  EXPECT_EQ(numbers(Options().tangential_stiffness), initial(table, "tangentialStiffness"));
  EXPECT_EQ(numbers(Options().friction), initial(table, "friction"));
  EXPECT_EQ(numbers(Options().contact_distance), initial(table, "contactDistance"));
  EXPECT_EQ(numbers(Options().damping), initial(table, "damping"));
  EXPECT_EQ(numbers(Options().max_subdivision), initial(table, "maxSubdivision"));
  EXPECT_EQ(Options().is_active, is_initially(table, "active"));
}

TangentialLoadOptions load() { return {.indices = {1, 2}, .times = {0, 1}, .forces = {0, 5}}; }
GraspOptions grasp() { return {.key_times = {0}, .positions = PointArray::Zero(1, 3), .radius = 0.5}; }

TEST(Options, HaveTheDefaultsOfTheTable) {
  const auto& tangential = attributes::kTangentialForceField;
  EXPECT_EQ(numbers(TangentialLoadOptions().group_size), initial(tangential, "groupSize"));
  EXPECT_EQ(numbers(TangentialLoadOptions().axis), initial(tangential, "axis"));
  EXPECT_EQ(numbers(TangentialLoadOptions().centre), initial(tangential, "centre"));
  const auto& instrument = attributes::kGraspForceField;
  EXPECT_EQ(numbers(GraspOptions().grasp_time), initial(instrument, "graspTime"));
  EXPECT_EQ(numbers(GraspOptions().release_time), initial(instrument, "releaseTime"));
  EXPECT_EQ(numbers(GraspOptions().radius), initial(instrument, "radius"));
  EXPECT_EQ(numbers(GraspOptions().stiffness), initial(instrument, "stiffness"));
  EXPECT_EQ(numbers(GraspOptions().max_force), initial(instrument, "maxForce"));
  EXPECT_EQ(numbers(GraspOptions().damping), initial(instrument, "damping"));
  const auto& tube = attributes::kTubeGridTopology;
  EXPECT_EQ(numbers(TubeGridOptions().cells), initial(tube, "cells"));
  EXPECT_EQ(numbers(TubeGridOptions().inner_radius), initial(tube, "innerRadius"));
  EXPECT_EQ(numbers(TubeGridOptions().outer_radius), initial(tube, "outerRadius"));
  EXPECT_EQ(numbers(TubeGridOptions().length), initial(tube, "length"));
  EXPECT_EQ(numbers(TubeGridOptions().bend), initial(tube, "bend"));
  const auto& sheet = attributes::kSheetGridTopology;
  EXPECT_EQ(numbers(SheetGridOptions().cells), initial(sheet, "cells"));
  EXPECT_EQ(numbers(SheetGridOptions().size), initial(sheet, "size"));
  EXPECT_EQ(numbers(SheetGridOptions().thickness), initial(sheet, "thickness"));
  EXPECT_EQ(numbers(SheetGridOptions().curvature), initial(sheet, "curvature"));
  const auto& patch = attributes::kSpherePatchGridTopology;
  EXPECT_EQ(numbers(SpherePatchGridOptions().cells), initial(patch, "cells"));
  EXPECT_EQ(numbers(SpherePatchGridOptions().inner_radius), initial(patch, "innerRadius"));
  EXPECT_EQ(numbers(SpherePatchGridOptions().outer_radius), initial(patch, "outerRadius"));
  EXPECT_EQ(numbers(SpherePatchGridOptions().angle), initial(patch, "angle"));
  const auto& solver = attributes::kMultigridCGLinearSolver;
  EXPECT_EQ(MultigridCGOptions().preconditioner,
            preconditioner_of(attributes::attribute_of(solver, "preconditioner").initial));
  EXPECT_EQ(numbers(MultigridCGOptions().tolerance), initial(solver, "tolerance"));
  EXPECT_EQ(numbers(MultigridCGOptions().iterations), initial(solver, "iterations"));
  const auto& contact = attributes::kInstrumentContactForceField;
  EXPECT_EQ(InstrumentOptions().shape, attributes::attribute_of(contact, "shape").initial);
  EXPECT_EQ(numbers(InstrumentOptions().radius), initial(contact, "radius"));
  EXPECT_EQ(numbers(InstrumentOptions().length), initial(contact, "length"));
  EXPECT_EQ(numbers(InstrumentOptions().size), initial(contact, "size"));
  EXPECT_EQ(numbers(InstrumentOptions().key_times), initial(contact, "keyTimes"));
  EXPECT_EQ(numbers(InstrumentOptions().orientations), initial(contact, "orientations"));
  expect_defaults_of_contact<InstrumentOptions>(contact);
  expect_defaults_of_contact<TissueContactOptions>(attributes::kTissueContactForceField);
  const auto& probe = attributes::kProbe;
  EXPECT_EQ(numbers(ProbeOptions().entries), initial(probe, "indices"));
  EXPECT_EQ(ProbeOptions().component, initial_word<ProbeOptions::Component>(probe, "component"));
  EXPECT_EQ(ProbeOptions().statistic, initial_word<ProbeOptions::Statistic>(probe, "statistic"));
  EXPECT_EQ(ProbeOptions().is_change, is_initially(probe, "change"));
}

TEST(Options, AreCalledInScenesAsTheTableCallsThem) {
  EXPECT_EQ(attribute_name("radius"), "radius");
  EXPECT_EQ(attribute_name("max_nb_iterations"), "maxNbIterations");
  EXPECT_EQ(attribute_name("keyTimes"), "keyTimes");
  const OptionError error("group_size", "0 must be >= 1");
  EXPECT_STREQ(error.what(), "group_size: 0 must be >= 1") << "in C++ the member";
  EXPECT_EQ(error.reasons().at(0).attribute, "groupSize");
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
  const auto tangential = [](auto change) {
    TangentialLoadOptions options = load();
    change(options);
    return refused([&] { TangentialLoad(options, 4); });
  };
  EXPECT_EQ(tangential([](auto&) {}), "nothing");
  EXPECT_EQ(tangential([](auto& o) { o.group_size = 0; }), "groupSize: 0 must lie in [1, 2147483646]");
  EXPECT_EQ(tangential([](auto& o) {
              o.group_size = 0;
              o.indices = {7};
              o.forces = {};
            }),
            "groupSize: 0 must lie in [1, 2147483646]; indices: 7 must lie in [0, 4); "
            "forces: 0 forces given for 2 times, must be as many");
  EXPECT_EQ(tangential([](auto& o) { o.group_size = 3; }), "indices: 2 nodes do not form groups of 3");
  EXPECT_EQ(tangential([](auto& o) { o.indices = {1, 4}; }), "indices: 4 must lie in [0, 4)");
  EXPECT_EQ(tangential([](auto& o) { o.indices = {-1, 2}; }), "indices: -1 must lie in [0, 4)");
  EXPECT_EQ(tangential([](auto& o) { o.axis.setZero(); }), "axis: is zero, must have a direction");
  EXPECT_EQ(tangential([](auto& o) { o.centre[1] = std::numeric_limits<double>::infinity(); }),
            "centre: inf is not finite");
  EXPECT_EQ(tangential([](auto& o) { o.times = {1, 1}; }), "times: 1 is followed by 1, must be ascending");
  EXPECT_EQ(tangential([](auto& o) { o.times = {}; }), "times: is empty, must hold at least one time");
  EXPECT_EQ(tangential([](auto& o) { o.forces = {1}; }), "forces: 1 forces given for 2 times, must be as many");

  const auto instrument = [](auto change) {
    GraspOptions options = grasp();
    change(options);
    return refused([&] { Grasp(options, 4); });
  };
  EXPECT_EQ(instrument([](auto&) {}), "nothing");
  EXPECT_EQ(instrument([](auto& o) { o.radius = {}; }), "radius: is not given");
  EXPECT_EQ(instrument([](auto& o) { o.radius = 0; }), "radius: 0 must be > 0");
  EXPECT_EQ(instrument([](auto& o) { o.max_force = -2; }), "maxForce: -2 must be > 0");
  EXPECT_EQ(instrument([](auto& o) { o.damping = std::numeric_limits<double>::quiet_NaN(); }),
            "damping: nan is not finite");
  EXPECT_EQ(instrument([](auto& o) { o.grasp_time = o.release_time.emplace(2); }),
            "releaseTime: is 2, must be after graspTime 2");
  EXPECT_EQ(instrument([](auto& o) { o.indices = {{0, 7}}; }), "indices: 7 must lie in [0, 4)");

  EXPECT_EQ(refused([] { make_grid(SheetGridOptions{.cells = {1, 2}}); }), "cells: 2 numbers given, must be three");
  EXPECT_EQ(refused([] { make_grid(SheetGridOptions{.size = {1}}); }), "size: 1 numbers given, must be two");
  EXPECT_EQ(refused([] { make_grid(TubeGridOptions{.cells = {0, 3, 1}}); }), "cells: 0 must lie in [1, 1000000]");
  EXPECT_EQ(refused([] { make_grid(SpherePatchGridOptions{.angle = 180}); }), "angle: 180 must lie in (0, 180)");
  EXPECT_THROW(make_grid(TubeGridOptions{.inner_radius = 2, .outer_radius = 1}), InputError) << "the core's own check";
  EXPECT_EQ(refused([] { MultigridCG({.tolerance = 0}); }), "tolerance: 0 must lie in (0, 1]");
  EXPECT_EQ(refused([] { preconditioner_of("Multigrid"); }),
            "preconditioner: 'Multigrid' must be auto, multigrid or diagonal (did you mean 'multigrid'?)");
}

TEST(Grasp, KeepsItsGripWhereOptionsChange) {
  Grasp tool(grasp(), 4);
  EXPECT_TRUE(tool.begin_step(0, kPoints).empty());
  ASSERT_EQ(tool.held_nodes().size(), 1u);
  PointArray x = kPoints;
  x.row(0) += Eigen::RowVector3d(0.01, 0, 0);
  EXPECT_DOUBLE_EQ(tool.energy(0, x), 1000 * 1e-4 / 2);
  GraspOptions stiffer = grasp();
  stiffer.stiffness = 3000;
  tool.set_options(stiffer);
  EXPECT_EQ(tool.held_nodes().size(), 1u);
  EXPECT_DOUBLE_EQ(tool.energy(0, x), 3000 * 1e-4 / 2);
  stiffer.stiffness = -1;
  EXPECT_THROW(tool.set_options(stiffer), OptionError);
  EXPECT_DOUBLE_EQ(tool.energy(0, x), 3000 * 1e-4 / 2) << "as before";
  tool.reset();
  EXPECT_FALSE(tool.is_closed());
}

TEST(Grasp, WarnsWhereItClosesOnNothing) {
  GraspOptions far = grasp();
  far.positions.row(0) << 9, 9, 9;
  const std::vector<Remark> warnings = Grasp(far, 4).begin_step(0, kPoints);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].attribute, "radius");
  EXPECT_EQ(warnings[0].text, "the grip closes on nothing: no node within 0.5 m of (9, 9, 9) at t = 0 s");
}

}  // namespace
}  // namespace hexaplast::parts
