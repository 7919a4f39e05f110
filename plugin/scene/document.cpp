// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "formats/readable_file.hpp"
#include "formats/xml.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast::scene {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_file(const Place& file, int line, const std::string& what) {
  Place place = file;
  place.line = line;
  throw SceneError(format_error(place, what));
}

constexpr XmlLimits kXmlOfScenes{.elements = 10'000, .attributes = 100'000};

/// Parses files and carries out their includes.
class Importer {
 public:
  Importer(Diagnostics& diagnostics, InputFiles* inputs, const SearchPath& search)
      : diagnostics_(diagnostics), inputs_(inputs), search_(search) {}

  /// `origin`: the file as messages name it, and where it is included.
  Element import(std::string_view text, const fs::path& file, const Place& origin) {
    XmlDocument document;
    try {
      document = parse_xml(text, kXmlOfScenes);
    } catch (const XmlError& error) {
      refuse_file(origin, error.line(), error.what());
    }
    open_files_.push_back({origin, fs::weakly_canonical(file)});
    Element element = convert(document.root);
    open_files_.pop_back();
    return element;
  }

 private:
  struct OpenFile {
    Place origin;
    fs::path canonical;
  };

  Place place(int line) const {
    Place here = open_files_.back().origin;
    here.line = line;
    return here;
  }

  Element convert(XmlElement& from) {
    if (++num_elements_ > kXmlOfScenes.elements)
      refuse_file(open_files_.back().origin, from.line,
                  fmt::format("more than {} elements with those of included files", kXmlOfScenes.elements));
    Element element{.tag = std::move(from.name), .place = place(from.line), .attributes = {}, .children = {}};
    for (XmlAttribute& attribute : from.attributes)
      element.attributes.push_back({std::move(attribute.name), std::move(attribute.value), place(attribute.line)});
    if (from.text_line > 0) element.text = place(from.text_line);
    for (XmlElement& child : from.children) {
      Element converted = convert(child);
      if (converted.tag == "include")
        include(converted, element);
      else
        element.children.push_back(std::move(converted));
    }
    return element;
  }

  void include(const Element& directive, Element& into) {
    const auto refuse = [&](const Place& at, const std::string& what) {
      diagnostics_.error(at, "include.href: " + what);
    };
    const ElementAttribute *href = directive.find("href"), *name = directive.find("name");
    if (!href || href->value.empty()) return refuse(directive.place, "is not given, must be a file");
    for (const ElementAttribute& given : directive.attributes)
      if (&given != href && &given != name)
        diagnostics_.error(given.place, fmt::format("include.{}: unknown attribute, must be href or name", given.name));
    if (!directive.children.empty() || directive.text)
      diagnostics_.error(directive.place, "include: holds elements or text, must be empty");

    const fs::path folder = open_files_.back().canonical.parent_path();
    const fs::path file = search_.find(href->value, folder).lexically_normal();
    const fs::path canonical = fs::weakly_canonical(file);
    const auto is_same = [&](const OpenFile& open) { return open.canonical == canonical; };
    if (std::ranges::any_of(open_files_, is_same))
      return refuse(href->place, fmt::format("'{}' includes itself", href->value));
    if (open_files_.size() > kMaxIncludeLevels)
      return refuse(href->place, fmt::format("more than {} levels of includes", kMaxIncludeLevels));
    if (++num_includes_ > kMaxIncludes) {
      if (num_includes_ == kMaxIncludes + 1) refuse(href->place, fmt::format("more than {} includes", kMaxIncludes));
      return;
    }

    std::string text;
    try {
      text = read_scene_file(file);
    } catch (const InputError& error) {
      diagnostics_.error(href->place, fmt::format("include.href: '{}': {}", href->value, error.what()),
                         search_.places_of(href->value));
      return;
    }
    if (inputs_) inputs_->add(file);
    num_bytes_ += text.size();
    if (num_bytes_ > kLargestSceneFile)
      refuse_file(href->place, href->place.line,
                  fmt::format("include.href: more than {} bytes are included", kLargestSceneFile));

    const bool is_beside = file == (folder / href->value).lexically_normal();
    const fs::path shown = is_beside ? fs::path(open_files_.back().origin.file).parent_path() / href->value : file;
    Element root = import(text, file, {shown.string(), 0, std::make_shared<const Place>(href->place)});
    const ElementAttribute* own_name = root.find("name");
    if (name) {
      std::erase_if(root.attributes, [](const ElementAttribute& own) { return own.name == "name"; });
      root.attributes.push_back(*name);
    } else if (own_name && own_name->value == "Group") {
      std::ranges::move(root.children, std::back_inserter(into.children));
      if (!into.text) into.text = root.text;
      return;
    }
    into.children.push_back(std::move(root));
  }

  Diagnostics& diagnostics_;
  InputFiles* inputs_;  // null: nobody asks
  const SearchPath& search_;
  std::vector<OpenFile> open_files_;  // from the scene to the file being read
  int num_includes_ = 0;
  int num_elements_ = 0;
  std::uintmax_t num_bytes_ = 0;
};

std::string text_of(const Element& element, const std::string& margin) {
  std::string text = fmt::format("{}<{}", margin, element.tag);
  for (const ElementAttribute& attribute : element.attributes)
    text += fmt::format(" {}=\"{}\"", attribute.name, escaped(attribute.value));
  if (element.children.empty()) return text + "/>\n";
  text += ">\n";
  for (const Element& child : element.children) text += text_of(child, margin + "  ");
  return text + fmt::format("{}</{}>\n", margin, element.tag);
}

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

const ElementAttribute* Element::find(std::string_view name) const {
  const auto found = std::ranges::find(attributes, name, &ElementAttribute::name);
  return found == attributes.end() ? nullptr : &*found;
}

std::string read_scene_file(const fs::path& file) {
  if (std::string reason = why_unreadable(file); !reason.empty()) throw InputError(std::move(reason));
  std::error_code failure;
  const std::uintmax_t size = fs::file_size(file, failure);
  if (size > kLargestSceneFile)
    throw InputError(fmt::format("{} bytes, a scene has at most {}", size, kLargestSceneFile));
  return whole_file(file);
}

Element read_document(std::string_view text, const fs::path& file, Diagnostics& diagnostics, InputFiles* inputs,
                      const SearchPath& search) {
  return Importer(diagnostics, inputs, search).import(text, file, {file.string(), 0, nullptr});
}

std::string write_document(const Element& root, const std::string& comment) {
  return fmt::format("<?xml version=\"1.0\"?>\n<!--{}-->\n{}", comment, text_of(root, ""));
}

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
