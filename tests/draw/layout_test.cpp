#include "draw/page/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "draw/made.h"
#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

constexpr double kAspects[] = {16.0 / 9, 4.0 / 3, 1, 3.0 / 4, 9.0 / 16, 21.0 / 9, 1.85, 1.0 / 3, 4};

std::vector<Text> texts(const Picture& picture) {
  std::vector<Text> all = picture.still->texts;
  all.insert(all.end(), picture.moving.texts.begin(), picture.moving.texts.end());
  return all;
}

struct Reach {
  double left, right, top, bottom;
};

// ascent and descent of Inter: its capitals are 0.727 em, its descenders 0.21
Reach reach(const Text& text) {
  const double width = shape(text).width, size = text.spans[0].size;
  const double left = text.at.x() - (text.align == Align::right    ? width
                                     : text.align == Align::center ? width / 2
                                                                   : 0);
  return {left, left + width, text.at.y() - 0.76 * size, text.at.y() + 0.22 * size};
}

/// The highest and lowest of what stands still and is not type.
double highest(const List& list) {
  double y = 1e9;
  for (const Point& p : list.points) y = std::min(y, p.y());
  for (const Node& n : list.nodes) y = std::min(y, n.at.y());
  return y;
}

TEST(Layout, RoomLiesInsideThePageBelowTheCaptionAtAnyAspect) {
  for (double aspect : kAspects) {
    for (auto [width, height] :
         {std::pair(8.0, 4.5), std::pair(4.0, 3.0), std::pair(1.0, 4.0), std::pair(20.0, 1.0)}) {
      const Made made = room(width, height);
      const View view = made.depictor(aspect).view(0);
      const Point low = view.page({0, 0, 0}), high = view.page({width, height, 0});
      // hatching is 24 units deep at weight 1; then comes the margin
      const double margin = 24 * std::min(1.0, std::sqrt(1080 * aspect / 1440)) + 20 * std::min(1.0, aspect);
      EXPECT_GE(low.x(), margin) << aspect;
      EXPECT_LE(high.x(), 1080 * aspect - margin) << aspect;
      EXPECT_LE(low.y(), 1080 - margin) << aspect;
      EXPECT_NEAR(low.x() + high.x(), 1080 * aspect, 1e-6) << "centred";
      const Picture picture = made.picture(aspect);
      for (const Text& text : texts(picture)) {
        EXPECT_LT(reach(text).bottom, highest(*picture.still)) << aspect << " " << width << " x " << height;
        EXPECT_GT(reach(text).top, 0) << aspect;
      }
    }
  }
}

TEST(Layout, RoomIsAsLargeAsStripAndBandAllow) {
  // one of the two limits is met: the page's width less margins, or its height less strip and margins
  for (double aspect : kAspects) {
    const View view = room(8, 4.5).depictor(aspect).view(0);
    const double w = std::min(1.0, std::sqrt(1080 * aspect / 1440));
    const double wide = 1080 * aspect - 2 * 60 * w - 8 * view.scale;
    const double high = 1080 - (76 + 24 + 60) * w - 4.5 * view.scale;
    EXPECT_GE(wide, -1e-6);
    EXPECT_TRUE(std::abs(wide) < 1e-6 || high < 37) << aspect << " wide " << wide << " high " << high;
  }
}

TEST(Layout, UpIsUpAndRightIsRight) {
  const View view = room(8, 4.5).depictor().view(0);
  EXPECT_LT(view.page({1, 2, 0}).y(), view.page({1, 1, 0}).y());
  EXPECT_LT(view.page({1, 1, 0}).x(), view.page({2, 1, 0}).x());
  EXPECT_NEAR(view.page({2, 1, 0}).x() - view.page({1, 1, 0}).x(), view.scale, 1e-9);
}

TEST(Layout, CaptionFitsAndDoesNotOverlap) {
  const std::string long_title = "A title that goes on for a good deal longer than any title should";
  for (double aspect : kAspects) {
    for (const std::string& title :
         {std::string("The room"), std::string(), long_title, long_title + ", " + long_title}) {
      for (const std::string& subtitle :
           {std::string(), std::string("in brief"), long_title + ", " + long_title}) {
        Made made = room(8, 4.5);
        made.look.title = title;
        made.look.subtitle = subtitle;
        made.now.time = 12.34;
        const std::vector<Text> lines = texts(made.picture(aspect));
        for (std::size_t i = 0; i < lines.size(); ++i) {
          const Reach a = reach(lines[i]);
          EXPECT_GE(a.left, 0) << aspect << title;
          EXPECT_LE(a.right, 1080 * aspect) << aspect << title;
          for (std::size_t j = 0; j < i; ++j) {
            const Reach b = reach(lines[j]);
            EXPECT_TRUE(a.right < b.left || b.right < a.left || a.bottom < b.top || b.bottom < a.top)
                << aspect << ": " << lines[i].spans[0].text << " over " << lines[j].spans[0].text;
          }
        }
      }
    }
  }
}

TEST(Layout, CaptionIsAlignedToTheRoom) {
  const Made made = room(8, 4.5);
  const View view = made.depictor().view(0);
  const Picture picture = made.picture();
  // to the outer edge of the wall's line, 3.2 wide
  EXPECT_NEAR(picture.still->texts[0].at.x(), view.page({0, 0, 0}).x() - 3.2, 1e-6);
  EXPECT_NEAR(picture.moving.texts[0].at.x(), view.page({8, 0, 0}).x() + 3.2, 1e-6);
}

TEST(Layout, WithoutCaptionTheRoomTakesTheStrip) {
  Made made = room(4, 4);
  const double with = made.depictor().view(0).scale;
  made.look.caption = false;
  EXPECT_GT(made.depictor().view(0).scale, 1.03 * with);
  EXPECT_TRUE(texts(made.picture()).empty());
  made.look.caption = true;
  made.look.clock = false;
  made.look.title = made.look.subtitle = "";
  EXPECT_GT(made.depictor().view(0).scale, 1.03 * with) << "nothing to say is no caption";
}

TEST(Layout, LongTitlesGoOnInAnotherLine) {
  Made made = room(4, 3);
  made.look.title =
      "A very long title about everything that happens in this room while a ball falls into it, "
      "and bounces, and rolls away until it has come to rest";
  made.look.subtitle =
      "which takes longer than one would think if nothing but its elasticity were known, and "
      "friction did not matter, as it does here";
  const double plain = room(4, 3).depictor().view(0).scale;
  std::string title, subtitle;
  double before = 0, ground = 0;
  for (const Text& text : texts(made.picture(1.4))) {
    const Span& span = text.spans[0];
    if (span.face != Face::bold && span.text.rfind("t =", 0) == 0) continue;
    (span.face == Face::bold ? title : subtitle) +=
        (before > 0 && !title.empty() && !subtitle.empty() ? " " : "") + span.text + " ";
    EXPECT_GT(text.at.y(), before);
    before = text.at.y();
    EXPECT_EQ(span.text.find("…"), std::string::npos) << span.text;
  }
  (void)ground;
  EXPECT_NE(title.find("come to rest"), std::string::npos) << title;
  EXPECT_NE(subtitle.find("as it does here"), std::string::npos) << subtitle;
  // and the room makes way
  EXPECT_LT(made.depictor().view(0).scale, plain);
}

// The room makes way for the limits of a sum in the caption's last line, whichever that is.
TEST(Layout, DeepMathematicsOfTheCaptionKeepsOffTheRoom) {
  for (const double width : {3.0, 12.0}) {
    Made made = room(width, 4);
    made.look.title = "Title", made.look.subtitle = "with $\\sum_{i=1}^n \\mathbf{F}_i$ and a few more words";
    const Layout& layout = made.depictor().layout();
    ASSERT_EQ(layout.prose.size(), 1u);
    const auto& [words, at] = layout.prose[0];
    const double ceiling = made.depictor().view(0).page({0, 4, 0}).y() - kBand * layout.weight;
    EXPECT_LT(at.y() + words.descent, ceiling) << width;
  }
}

// A title that three lines do not hold is smaller, until nothing of it is left out.
TEST(Layout, TitlesAreSmallerBeforeTheyAreCut) {
  Made made = room(2, 3);
  made.look.title =
      "A very long title of a film that a lecturer wrote in the night before the lecture, about friction and "
      "all the rest of what there is to be said of bodies that touch, before the next lecture begins, and "
      "the next one";
  for (const double aspect : {9.0 / 16, 0.75, 1.0}) {
    std::string title;
    double size = 0;
    for (const Text& text : texts(made.picture(aspect)))
      if (const Span& span = text.spans[0]; span.face == Face::bold) title += span.text, size = span.size;
    EXPECT_TRUE(title.ends_with("the next one")) << title;
    EXPECT_EQ(title.find("…"), std::string::npos) << title;
    EXPECT_GT(size, 10) << aspect;
  }
}

// At every size of type: what is made smaller to fit does.
TEST(Layout, SubtitlesThatFindRoomAreNotCut) {
  for (int scale = 50; scale <= 200; scale += 3) {
    for (int words = 1; words <= 12; ++words) {
      Made made = room(8, 4.5);
      made.look.type_scale = scale / 100.0;
      made.look.title = "Twins";
      made.look.subtitle = "two";
      for (int k = 1; k < words; ++k) made.look.subtitle += " pendulums";
      for (const Text& text : texts(made.picture()))
        EXPECT_EQ(text.spans[0].text.find("…"), std::string::npos) << scale << " " << text.spans[0].text;
    }
  }
}

TEST(Layout, EllipsisKeepsWholeCharacters) {
  const std::string words = "Größe und Übermaß älterer Öfen";
  for (double width = 0; width < 500; width += 3) {
    const std::string kept = fitted(words, Face::regular, 24, width);
    if (kept.empty()) continue;
    const double taken = shape({{0, 0}, Align::left, {{.text = kept, .size = 24}}}).width;
    EXPECT_LE(taken, width);
    if (kept == words) continue;
    EXPECT_EQ(kept.substr(kept.size() - 3), "…");
    EXPECT_EQ(words.compare(0, kept.size() - 3, kept, 0, kept.size() - 3), 0);
    // a cut character would begin with a byte that continues one
    EXPECT_NE(static_cast<unsigned char>(words[kept.size() - 3]) & 0xC0, 0x80);
  }
}

TEST(Layout, ClockHasTwoDecimalsAndNoNegativeZero) {
  EXPECT_EQ(clock_text(3.4166666, 5), "t = 3.42 s");
  EXPECT_EQ(clock_text(0, 5), "t = 0.00 s");
  EXPECT_EQ(clock_text(-0.001, 5), "t = 0.00 s");
  EXPECT_EQ(clock_text(123.456, 200), "t = 123.46 s");
}

TEST(Layout, ClockOfAShortRunHasASmallerUnit) {
  EXPECT_EQ(clock_text(0.05, 0.2), "t = 0.05 s");
  EXPECT_EQ(clock_text(0.05, 0.19), "t = 50.00 ms");
  EXPECT_EQ(clock_text(0.00052, 0.002), "t = 0.52 ms");
  EXPECT_EQ(clock_text(3.2e-5, 1e-4), "t = 32.00 µs");
  EXPECT_EQ(clock_text(3.2e-14, 1e-13), "t = 32.00 fs");
  EXPECT_EQ(clock_text(3.2e-17, 1e-16), "t = 0.03 fs");
}

TEST(Layout, WithoutARoomTheExtentIsFitted) {
  Made made;
  made.cast.scale = 2;
  made.extent = {{-3, 1, 0}, {5, 4, 0}};
  for (double aspect : kAspects) {
    const View view = made.depictor(aspect).view(0);
    const Point low = view.page(made.extent.low), high = view.page(made.extent.high);
    EXPECT_GE(low.x(), 0);
    EXPECT_LE(high.x(), 1080 * aspect);
    EXPECT_LE(low.y(), 1080);
    EXPECT_GE(high.y(), view.window.y);
  }
  EXPECT_TRUE(made.picture().still->strokes.empty()) << "no walls, no frame";
}

TEST(Layout, GroundNearTheBodiesIsInThePicture) {
  Made made;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.extent = {{-1, 0.5, 0}, {1, 2, 0}};
  const View view = made.depictor().view(0);
  EXPECT_LE(view.page({0, 0, 0}).y(), 1080 - 24);
}

}  // namespace
}  // namespace obscura::draw
