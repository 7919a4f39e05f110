// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formats/xml.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <set>
#include <vector>

#include "formats/text.hpp"

namespace hexaplast {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kLongestQuote = 40;  // bytes of a name that a message repeats

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Letters of other scripts among them: their bytes are all beyond ASCII.
bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == ':' ||
         static_cast<unsigned char>(c) > 127;
}
bool continues_name(char c) { return begins_name(c) || (c >= '0' && c <= '9') || c == '.' || c == '-'; }

std::string shown(std::string_view name) {
  if (name.size() <= kLongestQuote) return std::string(name);
  return std::string(name.substr(0, kLongestQuote)) + "...";
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

/// Refuses what the parser would let pass, would take too long over, or would only say a word about.
class InputValidator {
 public:
  InputValidator(std::string_view text, const XmlLimits& limits) : text_(text), limits_(limits) {}

  int pass() {
    require_text();
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
    while (!at_end()) {
      if (present() == '<') {
        pass_markup();
      } else {
        if (open_.empty() && !is_blank(present())) refuse("text stands outside of all elements");
        pass_character();
      }
    }
    if (!open_.empty()) refuse(open_.back().line, fmt::format("<{}> is never closed", shown(open_.back().name)));
    return num_elements_;
  }

 private:
  struct Tag {
    std::string_view name;
    int line;
  };

  [[noreturn]] void refuse(int line, const std::string& what) const { throw XmlError(line, what); }
  [[noreturn]] void refuse(const std::string& what) const { refuse(line_, what); }

  bool at_end() const { return at_ == text_.size(); }
  char present() const { return text_[at_]; }
  bool is_at(std::string_view markup) const { return text_.substr(at_, markup.size()) == markup; }

  // First: what is no text has no tags to speak of.
  void require_text() const {
    const auto is_plain = [](char c) { return static_cast<signed char>(c) > 0; };  // ASCII, no NUL byte
    const auto refuse_at = [&](std::size_t at, const char* what) {
      refuse(1 + static_cast<int>(std::ranges::count(text_.substr(0, at), '\n')), what);
    };
    for (auto rest = text_.begin(); (rest = std::find_if_not(rest, text_.end(), is_plain)) != text_.end();) {
      const auto at = static_cast<std::size_t>(rest - text_.begin());
      const std::size_t length = utf8_length(text_, at);
      if (length == 0) refuse_at(at, "the file is not valid UTF-8");
      if (text_[at] == '\0') refuse_at(at, "the file contains a NUL byte: must be text");
      rest += static_cast<std::ptrdiff_t>(length);
    }
  }

  // Over one byte, whatever it means.
  void step() { line_ += text_[at_++] == '\n'; }

  // Over one character of text or of a value.
  void pass_character() {
    if (present() == '&' && !is_known_reference(text_.substr(at_)))
      refuse("unknown entity: only &amp; &lt; &gt; &quot; &apos; and character numbers are allowed");
    step();
  }

  void skip_blanks() {
    while (!at_end() && is_blank(present())) step();
  }

  std::string_view pass_name() {
    const std::size_t begin = at_;
    while (!at_end() && continues_name(present())) step();
    return text_.substr(begin, at_ - begin);
  }

  void pass_markup() {
    if (is_at("<!--")) {
      pass_section("<!--", "-->", "a comment");
    } else if (is_at("<![CDATA[")) {
      pass_section("<![CDATA[", "]]>", "a CDATA section");
    } else if (is_at("<?")) {
      if (has_begun_) refuse("<? may stand at the beginning of the file alone");
      pass_section("<?", "?>", "a declaration");
      has_begun_ = false;  // others may follow
    } else if (is_at("<!DOCTYPE") || is_at("<!ENTITY")) {
      refuse("document types and entities are not allowed");
    } else if (is_at("</")) {
      close_tag();
    } else {
      open_tag();
    }
  }

  void pass_section(std::string_view opening, std::string_view closing, const char* what) {
    has_begun_ = true;
    if (++num_sections_ > limits_.elements) refuse(fmt::format("more than {} comments", limits_.elements));
    const std::size_t end = text_.find(closing, at_ + opening.size());
    if (end == text_.npos) refuse(fmt::format("{} ({}) is never closed by {}", what, opening, closing));
    while (at_ < end + closing.size()) step();
  }

  void close_tag() {
    const int line = line_;
    at_ += 2;
    const std::string_view name = pass_name();
    skip_blanks();
    if (at_end() || present() != '>') refuse(line, fmt::format("</{} has no '>'", shown(name)));
    ++at_;
    if (open_.empty()) refuse(line, fmt::format("</{}> closes nothing: no element is open", shown(name)));
    const Tag& open = open_.back();
    if (name != open.name)
      refuse(line, fmt::format("</{}> stands where </{}> must close the <{}> of line {}", shown(name), shown(open.name),
                               shown(open.name), open.line));
    open_.pop_back();
  }

  void open_tag() {
    has_begun_ = true;
    Tag tag{{}, line_};
    ++at_;
    if (at_end() || !begins_name(present())) refuse(tag.line, "'<' begins no tag here: &lt; is the sign itself");
    tag.name = pass_name();
    if (static_cast<int>(open_.size()) == limits_.levels)
      refuse(fmt::format("more than {} levels of elements", limits_.levels));
    if (++num_elements_ > limits_.elements) refuse(fmt::format("more than {} elements", limits_.elements));

    attributes_.clear();
    while (true) {
      skip_blanks();
      if (at_end()) refuse(tag.line, fmt::format("the file ends within the tag <{}", shown(tag.name)));
      if (present() == '>') {
        ++at_;
        open_.push_back(tag);
        return;
      }
      if (is_at("/>")) {
        at_ += 2;
        return;
      }
      pass_attribute(tag);
    }
  }

  void pass_attribute(const Tag& tag) {
    const auto refuse_in_tag = [&](const std::string& what) {
      refuse(fmt::format("{} in the tag <{}> of line {}", what, shown(tag.name), tag.line));
    };
    if (present() == '<') refuse_in_tag("'<' stands before the closing '>'");
    if (present() == '"' || present() == '\'') refuse_in_tag("a quote that belongs to no attribute stands");
    if (!begins_name(present())) refuse_in_tag(fmt::format("'{}' stands where an attribute must begin", present()));

    const std::string_view name = pass_name();
    const auto refuse_it = [&](int line, const char* what) {
      refuse(line, fmt::format("{}.{}: {}", shown(tag.name), shown(name), what));
    };
    skip_blanks();
    if (at_end() || present() != '=') refuse_it(line_, "no =\"value\" follows; or the quote before it is missing");
    ++at_;
    skip_blanks();
    if (at_end() || (present() != '"' && present() != '\'')) refuse_it(line_, "its value is not in quotes");
    const int line = line_;
    const char quote = present();
    for (++at_; !at_end() && present() != quote; pass_character())
      if (present() == '<') refuse_it(line, "the quote at the end of its value is missing (or '<' is meant: &lt;)");
    if (at_end()) refuse_it(line, "the quote at the end of its value is missing");
    ++at_;
    if (!at_end() && !is_blank(present()) && present() != '>' && present() != '/')
      refuse_it(line_, "no blank follows its value; or the quote at its end is missing");

    if (!attributes_.insert(name).second) refuse_it(line, "is given twice");
    if (static_cast<int>(attributes_.size()) > limits_.attributes_of_one)
      refuse(fmt::format("an element has more than {} attributes", limits_.attributes_of_one));
    if (++num_attributes_ > limits_.attributes) refuse(fmt::format("more than {} attributes", limits_.attributes));
  }

  std::string_view text_;
  const XmlLimits& limits_;
  std::size_t at_ = 0;
  int line_ = 1;
  bool has_begun_ = false;  // something but declarations has come
  std::vector<Tag> open_;
  std::set<std::string_view> attributes_;  // of the present tag
  int num_elements_ = 0, num_attributes_ = 0, num_sections_ = 0;
};

}  // namespace

int parse_xml(std::string_view text, const XmlLimits& limits, tinyxml2::XMLDocument& document) {
  const int num_elements = InputValidator(text, limits).pass();
  const tinyxml2::XMLError error = document.Parse(text.data(), text.size());
  if (error != tinyxml2::XML_SUCCESS && error != tinyxml2::XML_ERROR_EMPTY_DOCUMENT)
    throw XmlError(document.ErrorLineNum(), fmt::format("not well-formed XML ({})", document.ErrorName()));
  return num_elements;
}

std::string escaped(std::string_view words) {
  std::string text;
  for (const char c : words) {
    if (c == '&')
      text += "&amp;";
    else if (c == '<')
      text += "&lt;";
    else if (c == '>')
      text += "&gt;";
    else if (c == '"')
      text += "&quot;";
    else if (c == '\'')
      text += "&#39;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      text += c;
  }
  return text;
}

}  // namespace hexaplast
