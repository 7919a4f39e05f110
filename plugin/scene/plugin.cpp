// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/plugin.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>

namespace hexaplast::scene {
namespace {

constexpr const char* kTagSymbol = "hexaplast_plugin_abi_tag";
constexpr const char* kRegisterSymbol = "hexaplast_register_components";

// Loading a shared library runs its static constructors, so the tag cannot be asked for with dlsym: that would be too
// late. It is data without relocations, hence its bytes stand in the file as they will stand in memory, and this reads
// them there: the dynamic symbol table gives the tag's address, the section that contains the address gives the place
// in the file. Offsets and sizes come from a file of unknown origin, so every read is checked against the end of the
// file.
class ElfFile {
 public:
  explicit ElfFile(const std::filesystem::path& path) : file_(path, std::ios::binary) {
    std::error_code unknown;
    size_ = std::filesystem::file_size(path, unknown);
    if (unknown || !file_) throw PluginError("it cannot be read");

    const auto header = read<Elf64_Ehdr>(0);
    const bool is_shared_library = std::memcmp(header.e_ident, ELFMAG, SELFMAG) == 0 &&
                                   header.e_ident[EI_CLASS] == ELFCLASS64 && header.e_type == ET_DYN &&
                                   header.e_shentsize == sizeof(Elf64_Shdr);
    if (!is_shared_library) throw PluginError("it is not a shared library");
    sections_ = read_array<Elf64_Shdr>(header.e_shoff, header.e_shnum);
  }

  /// The first bytes of a data symbol; none when no symbol of that name and at least that size is defined. (The address
  /// sanitizer makes symbols larger.)
  template <class Content>
  std::optional<Content> content_of_symbol(std::string_view name) {
    for (const Elf64_Shdr& table : sections_) {
      if (table.sh_type != SHT_DYNSYM || table.sh_link >= sections_.size()) continue;
      const auto symbols = read_array<Elf64_Sym>(table.sh_offset, table.sh_size / sizeof(Elf64_Sym));
      const auto names = read_array<char>(sections_[table.sh_link].sh_offset, sections_[table.sh_link].sh_size);
      const std::string_view all_names(names.data(), names.size());

      for (const Elf64_Sym& symbol : symbols) {
        const bool is_defined = symbol.st_shndx != SHN_UNDEF && symbol.st_shndx < sections_.size();
        if (!is_defined || symbol.st_size < sizeof(Content) || symbol.st_name >= all_names.size()) continue;
        const std::string_view from_name = all_names.substr(symbol.st_name);
        if (from_name.substr(0, from_name.find('\0')) != name) continue;

        const Elf64_Shdr& section = sections_[symbol.st_shndx];
        if (section.sh_type == SHT_PROGBITS)
          return read<Content>(section.sh_offset + (symbol.st_value - section.sh_addr));
      }
    }
    return std::nullopt;
  }

 private:
  template <class Content>
  std::vector<Content> read_array(std::uint64_t offset, std::uint64_t count) {
    if (offset > size_ || (size_ - offset) / sizeof(Content) < count)
      throw PluginError("it is damaged, or no shared library");
    std::vector<Content> contents(count);
    file_.seekg(static_cast<std::streamoff>(offset));
    file_.read(reinterpret_cast<char*>(contents.data()), static_cast<std::streamsize>(count * sizeof(Content)));
    if (!file_) throw PluginError("it cannot be read");
    return contents;
  }

  template <class Content>
  Content read(std::uint64_t offset) {
    return read_array<Content>(offset, 1)[0];
  }

  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::vector<Elf64_Shdr> sections_;
};

void check_tag(const std::filesystem::path& file) {
  const std::optional<AbiTag> tag = ElfFile(file).content_of_symbol<AbiTag>(kTagSymbol);
  constexpr AbiTag ours = abi_tag();
  if (!tag || tag->magic != ours.magic || tag->tag_size != ours.tag_size) {
    throw PluginError(fmt::format("it carries no {} of this program", kTagSymbol));
  }

  const auto require = [](const char* what, std::uint32_t theirs, std::uint32_t wanted) {
    if (theirs != wanted) {
      throw PluginError(fmt::format("it was built for another {}: {}, must be {}", what, theirs, wanted));
    }
  };
  require("component interface", tag->interface_number, ours.interface_number);
  require("compiler ABI", tag->compiler_abi, ours.compiler_abi);
  require("standard library ABI", tag->stdlib_abi, ours.stdlib_abi);
  require("scalar size", tag->scalar_size, ours.scalar_size);
  require("alignment of Eigen types", tag->eigen_alignment, ours.eigen_alignment);
  for (std::size_t i = 0; i < ours.sizes.size(); ++i) require("layout of shared types", tag->sizes[i], ours.sizes[i]);
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
        check_tag(file);
        register_components(file, factory_);
      } catch (const PluginError& error) {
        throw PluginError(refusal(fmt::format("{}: {}", file.string(), error.what())));
      }
      loaded_.push_back(name);
      return;
    }
  }
  throw PluginError(refusal(fmt::format("there is no {0}.so or lib{0}.so", name)));
}

}  // namespace hexaplast::scene
