// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/document.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/readable_file.hpp"

namespace hexaplast::scene {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_file(const Place& file, int line, const std::string& what) {
  Place place = file;
  place.line = line;
  throw SceneError(format_error(place, what));
}

// Bytes of the UTF-8 sequence that begins at `at`; 0 when it is not well-formed (overlong, surrogate, beyond U+10FFFF,
// cut off).
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u; };
  const auto continues = [&](std::size_t i) { return (byte(i) & 0xC0) == 0x80; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return continues(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const unsigned least = first == 0xE0 ? 0xA0 : 0x80, most = first == 0xED ? 0x9F : 0xBF;
    return byte(1) >= least && byte(1) <= most && continues(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned least = first == 0xF0 ? 0x90 : 0x80, most = first == 0xF4 ? 0x8F : 0xBF;
    return byte(1) >= least && byte(1) <= most && continues(2) && continues(3) ? 4 : 0;
  }
  return 0;
}

// A reference must be one of XML's five entities or the number of a character: the parser would leave others in the
// text as they are, and end the text at character 0.
bool is_known_reference(std::string_view from_ampersand) {
  const std::size_t end = from_ampersand.substr(0, 16).find(';');
  if (end == from_ampersand.npos) return false;
  const std::string_view name = from_ampersand.substr(1, end - 1);
  static constexpr std::array<std::string_view, 5> kEntities = {"amp", "lt", "gt", "quot", "apos"};
  if (std::ranges::count(kEntities, name) > 0) return true;
  if (!name.starts_with('#')) return false;

  const bool is_hexadecimal = name.starts_with("#x");
  const char* const first = name.data() + (is_hexadecimal ? 2 : 1);
  std::uint32_t character = 0;
  const auto [last, error] = std::from_chars(first, name.data() + name.size(), character, is_hexadecimal ? 16 : 10);
  const bool is_surrogate = character >= 0xD800 && character <= 0xDFFF;
  return error == std::errc() && last == name.data() + name.size() && character > 0 && character <= 0x10FFFF &&
         !is_surrogate;
}

/// Refuses what the XML parser would let pass, and what it would take too long over: it compares each attribute with
/// all before it.
class Screen {
 public:
  Screen(std::string_view text, const Place& file) : text_(text), file_(file) {}

  /// Number of elements.
  int pass() {
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_);
      if (quote_ == 0 && (rest.starts_with("<!--") || rest.starts_with("<![CDATA["))) {
        skip_to(rest[2] == '-' ? "-->" : "]]>");
      } else {
        check_markup(rest);
        advance();
      }
    }
    return num_elements_;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { refuse_file(file_, line_, what); }

  // Over one character.
  void advance() {
    const std::size_t length = utf8_length(text_, at_);
    if (text_[at_] == '\0') refuse("the file contains a NUL byte: must be text");
    if (length == 0) refuse("the file is not valid UTF-8");
    if (text_[at_] == '\n') ++line_;
    at_ += length;
  }

  void skip_to(std::string_view closing) {
    const std::size_t end = std::min(text_.find(closing, at_ + 4), text_.size());
    while (at_ < end) advance();
  }

  void check_markup(std::string_view rest) {
    const char c = rest[0];
    if (c == '&' && !is_known_reference(rest))
      refuse("unknown entity: only &amp; &lt; &gt; &quot; &apos; and character numbers are allowed");
    if (quote_ != 0) {
      if (c == quote_) quote_ = 0;
    } else if (is_in_tag_) {
      check_tag(c);
    } else if (c == '<') {
      open_tag(rest);
    }
  }

  void open_tag(std::string_view rest) {
    if (rest.starts_with("<!DOCTYPE") || rest.starts_with("<!ENTITY"))
      refuse("document types and entities are not allowed in a scene");
    is_in_tag_ = true;
    num_attributes_ = 0;
    if (rest.starts_with("</")) {
      --depth_;
    } else if (!rest.starts_with("<?") && !rest.starts_with("<!")) {
      if (++depth_ > kMostLevels) refuse(fmt::format("more than {} levels of elements", kMostLevels));
      if (++num_elements_ > kMostElements) refuse(fmt::format("more than {} elements", kMostElements));
    }
  }

  void check_tag(char c) {
    if (c == '"' || c == '\'') {
      quote_ = c;
      if (++num_attributes_ > kMostAttributes)
        refuse(fmt::format("an element has more than {} attributes", kMostAttributes));
    } else if (c == '>') {
      is_in_tag_ = false;
      if (text_[at_ - 1] == '/') --depth_;
    }
  }

  std::string_view text_;
  const Place& file_;
  std::size_t at_ = 0;
  int line_ = 1;
  bool is_in_tag_ = false;
  char quote_ = 0;  // of the value that is being passed; 0: none
  int depth_ = 0, num_elements_ = 0, num_attributes_ = 0;
};

std::string explain(const tinyxml2::XMLDocument& document) {
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file holds no element, must hold one <Node>";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is closed by another one's end, or not at all";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is given twice, or is not of the form name=\"value\"";
    default:
      return fmt::format("not well-formed XML ({})", document.ErrorName());
  }
}

/// Parses files and carries out their includes.
class Importer {
 public:
  explicit Importer(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// `origin`: the file as messages name it, and where it is included.
  Element import(std::string_view text, const fs::path& file, const Place& origin) {
    num_elements_ += Screen(text, origin).pass();
    if (num_elements_ > kMostElements)
      refuse_file(origin, 1, fmt::format("more than {} elements with those of included files", kMostElements));
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      refuse_file(origin, document.ErrorLineNum(), explain(document));
    const tinyxml2::XMLElement* root = document.RootElement();
    if (!root) refuse_file(origin, 1, "the file holds no element, must hold one <Node>");
    for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling()) {
      const bool is_harmless = node == root || node->ToComment() || node->ToDeclaration();
      if (!is_harmless)
        refuse_file(origin, node->GetLineNum(), "something stands beside the root element, must be one <Node> alone");
    }

    open_files_.push_back({origin, fs::weakly_canonical(file)});
    Element element = convert(*root);
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

  Element convert(const tinyxml2::XMLElement& from) {
    Element element{.tag = from.Name(), .place = place(from.GetLineNum()), .attributes = {}, .children = {}};
    for (const tinyxml2::XMLAttribute* attribute = from.FirstAttribute(); attribute; attribute = attribute->Next())
      element.attributes.push_back({attribute->Name(), attribute->Value(), place(attribute->GetLineNum())});
    for (const tinyxml2::XMLNode* child = from.FirstChild(); child; child = child->NextSibling()) {
      if (const tinyxml2::XMLElement* inner = child->ToElement()) {
        Element converted = convert(*inner);
        if (converted.tag == "include") {
          include(converted, element);
        } else {
          element.children.push_back(std::move(converted));
        }
      } else if (!child->ToComment() && !element.text) {
        element.text = place(child->GetLineNum());
      }
    }
    return element;
  }

  void include(const Element& directive, Element& into) {
    const auto refuse = [&](const Place& at, const std::string& what) {
      diagnostics_.error(at, "include.href: " + what);
    };
    const ElementAttribute* href = directive.find("href");
    if (!href || href->value.empty()) return refuse(directive.place, "is not given, must be a file");
    if (!directive.children.empty() || directive.text)
      diagnostics_.error(directive.place, "include: holds elements or text, must be empty");

    const fs::path file = (open_files_.back().canonical.parent_path() / href->value).lexically_normal();
    const fs::path canonical = fs::weakly_canonical(file);
    const auto is_same = [&](const OpenFile& open) { return open.canonical == canonical; };
    if (std::ranges::any_of(open_files_, is_same))
      return refuse(href->place, fmt::format("'{}' includes itself", href->value));
    if (open_files_.size() > kMostIncludeLevels)
      return refuse(href->place, fmt::format("more than {} levels of includes", kMostIncludeLevels));
    if (++num_includes_ > kMostIncludes) {
      if (num_includes_ == kMostIncludes + 1) refuse(href->place, fmt::format("more than {} includes", kMostIncludes));
      return;
    }

    std::string text;
    try {
      text = read_scene_file(file);
    } catch (const InputError& error) {
      return refuse(href->place, fmt::format("'{}': {}", href->value, error.what()));
    }
    num_bytes_ += text.size();
    if (num_bytes_ > kLargestSceneFile)
      refuse_file(href->place, href->place.line,
                  fmt::format("include.href: more than {} bytes are included", kLargestSceneFile));

    const fs::path shown = fs::path(open_files_.back().origin.file).parent_path() / href->value;
    Element root = import(text, file, {shown.string(), 0, std::make_shared<const Place>(href->place)});
    replace_attributes(directive, root);
    splice(std::move(root), into);
  }

  void replace_attributes(const Element& directive, Element& root) {
    for (const ElementAttribute& given : directive.attributes) {
      if (given.name == "href" || is_switched_off(given.name)) continue;
      if (given.name == "name") {
        std::erase_if(root.attributes, [](const ElementAttribute& own) { return own.name == "name"; });
        root.attributes.push_back(given);
        continue;
      }
      const std::size_t separator = given.name.find("__");
      const bool is_for_one = separator != given.name.npos;
      const std::string owner = is_for_one ? given.name.substr(0, separator) : "";
      const std::string attribute = is_for_one ? given.name.substr(separator + 2) : given.name;
      if (replace(root, owner, attribute, given) > 0) continue;
      diagnostics_.error(
          given.place,
          fmt::format("include.{}: replaces nothing: '{}' is given in no {} of '{}'", given.name, attribute,
                      is_for_one ? fmt::format("element named '{}'", owner) : "element", root.place.file));
    }
  }

  /// Number of attributes replaced in an element and below. `owner`: name of the elements meant; empty: all.
  static int replace(Element& element, const std::string& owner, const std::string& attribute,
                     const ElementAttribute& given) {
    int count = 0;
    const ElementAttribute* name = element.find("name");
    if (owner.empty() || (name && name->value == owner)) {
      for (ElementAttribute& own : element.attributes) {
        if (own.name != attribute) continue;
        own.value = given.value;
        own.place = given.place;
        ++count;
      }
    }
    for (Element& child : element.children) count += replace(child, owner, attribute, given);
    return count;
  }

  static void splice(Element root, Element& into) {
    const ElementAttribute* name = root.find("name");
    if (name && (name->value == "Group" || name->value == "_Group_")) {
      std::ranges::move(root.children, std::back_inserter(into.children));
      if (!into.text) into.text = root.text;
    } else if (name && name->value == "_Merge_") {
      merge(std::move(root), into);
    } else {
      into.children.push_back(std::move(root));
    }
  }

  static void merge(Element from, Element& into) {
    for (ElementAttribute& lent : from.attributes) {
      if (lent.name == "name") continue;
      const auto own = std::ranges::find(into.attributes, lent.name, &ElementAttribute::name);
      if (own == into.attributes.end()) {
        into.attributes.push_back(std::move(lent));
      } else {
        *own = std::move(lent);
      }
    }
    if (!into.text) into.text = from.text;
    const std::size_t num_before = into.children.size();
    for (Element& child : from.children) {
      const auto end = into.children.begin() + static_cast<std::ptrdiff_t>(num_before);
      const auto twin =
          std::find_if(into.children.begin(), end, [&](const Element& own) { return is_twin(own, child); });
      if (twin == end) {
        into.children.push_back(std::move(child));
      } else {
        merge(std::move(child), *twin);
      }
    }
  }

  static std::string class_of(const Element& element) {
    const ElementAttribute* type = element.tag == "Object" ? element.find("type") : nullptr;
    return type ? type->value : element.tag;
  }

  static bool is_twin(const Element& a, const Element& b) {
    const ElementAttribute *name_a = a.find("name"), *name_b = b.find("name");
    return name_a && name_b && name_a->value == name_b->value && class_of(a) == class_of(b);
  }

  Diagnostics& diagnostics_;
  std::vector<OpenFile> open_files_;  // from the scene to the file being read
  int num_includes_ = 0;
  int num_elements_ = 0;
  std::uintmax_t num_bytes_ = 0;
};

}  // namespace

const ElementAttribute* Element::find(std::string_view name) const {
  const auto found = std::ranges::find(attributes, name, &ElementAttribute::name);
  return found == attributes.end() ? nullptr : &*found;
}

bool is_switched_off(std::string_view attribute) { return attribute.starts_with("_") || attribute.starts_with("NO"); }

std::string read_scene_file(const fs::path& file) {
  if (std::string reason = why_unreadable(file); !reason.empty()) throw InputError(std::move(reason));
  std::error_code failure;
  const std::uintmax_t size = fs::file_size(file, failure);
  if (size > kLargestSceneFile)
    throw InputError(fmt::format("{} bytes, a scene has at most {}", size, kLargestSceneFile));

  std::string text(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(size));
  if (!stream) throw InputError("cannot be read");
  return text;
}

Element read_document(std::string_view text, const fs::path& file, Diagnostics& diagnostics) {
  return Importer(diagnostics).import(text, file, {file.string(), 0, nullptr});
}

}  // namespace hexaplast::scene
