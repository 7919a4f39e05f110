// SPDX-License-Identifier: LGPL-2.1-or-later
// What XML is read, what is refused and in which words; and text as a terminal may see it.
#include "formats/xml.hpp"

#include <gtest/gtest.h>

#include <tuple>

#include "formats/base64.hpp"
#include "formats/text.hpp"

namespace hexaplast {
namespace {

int num_elements(const XmlElement& element) {
  int number = 1;
  for (const XmlElement& child : element.children) number += num_elements(child);
  return number;
}

/// "LINE: what is wrong", or how many elements there are.
std::string verdict_on_xml(std::string_view text, const XmlLimits& limits = {}) {
  try {
    return std::to_string(num_elements(parse_xml(text, limits).root));
  } catch (const XmlError& error) {
    return std::to_string(error.line()) + ": " + error.what();
  }
}

TEST(Xml, ErrorsShowWhatIsWrong) {
  const std::string missing = " (a quote or '>' missing before it, or -- in a comment?)";
  for (const auto& [text, verdict] : std::initializer_list<std::pair<std::string, std::string>>{
           {"", "1: the file holds no element, must hold one"},
           {"<Node>\n<bar>\n</Node>", "3: mismatched tag at column 3 in <bar> of line 2: Node>"},
           {"<Node>\n<bar>\n</bar>", "1: <Node> is never closed"},
           {"<a></a", "1: unclosed token at column 4 in <a> of line 1: </a"},
           {"<Node>\n<bar dt='1\n'", "2: unclosed token at column 1 in <Node> of line 1: <bar dt='1"},
           {"<Node\ndt='1>\n<a/></Node>", "3: not well-formed (invalid token) at column 1: <a/></Node>" + missing},
           {"<a dt='1 n='2' m='3'/>", "1: not well-formed (invalid token) at column 13: 2' m='3'/>" + missing},
           {"<a dt=1/>", "1: not well-formed (invalid token) at column 7: 1/>" + missing},
           {"<!-- a -- b --><a/>", "1: not well-formed (invalid token) at column 10:  b --><a/>" + missing},
           {"<a>\n1 < 2</a>", "2: not well-formed (invalid token) at column 4 in <a> of line 1:  2</a>" + missing},
           {std::string("<a>\n\0</a>", 9),
            "2: not well-formed (invalid token) at column 1 in <a> of line 1: \\u0000</a>" + missing},
           {"<a\nx='1'\nx='2'/>", "3: duplicate attribute at column 1: x='2'/>"},
           {"<a/>\nb", "2: junk after document element at column 1: b"},
           {"\n<!DOCTYPE a>", "2: document types and entities are not allowed"},
           {"<a>\n&nbsp;</a>", "2: undefined entity at column 1 in <a> of line 1: &nbsp;</a>"},
           {"<a>&#0;</a>", "1: reference to invalid character number at column 4 in <a> of line 1: &#0;</a>"},
           {"<a>\n\xFF</a>", "2: the file is not valid UTF-8"}})
    EXPECT_EQ(verdict_on_xml(text), verdict) << text;
  EXPECT_EQ(verdict_on_xml("<" + std::string(1000, 'n') + ">"), "1: <" + std::string(40, 'n') + "...> is never closed");
}

TEST(Xml, OtherEncodingsAreSaidToBeNoUtf8) {
  for (const std::string_view text : {std::string_view("\xFF\xFE<\0a\0/\0>\0", 10), std::string_view("\xE9<a/>"),
                                      std::string_view("\0<\0a\0/\0>", 8), std::string_view("<\0a\0/\0>\0", 8)})
    EXPECT_EQ(verdict_on_xml(text), "1: the file is not valid UTF-8");
}

TEST(Xml, IsReadWithItsLines) {
  const std::string text =
      "\xEF\xBB\xBF<?xml version='1.0'?>\r\n<?more?>\n<!-- > < & -->\n<ä:b.c-1\tb = 'c > \"d'\n_x='e\nf'  g=''>\n"
      "<!-- --><h/>\n\n text ]] é<![CDATA[ <&> ]]><h>&#233;&#x1F600;&amp;\n</h>\n</ä:b.c-1 >\n<!-- end -->";
  const XmlDocument document = parse_xml(text);
  EXPECT_EQ(document.comment, " > < & ");
  const XmlElement& root = document.root;
  EXPECT_EQ(root.name, "ä:b.c-1");
  EXPECT_EQ(root.line, 4);
  ASSERT_EQ(root.attributes.size(), 3u);
  EXPECT_EQ(root.attribute("b"), "c > \"d");
  EXPECT_EQ(root.attribute("_x"), "e f");
  EXPECT_EQ(root.attribute("none"), "");
  EXPECT_EQ(root.attributes[0].line, 4);
  EXPECT_EQ(root.attributes[1].line, 5);
  EXPECT_EQ(root.attributes[2].line, 6);
  EXPECT_EQ(root.text_line, 9);
  ASSERT_EQ(root.children.size(), 2u);
  EXPECT_EQ(root.child("h"), &root.children[0]);
  EXPECT_EQ(root.child("none"), nullptr);
  EXPECT_EQ(root.children[0].line, 7);
  EXPECT_EQ(root.children[0].content, "");
  EXPECT_EQ(root.children[0].text_line, 0);
  EXPECT_EQ(root.children[1].content, "&#233;&#x1F600;&amp;\n");
  EXPECT_EQ(root.children[1].text_line, 9);
}

// More than the first piece that the parser is given.
TEST(Xml, TakesLongValues) {
  const std::string value(1'000'000, 'v');
  const std::string text = "<a>\n<b c='" + value + "'>" + value + "</b>\n</a>";
  const XmlElement root = parse_xml(text).root;
  ASSERT_EQ(root.children.size(), 1u);
  EXPECT_EQ(root.children[0].attribute("c"), value);
  EXPECT_EQ(root.children[0].content, value);
}

TEST(Xml, EndsAtARawElement) {
  const XmlElement root = parse_xml(std::string_view("<a><b c='d'>\0<</a>", 18), {}, "b").root;
  ASSERT_EQ(root.children.size(), 1u);
  EXPECT_EQ(root.children[0].attribute("c"), "d");
  EXPECT_EQ(root.children[0].content, std::string_view("\0<</a>", 6));
}

TEST(Xml, OfMoreThanTheLimitsIsRefused) {
  constexpr XmlLimits kFew{.elements = 5, .attributes = 6};
  EXPECT_EQ(verdict_on_xml("<a><a/><a/><a/><a/></a>", kFew), "5");
  EXPECT_EQ(verdict_on_xml("<a><a/><a/><a/><a/>\n<a/>", kFew), "2: more than 5 elements");
  EXPECT_EQ(verdict_on_xml("<a x='' y='' z=''><a x='' y='' z=''/></a>", kFew), "2");
  EXPECT_EQ(verdict_on_xml("<a x='' y='' z=''><a x='' y='' z=''/><a x=''/></a>", kFew),
            "1: more than 6 '=', of which each may be an attribute");
  const auto nested = [](int levels) {
    std::string text;
    for (int k = 0; k < levels; ++k) text = "<a>" + text + "</a>";
    return text;
  };
  EXPECT_EQ(verdict_on_xml(nested(100)), "100");
  EXPECT_EQ(verdict_on_xml(nested(101)), "1: more than 100 levels of elements");
}

TEST(Printable, ShowsWhatWouldSteerATerminal) {
  EXPECT_EQ(printable("plain \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80\n\tnext"),
            "plain \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80\n\tnext");
  EXPECT_EQ(printable("\x1b[31mred\x1b]0;title\x07"), "\\u001b[31mred\\u001b]0;title\\u0007");
  EXPECT_EQ(printable(std::string_view("\0\b\r\x7f", 4)), "\\u0000\\u0008\\u000d\\u007f");
  EXPECT_EQ(printable("\xC2\x80\xC2\x9B\x32J\xC2\x9F\xC2\xA0"), "\\u0080\\u009b2J\\u009f\xC2\xA0");
  EXPECT_EQ(printable("a\xE2\x80\xAE\xE2\x81\xA6\xE2\x80\xA8z\xE2\x80\xA7"), "a\\u202e\\u2066\\u2028z\xE2\x80\xA7");
  EXPECT_EQ(printable_line("a\n\tb \xC3\xA9\xE2\x80\xAE"), "a\\u000a\\u0009b \xC3\xA9\\u202e");
  EXPECT_EQ(printable("\x9B\x32J \xED\xA0\x80 \xC3"), "\\x9b2J \\xed\\xa0\\x80 \\xc3");
}

// The examples of RFC 4648, section 10, and all values of a byte.
TEST(Base64, IsThatOfTheStandard) {
  for (const auto& [bytes, text] :
       {std::tuple("", ""), std::tuple("f", "Zg=="), std::tuple("fo", "Zm8="), std::tuple("foo", "Zm9v"),
        std::tuple("foob", "Zm9vYg=="), std::tuple("fooba", "Zm9vYmE="), std::tuple("foobar", "Zm9vYmFy")}) {
    EXPECT_EQ(to_base64(bytes), text);
    std::string padded = bytes;
    while (padded.size() % 3 != 0) padded += '\0';
    EXPECT_EQ(from_base64(text), padded);
  }
  std::string all;
  for (int byte = 0; byte < 255; ++byte) all += static_cast<char>(byte);
  EXPECT_EQ(from_base64(to_base64(all)), all);
  EXPECT_FALSE(from_base64("Zm9*"));
  EXPECT_FALSE(from_base64("Zm 9"));
}

}  // namespace
}  // namespace hexaplast
