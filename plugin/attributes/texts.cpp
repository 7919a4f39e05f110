// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/texts.hpp"

#include "attributes/files.hpp"
#include "attributes/words.hpp"

namespace hexaplast::attributes {
namespace {

/// What stands in the file behind each line that is a comment of one word.
std::vector<Example> sections_of(std::string_view file) {
  constexpr std::string_view kBegin = "\n<!-- ", kEnd = " -->\n";
  std::vector<Example> all;
  for (std::size_t at = file.find(kBegin); at != file.npos;) {
    const std::size_t name = at + kBegin.size(), end = file.find(kEnd, name);
    at = file.find(kBegin, end);
    const std::size_t lines = end + kEnd.size();
    all.push_back({file.substr(name, end - name), file.substr(lines, std::min(at, file.size() - 1) - lines)});
  }
  return all;
}

const std::vector<Example>& sections() {
  static const std::vector<Example> all = sections_of(kExamplesFile);
  return all;
}

}  // namespace

std::string_view example_scene() { return sections().front().lines; }

const std::vector<Example>& examples() {
  static const std::vector<Example> all(sections().begin() + 1, sections().end());
  return all;
}

const std::multimap<std::string_view, std::string_view>& gone() {
  static const std::multimap<std::string_view, std::string_view> all = [] {
    std::multimap<std::string_view, std::string_view> found;
    std::string_view instead;
    for (std::string_view rest = kGoneFile; !rest.empty();) {
      const std::string_view line = rest.substr(0, rest.find('\n'));
      rest.remove_prefix(line.size() + 1);
      if (line.starts_with(' '))
        for_each_word(line, [&](std::string_view name) { found.emplace(name, instead); });
      else
        instead = line;
    }
    return found;
  }();
  return all;
}

std::string_view instead_of(std::string_view name) {
  const auto found = gone().find(name);
  return found == gone().end() ? std::string_view() : found->second;
}

}  // namespace hexaplast::attributes
