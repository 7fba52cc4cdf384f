#include "page/reel.h"

#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "page/html.h"

namespace obscura::page {
namespace {

using draw::Point;

constexpr draw::Color kInk{10, 20, 30, 255};

nlohmann::ordered_json made(Reel& reel) {
  nlohmann::ordered_json json;
  reel.finish(json);
  return json;
}

// numbers as Reel::Form has them
constexpr int kRigid = 1, kGrown = 2, kLoose = 3;

TEST(Reel, AFormThatMovesAndTurnsIsWrittenOnce) {
  Reel reel;
  for (int i = 0; i < 50; ++i) {
    draw::Picture picture;
    const double c = std::cos(0.1 * i), s = std::sin(0.1 * i);
    std::vector<Point> corners;
    for (const Point& p : {Point(-40, -10), Point(40, -10), Point(0, 60)})
      corners.emplace_back(200 + 5 * i + c * p.x() - s * p.y(), 300 + s * p.x() + c * p.y());
    picture.moving.of({draw::Subject::What::body, 3});
    picture.moving.add(corners, kInk);
    reel.add(picture);
  }
  const auto json = made(reel);
  ASSERT_EQ(json["things"].size(), 1u);
  EXPECT_EQ(json["things"][0]["form"], kRigid);
  EXPECT_EQ(json["things"][0]["points"], 3);
  EXPECT_EQ(json["things"][0]["of"][1], 3);
}

TEST(Reel, ALineThatGrowsIsWrittenOnce) {
  Reel reel;
  for (int i = 0; i < 50; ++i) {
    draw::Picture picture;
    std::vector<draw::Node> line;
    for (int k = 0; k < 2 + i; ++k) line.push_back({{10.0 * k, 100 * std::sin(0.3 * k)}, 2, kInk});
    line.push_back({{10.0 * (2 + i) - 4, 7}, 2, kInk});
    picture.moving.add(line);
    reel.add(picture);
  }
  const auto json = made(reel);
  ASSERT_EQ(json["things"].size(), 1u);
  EXPECT_EQ(json["things"][0]["form"], kGrown);
  EXPECT_EQ(json["things"][0]["points"], 51);
}

TEST(Reel, WhatChangesItsFormIsWrittenFrameByFrame) {
  Reel reel;
  for (int i = 0; i < 9; ++i) {
    draw::Picture picture;
    std::vector<draw::Node> line;
    for (int k = 0; k < 6; ++k) line.push_back({{10.0 * k, 20 * std::sin(0.7 * k * i)}, 2, kInk});
    picture.moving.add(line);
    reel.add(picture);
  }
  EXPECT_EQ(made(reel)["things"][0]["form"], kLoose);
}

TEST(Reel, AThingThatGoesAndComesBackHasTwoLives) {
  Reel reel;
  for (int i = 0; i < 10; ++i) {
    draw::Picture picture;
    picture.moving.of({draw::Subject::What::body, 0});
    if (i < 3 || i > 6) picture.moving.add(draw::Disc{{50, 50}, 10, 2, kInk, kInk});
    picture.moving.of({draw::Subject::What::body, 1});
    picture.moving.add(draw::Disc{{90, 50}, 10, 2, kInk, kInk});
    reel.add(picture);
  }
  const auto json = made(reel);
  ASSERT_EQ(json["things"].size(), 2u);
  EXPECT_EQ(json["things"][0]["lives"], (nlohmann::ordered_json{0, 3, 7, 10}));
  EXPECT_FALSE(json["things"][1].contains("lives")) << "always there";
}

TEST(Html, ItsOriginComesBackAsItWas) {
  Reel reel;
  draw::Picture picture;
  picture.moving.add(draw::Disc{{90, 50}, 10, 2, kInk, kInk});
  reel.add(picture);
  FilmPage page;
  page.title = "a </title> \"b\" & 'c'";
  page.origin = "{\"text\": \"<!-- --> & \\\"x\\\" 'y' &amp; </script>\"}";
  const std::string file = html(page, reel);
  EXPECT_EQ(origin_in_html(file), page.origin);
  EXPECT_EQ(file.find("a </title>"), file.npos);
  EXPECT_EQ(origin_in_html("<html></html>"), "");
}

}  // namespace
}  // namespace obscura::page
