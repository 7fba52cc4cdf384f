// What may be part of a path, and what of a text is shown.

#include <gtest/gtest.h>

#include "scene/complaints.h"
#include "scene/utf8.h"

namespace obscura::scene {
namespace {

TEST(PathName, IsOneThatEveryFolderTakes) {
  for (const char* good : {"a", "side", "from above", "30°", "Überblick", "a.b", "_x-1", "(2)", "日本"})
    EXPECT_TRUE(is_path_name(good)) << good;
  EXPECT_TRUE(is_path_name(std::string(100, 'a')));
  EXPECT_FALSE(is_path_name(std::string(101, 'a')));
  for (const char* bad :
       {"",     ".",    "..",   ".a",    "-a",      " a",      "a ",    "a.",       "a/b",      "/a",
        "a\\b", "c:a",  "a*",   "a?",    "a\"",     "<a",      "a>",    "a|b",      "50%",      "{a",
        "a}",   "a\nb", "a\tb", "a\x7f", "a\u0085", "a\u202E", "a\xff", "\xc0\xaf", "a\xe2\x82"})
    EXPECT_FALSE(is_path_name(bad)) << one_line(bad);
}

TEST(OneLine, KeepsWhatIsShownAndNothingElse) {
  EXPECT_EQ(one_line("Ångström 日本 \U0001F600"), "Ångström 日本 \U0001F600");
  EXPECT_EQ(one_line("a\x1b[31m\nb\x7f"), "a [31m b ");
  EXPECT_EQ(one_line("a\u009b2J"), "a 2J");
  EXPECT_EQ(one_line("a\u202Eb\u2066c\u2028d"), "a b c d");
  EXPECT_EQ(one_line("a\xff\xc0\xaf\xe2\x82z\xed\xa0\x80"), "a?????z???");
  EXPECT_EQ(one_line(""), "");
}

}  // namespace
}  // namespace obscura::scene
