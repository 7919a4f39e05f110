// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mesh_source.hpp"

// Gmsh's file format, as its reference manual describes it: sections between $Name and $EndName; nodes carry tags of
// any value, by which elements name them. Numbers are text or binary, in the words of each version.

namespace hexaplast {
namespace {

constexpr std::int64_t kMaxNodes = std::numeric_limits<int>::max();

/// Nodes of each element type of Gmsh; 0: no such type.
constexpr std::array<int, 32> kNodesOfType{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                           8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};

/// In VTK's numbering; 0: it has none.
constexpr std::array<int, 20> kVtkKinds{0, 3, 5, 9, 10, 12, 13, 14, 21, 22, 28, 24, 29, 32, 0, 1, 23, 25, 26, 27};

int vtk_kind(std::int64_t type) {
  return type < static_cast<std::int64_t>(kVtkKinds.size()) ? kVtkKinds[static_cast<std::size_t>(type)] : 0;
}

class GmshFile {
 public:
  GmshFile(std::string_view content, const std::string& name) : source_(content, name) {}

  ImportedMesh read() {
    read_format();
    while (true) {
      const std::string_view section = source_.word();
      if (section.empty()) break;
      if (section == "$Nodes")
        is_version_4_ ? read_nodes_4() : read_nodes_2();
      else if (section == "$Elements")
        is_version_4_ ? read_elements_4() : read_elements_2();
      else if (section == "$PhysicalNames")
        read_group_names();
      else if (is_version_4_ && section == "$Entities")
        read_entities();
      else if (section == "$ParametricNodes")
        source_.refuse(
            "$ParametricNodes are not read: must be $Nodes, as Gmsh saves them with Mesh.SaveParametric = 0");
      else if (section.starts_with('$'))
        source_.skip_past_line("$End" + std::string(section.substr(1)));
      else
        source_.refuse("something stands between two sections, must be $Name");
    }
    if (!has_nodes_) source_.refuse("the file ends without $Nodes");
    if (!has_elements_) source_.refuse("the file ends without $Elements");
    add_groups(merge_copies(mesh_));
    return std::move(mesh_);
  }

 private:
  void read_format() {
    source_.expect("$MeshFormat");
    const std::string version(source_.word());
    is_version_4_ = version == "4.1";
    if (!is_version_4_ && version != "2" && version != "2.0" && version != "2.1" && version != "2.2")
      source_.refuse(fmt::format("version '{}' of the format, must be 2.0 to 2.2 or 4.1", excerpt(version)));
    source_.is_binary = source_.integer("the file type", 0, 1) == 1;
    source_.integer("the size of numbers", 8, 8);
    source_.line();
    if (source_.is_binary) {
      const auto one = source_.binary<std::int32_t>();
      source_.swaps_bytes = one != 1;
      if (one != 1 && one != 0x01000000) source_.refuse_at_byte("neither byte order gives the 1 that must stand here");
    }
    source_.expect("$EndMeshFormat");
    source_.line();
  }

  // Version 2
  // -----------------------------------------------------------------------------------------------------------------

  void read_nodes_2() {
    const std::size_t count = begin_nodes(source_.count("the number of nodes", source_.is_binary ? 28 : 8));
    source_.line();
    for (std::size_t n = 0; n < count; ++n) {
      add_tag(source_.number(kInt32, "a node"), n);
      read_position(n, 0);
    }
    source_.expect("$EndNodes");
  }

  void read_elements_2() {
    begin_elements();
    const std::size_t count = source_.count("the number of elements", source_.is_binary ? 8 : 6);
    source_.line();
    for (std::size_t e = 0; e < count;) {
      if (source_.is_binary) {
        const auto type = source_.binary<std::int32_t>(), in_block = source_.binary<std::int32_t>(),
                   num_tags = source_.binary<std::int32_t>();
        require_type(type);
        if (in_block < 1 || static_cast<std::size_t>(in_block) > count - e)
          refuse_block(in_block, "elements", count - e);
        if (num_tags < 0) source_.refuse_at_byte(fmt::format("{} tags, must be at least 0", num_tags));
        source_.checked_count(static_cast<std::uint64_t>(num_tags) + 1, "the number of tags", 4);
        for (int i = 0; i < in_block; ++i, ++e) {
          source_.number(kInt32, "an element");
          add_element_2(type, num_tags);
        }
      } else {
        source_.number(kInt32, "an element");
        const std::int64_t type = source_.integer("an element type", 1, kMaxNodes);
        add_element_2(type, source_.integer("the number of tags", 0, kMaxNodes));
        ++e;
      }
    }
    source_.expect("$EndElements");
  }

  /// From its tags on, of which the first is its group.
  void add_element_2(std::int64_t type, std::int64_t num_tags) {
    require_type(type);
    std::int64_t group = 0;
    for (std::int64_t t = 0; t < num_tags; ++t)
      if (const std::int64_t tag = source_.number(kInt32, "a tag"); t == 0) group = tag;
    add_element(type, {&group, 1}, kInt32, "a node");
  }

  // Version 4
  // -----------------------------------------------------------------------------------------------------------------

  void read_nodes_4() {
    if (source_.is_binary) source_.line();  // data begin on the line after the section's name
    const std::size_t num_blocks = count("the number of blocks", source_.is_binary ? 20 : 8);
    const std::size_t num_nodes = begin_nodes(count("the number of nodes", source_.is_binary ? 32 : 8));
    for (int i = 0; i < 2; ++i) source_.number(kInt64, "a node tag");  // smallest and greatest
    std::size_t n = 0;
    for (std::size_t block = 0; block < num_blocks; ++block) {
      const std::int64_t dimension = source_.number(kInt32, "a dimension", 0, 3);
      any_int("an entity");
      const bool has_parameters = source_.number(kInt32, "whether there are parameters", 0, 1) == 1;
      const std::size_t in_block = count("the number of nodes of a block", source_.is_binary ? 32 : 8);
      if (in_block > num_nodes - n) refuse_block(in_block, "nodes", num_nodes - n);
      for (std::size_t i = 0; i < in_block; ++i) add_tag(source_.number(kInt64, "a node tag"), n + i);
      for (std::size_t i = 0; i < in_block; ++i) read_position(n + i, has_parameters ? dimension : 0);
      n += in_block;
    }
    if (n != num_nodes) source_.refuse_data(fmt::format("{} nodes in the blocks, there must be {}", n, num_nodes));
    source_.expect("$EndNodes");
  }

  void read_elements_4() {
    begin_elements();
    if (source_.is_binary) source_.line();
    const std::size_t num_blocks = count("the number of blocks", source_.is_binary ? 20 : 8);
    const std::size_t num_elements = count("the number of elements", source_.is_binary ? 16 : 4);
    for (int i = 0; i < 2; ++i) source_.number(kInt64, "an element tag");
    std::size_t e = 0;
    for (std::size_t block = 0; block < num_blocks; ++block) {
      const std::int64_t dimension = source_.number(kInt32, "a dimension", 0, 3);
      const std::int64_t entity = any_int("an entity");
      const std::vector<std::int64_t>& groups = groups_of_volume_[dimension == 3 ? entity : kNoVolume];
      const std::int64_t type = source_.number(kInt32, "an element type", 1, std::numeric_limits<int>::max());
      require_type(type);
      const std::size_t in_block = count("the number of elements of a block", source_.is_binary ? 16 : 4);
      if (in_block > num_elements - e) refuse_block(in_block, "elements", num_elements - e);
      for (std::size_t i = 0; i < in_block; ++i) {
        source_.number(kInt64, "an element tag");
        add_element(type, groups, kInt64, "a node tag");
      }
      e += in_block;
    }
    if (e != num_elements)
      source_.refuse_data(fmt::format("{} elements in the blocks, there must be {}", e, num_elements));
    source_.expect("$EndElements");
  }

  /// Version 4 writes sizes and tags as 64 bits, the rest as 32.
  std::size_t count(const char* what, std::size_t bytes) {
    if (!source_.is_binary) return source_.count(what, bytes);
    return source_.checked_count(source_.binary<std::uint64_t>(), what, bytes);
  }
  std::int64_t any_int(const char* what) {
    return source_.number(kInt32, what, std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
  }

  /// Of which only the groups of volumes matter.
  void read_entities() {
    if (source_.is_binary) source_.line();
    std::array<std::size_t, 4> counts;  // by dimension
    for (std::size_t& size : counts) size = count("the number of entities", source_.is_binary ? 36 : 8);
    for (std::size_t dimension = 0; dimension < counts.size(); ++dimension)
      for (std::size_t i = 0; i < counts[dimension]; ++i) {
        const std::int64_t entity = any_int("an entity");
        for (int d = 0; d < (dimension == 0 ? 3 : 6); ++d) real("a coordinate");
        for (std::size_t left = count("the number of groups", source_.is_binary ? 4 : 2); left > 0; --left) {
          const std::int64_t group = any_int("a group");
          if (dimension == 3) groups_of_volume_[entity].push_back(group);
        }
        if (dimension == 0) continue;
        for (std::size_t left = count("the number of boundaries", source_.is_binary ? 4 : 2); left > 0; --left)
          any_int("a boundary");
      }
    source_.expect("$EndEntities");
  }

  // Both
  // -----------------------------------------------------------------------------------------------------------------

  [[noreturn]] void refuse_block(auto size, const char* what, std::size_t left) const {
    source_.refuse_data(fmt::format("a block of {} {}, there are {} left", size, what, left));
  }

  double real(const char* what) { return source_.is_binary ? source_.binary<double>() : source_.real(what); }

  std::size_t begin_nodes(std::size_t count) {
    if (std::exchange(has_nodes_, true)) source_.refuse_data("a second $Nodes, there must be one");
    if (count > static_cast<std::size_t>(kMaxNodes))
      source_.refuse_data(fmt::format("{} nodes, must be at most {}", count, kMaxNodes));
    mesh_.positions.resize(static_cast<Eigen::Index>(count), 3);
    number_of_.reserve(count);
    return count;
  }

  void begin_elements() {
    if (std::exchange(has_elements_, true)) source_.refuse("a second $Elements, there must be one");
  }

  void add_tag(std::int64_t node, std::size_t n) {
    if (!number_of_.emplace(node, static_cast<int>(n)).second)
      source_.refuse_data(fmt::format("a second node {}", node));
  }

  void read_position(std::size_t n, std::int64_t num_parameters) {
    for (int d = 0; d < 3; ++d) {
      const double x = real("a coordinate");
      if (!std::isfinite(x)) source_.refuse_data(fmt::format("{} is not a coordinate: must be a finite number", x));
      mesh_.positions(static_cast<Eigen::Index>(n), d) = x;
    }
    for (std::int64_t i = 0; i < num_parameters; ++i) real("a parameter");
  }

  void require_type(std::int64_t type) const {
    const bool is_known = type > 0 && type < static_cast<std::int64_t>(kNodesOfType.size());
    if (!is_known)
      source_.refuse_data(fmt::format("element type {}, must lie in [1, {}]", type, kNodesOfType.size() - 1));
  }

  /// Text in binary files too.
  void read_group_names() {
    const std::size_t count = source_.count("the number of names", 5);
    source_.line();
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t dimension = source_.integer("a dimension", 0, 3), group = source_.integer("a group");
      const std::string_view rest = source_.line();
      const std::size_t begin = rest.find('"'), end = rest.rfind('"');
      if (begin == end) source_.refuse("a group without a name, must have one in quotes");
      if (dimension == 3) name_of_[group] = rest.substr(begin + 1, end - begin - 1);
    }
    source_.expect("$EndPhysicalNames");
  }

  /// number: of each hexahedron, now that copies are merged.
  void add_groups(const std::vector<int>& number) {
    for (auto& [group, hexahedra] : hexahedra_of_) {
      for (int& e : hexahedra) e = number[e];
      std::ranges::sort(hexahedra);
      hexahedra.erase(std::unique(hexahedra.begin(), hexahedra.end()), hexahedra.end());
    }
    for (auto& [group, name] : name_of_) mesh_.groups.push_back({std::move(name), std::move(hexahedra_of_[group])});
    for (auto& [group, hexahedra] : hexahedra_of_)
      if (!name_of_.contains(group)) mesh_.groups.push_back({std::to_string(group), std::move(hexahedra)});
  }

  /// groups: that it belongs to; 0 is none, and a sign tells of a direction.
  void add_element(std::int64_t type, std::span<const std::int64_t> groups, const NumberType& tags, const char* what) {
    const int num_nodes = kNodesOfType[static_cast<std::size_t>(type)];
    std::array<std::int64_t, 64> nodes;
    for (int a = 0; a < num_nodes; ++a) {
      const std::int64_t node = source_.number(tags, what);
      const auto found = number_of_.find(node);
      if (found == number_of_.end()) source_.refuse_data(fmt::format("node {}, which is not among the nodes", node));
      nodes[a] = found->second;
    }
    const std::size_t num_hexahedra = mesh_.hexahedra.size();
    if (vtk_kind(type) == 0) {
      ++mesh_.skipped["cells of higher order"];
      return;
    }
    add_vtk_cell(vtk_kind(type), nodes.data(), static_cast<std::size_t>(num_nodes), mesh_);
    if (mesh_.hexahedra.size() == num_hexahedra) return;
    for (const std::int64_t group : groups)
      if (group != 0 && group != std::numeric_limits<std::int64_t>::min())
        hexahedra_of_[std::abs(group)].push_back(static_cast<int>(num_hexahedra));
  }

  MeshSource source_;
  ImportedMesh mesh_;
  std::unordered_map<std::int64_t, int> number_of_;  // of the node with a tag
  bool is_version_4_ = false;
  bool has_nodes_ = false, has_elements_ = false;

  static constexpr std::int64_t kNoVolume = std::numeric_limits<std::int64_t>::max();
  std::map<std::int64_t, std::string> name_of_;                                   // of groups of volumes
  std::unordered_map<std::int64_t, std::vector<std::int64_t>> groups_of_volume_;  // in version 4
  std::map<std::int64_t, std::vector<int>> hexahedra_of_;                         // of groups
};

}  // namespace

ImportedMesh parse_gmsh(std::string_view content, const std::string& name) { return GmshFile(content, name).read(); }

}  // namespace hexaplast
