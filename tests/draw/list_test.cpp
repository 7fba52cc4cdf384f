#include "draw/picture/list.h"

#include <gtest/gtest.h>

namespace obscura::draw {
namespace {

Disc disc(double x) { return {{x, 0}, 1, 0, {}, {}}; }

TEST(ListOfThings, SaysOfEachWhoseItIsAndWhereInSpaceItHangs) {
  const Hang here{{1, 2, 3}, {1, 2, 3}}, way{{0, 0, 0}, {0, 1, 0}};
  List list;
  list.add(disc(0));
  list.of({Subject::What::layer, 4});
  list.hang(here);
  list.add(disc(1));
  list.hang(way);
  list.add(disc(2));
  list.hang({});
  list.add(disc(3));
  list.hang(here);
  list.of({Subject::What::body, 7});
  list.add(disc(4));
  const auto check = [&](const std::vector<About>& about) {
    ASSERT_EQ(about.size(), 5u);
    EXPECT_FALSE(about[0].hang);
    EXPECT_EQ(about[1].hang, here);
    EXPECT_EQ(about[2].hang, way);
    EXPECT_FALSE(about[3].hang);
    EXPECT_FALSE(about[4].hang) << "of another subject";
    for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(about[i].subject.index, 4);
    EXPECT_EQ(about[4].subject.index, 7);
  };
  check(list.about(Kind::disc));
  // and on a larger page
  List page;
  page.add(list, 2, {10, 20});
  check(page.about(Kind::disc));
}

TEST(ListOfThings, WordsThatKeepToWholePixelsGoWithTheirPage) {
  List list, page;
  Text text{{3, 4}, Align::left, {{.text = "v", .size = 10}}};
  text.whole = Point(1, 2);
  list.add(text);
  page.add(list, 2, {10, 20});
  EXPECT_EQ(page.texts[0].at, Point(16, 28));
  EXPECT_EQ(page.texts[0].whole, Point(12, 24));
}

TEST(ListOfThings, WhatIsClippedAlikeSharesItsClip) {
  List list, page;
  for (int k = 0; k < 3; ++k) {
    list.clip({0, 0, 10, 10});
    list.add(Disc{{1, 1}, 1});
    list.add(Text{{3, 4}, Align::left, {{.text = "v", .size = 10}}});
  }
  page.add(list, 2, {10, 20});
  for (const List* each : {&list, &page}) EXPECT_EQ(each->clips.size(), 1u);
}

}  // namespace
}  // namespace obscura::draw
