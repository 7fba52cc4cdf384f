#include "scene/difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/error.h"

namespace obscura::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> told(const Source& a, const Source& b) {
  std::vector<std::string> all;
  for (const KeyDifference& each : differences(a, b))
    all.push_back(each.path + ": " + each.a + " | " + each.b);
  return all;
}

TEST(KeyDifferences, AreNoneOfCommentsLayoutAndOneNumberWrittenTwice) {
  EXPECT_THAT(told({"duration = 2 # s\n[room]\nsize = [4, 3]\n", {}},
                   {"room = { size = [4, 3] }\nduration = 2.0\n", {}}),
              IsEmpty());
  EXPECT_THAT(told({"duration = 2 # s\n", {}}, {"\nduration = 2.0\n", {}}), IsEmpty());
}

TEST(KeyDifferences, NameAMassByOneUnitInTheLastPlace) {
  const std::string box = "[[box]]\nname = \"crate\"\nmass = ";
  EXPECT_THAT(told({box + "1.0", {}}, {box + "1.0000000000000002", {}}),
              ElementsAre("crate.mass: 1 | 1.0000000000000002"));
}

TEST(KeyDifferences, NameWhatIsThereOnce) {
  EXPECT_THAT(told({"[look]\ntrails = 1\n[[ball]]\nname = \"a\"\n", {}}, {"[[ball]]\nname = \"b\"\n", {}}),
              ElementsAre("look.trails: 1 | ", "a: { name = \"a\" } | ", "b:  | { name = \"b\" }"));
}

TEST(KeyDifferences, AreToldOnOneLine) {
  EXPECT_THAT(told({"title = \"\"\"a\nb\"\"\"\n", {}}, {"title = \"a\\u001B[2J\"\n", {}}),
              ElementsAre("title: \"a b\" | \"a [2J\""));
}

TEST(KeyDifferences, SeeWhatIsSetFromOutside) {
  EXPECT_THAT(told({"[[box]]\nmass = 2\n", {}}, {"[[box]]\nmass = 1\n", {"box[0].mass=2"}}), IsEmpty());
  EXPECT_THAT(told({"duration = 2\n", {}}, {"duration = 2\n", {"look.theme=screen"}}),
              ElementsAre("look.theme:  | \"screen\""));
}

TEST(KeyDifferences, RefuseWhatIsNotToml) { EXPECT_THROW(told({"a = ", {}}, {"", {}}), Error); }

}  // namespace
}  // namespace obscura::scene
