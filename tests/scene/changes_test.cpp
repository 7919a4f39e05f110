// SPDX-License-Identifier: LGPL-2.1-or-later
// Every attribute that may change during a run, taken from the attribute table: it acts in the step that begins at its
// time, whoever changes it, nothing else moves, reset undoes it, and a run that is taken up goes on with it.
#include <optional>

#include "attributes/texts.hpp"
#include "hexaplast/base/error.hpp"
#include "support/example_scene.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;
using attributes::Access;
using attributes::Attribute;
using attributes::Description;
using attributes::Type;
using scene::Value;

constexpr int kChangesAt = 3, kSteps = 8;  // the step that the change begins with, of all

/// An attribute of each type of numbers, and of text, for others to follow.
constexpr Attribute kSourceAttributes[] = {
    {.name = "switch", .type = Type::kBool},       {.name = "number", .type = Type::kInteger},
    {.name = "real", .type = Type::kReal},         {.name = "text", .type = Type::kText},
    {.name = "integers", .type = Type::kIntegers}, {.name = "hexahedra", .type = Type::kHexahedra},
    {.name = "reals", .type = Type::kReals},       {.name = "boxes", .type = Type::kBoxes},
    {.name = "vector", .type = Type::kVector3},    {.name = "vectors", .type = Type::kVectors3},
};
constexpr Description kSource{
    .class_name = "Source", .category = "Test", .help = "Is followed.", .attributes = kSourceAttributes};

class Source final : public scene::Component, public scene::Changeable {
 public:
  Source() : Component(kSource) {}
  void refresh(std::span<const std::string_view>) override {}
};

std::string_view source_of(Type type) {
  const auto found = std::ranges::find(kSourceAttributes, type, &Attribute::type);
  return found == std::end(kSourceAttributes) ? "text" : found->name;
}

/// Values that say more than what follows from the present one by itself.
const std::map<std::string, std::string_view> kOtherValues = {
    {"BladeController.orientations", "0.3 0 0 1  0.3 0 0 1"},
    {"BladeController.points", "0 -0.02 0  0 0.05 0"},
    {"FixedProjectiveConstraint.indices", "0-7 40"},
    {"HexahedronElastoplasticFEMForceField.fractureStress", "12"},
    {"HexahedronElastoplasticFEMForceField.fractureStretch", "1.0001"},
    {"InstrumentContactForceField.contactDistance", "0.01"},
    {"InstrumentContactForceField.orientations", "0 0 0 1  0.7 0 0 0.7"},
    {"InstrumentContactForceField.surfaceTriangles", "2 1 0  0 1 3  1 2 3  0 3 2"},
    {"MaterialRegion.fractureStress", "12"},
    {"MaterialRegion.fractureStretch", "1.0001"},
    {"PartialFixedProjectiveConstraint.fixedDirections", "0 0 1"},
    {"PartialLinearMovementProjectiveConstraint.movedDirections", "0 1 1"},
    {"SpringForceField.spring", "72 60 30 0.1 0.1"},
    {"SurfacePressureForceField.max", "0.06 0.11 0.41"},
    {"TissueContactForceField.contactDistance", "0.01"},
};

/// Scenes in which more of what a component has acts within a few steps than in its example.
constexpr attributes::Example kMoreScenes[] = {
    {"AttachProjectiveConstraint", R"xml(<Node name="weight">
  <MechanicalObject name="points" position="0.1 0.1 0.4  0 0.1 0.4"/>
  <UniformMass totalMass="0.02"/>
</Node>
<AttachProjectiveConstraint object1="@nodes" object2="@weight/points" indices1="80 78" indices2="0 1"/>)xml"},
    {"BladeController", R"xml(<BladeController name="scalpel" points="0 -0.02 0  0 0.12 0" keyTimes="0 0.1"
    positions="0.05 0 0.31  0.12 0 0.31" orientations="0 0 0 1  0 0 0 1"/>)xml"},
    {"GraspForceField", R"xml(<GraspForceField name="forceps" radius="0.06" graspTime="0.04" releaseTime="0.07"
    keyTimes="0.02 0.06 0.08" positions="0.05 0.05 0.4  0.05 0.1 0.45  0.08 0.1 0.45" stiffness="500" damping="1"
    rayleighStiffness="0.01" maxForce="5"/>)xml"},
    {"HexahedronElastoplasticFEMForceField",
     R"xml(<HexahedronElastoplasticFEMForceField name="material" youngModulus="5e4" poissonRatio="0.45" yieldStress="10"
    plasticFlowRate="20" hardening="0.5" restShape="joined" rotationYield="0.0001" rotationFlowRate="5"
    fractureStress="900"/>
<ConstantForceField indices="72-80" totalForce="5 0 5"/>)xml"},
    {"InstrumentContactForceField",
     R"xml(<InstrumentContactForceField name="probe" shape="capsule" radius="0.02" length="0.1" friction="0.2"
    tangentialStiffness="2e6" contactStiffness="3e6" damping="100" keyTimes="0 0.1"
    positions="0.05 0.05 0.41  0.07 0.06 0.40"/>)xml"},
    {"InstrumentContactForceField",
     R"xml(<InstrumentContactForceField name="probe" shape="box" size="0.05 0.05 0.05" keyTimes="0 0.1"
    positions="0.05 0.05 0.42  0.07 0.06 0.40" orientations="0 0 0 1  0 0 0 1"/>)xml"},
    {"InstrumentContactForceField",
     R"xml(<InstrumentContactForceField name="probe" shape="surface" keyTimes="0 0.1"
    positions="0.05 0.05 0.42  0.07 0.06 0.40"
    surfacePositions="0 0 -0.03  0.03 0 0.03  -0.03 0.03 0.03  -0.03 -0.03 0.03"
    surfaceTriangles="0 2 1  0 1 3  1 2 3  0 3 2"/>)xml"},
    {"MaterialRegion",
     R"xml(<HexahedronElastoplasticFEMForceField name="material" youngModulus="5e4" poissonRatio="0.4" restShape="joined"/>
<ConstantForceField indices="72-80" totalForce="5 0 5"/>
<SphereROI name="tumour" centers="0.05 0.05 0.2" radii="0.2" strict="false"/>
<MaterialRegion name="hard" hexahedra="@tumour.hexahedraInROI" youngModulus="3e5" yieldStress="10"
    plasticFlowRate="20" hardening="0.5" rotationYield="0.0001" rotationFlowRate="5" fractureStress="900"/>)xml"},
    {"PlaneForceField", R"xml(<PlaneForceField normal="0.28 0 -0.96" d="-0.366" stiffness="100" damping="2" maxForce="1"
    rayleighStiffness="0.1"/>)xml"},
    {"SpringForceField", R"xml(<SpringForceField indices1="72 80" indices2="60 70" stiffness="20 30" damping="0.1 0.2"
    lengths="0.2 0.01" rayleighStiffness="0.1"/>)xml"},
    {"TissueContactForceField", R"xml(<Node name="other">
  <RegularGridTopology name="grid" n="3 3 3" min="0.02 0.02 0.395" max="0.08 0.08 0.5"/>
  <MechanicalObject name="nodes"/>
  <DiagonalMass massDensity="9000"/>
  <HexahedronElastoplasticFEMForceField name="block" youngModulus="5e4" poissonRatio="0.4"/>
  <ConstantForceField totalForce="3 0 0"/>
</Node>
<TissueContactForceField object1="@nodes" object2="@other/nodes" friction="0.2" damping="100" contactStiffness="3e6"
    tangentialStiffness="2e6"/>)xml"},
};

/// Names of attributes with those of their classes.
std::set<std::string> names(std::initializer_list<std::pair<std::string, std::string_view>> rows) {
  std::set<std::string> all;
  for (const auto& [class_name, attributes] : rows)
    for (const std::string_view name : scene::split_words(attributes)) all.insert(class_name + "." + std::string(name));
  return all;
}
constexpr std::string_view kPlastic =
    "fractureStress fractureStretch hardening plasticFlowRate rotationFlowRate rotationYield yieldStress";
/// What acts later than in its step: a forceps that is open yet, and plastic flow, which ends a step.
const std::set<std::string> kLate =
    names({{"GraspForceField",
            "damping graspTime indices keyTimes maxForce positions radius rayleighStiffness releaseTime stiffness"},
           {"HexahedronElastoplasticFEMForceField", kPlastic},
           {"MaterialRegion", kPlastic}});
/// What has no effect in these scenes.
const std::set<std::string> kIdle =
    names({{"HexahedronElastoplasticFEMForceField", "fractureEnergy"}, {"MaterialRegion", "fractureEnergy"}});
/// What cannot have another value by itself: lists that are as long as others, or excluded by them.
const std::set<std::string> kRefused = names({{"AttachProjectiveConstraint", "indices2"},
                                              {"InstrumentContactForceField", "embeddedPositions embeddedTriangles"},
                                              {"MaterialRegion", "indices"},
                                              {"RestShapeSpringsForceField", "external_points"},
                                              {"SpringForceField", "indices1 indices2"}});

/// Other values than the present one, the likely ones first.
std::vector<Value> others(const Attribute& attribute, const Value& present, const std::string& name) {
  if (const auto known = kOtherValues.find(name); known != kOtherValues.end())
    return {scene::read_value(attribute, known->second)};
  std::vector<Value> values;
  const auto scaled = [&](double factor) {
    std::vector<double> numbers = std::get<std::vector<double>>(present);
    for (double& number : numbers) number = number == 0 ? 0.01 * (factor - 1) : factor * number;
    return numbers;
  };
  if (const auto* flag = std::get_if<bool>(&present)) values = {!*flag};
  if (const auto* whole = std::get_if<std::int64_t>(&present)) values = {*whole + 1, *whole - 1};
  if (const auto* real = std::get_if<double>(&present)) values = {1.2 * *real, 0.8 * *real, 0.2, 0.0};
  if (const auto* numbers = std::get_if<std::vector<double>>(&present)) {
    if (numbers->empty())
      values = {std::vector<double>{0.2}, std::vector<double>{0, 0, 0.2}, std::vector<double>(6, 0.2)};
    else
      values = {scaled(1.2), scaled(0.8)};
  }
  if (const auto* numbers = std::get_if<std::vector<std::int64_t>>(&present)) {
    std::vector<std::int64_t> fewer = *numbers;
    const std::size_t group = attribute.type == Type::kHexahedra ? 8 : 1;
    if (fewer.size() >= group) fewer.resize(fewer.size() - group);
    values = {fewer, std::vector<std::int64_t>{40}, std::vector<std::int64_t>{1, 1, 0}, std::vector<std::int64_t>{0}};
  }
  if (attribute.type == Type::kWord)
    for (const std::string_view word : scene::split_words(attribute.words)) values.emplace_back(std::string(word));
  if (std::holds_alternative<std::monostate>(present)) {
    if (attribute.type == Type::kReal) values = {0.3, 30.0, 3e4};
    if (attribute.type == Type::kInteger) values = {std::int64_t{1}};
    if (attribute.type == Type::kVector3) values = {std::vector<double>{0, 0.1, 0.2}};
  }
  std::erase_if(values, [&](const Value& value) {
    if (value == present) return true;
    try {
      scene::check_value(attribute, value);
      return false;
    } catch (const InputError&) {
      return true;
    }
  });
  return values;
}

using NumberList = std::vector<double>;
using Motion = std::vector<std::vector<NumberList>>;  // positions of all states, after each step

std::vector<NumberList> positions(scene::Scene& scene) {
  std::vector<NumberList> all;
  for (scene::MechanicalState* state : scene.root().all<scene::MechanicalState>()) {
    const PointArray& x = state->positions();  // of as many rows as there are nodes at present
    all.emplace_back(x.data(), x.data() + x.size());
  }
  return all;
}

Motion motion(scene::Scene& scene, int steps) {
  Motion all;
  for (int k = 0; k < steps; ++k) {
    scene.step();
    all.push_back(positions(scene));
  }
  return all;
}

/// The steps from one on.
Motion tail(const Motion& motion, int from) { return {motion.begin() + from, motion.end()}; }

/// A scene around one component, the first of its class.
class Example {
 public:
  Example(const Description& description, std::string text) : description_(description), text_(std::move(text)) {
    scene::Scene scene = read_and_init(text_);
    const scene::Component& own = component(scene);
    const std::string folder = own.node().path();
    path_ = folder + (folder == "/" ? "" : "/") + own.name();
    unchanged_ = motion(scene, kSteps);
  }

  const std::string& text() const { return text_; }
  const std::string& path() const { return path_; }
  const Motion& unchanged() const { return unchanged_; }

  /// With lines at the head of the scene.
  std::string with(const std::string& lines) const {
    const std::string loop = "<DefaultAnimationLoop/>";
    return std::string(text_).insert(text_.find(loop) + loop.size(), lines);
  }

  scene::Component& component(scene::Scene& scene) const {
    for (scene::Component* each : scene.root().all<scene::Component>())
      if (each->class_name() == description_.class_name) return *each;
    throw std::out_of_range(std::string(description_.class_name));
  }

 private:
  const Description& description_;
  std::string text_, path_;
  Motion unchanged_;
};

std::string change(const std::string& component, std::string_view attribute, const Value& value) {
  const std::string text = scene::write_value(value);
  return "<AttributeChange component='@" + component + "' attribute='" + std::string(attribute) + "' keyTimes='" +
         std::to_string(0.01 * kChangesAt) + "' values='" + (text.empty() ? " " : text) + "'/>";
}

/// Expects a change of one attribute to have the same effect however it comes. Returns the first step that it has one
/// in, kSteps: in none; none: the scene takes no other value.
std::optional<int> expect_effect(const Example& example, const Attribute& attribute, const std::string& name) {
  scene::Scene untouched = read_and_init(example.text());
  scene::Data& data = *example.component(untouched).find_data(attribute.name);
  const Value present = data.value();
  const bool is_given = data.is_given();

  std::optional<Value> value;
  for (const Value& other : others(attribute, present, name)) try {
      scene::Scene scene = read_and_init(example.with(change(example.path(), attribute.name, other)));
      run(scene, kSteps);
      value = other;
      break;
    } catch (const scene::SceneError&) {
    }
  if (!value) return std::nullopt;
  SCOPED_TRACE(scene::write_value(*value));

  const std::string text = example.with(change(example.path(), attribute.name, *value));
  scene::Scene changing = read_and_init(text);
  const Motion changed = motion(changing, kSteps);
  int first = 0;
  while (first < kSteps && changed[first] == example.unchanged()[first]) ++first;
  EXPECT_GE(first, kChangesAt) << "before its time";

  changing.reset();
  EXPECT_EQ(motion(changing, kSteps), changed) << "after reset";

  for (const int steps : {kChangesAt - 1, kChangesAt, kChangesAt + 1}) {
    scene::Scene put_down = read_and_init(text), taken_up = read_and_init(text);
    run(put_down, steps);
    go_on_in(put_down, taken_up);
    EXPECT_EQ(motion(taken_up, kSteps - steps), tail(changed, steps)) << "taken up after " << steps << " steps";
  }

  // by the window, between two steps
  run(untouched, kChangesAt);
  data.set(*value, {"window", 1});
  EXPECT_EQ(motion(untouched, kSteps - kChangesAt), tail(changed, kChangesAt)) << "by the window";

  // another value that goes again before the component has seen it: all is read anew, and nothing moves
  scene::Scene there_and_back =
      read_and_init(example.with(change(example.path(), attribute.name, *value) +
                                 change(example.path(), attribute.name, is_given ? present : Value())));
  EXPECT_EQ(motion(there_and_back, kSteps), example.unchanged()) << "the present value given anew";

  // through a link to what changes
  const std::string first_value = scene::write_value(present);
  if (!is_given && first_value.empty()) return first;  // nothing that is given may differ from nothing
  const std::string source(source_of(attribute.type));
  scene::Scene linked = read(
      example.with(change("source", source, *value) + "<Source name='source' " + source + "='" + first_value + "'/>"));
  example.component(linked).find_data(attribute.name)->read("@/source." + source, {"test.scn", 1});
  linked.init();
  EXPECT_EQ(motion(linked, kSteps), changed) << "through a link";
  return first;
}

TEST(Changes, ActInTheirStepAloneAndAreUndone) {
  plugins();
  factory().add<Source>(kSource);
  const std::vector<const Description*> all = factory().descriptions();
  std::map<std::string, std::string> category_of;
  for (const Description* description : all) category_of[std::string(description->class_name)] = description->category;

  std::set<std::string> tried, refused, idle, late;
  for (const Description* description : all) {
    const std::string_view class_name = description->class_name;
    if (description->takes_anything || description->category == "Test" || description->category == "Visual") continue;
    std::vector<attributes::Example> pieces;
    for (const attributes::Example& each : attributes::examples())
      if (each.class_name == class_name) pieces.push_back(each);
    for (const attributes::Example& each : kMoreScenes)
      if (each.class_name == class_name) pieces.push_back(each);
    for (const attributes::Example& piece : pieces) {
      if (piece.lines.find("ilename") != piece.lines.npos || piece.lines.find("fileTopology") != piece.lines.npos)
        continue;
      SCOPED_TRACE(piece.lines);
      const Example example(*description, support::pasted(std::string(attributes::example_scene()),
                                                          std::string(piece.lines), category_of));
      scene::Scene scene = read_and_init(example.text());
      const auto* changeable = dynamic_cast<const scene::Changeable*>(&example.component(scene));
      if (!changeable) continue;
      for (const Attribute& attribute : description->attributes) {
        if (attribute.access != Access::kInput || attribute.type == Type::kLink ||
            !changeable->may_change(attribute.name))
          continue;
        const std::string name = std::string(class_name) + "." + std::string(attribute.name);
        SCOPED_TRACE(name);
        if (const std::optional<int> first = expect_effect(example, attribute, name))
          (*first == kChangesAt ? tried : *first < kSteps ? late : idle).insert(name);
        else
          refused.insert(name);
      }
    }
  }
  for (const std::string& name : tried) late.erase(name);
  for (auto* others : {&tried, &late})
    for (const std::string& name : *others) {
      idle.erase(name);
      refused.erase(name);
    }
  for (const std::string& name : idle) refused.erase(name);
  EXPECT_EQ(late, kLate) << "later than in their step";
  EXPECT_EQ(idle, kIdle) << "without effect";
  EXPECT_EQ(refused, kRefused) << "no other value was found";
  EXPECT_GE(tried.size(), 75u);
}

}  // namespace
