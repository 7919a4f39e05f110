// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/plugin.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "formats/readable_file.hpp"

namespace hexaplast::scene {
namespace {

constexpr const char* kTagSymbol = "hexaplast_plugin_abi_tag";
constexpr const char* kRegisterSymbol = "hexaplast_register_components";

/// The tag in the file of a shared library. Loading it runs its static constructors, so that dlsym would be too late;
/// but the tag is data without relocations, hence its bytes stand in the file as they will stand in memory.
AbiTag tag_of(const std::filesystem::path& file) {
  const std::string bytes = whole_file(file);
  // the sections are described last: a file that is cut off would end the program in the middle of loading
  Elf64_Ehdr header{};
  std::memcpy(&header, bytes.data(), std::min(bytes.size(), sizeof header));
  if (header.e_shoff > bytes.size() || (bytes.size() - header.e_shoff) / sizeof(Elf64_Shdr) < header.e_shnum)
    throw PluginError("it is damaged, or no shared library");

  AbiTag tag = abi_tag();
  const std::size_t at = bytes.find({reinterpret_cast<const char*>(&tag), offsetof(AbiTag, interface_number)});
  if (at == bytes.npos || bytes.size() - at < sizeof tag)
    throw PluginError(fmt::format("it carries no {} of this program", kTagSymbol));
  std::memcpy(&tag, bytes.data() + at, sizeof tag);
  return tag;
}

void check_tag(const AbiTag& tag) {
  constexpr AbiTag ours = abi_tag();
  const auto require = [](const char* what, std::uint32_t theirs, std::uint32_t wanted) {
    if (theirs != wanted) {
      throw PluginError(fmt::format("it was built for another {}: {}, must be {}", what, theirs, wanted));
    }
  };
  require("component interface", tag.interface_number, ours.interface_number);
  require("compiler ABI", tag.compiler_abi, ours.compiler_abi);
  require("standard library ABI", tag.stdlib_abi, ours.stdlib_abi);
  require("scalar size", tag.scalar_size, ours.scalar_size);
  require("alignment of Eigen types", tag.eigen_alignment, ours.eigen_alignment);
  for (std::size_t i = 0; i < ours.sizes.size(); ++i) require("layout of shared types", tag.sizes[i], ours.sizes[i]);
}

void register_components(const std::filesystem::path& file, Factory& factory) {
  // An absolute path, because dlopen looks for bare names in the system's directories. RTLD_NOW: a missing function is
  // found here, not in the middle of a run.
  void* library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw PluginError(dlerror());
  const auto add_all = reinterpret_cast<void (*)(Factory&)>(dlsym(library, kRegisterSymbol));
  if (!add_all) throw PluginError(fmt::format("it has no function {}", kRegisterSymbol));
  add_all(factory);
}

/// Whatever links lead there: the folders themselves are compared, not their names.
bool lies_below(const std::filesystem::path& file, const std::filesystem::path& directory) {
  std::error_code unknown;
  std::filesystem::path folder = std::filesystem::canonical(file).parent_path();
  while (!std::filesystem::equivalent(folder, directory, unknown)) {
    if (folder == folder.parent_path()) return false;
    folder = folder.parent_path();
  }
  return true;
}

}  // namespace

PluginLoader::PluginLoader(Factory& factory, std::vector<std::filesystem::path> directories,
                           std::filesystem::path installation, std::filesystem::path untrusted)
    : factory_(factory),
      directories_(std::move(directories)),
      installation_(std::move(installation)),
      untrusted_(std::move(untrusted)) {
  if (!installation_.empty()) directories_.push_back(installation_);
}

void PluginLoader::load(const std::string& name) {
  if (name.starts_with("Sofa.") || std::ranges::count(loaded_, name) > 0) return;
  const auto refusal = [&](const std::string& reason) {
    std::string message = fmt::format("plugin '{}': {}; search path: ", name, reason);
    for (const std::filesystem::path& directory : directories_)
      message += fmt::format("{}{}", &directory == &directories_.front() ? "" : ":", directory.string());
    return message;
  };
  if (!is_plain_name(name) || name[0] == '.')
    throw PluginError(refusal("plugins are loaded by name (letters, digits, _ - .), never by path"));

  for (const std::filesystem::path& directory : directories_) {
    for (const std::string& file_name : {name + ".so", "lib" + name + ".so"}) {
      const std::filesystem::path file = directory / file_name;
      std::error_code unknown;
      if (!std::filesystem::is_regular_file(file, unknown)) continue;
      try {
        if (!untrusted_.empty() && directory != installation_ && lies_below(file, untrusted_))
          throw PluginError(fmt::format("it lies below {}, from which nothing is loaded", untrusted_.string()));
        check_tag(tag_of(file));
        register_components(file, factory_);
      } catch (const std::runtime_error& error) {
        throw PluginError(refusal(fmt::format("{}: {}", file.string(), error.what())));
      }
      loaded_.push_back(name);
      return;
    }
  }
  throw PluginError(refusal(fmt::format("there is no {0}.so or lib{0}.so", name)));
}

void Factory::add(const attributes::Description& description, Make make) {
  const auto [entry, is_new] =
      entries_.try_emplace(std::string(description.class_name), Entry{&description, std::move(make)});
  if (!is_new) throw PluginError(fmt::format("component {} is registered twice", description.class_name));
}

std::unique_ptr<Component> Factory::make(std::string_view class_name) const {
  const auto found = entries_.find(class_name);
  return found == entries_.end() ? nullptr : found->second.make();
}

std::vector<const attributes::Description*> Factory::descriptions() const {
  std::vector<const attributes::Description*> all;
  for (const auto& [key, entry] : entries_) all.push_back(entry.description);
  return all;
}

}  // namespace hexaplast::scene
