#include "app/film/output.h"

#include <gtest/gtest.h>

#include "app/console/exit.h"

namespace obscura::app {
namespace {

using Form = Output::Form;

TEST(Output, TheFormOfTheNameChoosesIt) {
  EXPECT_EQ(output({}, "room", false, 600).path, "render_out/room.mp4");
  EXPECT_EQ(output({}, "room", true, 1).path, "render_out/room.png");
  EXPECT_EQ(output("a.MKV", "room", false, 600).form, Form::movie);
  EXPECT_EQ(output("-", "room", false, 600).form, Form::pipe);
  EXPECT_EQ(output("a.png", "room", true, 1).form, Form::still);
  EXPECT_EQ(output("a.png", "room", false, 1).form, Form::still);
  EXPECT_EQ(output("f/{frame:04}.png", "room", false, 9).form, Form::frames);
  EXPECT_EQ(output("f/", "room", false, 9).path, "f/{frame:04}.png");
}

TEST(Output, BothPatternsNumberTheFrames) {
  EXPECT_EQ(output("f/{frame:04}.png", "room", false, 9).file(7), "f/0007.png");
  EXPECT_EQ(output("f/%04d.png", "room", false, 9).file(7), "f/0007.png");
  EXPECT_EQ(output("f/a{frame}b.png", "room", false, 9).file(12), "f/a12b.png");
  EXPECT_EQ(output("f/%d.png", "room", false, 9).file(12), "f/12.png");
  EXPECT_EQ(output("f/{frame:02}.png", "room", false, 9).file(123), "f/123.png");
}

TEST(Output, WhatCannotBeMeantIsRefusedWithTheRightForm) {
  EXPECT_THROW(output("a.png", "room", false, 600), UsageError);
  EXPECT_THROW(output("a.mp4", "room", true, 1), UsageError);
  EXPECT_THROW(output("{frame:04}.mp4", "room", false, 9), UsageError);
  EXPECT_THROW(output("{frame:xx}.png", "room", false, 9), UsageError);
  EXPECT_THROW(output("{frame.png", "room", false, 9), UsageError);
  EXPECT_THROW(output("100%.png", "room", false, 9), UsageError);
  EXPECT_THROW(output("", "room", false, 9), UsageError);
}

TEST(Output, APartialMovieSaysSo) {
  EXPECT_EQ(output("films/room.mp4", "room", false, 600).partial(), "films/room.partial.mp4");
}

}  // namespace
}  // namespace obscura::app
