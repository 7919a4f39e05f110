// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>

#include "hexaplast/base/error.hpp"

namespace tinyxml2 {
class XMLDocument;
}

namespace hexaplast {

/// How much of a file the XML parser is given. An element costs it some hundred bytes of memory, however few it takes
/// in the file, and it compares each attribute of an element with all before it.
struct XmlLimits {
  int elements;           ///< and as many comments
  int attributes_of_one;  ///< element
  int attributes;         ///< of all elements
  int levels = 98;        ///< of elements in one another; the parser goes down by recursion, and no further itself
};

/// Of files that programs write, which have a long list of files (.pvd) or the numbers of a mesh (.vtu).
inline constexpr XmlLimits kXmlOfPrograms{.elements = 100'000, .attributes_of_one = 100, .attributes = 500'000};

/// XML that is not accepted. The message says what is wrong, without a place.
class XmlError : public InputError {
 public:
  XmlError(int line, const std::string& what) : InputError(what), line_(line) {}
  int line() const { return line_; }  ///< from 1

 private:
  int line_;
};

/// Reads XML into a document of the parser's, which is first looked through in time and memory that are small beside
/// the text's own. Throws XmlError for what is not well-formed, with the tag and the reason, and for what is not
/// accepted: text that is not UTF-8 or holds a NUL, document types, entities but XML's five, more than `limits`. A text
/// without elements leaves the document without a root. Returns the number of elements.
int parse_xml(std::string_view text, const XmlLimits& limits, tinyxml2::XMLDocument& document);

/// Words as text or attribute value of XML and HTML; control characters, which have no place there, are left out.
std::string escaped(std::string_view words);

}  // namespace hexaplast
