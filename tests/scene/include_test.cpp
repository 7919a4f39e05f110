// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/description.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

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
