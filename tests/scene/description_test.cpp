// SPDX-License-Identifier: LGPL-2.1-or-later
// What a scene file says of itself.
#include "scene/description.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace hexaplast::scene {
namespace {

std::optional<Description> description_in(const std::string& text) {
  const support::Scratch scratch;
  support::put(scratch / "some.scn", text);
  return description_of(scratch / "some.scn");
}

TEST(Description, IsTheLineAndTheParagraphAtTheHeadOfTheFile) {
  const auto found = description_in(
      "<?xml version=\"1.0\"?>\n<!-- a licence -->\n<!--\n  Fat on a\n  vessel\n\n  It is   drawn\n  out.\n\n  "
      "More.\n-->"
      "\n<Node name=\"root\"><!-- within\n\n  the scene --></Node>\n");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->heading, "Fat on a vessel");
  EXPECT_EQ(found->words, "It is drawn out.");
}

TEST(Description, IsNoneWhereTheFileHasNone) {
  EXPECT_FALSE(description_in("<Node name=\"root\"><!-- within\n\n  the scene --></Node>"));
  EXPECT_FALSE(description_in("<!-- a licence --><Node name=\"root\"/>"));
  EXPECT_FALSE(description_in("<!-- long " + std::string(200, 'x') + "\n\n words --><Node name=\"root\"/>"));
  EXPECT_FALSE(description_in("<!-- one\n\n two --><Node"));
  EXPECT_FALSE(description_of("/nowhere.scn"));
  EXPECT_FALSE(description_of("/dev/zero"));
}

TEST(Description, OfEveryShippedSceneIsThere) {
  for (const auto& entry : std::filesystem::directory_iterator(HEXAPLAST_SOURCE_DIR "/scenes"))
    if (entry.path().extension() == ".scn") {
      EXPECT_TRUE(description_of(entry.path())) << entry.path();
    }
}

}  // namespace
}  // namespace hexaplast::scene
