#include "page/markup.h"

#include <gtest/gtest.h>

namespace obscura::page {
namespace {

TEST(Markup, EscapedTextIsReadBackAsItWas) {
  EXPECT_EQ(escaped("1 < 2 & \"3\" > 2"), "1 &lt; 2 &amp; &quot;3&quot; &gt; 2");
  EXPECT_EQ(escaped("&amp;"), "&amp;amp;");
  EXPECT_EQ(escaped("one\n\ttwo, 3 µm"), "one\n\ttwo, 3 µm");
}

TEST(Markup, WhatXmlDoesNotHaveIsASpace) { EXPECT_EQ(escaped(std::string("a\0b\x1B\r", 5)), "a b  "); }

// the examples of RFC 4648 §10, and bytes whose highest bit is set
TEST(Markup, Base64IsThatOfTheStandard) {
  const auto of = [](const std::string& text) {
    return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foob"), "Zm9vYg==");
  EXPECT_EQ(of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(of("\xFB\xFF\xFE"), "+//+");
}

}  // namespace
}  // namespace obscura::page
