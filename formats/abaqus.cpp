// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <unordered_map>

#include "exported_cells.hpp"
#include "mesh_source.hpp"

// Abaqus input decks, of which the nodes and elements of the first order are read: keyword lines begin with a star,
// data lines between them hold numbers separated by commas, and may go on after a comma at their end.

namespace hexaplast {
namespace {

constexpr std::int64_t kGreatestTag = 2'147'483'647;
// Keywords that bring in, copy or make nodes and elements.
constexpr std::array<std::string_view, 9> kNotRead = {"*INCLUDE", "*INSTANCE", "*SYSTEM", "*ELCOPY", "*ELGEN",
                                                      "*NCOPY",   "*NFILL",    "*NGEN",   "*NMAP"};

std::string upper(std::string_view text) {
  std::string raised;
  for (const char c : text)
    if (c != ' ' && c != '\t') raised += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return raised;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Types of elements that are cells of ours, by how their names begin.
struct CellType {
  std::string_view name;
  int vtk_kind;
  int num_nodes;
};
constexpr std::array kCellTypes = {
    CellType{"C3D8", 12, 8}, CellType{"S4", 9, 4},   CellType{"M3D4", 9, 4}, CellType{"R3D4", 9, 4},
    CellType{"CPS4", 9, 4},  CellType{"CPE4", 9, 4}, CellType{"CAX4", 9, 4}, CellType{"S3", 5, 3},
    CellType{"M3D3", 5, 3},  CellType{"R3D3", 5, 3}, CellType{"CPS3", 5, 3}, CellType{"CPE3", 5, 3},
    CellType{"T3D2", 3, 2},  CellType{"B31", 3, 2},
};

/// Null for a type that is skipped. Letters may follow the name of a type, as in C3D8R, but no digit.
const CellType* find_type(std::string_view name) {
  for (const CellType& type : kCellTypes)
    if (name.starts_with(type.name) &&
        (name.size() == type.name.size() || !std::isdigit(static_cast<unsigned char>(name[type.name.size()]))))
      return &type;
  return nullptr;
}

class AbaqusFile {
 public:
  AbaqusFile(std::string_view content, const std::string& name) : source_(content, name) {}

  ImportedMesh read() {
    while (!source_.at_end()) {
      const std::string_view line = trimmed(source_.line());
      if (line.empty() || line.starts_with("**")) continue;
      if (line.starts_with('*'))
        begin(upper(line));
      else if (section_ == Section::kNodes)
        add_node(line);
      else if (section_ == Section::kElements)
        add_element_data(line);
    }
    end_element();
    if (!has_nodes_) source_.refuse("the file ends without *NODE");
    if (!has_elements_) source_.refuse("the file ends without *ELEMENT");
    mesh_.positions =
        Eigen::Map<const PointArray>(coordinates_.data(), static_cast<Eigen::Index>(coordinates_.size() / 3), 3);
    merge_copies(mesh_);
    return std::move(mesh_);
  }

 private:
  enum class Section { kNodes, kElements, kOther };

  void begin(const std::string& keyword) {
    end_element();
    section_ = Section::kOther;
    const std::string name = keyword.substr(0, keyword.find(','));
    if (name == "*NODE") {
      if (keyword.find(",SYSTEM=") != keyword.npos && keyword.find(",SYSTEM=R") == keyword.npos)
        source_.refuse("nodes in a system of their own, must be rectangular coordinates");
      section_ = Section::kNodes;
      has_nodes_ = true;
    } else if (name == "*ELEMENT") {
      const std::size_t at = keyword.find(",TYPE=");
      if (at == keyword.npos) source_.refuse("*ELEMENT without TYPE");
      const std::string type = keyword.substr(at + 6, keyword.find(',', at + 1) - at - 6);
      type_ = find_type(type);
      type_name_ = fmt::format("elements of type {}", type.substr(0, 40));
      section_ = Section::kElements;
      has_elements_ = true;
    } else if (std::ranges::count(kNotRead, name) > 0) {
      source_.refuse(fmt::format("{} is not read: the deck must hold its nodes and elements as they are", name));
    }
  }

  void add_node(std::string_view line) {
    const std::vector<std::string_view> fields = split(line);
    if (fields.size() < 2 || fields.size() > 4)
      source_.refuse(
          fmt::format("{} numbers for a node, must be its number and up to three coordinates", fields.size()));
    const std::int64_t tag = tag_of(fields[0]);
    if (!number_of_.emplace(tag, static_cast<int>(coordinates_.size() / 3)).second)
      source_.refuse(fmt::format("a second node {}", tag));
    for (std::size_t d = 1; d < 4; ++d) {
      double x = 0;  // what is left out
      if (d < fields.size() && !read_number(fields[d], x))
        source_.refuse(fmt::format("'{}' is not a coordinate: must be a finite number", fields[d].substr(0, 40)));
      coordinates_.push_back(x);
    }
  }

  void add_element_data(std::string_view line) {
    const bool goes_on = line.ends_with(',');
    const std::vector<std::string_view> fields = split(line);
    if (!is_in_element_ && !type_) ++mesh_.skipped[type_name_];
    for (const std::string_view field : fields) {
      const std::int64_t tag = tag_of(field);
      if (!type_) continue;
      if (!is_in_element_) {
        is_in_element_ = true;  // its own number
        nodes_.clear();
        continue;
      }
      const auto found = number_of_.find(tag);
      if (found == number_of_.end()) source_.refuse(fmt::format("node {}, which is not among the nodes so far", tag));
      nodes_.push_back(found->second);
    }
    is_in_element_ = !fields.empty();
    if (!goes_on) end_element();
  }

  /// Takes the element whose data have been read.
  void end_element() {
    if (!std::exchange(is_in_element_, false) || !type_) return;
    if (static_cast<int>(nodes_.size()) != type_->num_nodes)
      source_.refuse(fmt::format("an element of {} nodes, {} has {}", nodes_.size(), type_->name, type_->num_nodes));
    add_vtk_cell(type_->vtk_kind, nodes_.data(), nodes_.size(), mesh_);
  }

  /// The fields of a data line; a comma at its end begins none.
  static std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> fields;
    while (!line.empty()) {
      const std::size_t comma = std::min(line.find(','), line.size());
      fields.push_back(trimmed(line.substr(0, comma)));
      line.remove_prefix(std::min(comma + 1, line.size()));
    }
    return fields;
  }

  std::int64_t tag_of(std::string_view field) const {
    std::int64_t tag = 0;
    if (!read_number(field, tag) || tag < 1 || tag > kGreatestTag)
      source_.refuse(fmt::format("'{}' is not the number of a node or element: must lie in [1, {}]",
                                 field.substr(0, 40), kGreatestTag));
    return tag;
  }

  MeshSource source_;
  ImportedMesh mesh_;
  std::vector<double> coordinates_;
  std::unordered_map<std::int64_t, int> number_of_;  // of the node with a tag
  Section section_ = Section::kOther;
  std::string type_name_;
  const CellType* type_ = nullptr;   // of the present elements; null: they are skipped
  std::vector<std::int64_t> nodes_;  // of the present element
  bool is_in_element_ = false;       // its data are not complete
  bool has_nodes_ = false, has_elements_ = false;
};

/// As many digits as fit into what CalculiX reads of a number.
std::string short_number(double value) {
  constexpr std::size_t kLongest = 20;
  std::string text = fmt::format("{}", value);
  for (int digits = 16; text.size() > kLongest; --digits) text = fmt::format("{:.{}g}", value, digits);
  return text;
}

}  // namespace

ImportedMesh parse_abaqus(std::string_view content, const std::string& name) {
  return AbaqusFile(content, name).read();
}

ImportedMesh read_abaqus(const std::filesystem::path& file) { return parse_abaqus(whole_file(file), file.string()); }

std::string abaqus_text(const ExportedMesh& mesh) {
  std::string text;
  text += fmt::format("*NODE, NSET=ALL\n");
  for (std::size_t n = 0; n < mesh.points.size() / 3; ++n)
    text += fmt::format("{}, {}, {}, {}\n", n + 1, short_number(mesh.points[3 * n]),
                        short_number(mesh.points[3 * n + 1]), short_number(mesh.points[3 * n + 2]));
  std::size_t number = 0;
  for_each_kind(mesh, [&](const auto& cells, std::uint8_t kind) {
    if (cells.empty()) return;
    const auto [type, set] = kind == kVtkLine       ? std::pair("T3D2", "EDGES")
                             : kind == kVtkTriangle ? std::pair("S3", "TRIANGLES")
                             : kind == kVtkQuad     ? std::pair("S4", "QUADS")
                                                    : std::pair("C3D8", "BODY");
    text += fmt::format("*ELEMENT, TYPE={}, ELSET={}\n", type, set);
    for (const auto& cell : cells) text += fmt::format("{}, {}\n", ++number, joined_from_1(cell, ", "));
  });
  return text;
}

}  // namespace hexaplast
