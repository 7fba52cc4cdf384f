// Labels: the words of bodies, beside them and upright.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "draw/compose/annotations.h"
#include "draw/compose/comparison.h"
#include "draw/compose/label_courses.h"
#include "draw/made.h"
#include "draw/page/layout.h"
#include "draw/picture/formula.h"
#include "draw/picture/type.h"
#include "draw/space/camera.h"

namespace obscura::draw {
namespace {

using sim::ShapeKind;

// the text of a list that says these words
const Text* said(const List& list, const std::string& words) {
  for (const Text& text : list.texts)
    if (text.spans[0].text == words) return &text;
  return nullptr;
}

double middle(const Text& text) { return text.at.x() + shape(text).width / 2; }

TEST(Labels, StandOverTheHighestCornerHoweverTheBodyIsTurned) {
  Made made = room(8, 4.5);
  const int it = made.body(ShapeKind::box, {3, 2, 0}, 0.5);
  made.look.bodies[it].label = "crate";
  for (double angle : {0.0, 0.4, 0.785398}) {
    made.now.bodies[it].angle = angle;
    made.now.bodies[it].orientation = Eigen::AngleAxisd(angle, sim::Vec3::UnitZ());
    const Picture picture = made.picture();
    const Text* text = said(picture.moving, "crate");
    ASSERT_TRUE(text);
    const View view = made.depictor().view(0);
    const double high = 0.5 * (std::abs(std::sin(angle)) + std::abs(std::cos(angle)));
    const double over = view.page({3, 2 + high, 0}).y() - text->at.y();
    EXPECT_GT(over, 5);
    EXPECT_LT(over, 25);
    EXPECT_NEAR(middle(*text), view.page({3, 2, 0}).x(), 1e-9);
  }
}

TEST(Labels, StayInTheWindow) {
  Made made = room(8, 4.5);
  made.wall({0, 0, 0}, {0, 1, 0});
  const int it = made.body(ShapeKind::ball, {0.02, 4.49, 0}, 0.01);
  made.look.bodies[it].label = "a ball with many words";
  CameraKey key;
  key.center = sim::Vec3(1, 4, 0), key.width = 1.97;
  made.camera.keys = {key};
  const Picture picture = made.picture();
  const Text* text = said(picture.moving, "a ball with many words");
  ASSERT_TRUE(text);
  const View view = made.depictor().view(0);
  EXPECT_GE(text->at.x(), view.window.x);
  EXPECT_LE(text->at.x() + shape(*text).width, view.window.x + view.window.width);
  EXPECT_GE(text->at.y() - text->spans[0].size, view.window.y);
}

TEST(Labels, InSpaceStandOverTheBodyForEachCamera) {
  Made made;
  made.cast.dimension = 3, made.cast.scale = 2;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.extent = {{-2, 0, -2}, {2, 2, 2}};
  const int it = made.body(ShapeKind::ball, {0.5, 0.6, -0.3}, 0.2);
  made.look.bodies[it].label = "ball";
  const Illustrator depictor(made.cast, made.look, {side(), slant()}, made.extent, 16.0 / 9);
  const Picture picture = depictor.depict(made.now, {});
  std::vector<Text> found;
  for (const Text& text : picture.moving.texts)
    if (text.spans[0].text == "ball") found.push_back(text);
  ASSERT_EQ(found.size(), 2u);
  for (int panel = 0; panel < 2; ++panel) {
    const CameraProjection lens = depictor.lens(made.now, panel);
    const Point center = lens.page(made.now.bodies[it].position);
    EXPECT_NEAR(middle(found[std::size_t(panel)]), center.x(), 1e-9);
    const double over =
        center.y() - 0.2 * lens.scale_at(made.now.bodies[it].position) - found[std::size_t(panel)].at.y();
    EXPECT_GT(over, 5);
    EXPECT_LT(over, 25);
  }
}

TEST(Labels, AreMathematicsOrWords) {
  const auto of = [](const std::string& words) {
    Made made = room(8, 4.5);
    made.look.bodies[made.body(ShapeKind::ball, {3, 2, 0}, 0.3)].label = words;
    std::vector<std::pair<std::string, Face>> spans;
    for (const Text& text : made.picture().moving.texts)
      for (const Span& span : text.spans)
        if (span.face >= Face::math) spans.emplace_back(span.text, span.face);
    return spans;
  };
  using Spans = std::vector<std::pair<std::string, Face>>;
  EXPECT_EQ(of("m_1"), (Spans{{"m", Face::math_italic}, {"1", Face::math}}));
  EXPECT_EQ(of("m = 2 kg"), (Spans{{"m", Face::math_italic}, {" = 2 kg", Face::math}}));
  EXPECT_EQ(of("Io"), (Spans{{"Io", Face::math}}));
  EXPECT_EQ(of("a ball at rest"), (Spans{{"a ball at rest", Face::math}}));
  EXPECT_EQ(of("\xC3\x89tienne"), (Spans{{"\xC3\x89tienne", Face::math}}));
  EXPECT_EQ(of("$\\mu m$")[0], (Spans::value_type{"μm", Face::math_italic}));
}

// a body that lies over the usual place, and an arrow there
TEST(Labels, KeepOffOtherBodiesAndTheArrowsOfBodies) {
  for (const bool arrow : {false, true}) {
    Made made = room(8, 4.5);
    const int it = made.body(ShapeKind::ball, {3, 2, 0}, 0.3);
    made.look.bodies[it].label = "Sun";
    if (arrow)
      made.look.bodies[it].velocity = true, made.now.bodies[it].velocity = {0, 20, 0};
    else
      made.body(ShapeKind::ball, {3, 2.75, 0}, 0.4);
    const Picture picture = made.picture();
    const Text* text = said(picture.moving, "Sun");
    ASSERT_TRUE(text);
    const View view = made.depictor().view(0);
    const double low = text->at.y(), high = text->at.y() - 0.7 * text->spans[0].size;
    for (int k = 0; k <= 40; ++k) {
      // its shaft, or the other ball's edge
      const double a = 0.05 * k * 3.14159265;
      const Point p = arrow ? view.page({3, 2.0 + 0.05 * k, 0})
                            : view.page({3 + 0.4 * std::cos(a), 2.75 + 0.4 * std::sin(a), 0});
      EXPECT_FALSE(p.x() > text->at.x() && p.x() < text->at.x() + shape(*text).width && p.y() > high &&
                   p.y() < low)
          << arrow << " " << k;
    }
  }
}

// Runs that are drawn over each other have their names as the panels have them.
TEST(Labels, NamesOfRunsOverEachOtherAreMathematics) {
  std::vector<ComparedRun> runs(3);
  runs[0].name = "Euler", runs[1].name = "RK4 $\\sqrt{h}$", runs[2].name = "$\\frac{a}{b}$";
  const std::vector<RunInstant> nows(3);
  List list;
  draw_run_names(runs, nows, {0, 0, 1000, 1000}, 1, palette(Theme::paper), list);
  EXPECT_TRUE(said(list, "Euler"));
  EXPECT_TRUE(said(list, "RK4 "));
  EXPECT_TRUE(said(list, "h"));
  for (const Text& text : list.texts) EXPECT_EQ(text.spans[0].text.find("√"), std::string::npos);
  EXPECT_GE(list.strokes.size(), 2u);  // the root's sign and the fraction's bar
  // one below the other, and no plate over another
  EXPECT_GT(said(list, "RK4 ")->at.y(), said(list, "Euler")->at.y() + 20);
  EXPECT_GT(said(list, "a")->at.y() - 20, said(list, "RK4 ")->at.y());
}

// how much of a line lies in a text's rectangle
double covered(const Text& text, const Point& a, const Point& b) {
  const double wide = shape(text).width, tall = text.spans[0].size;
  constexpr int kPieces = 200;
  int within = 0;
  for (int k = 0; k <= kPieces; ++k) {
    const Point p = a + (b - a) * k / kPieces;
    within += p.x() > text.at.x() && p.x() < text.at.x() + wide && p.y() < text.at.y() &&
              p.y() > text.at.y() - 0.7 * tall;
  }
  return (b - a).norm() * within / (kPieces + 1);
}

/// The words of an arrow that goes round past two others do not go over these with it.
TEST(Labels, OfAnArrowThatGoesRoundKeepOffTheOthers) {
  Made made = room(8, 4.5);
  const int it = made.body(ShapeKind::ball, {4, 2.3, 0}, 0.15);
  Marks marks;
  for (const Quantity quantity : {Quantity::drag, Quantity::velocity, Quantity::field}) {
    Marks::Vector vector;
    vector.quantity = quantity, vector.body = it;
    vector.label = quantity == Quantity::drag       ? "D = {:.1}"
                   : quantity == Quantity::velocity ? "v = {:.1}"
                                                    : "F = {:.1}";
    marks.vectors.push_back(vector);
  }
  RunAhead ahead;
  for (int k = 0; k <= 90; ++k) {
    sim::Snapshot now = made.now;
    now.time = k / 30.0;
    const double turn = 2 * std::numbers::pi * now.time / 1.5;
    now.bodies[0].drag = {0, -1, 0}, now.bodies[0].velocity = {1, 0, 0};
    now.bodies[0].field = sim::Vec3(std::cos(turn), std::sin(turn), 0);
    ahead.moments.push_back(now), ahead.films.push_back(now.time);
  }
  const Illustrator artist = made.depictor();
  const Annotations annotations(marks, artist, ahead, {.velocity = 0.8, .force = 0.8}, 60, 0);
  int over = 0, unseen = 0;
  for (std::size_t k = 0; k < ahead.moments.size(); ++k) {
    const Projection projection = artist.projection(0, ahead.moments[k]);
    List list;
    annotations.draw(0, projection, ahead.moments[k], ahead.films[k], list);
    const Text* text = said(list, "F");
    if (!text) {
      ++unseen;
      continue;
    }
    const auto page = [&](double x, double y) { return projection.page({x, y, 0}); };
    over += covered(*text, page(4, 2.3), page(4, 1.5)) + covered(*text, page(4, 2.3), page(4.8, 2.3)) > 6;
  }
  EXPECT_LE(over, 4) << "of " << ahead.moments.size();
  EXPECT_LE(unseen, 4) << "of " << ahead.moments.size();
}

/// In a figure, where an arrow's words have several places and a label of the room one.
TEST(Labels, OfAnArrowKeepOffALabelThatHasItsPlace) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {4, 3, 0}, 0.2);
  made.now.bodies[0].velocity = {0, -1, 0};
  Marks marks;
  Marks::Vector vector;
  vector.quantity = Quantity::velocity, vector.body = 0, vector.label = "fall";
  marks.vectors.push_back(vector);
  const auto words = [&](const Point& at) {
    marks.labels = {{{-1, {at.x(), at.y(), 0}}, "label", {}, -1, {}}};
    const Illustrator artist = made.depictor();
    List list;
    annotate(marks, {.velocity = 1.5}, made.cast, artist.colours(), artist.projection(0, made.now), made.now,
             list);
    const Text &name = *said(list, "fall"), &label = *said(list, "label");
    const double size = label.spans[0].size;
    return covered(name, label.at - Point(0, 0.3 * size), label.at + Point(shape(label).width, -0.3 * size));
  };
  // all around the arrow's tip
  for (const double x : {3.5, 3.7, 3.9, 4.1, 4.3, 4.5})
    for (const double y : {1.2, 1.4, 1.6, 1.8}) EXPECT_EQ(words({x, y}), 0) << x << " " << y;
}

/// The farthest that the words `begins` go in a frame as seen from body 0, page units, in three seconds of a
/// run that at(time) tells. see(text, projection, now) is called for each frame.
template <class At, class See>
double fastest_of_words(const Made& made, const Marks& marks, const Scales& scales, const char* begins,
                        At&& at, See&& see) {
  RunAhead ahead;
  for (int k = 0; k <= 45; ++k) ahead.moments.push_back(at(k / 15.0)), ahead.films.push_back(k / 15.0);
  const Illustrator artist = made.depictor();
  const Annotations annotations(marks, artist, ahead, scales, 60, 0);
  std::optional<Point> last;
  double fastest = 0;
  for (int n = 0; n <= 180; ++n) {
    const sim::Snapshot now = at(n / 60.0);
    const Projection projection = artist.projection(0, now);
    List list;
    annotations.draw(0, projection, now, now.time, list);
    const Text* text = said(list, begins);
    if (!text) {
      ADD_FAILURE() << "no words in frame " << n;
      return fastest;
    }
    const Point beside = text->at - projection.page(now.bodies[0].position);
    if (last) fastest = std::max(fastest, (beside - *last).norm());
    last = beside;
    see(*text, projection, now);
  }
  return fastest;
}

/// The words of an arrow that flips in an instant, as the velocity of a ball that bounces, do not jump with
/// it, nor lie on it.
TEST(Labels, OfAnArrowThatFlipsDoNotJump) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {4, 2.3, 0}, 0.15);
  Marks marks;
  Marks::Vector vector;
  vector.quantity = Quantity::velocity, vector.body = 0, vector.label = "v = {:.1}";
  marks.vectors.push_back(vector);
  for (const sim::Vec3& after : {sim::Vec3(0.4, 1, 0), sim::Vec3(-0.6, -0.9, 0), sim::Vec3(0, 0.8, 0)}) {
    const auto at = [&](double time) {
      sim::Snapshot now = made.now;
      now.time = time;
      const double flipped = 1.217;
      now.bodies[0].position.x() = 3.5 + 0.5 * time;
      now.bodies[0].velocity = time < flipped ? sim::Vec3(after.x(), -after.y(), 0) : after;
      return now;
    };
    double over = 0;
    const double fastest = fastest_of_words(
        made, marks, {.velocity = 0.8}, "v", at,
        [&](const Text& text, const Projection& projection, const sim::Snapshot& now) {
          const sim::Vec3 &center = now.bodies[0].position, tip = center + 0.8 * now.bodies[0].velocity;
          over = std::max(over, covered(text, projection.page(center), projection.page(tip)));
        });
    EXPECT_LT(fastest, 2) << after.transpose();
    EXPECT_LT(over, 3) << after.transpose();
  }
}

/// The words of an arrow that becomes longer or shorter in an instant, or in a blow, do not jump with it.
TEST(Labels, OfAnArrowThatChangesInAnInstantDoNotJump) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {4, 2.3, 0}, 0.15);
  Marks marks;
  Marks::Vector vector;
  vector.quantity = Quantity::drag, vector.body = 0, vector.label = "D = {:.1}";
  marks.vectors.push_back(vector);
  struct Change {
    double before, after, blow;
  };
  for (const auto& [before, after, blow] :
       {Change{1, 0.4, 0}, {0.3, 1.3, 0}, {0.5, 0.5, 1.6}, {0.4, 1, 1.6}}) {
    const auto at = [&, before = before, after = after, blow = blow](double time) {
      sim::Snapshot now = made.now;
      now.time = time;
      now.bodies[0].position.x() = 3.5 + 0.5 * time;
      const double since = time - 1.217;
      now.bodies[0].drag = {0, since < 0 ? before : blow > 0 && since < 0.02 ? blow : after, 0};
      return now;
    };
    const double fastest = fastest_of_words(made, marks, {.force = 1}, "D", at, [](auto&&...) {});
    EXPECT_LT(fastest, 2) << before << " to " << after << " by " << blow;
  }
}

/// Where an arrow turns around and begins elsewhere, as friction does when a box turns back, the place around
/// which words stand goes over.
TEST(Labels, OfAnArrowThatBeginsElsewhereGoOver) {
  EasedArrow arrow;
  const auto real = [](double film) {
    return film < 1.02 ? EasedArrow::Ends{{10, 0}, {60, 0}} : EasedArrow::Ends{{-10, 0}, {-60, 0}};
  };
  for (int k = 0; k <= 30; ++k) arrow.add(k / 15.0, (k - 1) / 15.0, real(k / 15.0));
  arrow.ease(100, 3);
  double fastest = 0;
  for (int n = 1; n <= 120; ++n) {
    const auto at = [&](int frame) { return arrow.at(frame / 60.0, real(frame / 60.0)); };
    fastest = std::max(fastest, (at(n).first - at(n - 1).first).norm());
    // but it is never said to point where it does not
    const EasedArrow::Ends eased = at(n), now = real(n / 60.0);
    EXPECT_NEAR((eased.second - eased.first - (now.second - now.first)).norm(), 0, 1e-9) << n;
  }
  EXPECT_LT(fastest, 2);
  EXPECT_NEAR(arrow.at(0, real(0)).first.x(), 10, 1e-9);
  EXPECT_NEAR(arrow.at(2, real(2)).first.x(), -10, 1e-9);
}

/// An arrow that goes round is where it is for its words, too.
TEST(Labels, OfAnArrowThatGoesRoundGoWithIt) {
  EasedArrow arrow;
  const auto real = [](double film) {
    const double turn = 5 * film;
    return EasedArrow::Ends{{5, 0}, {5 + 90 * std::cos(turn), (60 + 20 * film) * std::sin(turn)}};
  };
  for (int k = 0; k <= 30; ++k) arrow.add(k / 15.0, (k - 1) / 15.0, real(k / 15.0));
  arrow.ease(100, 3);
  for (int n = 0; n <= 120; ++n) {
    const EasedArrow::Ends now = real(n / 60.0);
    EXPECT_LT((arrow.at(n / 60.0, now).second - now.second).norm(), 1e-9) << n;
  }
}

/// A name says nothing of an arrow that is shorter than its head by far; a value does, also where the arrow
/// is too short to be drawn, until it is nearly nothing.
TEST(Labels, NameNoArrowThatIsHardlySeen) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {4, 2.3, 0}, 0.15);
  const Illustrator artist = made.depictor();
  const auto strength = [&](const char* label, double force) {
    made.now.bodies[0].drag = {force, 0, 0};
    Marks marks;
    Marks::Vector vector;
    vector.quantity = Quantity::drag, vector.body = 0, vector.label = label;
    marks.vectors.push_back(vector);
    RunAhead ahead{{made.now}, {0}, {}, {}, {}};
    const Annotations annotations(marks, artist, ahead, {.force = 0.05}, 60, 0);
    List list;
    annotations.draw(0, artist.projection(0, made.now), made.now, 0, list);
    const Text* text = said(list, "F");
    return text ? text->spans[0].color.a : 0;
  };
  EXPECT_EQ(strength("F", 1.2), 0);
  EXPECT_EQ(strength("F", 3), 255);
  EXPECT_EQ(strength("F = {:.1}", 1.2), 255);
  for (const double force : {0.9, 0.7, 0.4}) EXPECT_EQ(strength("F = {:.1}", force), 255) << force;
  EXPECT_EQ(strength("F", 0.4), 0);
  EXPECT_EQ(strength("F = {:.1}", 0.001), 0);
}

/// The words of an arrow whose body leaves the picture leave it as fast, not in an instant.
TEST(Labels, LeaveThePictureWithTheirArrow) {
  Made made = room(8, 4.5);
  made.body(ShapeKind::ball, {4, 2.3, 0}, 0.15);
  Marks marks;
  Marks::Vector vector;
  vector.quantity = Quantity::velocity, vector.body = 0, vector.label = "v";
  marks.vectors.push_back(vector);
  const auto at = [&](double time) {
    sim::Snapshot now = made.now;
    now.time = time;
    now.bodies[0].velocity = {2, 0, 0};
    now.bodies[0].position.x() = 6.5 + 1.5 * time;
    return now;
  };
  RunAhead ahead;
  for (int k = 0; k <= 30; ++k) ahead.moments.push_back(at(k / 15.0)), ahead.films.push_back(k / 15.0);
  const Illustrator artist = made.depictor();
  const Annotations annotations(marks, artist, ahead, {.velocity = 0.4}, 60, 0);
  Point last(0, 0);
  bool before = false;
  const Projection projection = artist.projection(0, made.now);
  const double own = 1.5 / 60 * projection.scale_at({4, 2, 0});
  double fastest = 0, farthest = 0;
  for (int n = 0; n <= 120; ++n) {
    const sim::Snapshot now = at(n / 60.0);
    List list;
    annotations.draw(0, projection, now, now.time, list);
    const Text* text = said(list, "v");
    if (text && before) fastest = std::max(fastest, (text->at - last).norm());
    before = text != nullptr;
    if (text) last = text->at, farthest = std::max(farthest, text->at.x());
  }
  EXPECT_LT(fastest, 1.6 * own);
  EXPECT_GT(farthest, projection.page({8, 0, 0}).x());
}

/// Two arrows on one line that point at each other stand side by side; in the picture of a film they would be
/// a star.
TEST(Labels, ArrowsThatMeetHeadOnStandSideBySide) {
  const auto apart = [](double aside) {
    Made made = room(8, 4.5);
    Marks marks;
    for (const double side : {-1.0, 1.0}) {
      const int it = made.body(ShapeKind::ball, {4 + side, side > 0 ? 2 + aside : 2, 0}, 0.15);
      made.now.bodies.back().drag = {-side, 0, 0};
      Marks::Vector vector;
      vector.quantity = Quantity::drag, vector.body = it;
      marks.vectors.push_back(vector);
    }
    const Illustrator artist = made.depictor();
    RunAhead ahead{{made.now}, {0}, {}, {}, {}};
    const Annotations annotations(marks, artist, ahead, {.force = 1.2}, 60, 0);
    const Projection projection = artist.projection(0, made.now);
    List list;
    annotations.draw(0, projection, made.now, 0, list);
    double low = 1e300, high = -1e300;  // of the middles of heads and shafts
    for (const Node& node : list.nodes) low = std::min(low, node.at.y()), high = std::max(high, node.at.y());
    return high - low;
  };
  const double side_by_side = apart(0), with_room = apart(0.5);
  EXPECT_GT(side_by_side, 6);
  EXPECT_LT(side_by_side, 20);
  EXPECT_GT(with_room, 40);
}

/// Words that are hidden before they have come to their next place do not go there at once while they are
/// seen.
TEST(Labels, HiddenOnTheirWayDoNotJump) {
  std::vector<std::vector<Offered>> samples;
  std::vector<double> films;
  const auto hidden = [](double film) { return film > 4.4 && film < 4.8; };
  for (int k = 0; k <= 90; ++k) {
    const double film = k / 15.0;
    films.push_back(film);
    std::vector<Offered>& now = samples.emplace_back();
    if (hidden(film)) continue;
    Offered label{{WordKey::vector}, {60, 20}, {0, 0}, {}};
    // the second place is free for a while before the words are hidden
    label.places = {{{0, 0}, film > 3.9 && film < 4.4 ? 8000.0 : 0.0},
                    {{300, 0}, film < 3.9 ? 8000.0 : 10.0}};
    now.push_back(label);
  }
  const LabelPlan::Course course = courses(samples, films, 2.8, 100).at({WordKey::vector});
  Point last(0, 0);
  int seen = 0;
  double fastest = 0;
  bool before = false;
  for (int n = 0; n <= 360; ++n) {
    if (hidden(n / 60.0)) {
      before = false;
      continue;
    }
    const Point at =
        place_of_course(course, WordKey::vector, {0, 0}, samples[0][0].places, n / 60.0).first.center;
    if (before) fastest = std::max(fastest, (at - last).norm());
    last = at, before = true, ++seen;
  }
  EXPECT_LT(fastest, 5);
  EXPECT_GT(seen, 100);
  EXPECT_FALSE(course.moves.empty());
}

/// The words of a point go around it from one side to the other.
TEST(Labels, OfAPointGoAroundIt) {
  const std::vector<Placing::Candidate> places{{{0, -50}}, {{0, 50}}};
  const LabelPlan::Course course{0, {{0, 1, 1}}};
  for (const double film : {0.0, 0.3, 0.5, 0.7, 1.0})
    EXPECT_NEAR(place_of_course(course, WordKey::point, {0, 0}, places, film).first.center.norm(), 50, 1e-9);
}

/// The words of a label at a place of a room that shows its axes.
std::optional<Text> beside_axes(const Made& made, const Illustrator& artist, const sim::Vec3& at) {
  Marks marks;
  marks.axes = true;
  Marks::Label label;
  label.text = "E = 5 J", label.at.local = at;
  marks.labels.push_back(label);
  RunAhead ahead{{made.now}, {0}, {}, {}, {}};
  const Annotations annotations(marks, artist, ahead, {}, 60, 0);
  List list;
  annotations.draw(0, artist.projection(0, made.now), made.now, 0, list);
  const Text* text = said(list, "E");
  return text ? std::optional(*text) : std::nullopt;
}

/// Words at a place of the room stand beside the axes, not on them.
TEST(Labels, StandBesideAxes) {
  Made made = room(8, 4.5);
  const Illustrator artist = made.depictor();
  const Projection projection = artist.projection(0, made.now);
  for (const sim::Vec3& at : {sim::Vec3(0.7, 0, 0), sim::Vec3(0.05, 0.8, 0), sim::Vec3(-0.05, 0.03, 0)}) {
    const std::optional<Text> text = beside_axes(made, artist, at);
    ASSERT_TRUE(text);
    const Point corner = projection.page({0, 0, 0});
    EXPECT_EQ(covered(*text, corner, projection.page({2, 0, 0})), 0) << at.transpose();
    EXPECT_EQ(covered(*text, corner, projection.page({0, 2, 0})), 0) << at.transpose();
    EXPECT_LT((text->at - projection.page(at)).norm(), 1.5 * shape(*text).width) << at.transpose();
  }
}

/// A room of space seen from twelve sides: look(room, artist, where that is).
void from_all_sides(const std::function<void(const Made&, const Illustrator&, const std::string&)>& look) {
  Made made;
  made.cast.dimension = 3, made.cast.scale = 2;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.extent = {{-2, 0, -2}, {2, 2, 2}};
  for (const double azimuth : {-40, 30, 75, 160})
    for (const double elevation : {15, 25, 50}) {
      Camera camera = slant();
      camera.azimuth = azimuth * std::numbers::pi / 180,
      camera.elevation = elevation * std::numbers::pi / 180;
      look(made, Illustrator(made.cast, made.look, {camera}, made.extent, 16.0 / 9),
           "from " + std::to_string(azimuth) + " " + std::to_string(elevation));
    }
}

/// Beside the three of space as well, wherever they are in the picture.
TEST(Labels, StandBesideTheAxesOfSpace) {
  from_all_sides([](const Made& made, const Illustrator& artist, const std::string& from) {
    const Projection projection = artist.projection(0, made.now);
    for (double x = -0.2; x < 0.21; x += 0.05)
      for (double y = -0.2; y < 0.21; y += 0.05) {
        const std::optional<Text> text = beside_axes(made, artist, {x, y, 0});
        ASSERT_TRUE(text);
        for (const sim::Vec3& axis : {sim::Vec3(0.5, 0, 0), sim::Vec3(0, 0.5, 0), sim::Vec3(0, 0, 0.5)})
          EXPECT_LT(covered(*text, projection.page({0, 0, 0}), projection.page(axis)), 1)
              << x << " " << y << " on " << axis.transpose() << " " << from;
      }
  });
}

/// In space axes are named past their tips, beside them where another is in the way, as in one of these
/// views.
TEST(Labels, OfAxesInSpaceStandAtTheirTips) {
  Marks marks;
  marks.axes = true;
  int past = 0;
  from_all_sides([&](const Made& made, const Illustrator& artist, const std::string& from) {
    const Projection projection = artist.projection(0, made.now);
    RunAhead ahead{{made.now}, {0}, {}, {}, {}};
    const Annotations annotations(marks, artist, ahead, {}, 60, 0);
    List list;
    annotations.draw(0, projection, made.now, 0, list);
    const double length = 0.36 * std::min(projection.window().width, projection.window().height) /
                          projection.scale_at({0, 0, 0});
    const Point origin = projection.page({0, 0, 0});
    for (int axis = 0; axis < 3; ++axis) {
      const Text* text = said(list, std::array{"x", "y", "z"}[std::size_t(axis)]);
      ASSERT_TRUE(text);
      const Point way = projection.page(length * sim::Vec3::Unit(axis)) - origin;
      // a letter reaches up by about half of its size
      const Point at(middle(*text), text->at.y() - 0.25 * text->spans[0].size);
      const double along = (at - origin).dot(way) / way.squaredNorm();
      EXPECT_GT(along, 0.8) << axis << " " << from;
      past += along > 1;
    }
  });
  EXPECT_GE(past, 35) << "of 36";
}

/// Axes lie under the plates of words, other arrows over them.
TEST(Labels, LieOverAxes) {
  Made made = room(8, 4.5);
  Marks marks;
  marks.axes = true;
  Marks::Label label;
  label.text = "E = 5 J", label.at.local = {0.7, 0, 0};
  marks.labels.push_back(label);
  made.body(ShapeKind::ball, {4, 2.3, 0}, 0.15);
  marks.paths.push_back({.at = {0, {0, 0, 0}}});  // words have plates where there are paths
  const Illustrator artist = made.depictor();
  RunAhead ahead{{made.now}, {0}, {}, {}, {}};
  const Annotations annotations(marks, artist, ahead, {}, 60, 0);
  List list;
  annotations.draw(0, artist.projection(0, made.now), made.now, 0, list);
  std::optional<std::size_t> plate, axis;
  for (std::size_t i = 0; i < list.batches.size(); ++i) {
    if (list.batches[i].kind == Kind::box) plate = i;
    if (list.batches[i].kind == Kind::stroke || list.batches[i].kind == Kind::polygon) axis = i;
  }
  ASSERT_TRUE(plate && axis);
  EXPECT_GT(*plate, *axis);
}

}  // namespace
}  // namespace obscura::draw
