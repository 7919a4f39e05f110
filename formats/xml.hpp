// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

/// How much of a file is kept: an element takes some hundred bytes of memory, however few in the file.
struct XmlLimits {
  int elements = 100'000;    ///< of programs' files, which have a long list of files (.pvd) or a mesh's numbers (.vtu)
  int attributes = 500'000;  ///< of all elements, with each '=' elsewhere
};
inline constexpr int kMaxXmlLevels = 100;  ///< of elements in one another, through which others go by recursion

struct XmlAttribute {
  std::string name, value;
  int line;
};

/// Lines count from 1.
struct XmlElement {
  std::string name;
  int line = 0;  ///< where its tag begins
  std::vector<XmlAttribute> attributes = {};
  std::vector<XmlElement> children = {};
  int text_line = 0;              ///< where its text begins; 0: it holds elements, comments and blanks alone
  std::string_view content = {};  ///< all between its tags, as it stands in the text that was parsed

  std::string_view attribute(std::string_view of_name) const;  ///< its value; empty: not given
  const XmlElement* child(std::string_view of_name) const;     ///< the first one; null: none
};

struct XmlDocument {
  XmlElement root;
  std::string comment;  ///< the last one before the root
};

/// XML that is not accepted. The message says what is wrong, without a place.
class XmlError : public InputError {
 public:
  XmlError(int line, const std::string& what) : InputError(what), line_(line) {}
  int line() const { return line_; }  ///< from 1

 private:
  int line_;
};

/// Reads XML, which must be UTF-8 without a document type, and so without entities but XML's five. Throws XmlError for
/// other text, and for more than `limits`. The content of an element named `raw` is no XML: it is all that follows its
/// tag.
XmlDocument parse_xml(std::string_view text, const XmlLimits& limits = {}, std::string_view raw = {});

/// Words as text or attribute value of XML and HTML. Control characters, which have no place there, are left out, but
/// for tabs and ends of lines.
std::string escaped(std::string_view words);

}  // namespace hexaplast
