// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <list>
#include <string>

#include "hexaplast/material/rows.hpp"

namespace hexaplast::attributes {
namespace {

/// Keeps a text for as long as the program runs: tables of attributes refer to theirs.
std::string_view kept(std::string text) {
  static std::list<std::string> all;
  return all.emplace_back(std::move(text));
}

/// The default as scenes write it; where it is infinite, there is none.
template <class Options>
std::string initial_text(const Row<Options>& row) {
  if (row.at.list) return "";
  const double value = row.at.get(Options{});
  if (row.at.type == MemberType::kWord) return std::string(row.words[static_cast<std::size_t>(value)]);
  return row.may_be_infinite() ? "" : fmt::format("{}", value);
}

/// Says after the first sentence that there may be a value for each hexahedron.
std::string help_of_list(std::string_view help) {
  const std::size_t end = std::min(help.find(". "), help.size() - 1);
  return fmt::format("{}: one value, or one per hexahedron{}", help.substr(0, end), help.substr(end));
}

/// Without the last sentence where that tells of a body that has no value.
std::string_view help_of_given(std::string_view help) { return help.substr(0, help.find(" Without it ")); }

template <class Options>
Attribute attribute_of(const Row<Options>& row) {
  const Type type = row.at.type == MemberType::kWord      ? Type::kWord
                    : row.at.type == MemberType::kInteger ? Type::kInteger
                    : row.may_vary || row.at.list         ? Type::kReals
                                                          : Type::kReal;
  return {.name = row.name,
          .type = type,
          .initial = kept(initial_text(row)),
          .unit = row.unit,
          .range = row.range,
          .words = kept(fmt::format("{}", fmt::join(row.words, " "))),
          .help = row.may_vary ? kept(help_of_list(row.help)) : row.help,
          .group = row.group};
}

template <class Options>
void add_group(std::string_view group, std::span<const Row<Options>> rows, std::vector<Attribute>& all) {
  for (const Row<Options>& row : rows)
    if (row.group == group) all.push_back(attribute_of(row));
}

}  // namespace

std::span<const Attribute> body_attributes() {
  static const std::vector<Attribute> all = [] {
    std::vector<Attribute> found;
    for (const std::string_view group : kBodyGroups) {
      add_group(group, material_rows(), found);
      add_group(group, settings_rows(), found);
    }
    return found;
  }();
  return all;
}

std::span<const Attribute> region_attributes() {
  static const std::vector<Attribute> all = [] {
    std::vector<Attribute> found;
    for (const std::string_view group : kBodyGroups) add_group(group, material_rows(), found);
    for (Attribute& attribute : found) {
      const Row<Material>& row = *find_row(material_rows(), attribute.name, Names::kScenes);
      const std::string_view help = help_of_given(row.help);
      attribute.initial = {};
      attribute.help = row.may_vary ? kept(help_of_list(help)) : help;
    }
    return found;
  }();
  return all;
}

std::vector<Attribute> joined(std::span<const Attribute> first, std::span<const Attribute> then) {
  std::vector<Attribute> all(first.begin(), first.end());
  all.insert(all.end(), then.begin(), then.end());
  return all;
}

}  // namespace hexaplast::attributes
