// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formats/xml.hpp"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>

#include "formats/text.hpp"

namespace hexaplast {
namespace {

constexpr std::string_view kXmlBlanks = " \t\r\n";

// Expat copies what it is given, and looks at a long attribute anew with each piece of it: pieces that double keep both
// small, and what follows a raw element is not copied.
constexpr std::size_t kFirstPiece = 1 << 16, kLargestPiece = 1 << 30;  // [byte]

class XmlReader {
 public:
  XmlReader(std::string_view text, const XmlLimits& limits, std::string_view raw)
      : text_(text), limits_(limits), raw_(raw), parser_(XML_ParserCreate("UTF-8"), XML_ParserFree) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), call<&XmlReader::open>, call<&XmlReader::end>);
    XML_SetCharacterDataHandler(parser_.get(), call<&XmlReader::read_text>);
    XML_SetCommentHandler(parser_.get(), call<&XmlReader::read_comment>);
    XML_SetStartDoctypeDeclHandler(parser_.get(), call<&XmlReader::refuse_document_type>);
  }

  XmlDocument read() {
    // UTF-16, which expat takes unasked, has a NUL byte in the first '<' or blank
    if (text_.substr(0, 4).find('\0') != text_.npos) refuse(1, "the file is not valid UTF-8");
    bool is_last = false;
    for (std::size_t at = 0, size = kFirstPiece; !is_last && !has_stopped_; size = std::min(2 * size, kLargestPiece)) {
      const std::string_view piece = text_.substr(at, size);
      at += piece.size();
      is_last = at == text_.size();
      // before expat, which takes a whole tag before it tells of it
      num_equals_ += std::ranges::count(piece, '=');
      if (num_equals_ > limits_.attributes)
        refuse(line(), fmt::format("more than {} '=', of which each may be an attribute", limits_.attributes));
      const XML_Status status = XML_Parse(parser_.get(), piece.data(), static_cast<int>(piece.size()), is_last);
      if (status == XML_STATUS_ERROR && !has_stopped_) refuse_malformed();
    }
    if (failure_) std::rethrow_exception(failure_);
    return std::move(document_);
  }

 private:
  /// Lets expat, which is C and passes no exceptions on, call a function of the reader.
  template <auto function, class... Arguments>
  static void call(void* user, Arguments... arguments) {
    XmlReader& reader = *static_cast<XmlReader*>(user);
    if (reader.has_stopped_) return;
    try {
      (reader.*function)(arguments...);
    } catch (...) {
      reader.failure_ = std::current_exception();
      reader.stop();
    }
  }

  void stop() {
    has_stopped_ = true;
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  int line() const { return static_cast<int>(XML_GetCurrentLineNumber(parser_.get())); }
  std::size_t at() const {  // none: at the end
    return std::min(static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())), text_.size());
  }

  [[noreturn]] static void refuse(int line, const std::string& what) { throw XmlError(line, what); }

  [[noreturn]] void refuse_malformed() const {
    const XML_Error error = XML_GetErrorCode(parser_.get());
    if (error == XML_ERROR_NO_ELEMENTS)
      open_.empty() ? refuse(line(), "the file holds no element, must hold one")
                    : refuse(open_.back().line, fmt::format("<{}> is never closed", excerpt(open_.back().name)));
    if (at() < text_.size() && utf8_length(text_, at()) == 0) refuse(line(), "the file is not valid UTF-8");
    std::string what =
        fmt::format("{} at column {}", XML_ErrorString(error), XML_GetCurrentColumnNumber(parser_.get()) + 1);
    if (!open_.empty()) what += fmt::format(" in <{}> of line {}", excerpt(open_.back().name), open_.back().line);
    what += fmt::format(": {}", excerpt(text_.substr(at(), text_.find_first_of("\r\n", at()) - at())));
    if (error == XML_ERROR_INVALID_TOKEN) what += " (a quote or '>' missing before it, or -- in a comment?)";
    refuse(line(), what);
  }

  void refuse_document_type(const char*, const char*, const char*, int) {
    refuse(line(), "document types and entities are not allowed");
  }

  void open(const char* name, const char** attributes) {
    const std::size_t tag = at();
    XmlElement element{.name = name, .line = line()};
    if (open_.size() == kMaxXmlLevels)
      refuse(element.line, fmt::format("more than {} levels of elements", kMaxXmlLevels));
    if (++num_elements_ > limits_.elements)
      refuse(element.line, fmt::format("more than {} elements", limits_.elements));

    // expat knows the line of the tag alone
    std::size_t counted = tag, end = tag + 1 + element.name.size();
    for (int line = element.line; *attributes; attributes += 2) {
      const std::size_t begin = text_.find_first_not_of(kXmlBlanks, end);
      line += static_cast<int>(std::ranges::count(text_.substr(counted, begin - counted), '\n'));
      counted = begin;
      const std::size_t quote = text_.find_first_of("\"'", begin);
      end = text_.find(text_[quote], quote + 1) + 1;
      element.attributes.push_back({attributes[0], attributes[1], line});
    }

    element.content = text_.substr(tag + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get())));
    open_.push_back(std::move(element));
    if (name != raw_) return;
    while (!open_.empty()) close(text_.size());
    stop();
  }

  void end(const char*) { close(at()); }

  void close(std::size_t end) {
    XmlElement element = std::move(open_.back());
    open_.pop_back();
    element.content.remove_suffix(text_.size() - end);
    if (open_.empty())
      document_.root = std::move(element);
    else
      open_.back().children.push_back(std::move(element));
  }

  void read_text(const char* text, int size) {
    XmlElement& element = open_.back();
    const bool is_blank =
        std::string_view(text, static_cast<std::size_t>(size)).find_first_not_of(kXmlBlanks) == std::string_view::npos;
    if (element.text_line == 0 && !is_blank) element.text_line = line();
  }

  void read_comment(const char* text) {
    if (num_elements_ == 0) document_.comment = text;
  }

  std::string_view text_;
  const XmlLimits& limits_;
  std::string_view raw_;
  std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
  XmlDocument document_;
  std::vector<XmlElement> open_;
  int num_elements_ = 0;
  std::ptrdiff_t num_equals_ = 0;
  bool has_stopped_ = false;
  std::exception_ptr failure_;
};

}  // namespace

std::string_view XmlElement::attribute(std::string_view of_name) const {
  const auto found = std::ranges::find(attributes, of_name, &XmlAttribute::name);
  return found == attributes.end() ? std::string_view() : found->value;
}

const XmlElement* XmlElement::child(std::string_view of_name) const {
  const auto found = std::ranges::find(children, of_name, &XmlElement::name);
  return found == children.end() ? nullptr : &*found;
}

XmlDocument parse_xml(std::string_view text, const XmlLimits& limits, std::string_view raw) {
  return XmlReader(text, limits, raw).read();
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
    else if (c == '\t' || c == '\n' || c == '\r')
      text += fmt::format("&#{};", static_cast<int>(c));  // it would be a blank in the value of an attribute
    else if (static_cast<unsigned char>(c) >= 0x20)
      text += c;
  }
  return text;
}

}  // namespace hexaplast
