// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formats/base64.hpp"

#include <gtest/gtest.h>

#include <tuple>

namespace hexaplast {
namespace {

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
