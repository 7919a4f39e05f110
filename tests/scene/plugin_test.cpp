// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/plugin.hpp"

#include <cstring>

#include "support/files.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// A directory of its own for each test, with plugins made from the bytes of the real one.
class PluginFiles : public testing::Test {
 protected:
  void SetUp() override { ASSERT_FALSE(real_.empty()); }

  std::string refusal(const std::string& bytes) {
    put(directory_ / "libOther.so", bytes);
    return refusal_of_name("Other");
  }
  std::string refusal_of_name(const std::string& name) {
    scene::Factory factory;
    try {
      scene::PluginLoader(factory, {directory_.path()}).load(name);
      return "loaded";
    } catch (const scene::PluginError& error) {
      return error.what();
    }
  }

  std::string prefix() const { return "plugin 'Other': " + (directory_ / "libOther.so").string() + ": "; }
  std::string search_path() const { return "; search path: " + directory_.path().string(); }

  const Scratch directory_;
  const std::string real_ = content(fs::path(HEXAPLAST_TEST_PLUGINS) / "Hexaplast.so");
};

TEST_F(PluginFiles, ComponentsComeFromAPluginFoundByName) {
  scene::Factory factory;
  scene::PluginLoader loader(factory, {directory_.path(), HEXAPLAST_TEST_PLUGINS});
  EXPECT_FALSE(factory.make("MechanicalObject"));
  loader.load("Hexaplast");
  loader.load("Hexaplast");  // a second time does nothing
  loader.load("Sofa.Component.Mass");
  EXPECT_TRUE(factory.make("MechanicalObject"));
}

// In a directory that a stranger may have filled: whoever runs the program of an installation there trusts it.
TEST_F(PluginFiles, OfTheInstallationAreTrustedWhereverItLies) {
  const fs::path installed = HEXAPLAST_TEST_PLUGINS;
  for (const fs::path& untrusted : {installed, installed.parent_path()}) {
    scene::Factory factory;
    scene::PluginLoader(factory, {directory_.path()}, installed, untrusted).load("Hexaplast");
    EXPECT_TRUE(factory.make("MechanicalObject"));
    try {
      scene::PluginLoader(factory, {installed}, {}, untrusted).load("Hexaplast");
      ADD_FAILURE() << untrusted;
    } catch (const scene::PluginError& error) {
      EXPECT_TRUE(has(error.what(), "from which nothing is loaded"));
    }
  }
}

TEST_F(PluginFiles, APathIsNoName) {
  for (const char* name : {"../Other", "/tmp/libOther.so", "a/b", "..", ".hidden", "a b", ""}) {
    EXPECT_EQ(refusal_of_name(name), std::string("plugin '") + name +
                                         "': plugins are loaded by name (letters, digits, _ - .), never by path" +
                                         search_path());
  }
}

TEST_F(PluginFiles, AMissingPluginNamesTheSearchPath) {
  EXPECT_EQ(refusal_of_name("Absent"), "plugin 'Absent': there is no Absent.so or libAbsent.so" + search_path());
}

TEST_F(PluginFiles, OtherFilesAreNotLoaded) {
  EXPECT_EQ(refusal(""), prefix() + "it carries no hexaplast_plugin_abi_tag of this program" + search_path());
  EXPECT_EQ(refusal(std::string(4096, 'x')), prefix() + "it is damaged, or no shared library" + search_path());

  fs::remove(directory_ / "libOther.so");
  fs::create_directory(directory_ / "libOther.so");
  EXPECT_EQ(refusal_of_name("Other"), "plugin 'Other': there is no Other.so or libOther.so" + search_path());
}

// The bytes of the tag are changed in the file, and the refusal shows that they were read there.
TEST_F(PluginFiles, AnotherAbiIsRefusedBeforeAnyCodeRuns) {
  const scene::AbiTag tag = scene::abi_tag();
  const std::string bytes(reinterpret_cast<const char*>(&tag), sizeof tag);
  const std::size_t at = real_.find(bytes);
  ASSERT_NE(at, real_.npos);
  ASSERT_EQ(real_.find(bytes, at + 1), real_.npos);

  using Change = void (*)(scene::AbiTag&);
  for (const auto& [change, reason] : std::vector<std::pair<Change, std::string>>{
           {[](scene::AbiTag& changed) { ++changed.interface_number; },
            "it was built for another component interface: " + std::to_string(scene::kInterfaceNumber + 1) +
                ", must be " + std::to_string(scene::kInterfaceNumber) + search_path()},
           {[](scene::AbiTag& changed) { changed.scalar_size = 4; },
            "it was built for another scalar size: 4, must be 8" + search_path()},
           {[](scene::AbiTag& changed) { changed.compiler_abi += 1; }, "it was built for another compiler ABI"},
           {[](scene::AbiTag& changed) { changed.sizes[1] += 8; }, "it was built for another layout of shared types"},
           {[](scene::AbiTag& changed) { changed.magic[0] = 'H'; },
            "it carries no hexaplast_plugin_abi_tag of this program" + search_path()}}) {
    scene::AbiTag changed = tag;
    change(changed);
    std::string other = real_;
    std::memcpy(other.data() + at, &changed, sizeof changed);
    EXPECT_TRUE(refusal(other).starts_with(prefix() + reason)) << reason;
  }
}

TEST_F(PluginFiles, AFunctionIsNeeded) {
  std::string other = real_;
  const std::string symbol = "hexaplast_register_components";
  for (std::size_t at = other.find(symbol); at != other.npos; at = other.find(symbol, at)) other[at] = 'H';
  const std::string message = refusal(other);
  EXPECT_TRUE(has(message, "it has no function " + symbol));
}

TEST_F(PluginFiles, EveryTruncationIsRefused) {
  for (std::size_t i = 0; i < 64; ++i) {
    const std::string message = refusal(real_.substr(0, real_.size() * i / 64));
    EXPECT_TRUE(has(message, prefix() + "it "));
  }
}

}  // namespace
