// SPDX-License-Identifier: LGPL-2.1-or-later
// What XML is read, what is refused and in which words; and text as a terminal may see it.
#include "formats/xml.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include "formats/text.hpp"

namespace hexaplast {
namespace {

constexpr XmlLimits kFew{.elements = 5, .attributes_of_one = 3, .attributes = 6, .levels = 3};

/// "LINE: what is wrong", or how many elements there are.
std::string verdict_on_xml(std::string_view text, const XmlLimits& limits = kXmlOfPrograms) {
  tinyxml2::XMLDocument document;
  try {
    return std::to_string(parse_xml(text, limits, document));
  } catch (const XmlError& error) {
    return std::to_string(error.line()) + ": " + error.what();
  }
}

TEST(Xml, ErrorsNameTheTagAndWhatIsWrong) {
  for (const auto& [text, verdict] : std::initializer_list<std::pair<const char*, const char*>>{
           {"<Node>\n<bar>\n</Node>", "3: </Node> stands where </bar> must close the <bar> of line 2"},
           {"<Node>\n<bar>\n</bar>", "1: <Node> is never closed"},
           {"<Node>\n<bar/>\n", "1: <Node> is never closed"},
           {"<a/>\n</b>", "2: </b> closes nothing: no element is open"},
           {"<a></a", "1: </a has no '>'"},
           {"<a></a b=''>", "1: </a has no '>'"},
           {"<Node>\n<bar dt='1'\n", "2: the file ends within the tag <bar"},
           {"<Node>\n<bar dt='1\n'", "2: the file ends within the tag <bar"},
           {"<Node>\n<bar dt='1'\n<a/></Node>", "3: '<' stands before the closing '>' in the tag <bar> of line 2"},
           {"<Node\ndt='1\n/>", "2: Node.dt: the quote at the end of its value is missing"},
           {"<Node\ndt='1>\n<a/></Node>",
            "2: Node.dt: the quote at the end of its value is missing (or '<' is meant: &lt;)"},
           {"<a dt='1 n='2' m='3'/>", "1: a.dt: no blank follows its value; or the quote at its end is missing"},
           {"<a dt='1 n='b' m='3'/>", "1: a.dt: no blank follows its value; or the quote at its end is missing"},
           {"<a dt='1 n=' b' m='3'/>", "1: a.b: no =\"value\" follows; or the quote before it is missing"},
           {"<a dt=1/>", "1: a.dt: its value is not in quotes"},
           {"<a dt/>", "1: a.dt: no =\"value\" follows; or the quote before it is missing"},
           {"<a 'dt'='1'/>", "1: a quote that belongs to no attribute stands in the tag <a> of line 1"},
           {"<a 1='2'/>", "1: '1' stands where an attribute must begin in the tag <a> of line 1"},
           {"<a / >", "1: '/' stands where an attribute must begin in the tag <a> of line 1"},
           {"<a\nx='1'\nx='2'/>", "3: a.x: is given twice"},
           {"<a/>\nb", "2: text stands outside of all elements"},
           {"<a>1 < 2</a>", "1: '<' begins no tag here: &lt; is the sign itself"},
           {"<a>\n<!-- </a>", "2: a comment (<!--) is never closed by -->"},
           {"<a>\n<![CDATA[ </a>", "2: a CDATA section (<![CDATA[) is never closed by ]]>"},
           {"<?xml version='1.0'", "1: a declaration (<?) is never closed by ?>"},
           {"<a>\n<?xml?></a>", "2: <? may stand at the beginning of the file alone"},
           {"\n<!DOCTYPE a>", "2: document types and entities are not allowed"},
           {"<a>\n&nbsp;</a>",
            "2: unknown entity: only &amp; &lt; &gt; &quot; &apos; and character numbers are allowed"},
           {"<a>\n\xFF</a>", "2: the file is not valid UTF-8"}})
    EXPECT_EQ(verdict_on_xml(text), verdict) << text;
  for (const char* reference : {"&#0;", "&#x0;", "&#xD800;", "&#x110000;", "&#;", "&#xg;"})
    EXPECT_EQ(verdict_on_xml(std::string("<a>") + reference + "</a>").rfind("1: unknown entity: ", 0), 0u) << reference;
  EXPECT_EQ(verdict_on_xml(std::string_view("<a>\n\0</a>", 9)), "2: the file contains a NUL byte: must be text");
  EXPECT_EQ(verdict_on_xml("<" + std::string(1000, 'n') + ">"), "1: <" + std::string(40, 'n') + "...> is never closed");
}

TEST(Xml, OtherEncodingsAreSaidToBeNoUtf8) {
  for (const std::string_view text : {std::string_view("\xFF\xFE<\0a\0/\0>\0", 10), std::string_view("\xE9<a/>")})
    EXPECT_EQ(verdict_on_xml(text), "1: the file is not valid UTF-8");
  EXPECT_EQ(verdict_on_xml(std::string_view("\0<\0a\0/\0>", 8)), "1: the file contains a NUL byte: must be text");
  EXPECT_EQ(verdict_on_xml(std::string_view("<\0a\0/\0>\0", 8)), "1: the file contains a NUL byte: must be text");
}

TEST(Xml, TakesWhatIsWellFormed) {
  for (const char* text :
       {"<a/>", "\xEF\xBB\xBF<?xml version='1.0'?>\r\n<?more?>\n<!-- > < & -->\n<a\tb = 'c > \"d'\n/>",
        "<a b='&#233;&#x1F600;&amp;'>text ]]> é<![CDATA[ <&> ]]></a >", "<ä:b.c-1 _x=''/>"})
    EXPECT_EQ(verdict_on_xml(text), "1") << text;
  EXPECT_EQ(verdict_on_xml("<a><b/><b></b></a>"), "3");
  EXPECT_EQ(verdict_on_xml(" \n"), "0") << "that there is a root is asked by whoever wants one";
}

TEST(Xml, OfMoreThanTheLimitsIsRefused) {
  EXPECT_EQ(verdict_on_xml("<a><a><a/></a></a>", kFew), "3");
  EXPECT_EQ(verdict_on_xml("<a><a><a>\n<a/>", kFew), "2: more than 3 levels of elements");
  const auto nested = [](int levels) {
    std::string text;
    for (int k = 0; k < levels; ++k) text = "<a>" + text + "</a>";
    return text;
  };
  EXPECT_EQ(verdict_on_xml(nested(98)), "98") << "the parser has a limit of its own";
  EXPECT_EQ(verdict_on_xml(nested(99)), "1: more than 98 levels of elements");
  std::string open;
  for (int k = 0; k < 1'000'000; ++k) open += "<a>";
  EXPECT_EQ(verdict_on_xml(open), "1: more than 98 levels of elements");
  EXPECT_EQ(verdict_on_xml("<a><a/><a/><a/><a/>\n<a/>", kFew), "2: more than 5 elements");
  EXPECT_EQ(verdict_on_xml("<a x='' y='' z=''\nu=''/>", kFew), "2: an element has more than 3 attributes");
  EXPECT_EQ(verdict_on_xml("<a x='' y='' z=''><a x='' y='' z=''/>\n<a x=''/></a>", kFew), "2: more than 6 attributes");
  EXPECT_EQ(verdict_on_xml("<!----><!----><!----><!---->\n<!----><!---->", kFew), "2: more than 5 comments");
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

}  // namespace
}  // namespace hexaplast
