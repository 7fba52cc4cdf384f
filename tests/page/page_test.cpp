// A page: as large as it is told, with its things where the list has them.

#include "page/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <map>
#include <string>

#include "needs.h"

namespace obscura::page {
namespace {

using testing::HasSubstr;
using testing::Not;

// 1080 units are 108 pt high, so that ten units are a point
constexpr double kWidth = 216;

draw::Picture picture(draw::List list) {
  draw::Picture it;
  it.aspect = 2;
  it.ground = {255, 255, 255};
  it.moving = std::move(list);
  return it;
}

std::string svg(draw::List list) {
  const auto bytes = page(picture(std::move(list)), Form::svg, {.width = kWidth, .title = ""});
  return {bytes.begin(), bytes.end()};
}

TEST(Page, AnOutlineLiesWithinItsRim) {
  draw::List list;
  list.add(draw::Disc{{100, 200}, 50, 10, {1, 2, 3}, {4, 5, 6}});
  // radius 5 pt, line 1 pt: its middle is 4.5 pt out, and so far goes the fill
  EXPECT_THAT(svg(list), HasSubstr("<circle cx=\"10\" cy=\"20\" r=\"4.5\" fill=\"#010203\"/>\n"
                                   "<circle cx=\"10\" cy=\"20\" r=\"4.5\" fill=\"none\" stroke-width=\"1\" "
                                   "stroke=\"#040506\"/>"));
}

TEST(Page, AnEvenStrokeIsOneLineAndATaperingOneIsPieces) {
  draw::List even, taper;
  even.add({{{0, 0}, 10, {}}, {{100, 0}, 10, {}}, {{100, 100}, 10, {}}}, draw::Cap::butt);
  EXPECT_THAT(svg(even), HasSubstr("<path d=\"M0 0L10 0 10 10\" fill=\"none\" stroke-width=\"1\""));
  taper.add({{{0, 0}, 10, {}}, {{100, 0}, 20, {}}}, draw::Cap::butt);
  // from half a point on either side to a point
  EXPECT_THAT(svg(taper), HasSubstr("<path d=\"M0 0.5L10 1 10 1 10 -1 10 -1 0 -0.5Z\""));
}

TEST(Page, WhatFadesIsMixedWithTheGround) {
  draw::List list;
  list.add({{{0, 0}, 10, {0, 0, 0, 51}}, {{100, 0}, 10, {0, 0, 0, 51}}}, draw::Cap::butt,
           draw::Blend::darken);
  EXPECT_THAT(svg(list), HasSubstr("stroke=\"#cccccc\""));  // 255 * 4 / 5
  EXPECT_THAT(svg(list), Not(HasSubstr("stroke-opacity")));
}

TEST(Page, WhatIsClippedIsInAGroup) {
  draw::List list;
  list.clip({10, 20, 30, 40});
  list.add(draw::Disc{{0, 0}, 50, 0, {}, {}});
  list.unclip();
  list.add(draw::Disc{{0, 0}, 60, 0, {}, {}});
  EXPECT_THAT(svg(list), HasSubstr("<path d=\"M1 2h3v4h-3Z\"/></clipPath>\n<g clip-path=\"url(#c1)\">\n"
                                   "<circle cx=\"0\" cy=\"0\" r=\"5\" fill=\"#000000\"/>\n</g>\n<circle"));
}

TEST(Page, TypeIsEscapedAndBringsItsFont) {
  draw::List list;
  list.add(draw::Text{{0, 0}, draw::Align::left, {{.text = "a<b & c", .size = 100}}});
  const std::string page = svg(list);
  EXPECT_THAT(page, HasSubstr(">a&lt;b &amp; c</tspan>"));
  EXPECT_THAT(page, HasSubstr("font-size=\"10\""));
  EXPECT_THAT(page, HasSubstr("src:url(data:font/otf;base64,T1RUTw"));  // "OTTO"
}

TEST(Page, APdfIsTheSameBytesWheneverItIsMade) {
  OBSCURA_NEEDS(writes(Form::pdf), "libcairo2-dev, where it is built");
  draw::List list;
  list.add(draw::Text{{0, 0}, draw::Align::left, {{.text = "v", .face = draw::Face::math_italic}}});
  const auto one = page(picture(list), Form::pdf, {}), other = page(picture(list), Form::pdf, {});
  EXPECT_EQ(one, other);
  const std::string text(one.begin(), one.end());
  EXPECT_THAT(text, HasSubstr("%PDF-1.4"));
  EXPECT_THAT(text, Not(HasSubstr("CreationDate")));
}

/// A number behind a word of a file, from some place on.
std::size_t number_at(const std::string& file, const std::string& word, std::size_t from = 0) {
  return std::stoul(file.substr(file.find(word, from) + word.size()));
}

/// Screen readers say the description instead of the picture; the last table of the file has its figure and
/// its catalogue where they are.
TEST(Page, APdfThatIsDescribedIsATaggedFigure) {
  OBSCURA_NEEDS(writes(Form::pdf), "libcairo2-dev, where it is built");
  draw::List list;
  list.add(draw::Disc{{100, 200}, 50, 10, {1, 2, 3}, {4, 5, 6}});
  const Sheet sheet{.width = kWidth, .title = "A fall", .text = "A ball, \u03bc = 0.3, \U0001D44E."};
  const auto bytes = page(picture(list), Form::pdf, sheet);
  EXPECT_EQ(page(picture(list), Form::pdf, sheet), bytes);
  const std::string file(bytes.begin(), bytes.end());
  const std::size_t table = number_at(file, "startxref\n", file.rfind("startxref"));
  ASSERT_EQ(file.substr(table, 5), "xref\n");
  const std::size_t root = number_at(file, "/Root ", table);
  // entries: a number and 1, then the place
  std::size_t line = table + 5;
  std::map<std::size_t, std::string> objects;
  while (std::isdigit(file[line])) {
    const std::size_t number = std::stoul(file.substr(line));
    line = file.find('\n', line) + 1;
    const std::size_t place = std::stoul(file.substr(line, 10));
    line += 20;
    objects[number] = file.substr(place, file.find("endobj", place) - place);
    EXPECT_EQ(std::stoul(objects[number]), number);
  }
  ASSERT_EQ(objects.size(), 2u);
  for (const char* key :
       {"/Type /Catalog", "/StructTreeRoot", "/MarkInfo", "/Lang (en)", "/DisplayDocTitle true"})
    EXPECT_THAT(objects[root], HasSubstr(key));
  objects.erase(root);
  EXPECT_THAT(objects.begin()->second, HasSubstr("/S /Figure"));
  EXPECT_THAT(objects.begin()->second, HasSubstr("/Alt <FEFF004100200062"));
  EXPECT_THAT(objects.begin()->second, HasSubstr("03BC0020003D00200030002E0033002C0020D835DC4E002E>"));
  EXPECT_THAT(file.substr(table), HasSubstr("/Prev " + std::to_string(number_at(file, "startxref\n"))));
  // what is not described has no tags
  const auto plain = page(picture(list), Form::pdf, {.width = kWidth, .title = "A fall"});
  EXPECT_THAT(std::string(plain.begin(), plain.end()), Not(HasSubstr("/Figure")));
}

}  // namespace
}  // namespace obscura::page
