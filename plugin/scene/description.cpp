// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/description.hpp"

#include <sstream>
#include <vector>

#include "formats/readable_file.hpp"
#include "formats/xml.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast::scene {
namespace {

constexpr std::size_t kLongestHeading = 100, kLongestParagraph = 1000;  // [bytes]

/// With single blanks between words.
std::vector<std::string> paragraphs_of(const std::string& text) {
  std::vector<std::string> paragraphs(1);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    bool is_empty = true;
    for (std::string word; words >> word; is_empty = false)
      paragraphs.back() += (paragraphs.back().empty() ? "" : " ") + word;
    if (is_empty && !paragraphs.back().empty()) paragraphs.emplace_back();
  }
  return paragraphs;
}

}  // namespace

std::optional<Description> description_of(const std::filesystem::path& file) {
  std::string comment;
  try {
    comment = parse_xml(whole_file(file)).comment;
  } catch (const InputError&) {
    return std::nullopt;
  }
  const std::vector<std::string> paragraphs = paragraphs_of(comment);
  if (paragraphs.size() < 2 || paragraphs[1].empty() || paragraphs[0].size() > kLongestHeading ||
      paragraphs[1].size() > kLongestParagraph)
    return std::nullopt;
  return Description{paragraphs[0], paragraphs[1]};
}

}  // namespace hexaplast::scene
