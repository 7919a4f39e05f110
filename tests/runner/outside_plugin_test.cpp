// SPDX-License-Identifier: LGPL-2.1-or-later
// What somebody outside the project sees: a plugin and a program built against an installation, the example that the
// pages show, and the packages.
#include <regex>

#include "support/command.hpp"

namespace {

using namespace hexaplast::support;
using namespace std::string_literals;
using Json = nlohmann::json;

const fs::path kSource = HEXAPLAST_SOURCE_DIR;
const std::string kExample = kSource / "docs/examples/plugin";

/// The command of the installation under `prefix`.
class OutsidePlugin : public Command {
 protected:
  Outcome installed(const std::string& arguments) {
    return shell(quoted(directory_ / "prefix" / HEXAPLAST_BIN / "hexaplast") + " " + arguments);
  }

  void must(const std::string& line) {
    const Outcome outcome = shell(line);
    ASSERT_EQ(outcome.code, 0) << line << "\n" << outcome.out << outcome.err;
  }

  /// Runs the lines of a page from the one that begins so to the end of their block, as its reader does in the folder
  /// of the sources.
  void must_as_shown(const std::string& page, const std::string& first_line, const std::string& before = "") {
    const std::string text = content(kSource / page);
    const std::size_t begin = text.find("\n" + first_line), end = text.find("\n```", begin);
    ASSERT_NE(begin, text.npos) << page << " has no line " << first_line;
    for (const char* name : {"docs", "examples"})
      if (!is_there(name)) fs::create_symlink(kSource / name, directory_ / name);
    if (!is_there("build")) fs::create_symlink(HEXAPLAST_BUILD_DIR, directory_ / "build");
    const std::string lines = std::regex_replace(text.substr(begin, end - begin), std::regex("\\bPREFIX\\b"),
                                                 (directory_ / "prefix").string());
    write("lines.sh", "set -e\nexport CXX='" HEXAPLAST_COMPILER "'\n" + lines + "\n");
    must(before + "sh ./lines.sh");
  }
};

TEST_F(OutsidePlugin, IsBuiltFromTheInstallationAndFoundByName) {
  const std::string cmake = "'" HEXAPLAST_CMAKE "' ", scene = quoted(kExample + "/tether.scn");
  must_as_shown("docs/plugins.md", "cmake --install build");

  EXPECT_EQ(installed("run " + scene).code, 6);
  EXPECT_EQ(installed("run " + scene + " --plugin-path tether --final state.json").code, 0);

  // Every node of the cube moves alike, so that it is one mass on one spring, by the scheme of the solver:
  // (m + h^2 k) dv = h (-k (u - offset) - h k v).
  const Json state = json("state.json");
  const double m = 4.0 / 8, k = 20, h = 0.01;
  double u = 0, v = 0;
  for (int step = 0; step < 50; ++step) {
    v += h * (-k * (u - 0.1) - h * k * v) / (m + h * h * k);
    u += h * v;
  }
  ASSERT_GT(u, 0.1);  // past the place it is drawn to
  for (int node = 0; node < 8; ++node) {
    EXPECT_NEAR(state["positions"][node][0], (node % 2) * 0.2 + u, 1e-12) << "node " << node;
    EXPECT_NEAR(state["velocities"][node][0], v, 1e-12) << "node " << node;
  }

  // installed beside the others it needs no path, and a scene that does not require it can be given it by name
  must(cmake + "--install tether --prefix prefix");
  EXPECT_EQ(installed("run " + scene).code, 0);
  write("bare.scn", "<Node><TetherForceField/></Node>");
  EXPECT_EQ(installed("check bare.scn").code, 3);
  const Outcome named = installed("check bare.scn --plugin Tether");
  EXPECT_EQ(named.code, 3);
  EXPECT_FALSE(has(named.err, "unknown component"));
  const Outcome listed = installed("list TetherForceField --plugin Tether");
  EXPECT_EQ(listed.code, 0);
  EXPECT_TRUE(has(listed.out, "stiffness: one number [N/m], must be > 0; default 1"));
  EXPECT_EQ(installed("run " + scene + " --set cube/TetherForceField1.stiffness=-1").code, 2);
}

TEST_F(OutsidePlugin, IsALibraryForOtherPrograms) {
  const std::string cmake = "'" HEXAPLAST_CMAKE "' ", consumer = kSource / "examples/consumer";
  must_as_shown("docs/installing.md", "cmake --install build --prefix");
  must(cmake + "-S " + quoted(consumer) +
       " -B with_cmake -DCMAKE_PREFIX_PATH=\"$PWD/prefix\" -DCMAKE_CXX_COMPILER='" HEXAPLAST_COMPILER "'");
  must(cmake + "--build with_cmake");
  const Outcome strain = shell("with_cmake/consumer");
  EXPECT_EQ(strain.code, 0);

  // what the pages show are these programs, and what they print
  const auto shows = [&](const char* page, const std::string& file, const std::string& printed) {
    const std::string source = content(consumer + file), program = source.substr(source.find("#include"));
    EXPECT_TRUE(has(content(kSource / page), "```cpp\n" + program + "```\n")) << page << " does not show\n" << program;
    EXPECT_TRUE(has(content(kSource / page), "```\n" + printed + "```\n")) << page << " does not say\n" << printed;
  };
  shows("docs/api.md", "/main.cpp", strain.out);
  shows("include/hexaplast/README.md", "/main.cpp", strain.out);
  EXPECT_TRUE(has(content(kSource / "docs/api.md"), "```\n" + shell("with_cmake/forceps").out + "```\n"));

  // pkg-config tells the same without CMake
  fs::copy(consumer + "/main.cpp", directory_ / "main.cpp");
  const std::string variables = "export PKG_CONFIG_PATH=\"$PWD/prefix/" HEXAPLAST_LIBDIR
                                "/pkgconfig\" LD_LIBRARY_PATH=\"$PWD/prefix/" HEXAPLAST_LIBDIR "\"; ";
  must(variables + "pkg-config --exact-version=" HEXAPLAST_VERSION " hexaplast");
  must_as_shown("docs/installing.md", "g++ ", variables);
  EXPECT_EQ(shell(variables + "./a.out").out, strain.out);

  // components by name, and versions that are not compatible
  const auto finds = [&](const std::string& what) {
    write("CMakeLists.txt",
          "cmake_minimum_required(VERSION 3.22)\nproject(Asks LANGUAGES CXX)\nfind_package(Hexaplast " + what +
              " REQUIRED)\n");
    return shell(cmake + "-S . -B asked --fresh -DCMAKE_PREFIX_PATH=\"$PWD/prefix\" -DCMAKE_CXX_COMPILER='" +
                 HEXAPLAST_COMPILER "'")
               .code == 0;
  };
  EXPECT_TRUE(finds("0.2 COMPONENTS parts scene components output"));
  EXPECT_FALSE(finds("COMPONENTS teapot"));
  EXPECT_FALSE(finds("0.1"));
}

// What headers include is installed with them. That each compiles by itself is checked by scripts/check_sources.
TEST_F(OutsidePlugin, AllPublicHeadersAreInstalled) {
  must("'" HEXAPLAST_CMAKE "' --install '" HEXAPLAST_BUILD_DIR "' --prefix prefix --component development");
  std::string headers;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory_ / "prefix/include"))
    if (entry.path().extension() == ".hpp" && !has(entry.path().string(), "/plugin/"))
      headers += "#include \"" + entry.path().string() + "\"\n";
  EXPECT_GT(std::ranges::count(headers, '\n'), 30) << "the search has lost its object";
  write("headers.cpp", headers);
  must("'" HEXAPLAST_COMPILER "' -std=c++20 -fsyntax-only $(PKG_CONFIG_PATH=\"$PWD/prefix/" HEXAPLAST_LIBDIR
       "/pkgconfig\" pkg-config --cflags hexaplast) headers.cpp");
}

/// The value of a variable of a preset.
std::string preset(const std::string& name, const std::string& variable) {
  const Json presets = Json::parse(content(kSource / "CMakePresets.json"));
  for (const Json& one : presets["configurePresets"])
    if (one["name"] == name) return one["cacheVariables"].value(variable, "");
  return "";
}

TEST_F(OutsidePlugin, PackagesAreCompiledWithChecksOfStackAndBuffers) {
  const std::string cmake = "'" HEXAPLAST_CMAKE "' ";
  must(cmake + "-S " + quoted(kSource / "tests/hardening") +
       " -B build -DCMAKE_BUILD_TYPE=Release -DHEXAPLAST_HARDENING='" + preset("package", "HEXAPLAST_HARDENING") +
       "' -DCMAKE_CXX_COMPILER='" HEXAPLAST_COMPILER "'");
  must(cmake + "--build build");
  const std::string symbols = shell("nm -D build/libhardened.so").out;
  EXPECT_TRUE(has(symbols, "__stack_chk_fail")) << symbols;
  EXPECT_TRUE(has(symbols, "__memcpy_chk")) << symbols;
}

const std::string kLibrary = "libhexaplast" HEXAPLAST_SONAME;

/// The packages of `cpack -G DEB`, unpacked into a folder that stands for /.
class DebianPackages : public OutsidePlugin {
 protected:
  void SetUp() override {
    OutsidePlugin::SetUp();
    if (shell("command -v dpkg-deb dpkg-shlibdeps").code != 0) GTEST_SKIP() << "no Debian here";
    must("cd '" HEXAPLAST_BUILD_DIR "' && '" HEXAPLAST_CPACK "' -G DEB -B \"$OLDPWD/packages\"");
  }

  std::string field(const std::string& package, const std::string& name) {
    return shell("dpkg-deb -f packages/" + package + "_*.deb " + name).out;
  }
  std::string files(const std::string& package) { return shell("dpkg-deb -c packages/" + package + "_*.deb").out; }
};

TEST_F(DebianPackages, HoldWhatTheirNamesSayAndWorkTogether) {
  const std::string library = files(kLibrary), components = files("hexaplast-components"),
                    headers = files("libhexaplast-dev"), tools = files("hexaplast-tools");
  EXPECT_TRUE(has(library, "/libhexaplast_core.so." HEXAPLAST_VERSION "\n")) << library;
  EXPECT_FALSE(has(library, "/libhexaplast_core.so\n") || has(library, ".hpp") || has(library, "/bin/")) << library;
  EXPECT_TRUE(has(components, "/hexaplast/plugins/Hexaplast.so\n")) << components;
  EXPECT_TRUE(has(headers, "/hexaplast/body.hpp\n") && has(headers, "/libhexaplast_core.so ->")) << headers;
  EXPECT_TRUE(has(headers, "/HexaplastConfig.cmake\n") && has(headers, "/pkgconfig/hexaplast.pc\n")) << headers;
  EXPECT_TRUE(has(tools, "/bin/hexaplast\n") && has(tools, "/man1/hexaplast.1")) << tools;
  EXPECT_TRUE(has(tools, "/bash-completion/completions/hexaplast\n")) << tools;
  EXPECT_TRUE(has(tools, "/bin/hexaplast-sweep\n") && has(tools, "/hexaplast_study/sweep.py\n")) << tools;
  EXPECT_TRUE(has(field("hexaplast-tools", "Recommends"), "python3-scipy, python3-h5py, python3-matplotlib"));
  for (const std::string& package : {kLibrary, "hexaplast-components"s, "libhexaplast-dev"s, "hexaplast-tools"s})
    EXPECT_TRUE(has(files(package), "/doc/" + package + "/copyright\n")) << package;

  const std::string exactly = " (= " HEXAPLAST_VERSION ")";
  const std::string needs = field(kLibrary, "Depends"), dev_needs = field("libhexaplast-dev", "Depends"),
                    tools_need = field("hexaplast-tools", "Depends");
  EXPECT_TRUE(has(needs, "libcholmod3")) << needs;
  EXPECT_TRUE(has(dev_needs, "libeigen3-dev") && has(dev_needs, kLibrary + exactly)) << dev_needs;
  EXPECT_TRUE(has(tools_need, kLibrary + exactly) && has(tools_need, "hexaplast-components" + exactly)) << tools_need;

  // any later release of the same soname will do, and another soname is another package; the linker's cache is renewed
  // once for all packages
  must("dpkg-deb -e packages/" + kLibrary + "_*.deb control");
  const std::string shlibs = read("control/shlibs");
  for (const char* part : {"_core", "_formats", "_attributes", "_parts", "_scene", "_components", "_output"})
    EXPECT_TRUE(
        has(shlibs, "libhexaplast"s + part + " " HEXAPLAST_SONAME " " + kLibrary + " (>= " HEXAPLAST_VERSION ")"))
        << shlibs;
  EXPECT_EQ(read("control/triggers"), "activate-noawait ldconfig\n");
  EXPECT_FALSE(is_there("control/postinst"));

  must("mkdir root && for deb in packages/*.deb; do dpkg-deb -x $deb root; done");
  const Outcome run = shell("root/usr/bin/hexaplast run '" + std::string(HEXAPLAST_SOURCE_DIR) +
                            "/scenes/bar_stretch_high.scn' --steps 2");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "state hash"));
  // position-independent, with tables of addresses that are read-only from the start
  for (const char* binary : {"root/usr/bin/hexaplast", "$(find root -name 'libhexaplast_core.so.*' -type f)"}) {
    const std::string headers_of = shell(std::string("readelf -W -h -l -d ") + binary).out;
    EXPECT_TRUE(has(headers_of, "DYN (") && has(headers_of, "GNU_RELRO") && has(headers_of, "NOW")) << headers_of;
  }
  // pkg-config finds what lies beside its file, in the folder of this architecture too
  must(
      "export PKG_CONFIG_PATH=\"$(dirname \"$(find \"$PWD/root\" -name hexaplast.pc)\")\" && "
      "test -e \"$(pkg-config --variable=includedir hexaplast)/hexaplast/body.hpp\" && "
      "test -e \"$(pkg-config --variable=libdir hexaplast)/libhexaplast_core.so\"");
  // nothing of the build tree is left in what is delivered
  EXPECT_NE(shell("grep -rl '" HEXAPLAST_BUILD_DIR "' root").code, 0) << read("out");
}

}  // namespace
