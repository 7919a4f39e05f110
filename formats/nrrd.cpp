// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "hexaplast/base/error.hpp"
#include "volume_source.hpp"

// NRRD: a magic word, lines "field: value" and "key:=value", an empty line, and the data.

namespace hexaplast {
namespace {

std::map<std::string, NumberType> nrrd_types() {
  std::map<std::string, NumberType> types;
  const auto add = [&](const NumberType& type, std::initializer_list<const char*> names) {
    for (const char* name : names) types[name] = type;
  };
  add({1, true}, {"signed char", "int8", "int8_t"});
  add({1, false}, {"uchar", "unsigned char", "uint8", "uint8_t"});
  add({2, true}, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"});
  add({2, false}, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"});
  add({4, true}, {"int", "signed int", "int32", "int32_t"});
  add({4, false}, {"uint", "unsigned int", "uint32", "uint32_t"});
  add({8, true},
      {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"});
  add({8, false}, {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"});
  add({4, true, true}, {"float"});
  add({8, true, true}, {"double"});
  return types;
}

/// A space of patients, as the signs by which its coordinates become LPS, or one that names no patient.
struct NrrdSpace {
  Vec3 signs = Vec3::Ones();
  bool is_of_patient = true;
};

// Fields that do not change what a label is or where it lies.
constexpr std::string_view kWithoutEffect[] = {
    "content", "number", "sample units", "min",    "max",     "old min",    "oldmin",
    "old max", "oldmax", "thicknesses",  "labels", "centers", "centerings", "measurement frame"};

constexpr std::string_view kNrrdFields[] = {
    "type",         "dimension",   "sizes",    "encoding", "endian", "space",     "space dimension", "space directions",
    "space origin", "space units", "spacings", "units",    "kinds",  "data file", "datafile",        "byte skip",
    "byteskip",     "line skip",   "lineskip"};

class NrrdFile {
 public:
  NrrdFile(std::string_view content, const std::string& name) : name_(name), header_(content, name) {}

  ImportedVolume read(const ReadBeside& beside, const VoxelCells& planned) {
    read_header();
    require_one_layer();
    for (const char* skip : {"byte skip", "byteskip", "line skip", "lineskip"}) header_.expect(skip, "0");

    NumberType type = header_.one_of("type", nrrd_types());
    if (type.bytes > 1) {
      header_.value("endian");
      type.swaps_bytes = header_.one_of<std::endian>("endian", {{"little", std::endian::little},
                                                                {"big", std::endian::big}}) != std::endian::native;
    }
    const bool is_compressed = header_.one_of<bool>("encoding", {{"raw", false}, {"gzip", true}, {"gz", true}});
    const NrrdSpace space = read_space();

    std::string data;
    const std::string file_field = header_.find("datafile") ? "datafile" : "data file";
    const bool is_detached = header_.find(file_field) != nullptr;
    if (is_detached) data = header_.data_beside(file_field, beside);
    ByteSource source(is_detached ? data : header_.rest(), is_compressed, name_);
    std::map<int, std::string> label_names = names();
    ImportedVolume found{.volume = read_voxels(geometry_, type, source, name_, planned),
                         .has_frame = space.is_of_patient};
    found.volume.names = std::move(label_names);
    return found;
  }

 private:
  void read_header() {
    std::string_view text;
    header_.next_line(text);
    if (text.size() != 8 || !text.starts_with("NRRD000") || text[7] < '1' || text[7] > '5')
      header_.refuse_line("the file must begin with NRRD0001 to NRRD0005");
    while (header_.next_line(text)) {
      if (text.empty()) return;
      if (!text.starts_with('#')) add(text);
    }
    if (!header_.find("data file") && !header_.find("datafile"))
      header_.refuse_line("the file ends in its header: an empty line and the data must follow");
  }

  void add(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == text.npos)
      header_.refuse_line("must be 'field: value', 'key:=value', or a comment that begins with #");
    const std::string field(without_blanks(text.substr(0, colon)));
    if (text.substr(colon).starts_with(":=")) {
      if (field.starts_with("Segment")) header_.add(field, without_blanks(text.substr(colon + 2)));
      return;
    }
    const std::string known = in_small_letters(field);
    header_.add(field, without_blanks(text.substr(colon + 1)));
    if (std::ranges::count(kNrrdFields, known) == 0 && std::ranges::count(kWithoutEffect, known) == 0)
      header_.refuse(field, "this field is not known, or not read");
  }

  void require_one_layer() {
    if (header_.value("dimension") == "4")
      header_.refuse(
          "dimension",
          "must be 3; segments that overlap lie in several layers (4): remove the overlap, or save a labelmap");
    header_.expect("dimension", "3");
    header_.expect("space dimension", "3");
    geometry_.size = header_.size("sizes");
    if (header_.find("kinds"))
      for (const std::string_view kind : header_.words("kinds"))
        if (kind != "domain" && kind != "space" && kind != "???")
          header_.refuse("kinds", "must be domain or space each");
  }

  /// Size, axes and origin [mm], in LPS where the file knows a patient.
  NrrdSpace read_space() {
    NrrdSpace space{Vec3::Ones(), false};
    if (header_.find("space"))
      space = header_.one_of<NrrdSpace>("space", {{"left-posterior-superior", {}},
                                                  {"lps", {}},
                                                  {"right-anterior-superior", {Vec3(-1, -1, 1)}},
                                                  {"ras", {Vec3(-1, -1, 1)}},
                                                  {"left-anterior-superior", {Vec3(1, -1, 1)}},
                                                  {"las", {Vec3(1, -1, 1)}},
                                                  {"scanner-xyz", {Vec3::Ones(), false}},
                                                  {"3d-right-handed", {Vec3::Ones(), false}}});
    if (header_.find("space directions")) {
      if (!header_.find("space") && !header_.find("space dimension"))
        header_.refuse("space directions", "'space' must be given too");
      geometry_.axes_field = "space directions";
      const std::vector<Vec3> axes = vectors("space directions", 3);
      for (int d = 0; d < 3; ++d) geometry_.axes.col(d) = axes[static_cast<std::size_t>(d)];
      if (header_.find("space origin")) geometry_.origin = vectors("space origin", 1).front();
    } else if (header_.find("spacings")) {
      geometry_.axes = header_.spacing("spacings").asDiagonal();
      geometry_.axes_field = "spacings";
      if (header_.find("space origin")) header_.refuse("space origin", "'space directions' must be given too");
    } else {
      header_.refuse("space directions", "must be given, or 'spacings'");
    }
    for (const char* field : {"space units", "units"})
      if (header_.find(field)) scale(millimetres(field));
    flip(geometry_, space.signs);
    return space;
  }

  void scale(double millimetres) {
    geometry_.axes *= millimetres;
    geometry_.origin *= millimetres;
  }

  /// What '"mm" "mm" "mm"' stands for.
  double millimetres(const std::string& field) const {
    const std::vector<std::string_view> words = header_.words(field);
    const std::string_view first = words.empty() ? std::string_view() : words.front();
    const bool is_quoted = first.size() > 2 && first.starts_with('"') && first.ends_with('"');
    static const std::map<std::string_view, double> kUnits{{"mm", 1},    {"millimeter", 1}, {"cm", 10},  {"m", 1000},
                                                           {"um", 1e-3}, {"micron", 1e-3},  {"nm", 1e-6}};
    const auto found = kUnits.find(is_quoted ? first.substr(1, first.size() - 2) : first);
    if (words.size() != 3 || words[1] != first || words[2] != first || found == kUnits.end())
      header_.refuse(field, "must be three times the same of \"mm\", \"cm\", \"m\", \"um\", \"micron\" and \"nm\"");
    return found->second;
  }

  /// "(1,0,0) (0,1,0)"
  std::vector<Vec3> vectors(const std::string& field, std::size_t count) const {
    const std::string what =
        fmt::format("must be {} vector{} of three finite numbers, as (1,0,0)", count, count == 1 ? "" : "s");
    std::string text = header_.value(field);
    std::vector<Vec3> found;
    for (std::size_t at = 0; (at = text.find_first_not_of(' ', at)) != text.npos;) {
      const std::size_t end = text.find(')', at);
      if (text[at] != '(' || end == text.npos || found.size() == count) header_.refuse(field, what);
      std::string_view rest = std::string_view(text).substr(at + 1, end - at - 1);
      Vec3& vector = found.emplace_back();
      for (int d = 0; d < 3; ++d) {
        const std::size_t comma = rest.find(',');
        if ((comma == rest.npos) != (d == 2) || !read_number(without_blanks(rest.substr(0, comma)), vector[d]))
          header_.refuse(field, what);
        rest.remove_prefix(d == 2 ? rest.size() : comma + 1);
      }
      at = end + 1;
    }
    if (found.size() != count) header_.refuse(field, what);
    return found;
  }

  /// Of the labels, as 3D Slicer writes them.
  std::map<int, std::string> names() const {
    std::map<int, std::string> names;
    for (int s = 0;; ++s) {
      const std::string segment = fmt::format("Segment{}_", s);
      const std::string *name = header_.find(segment + "Name"), *label = header_.find(segment + "LabelValue");
      if (!name && !label) return names;
      header_.expect(segment + "Layer", "0");
      if (!name || !label) continue;
      std::int64_t value = 0;
      if (!read_number(*label, value) || value != static_cast<int>(value))
        header_.refuse(segment + "LabelValue", "must be a whole number");
      if (!names.try_emplace(static_cast<int>(value), *name).second)
        header_.refuse(segment + "LabelValue", "belongs to another segment, too");
    }
  }

  std::string name_;
  TextHeader header_;
  VolumeGeometry geometry_;
};

}  // namespace

ImportedVolume parse_nrrd(std::string_view content, const std::string& name, const ReadBeside& beside,
                          const VoxelCells& planned) {
  return NrrdFile(content, name).read(beside, planned);
}

}  // namespace hexaplast
