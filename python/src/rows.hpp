// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "hexaplast/material/rows.hpp"

/// Members of the library's structs in the words of Python, for the module and for its type stubs.
namespace hexaplast::python {

/// "float", "int", "list[float]", 'Literal["double", "mixed"]'
template <class Options>
std::string python_type(const Row<Options>& row) {
  if (row.at.type == MemberType::kReal) return "float";
  if (row.at.type == MemberType::kInteger) return "int";
  if (row.at.type == MemberType::kReals) return "list[float]";
  return fmt::format("Literal[\"{}\"]", fmt::join(row.words, "\", \""));
}

/// A member as Python prints it.
template <class Options>
std::string python_text(const Row<Options>& row, const Options& options, char quote = '\'') {
  if (row.at.list) return fmt::format("[{}]", fmt::join(row.values(options), ", "));
  const double value = row.at.get(options);
  if (row.at.type != MemberType::kWord) return fmt::format("{}", value);
  return fmt::format("{0}{1}{0}", quote, row.words[static_cast<std::size_t>(value)]);
}

/// "young_modulus: float = 5000": the keywords of the constructor. Infinity has no literal, and is `...` in stubs.
template <class Options>
std::vector<std::string> keywords(std::span<const Row<Options>> rows) {
  std::vector<std::string> all;
  for (const Row<Options>& row : rows)
    all.push_back(fmt::format("{}: {} = {}", row.member, python_type(row),
                              row.may_be_infinite() ? "..." : python_text(row, Options{}, '"')));
  return all;
}

}  // namespace hexaplast::python
