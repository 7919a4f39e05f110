// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scene/factory.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::scene {

/// A plugin that cannot be used. The message gives the reason and the search path.
class PluginError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Number of this component interface; grows with every change that a compiled plugin would notice.
inline constexpr std::uint32_t kInterfaceNumber = 20;

/// What a plugin and its host must agree on before one may call the other. Plain data without pointers: the host reads
/// it from the plugin's file, before any code of the plugin runs.
struct AbiTag {
  std::array<char, 16> magic = {};       ///< "hexaplast plugin"
  std::uint32_t tag_size = 0;            ///< [byte]
  std::uint32_t interface_number = 0;    ///< kInterfaceNumber
  std::uint32_t compiler_abi = 0;        ///< __GXX_ABI_VERSION
  std::uint32_t stdlib_abi = 0;          ///< _GLIBCXX_USE_CXX11_ABI
  std::uint32_t scalar_size = 0;         ///< [byte] of a nodal coordinate
  std::uint32_t eigen_alignment = 0;     ///< [byte] largest alignment of Eigen's fixed-size types
  std::array<std::uint32_t, 8> sizes{};  ///< [byte] of the types that cross the boundary

  bool operator==(const AbiTag&) const = default;
};

/// The tag of the code that is being compiled.
constexpr AbiTag abi_tag() {
  AbiTag tag;
  constexpr std::string_view kMagic = "hexaplast plugin";
  for (std::size_t i = 0; i < kMagic.size(); ++i) tag.magic[i] = kMagic[i];
  tag.tag_size = sizeof(AbiTag);
  tag.interface_number = kInterfaceNumber;
  tag.compiler_abi = __GXX_ABI_VERSION;
  tag.stdlib_abi = _GLIBCXX_USE_CXX11_ABI;
  tag.scalar_size = sizeof(PointArray::Scalar);
  tag.eigen_alignment = EIGEN_MAX_ALIGN_BYTES;
  tag.sizes = {sizeof(Object),
               sizeof(Component),
               sizeof(Node),
               sizeof(Data),
               sizeof(PointArray),
               sizeof(BlockMatrix),
               sizeof(attributes::Attribute),
               sizeof(attributes::Description)};
  return tag;
}

/// Finds plugins by name and adds their components to a factory. Loaded plugins stay until the program ends.
class PluginLoader {
 public:
  /// Directories are searched in order for lib<Name>.so, then <Name>.so, and `installation` last. What of the former
  /// lies below `untrusted`, by whatever path or link it is found, is refused: the directory of a run that a stranger
  /// may have made. The installation is trusted by whoever runs its program. Empty: there is none.
  PluginLoader(Factory& factory, std::vector<std::filesystem::path> directories,
               std::filesystem::path installation = {}, std::filesystem::path untrusted = {});

  /// Does nothing when the plugin is loaded already, or when the name begins with "Sofa.": those modules are SOFA's
  /// own, and what we have of them is built in. Throws PluginError: there is no such file in the search path, the name
  /// is a path, the file is no plugin or made for another interface.
  void load(const std::string& name);

 private:
  Factory& factory_;
  std::vector<std::filesystem::path> directories_;
  std::filesystem::path installation_, untrusted_;
  std::vector<std::string> loaded_;
};

}  // namespace hexaplast::scene

/// Once per plugin: `HEXAPLAST_PLUGIN(factory) { factory.add<MyForce>(kMyForce); }`
#define HEXAPLAST_PLUGIN(factory)                                                                            \
  extern "C" __attribute__((visibility("default"))) const hexaplast::scene::AbiTag hexaplast_plugin_abi_tag; \
  constexpr hexaplast::scene::AbiTag hexaplast_plugin_abi_tag = hexaplast::scene::abi_tag();                 \
  extern "C" __attribute__((visibility("default"))) void hexaplast_register_components(                      \
      [[maybe_unused]] hexaplast::scene::Factory& factory)
