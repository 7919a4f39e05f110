// SPDX-License-Identifier: LGPL-2.1-or-later
// What attributes may say, and files that a scene includes.
#include <memory>
#include <set>

#include "attributes/hexaplast.hpp"
#include "attributes/parts.hpp"
#include "attributes/stock.hpp"
#include "attributes/words.hpp"
#include "hexaplast/base/error.hpp"
#include "scene/document.hpp"
#include "scene/interfaces.hpp"
#include "scene/value.hpp"
#include "support/files.hpp"
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

/// A directory of its own for each test. Messages name files in it without the directory.
class SceneInclude : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    fs::create_directories((directory_ / name).parent_path());
    put(directory_ / name, text);
  }

  scene::Scene read(const std::string& name) {
    scene::PluginLoader& loader = plugins();
    return scene::read_scene(directory_ / name, factory(), loader, search_path_);
  }

  std::string errors_of(const std::string& name) {
    try {
      read(name).init();
      return "";
    } catch (const scene::SceneError& error) {
      std::string text = error.what();
      const std::string folder = directory_.path().string() + "/";
      for (std::size_t found = text.find(folder); found != text.npos; found = text.find(folder, found))
        text.erase(found, folder.size());
      return text;
    }
  }

  const Scratch directory_;
  scene::SearchPath search_path_;
};

TEST_F(SceneInclude, AFileStandsForItsRootAndIsFoundFromTheIncludingFile) {
  write("main.scn", "<Node name='main'><include href='parts/a.xml'/></Node>");
  write("parts/a.xml", "<Node name='a'><include href='b.xml' name='renamed'/></Node>");
  write("parts/b.xml", "<BoxROI name='b' box='1 2 3 4 5 6'/>");
  scene::Scene scene = read("main.scn");
  EXPECT_EQ(at<scene::Engine>(scene, "a/renamed").reals("box"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
}

TEST_F(SceneInclude, ErrorsShowTheChainOfFiles) {
  write("main.scn", "<Node>\n<include href='parts/a.xml'/></Node>");
  write("parts/a.xml", "<Node>\n\n<include href='b.xml'/></Node>");
  write("parts/b.xml", "\n\n\n<Nonsense/>");
  EXPECT_TRUE(errors_of("main.scn")
                  .starts_with("parts/b.xml:4: error: Nonsense: unknown component\n  included at parts/a.xml:3\n  "
                               "included at main.scn:2\n"));
  write("parts/b.xml", "<Node>\n<BoxROI></Node>");
  EXPECT_EQ(errors_of("main.scn"),
            "parts/b.xml:2: error: mismatched tag at column 11 in <BoxROI> of line 2: Node>\n"
            "  included at parts/a.xml:3\n  included at main.scn:2");
}

TEST_F(SceneInclude, WhatCannotBeIncludedIsAnError) {
  fs::create_directory(directory_ / "parts");
  write("main.scn",
        "<Node>\n<include/>\n<include href=''/>\n<include href='absent.xml'/>\n<include href='parts'/>"
        "\n<include href='a.xml'><BoxROI/></include>\n<include href='a.xml' box='1 1 1 2 2 2'/></Node>");
  write("a.xml", "<Node/>");
  EXPECT_EQ(errors_of("main.scn"),
            "main.scn:2: error: include.href: is not given, must be a file\n"
            "main.scn:3: error: include.href: is not given, must be a file\n"
            "main.scn:4: error: include.href: 'absent.xml': no such file\n"
            "main.scn:5: error: include.href: 'parts': is not a file\n"
            "main.scn:6: error: include: holds elements or text, must be empty\n"
            "main.scn:7: error: include.box: unknown attribute, must be href or name");
}

TEST_F(SceneInclude, CirclesAreFoundWhateverTheFilesAreCalled) {
  fs::create_directory(directory_ / "parts");
  write("main.scn", "<Node>\n<include href='parts/../main.scn'/></Node>");
  EXPECT_EQ(errors_of("main.scn"), "main.scn:2: error: include.href: 'parts/../main.scn' includes itself");

  write("main.scn", "<Node><include href='a.xml'/></Node>");
  write("a.xml", "<Node><include href='parts/link.xml'/></Node>");
  fs::create_symlink(directory_ / "a.xml", directory_ / "parts/link.xml");
  EXPECT_EQ(errors_of("main.scn"),
            "a.xml:1: error: include.href: 'parts/link.xml' includes itself\n  included at main.scn:1");
}

TEST_F(SceneInclude, LevelsAndNumberAreLimited) {
  const auto file = [](int i) { return "level" + std::to_string(i) + ".xml"; };
  for (int i = 0; i <= 17; ++i) write(file(i), "<Node><include href='" + file(i + 1) + "'/></Node>");
  write(file(16), "<Node/>");
  EXPECT_EQ(errors_of(file(0)), "");
  write(file(16), "<Node><include href='" + file(17) + "'/></Node>");
  write(file(17), "<Node/>");
  EXPECT_EQ(errors_of(file(0)).rfind("level16.xml:1: error: include.href: more than 16 levels of includes\n", 0), 0u)
      << errors_of(file(0));

  // each file includes the next one twice: 65,535 files in all
  for (int i = 0; i < 16; ++i)
    write(file(i), "<Node><include href='" + file(i + 1) + "'/><include href='" + file(i + 1) + "'/></Node>");
  write(file(16), "<Node/>");
  EXPECT_TRUE(has(errors_of(file(0)), "error: include.href: more than 1000 includes\n"));
}

/// The file is not beside the scene, but below a directory of the search path.
class SceneSearchPath : public SceneInclude {
 protected:
  SceneSearchPath() {
    write("scenes/a.scn", "<Node><include href='parts/part.xml'/></Node>");
    write("one/parts/part.xml", part("mesh/m.obj"));
    search_path_ = scene::SearchPath({directory_ / "none", directory_ / "one", directory_ / "two"});
  }

  static std::string part(const std::string& mesh) {
    return "<Node name='Group'><MeshOBJLoader name='mesh' filename='" + mesh + "'/></Node>";
  }

  /// A triangle whose first corner lies at x.
  void write_mesh(const std::string& name, double x) {
    write(name, "v " + std::to_string(x) + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }

  double first_x() {
    scene::Scene scene = read("scenes/a.scn");
    scene.init();
    return at<scene::Component>(scene, "mesh").reals("position")[0];
  }
};

TEST_F(SceneSearchPath, TheFileItselfComesFirstThenTheDirectoriesInTheirOrder) {
  write_mesh("two/mesh/m.obj", 2);
  EXPECT_EQ(first_x(), 2);
  write_mesh("one/mesh/m.obj", 1);
  EXPECT_EQ(first_x(), 1);
  write_mesh("one/parts/mesh/m.obj", 3);  // beside the file that names it
  EXPECT_EQ(first_x(), 3);
  // what is read is never written over
  scene::Scene scene = read("scenes/a.scn");
  scene.init();
  for (const char* input : {"one/parts/mesh/m.obj", "one/parts/part.xml"})
    EXPECT_FALSE(scene.root().files().inputs.replaced_by(directory_ / input).empty()) << input;
}

TEST_F(SceneSearchPath, WhatIsNowhereIsRefusedWithThePlaces) {
  EXPECT_TRUE(has(errors_of("scenes/a.scn"), "  hint: looked for in none, "));
  fs::remove(directory_ / "one/parts/part.xml");
  EXPECT_TRUE(has(errors_of("scenes/a.scn"), "'parts/part.xml': no such file\n  hint: looked for in none, "));
}

TEST_F(SceneSearchPath, NamesThatLeadUpwardsCountFromTheirFileAlone) {
  write("one/parts/part.xml", part("../m.obj"));
  write_mesh("m.obj", 7);  // one/../m.obj
  const std::string errors = errors_of("scenes/a.scn");
  EXPECT_TRUE(has(errors, "no such file"));
  EXPECT_FALSE(has(errors, "hint"));
}

std::optional<scene::Description> description_in(const std::string& text) {
  const Scratch scratch;
  put(scratch / "some.scn", text);
  return scene::description_of(scratch / "some.scn");
}

TEST(Description, IsTheLineAndTheParagraphAtTheHeadOfTheFile) {
  const auto found = description_in(
      "<?xml version=\"1.0\"?>\n<!-- a licence -->\n<!--\n  Fat on a\n  vessel\n\n  It is   drawn\n  out.\n\n  "
      "More.\n-->"
      "\n<Node name=\"root\"><!-- within\n\n  the scene --></Node>\n");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->heading, "Fat on a vessel");
  EXPECT_EQ(found->words, "It is drawn out.");
}

TEST(Description, IsNoneWhereTheFileHasNone) {
  EXPECT_FALSE(description_in("<Node name=\"root\"><!-- within\n\n  the scene --></Node>"));
  EXPECT_FALSE(description_in("<!-- a licence --><Node name=\"root\"/>"));
  EXPECT_FALSE(description_in("<!-- long " + std::string(200, 'x') + "\n\n words --><Node name=\"root\"/>"));
  EXPECT_FALSE(description_in("<!-- one\n\n two --><Node"));
  EXPECT_FALSE(scene::description_of("/nowhere.scn"));
  EXPECT_FALSE(scene::description_of("/dev/zero"));
}

TEST(Description, OfEveryShippedSceneIsThere) {
  for (const auto& entry : std::filesystem::directory_iterator(HEXAPLAST_SOURCE_DIR "/scenes"))
    if (entry.path().extension() == ".scn") {
      EXPECT_TRUE(scene::description_of(entry.path())) << entry.path();
    }
}

}  // namespace
