#pragma once

#include <bit>
#include <compare>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "draw/compose/depict.h"
#include "draw/compose/eased_arrow.h"
#include "draw/page/figure.h"
#include "draw/page/layout.h"
#include "draw/page/placing.h"
#include "draw/page/readings.h"
#include "draw/page/sheet.h"
#include "draw/picture/theme.h"
#include "draw/picture/world_line.h"

namespace obscura::draw {

/// Where places of the world lie on a page: of the plane by a view, of space by a lens.
class Projection {
 public:
  explicit Projection(const View& view) : view_(view), window_(view.window) {}
  /// A lens's page, put down `scale` times as large with its corner at `corner`.
  Projection(const CameraProjection& lens, double scale, const Point& corner);

  Point page(const sim::Vec3& place) const;
  /// The place of a segment that is seen at a part of its way on the page.
  sim::Vec3 between(const sim::Vec3& a, const sim::Vec3& b, double part) const;
  /// Page units a metre there.
  double scale_at(const sim::Vec3& place) const;
  /// The way from there to the eye, unit.
  sim::Vec3 sight(const sim::Vec3& place) const;
  /// Whether it lies before the eye.
  bool before(const sim::Vec3& place) const;
  const Rect& window() const { return window_; }
  /// The plane's; none of space.
  const View* view() const { return view_ ? &*view_ : nullptr; }

 private:
  std::optional<View> view_;
  CameraProjection lens_;
  double scale_ = 1;
  Point corner_ = {0, 0};
  Rect window_;
};

/// The scales at which the longest arrow of each kind is a good part of a window of `scale` page units a
/// metre.
Scales scales(const Marks& marks, const sim::SceneInfo& cast, std::span<const sim::Snapshot> moments,
              const Rect& window, double scale);

/// How large marks are on their page: of a sheet for print, unless said otherwise.
struct Lettering {
  double point = kPoint;                     // page units a point of type and thin lines
  double arrow = 1.1 * kPoint / kArrowLine;  // weight of arrows: a shaft of 1.1 pt
  double weight = 0.9 / kOutline * kPoint;   // of the bodies' outlines
  double pixel = 0;                          // page units; words keep to whole ones; 0: there are none
};

/// The em of annotations, points.
inline constexpr double kAnnotationType = 10;

/// Of a film, at a weight and a scale of its type.
Lettering film_lettering(double weight, double type_scale, int rows = 0);

/// Which words: of which list of marks, of which mark, of which of its arrows.
struct WordKey {
  enum Kind { axis, cone, length, angle, vector, point, label, name, time } kind = label;
  int index = 0, part = 0;
  auto operator<=>(const WordKey&) const = default;
};

/// The values that a label shows over a run.
struct ValueRange {
  double low = 1e300, high = -1e300;
  double longest = 0;  // page units: of its arrow
  unsigned ways = 0;   // the eighths of a circle in which its arrow points, as bits
  /// Whether the arrow turns by more than a right angle, or flips.
  bool swings() const {
    const unsigned turned = (ways << 1 | ways >> 7) & 0xff;  // by an eighth
    return std::popcount(ways) > 2 || (std::popcount(ways) == 2 && !(ways & turned));
  }
};

/// Words that could stand at any of `places`, as in a survey of a film: the index of a place means the same
/// at every instant, and its cost is that of this instant.
struct Offered {
  WordKey key;
  Point size;
  Point anchor;
  std::vector<Placing::Candidate> places;
  std::optional<std::pair<Point, Point>> arrow{};  // from tail to tip: that it names, and does not pass over
  Point along{0, 0};                               // the body that the arrow goes with
  bool legible = true;                             // strong enough to be read
  double ball = 0;                                 // the radius of that in whose middle the arrow begins
};

/// Whether words with so many places hardly move, as those at a place of the room: they are planned before
/// others, which go out of their way.
bool stays(const WordKey& key, std::size_t places);

/// Of the sizes of two labels together: nearer than that they lie on each other.
inline constexpr double kNearWords = 0.56;

/// What a film knows of its labels before it draws one.
struct LabelPlan {
  /// From one time of the film to another the words go over to another place.
  struct Move {
    double begin = 0, end = 0;  // s of the film
    int to = 0;
  };
  /// At a time of the film words are seen no more than so much, 0 to 1.
  struct Dim {
    double film = 0, strength = 1;
  };
  struct Course {
    int first = 0;
    std::vector<Move> moves;
    bool covers = true;  // whether something may lie under them
    bool yields = true;  // whether they fade where they come over other words, which they do only in passing
    std::vector<Dim> dims{};  // in the order of time: where they do
  };
  std::map<WordKey, ValueRange> ranges;
  std::map<WordKey, EasedArrow> arrows;  // as seen from their bodies
  std::map<WordKey, Course> courses;
};

/// Whether words go around what they name, at `anchor`, from one place to another; others go straight.
inline bool goes_around(WordKey::Kind kind) { return kind == WordKey::name || kind == WordKey::point; }

/// A place between two of the same words, a part of the way from one to the other.
Point on_its_way(WordKey::Kind kind, const Point& anchor, const Point& from, const Point& to, double part);

/// Where the words of a course stand at a time of the film, and how far their leader is drawn, 0 to 1.
std::pair<Placing::Candidate, double> place_of_course(const LabelPlan::Course& course, WordKey::Kind kind,
                                                      const Point& anchor,
                                                      const std::vector<Placing::Candidate>& places,
                                                      double film);

/// An earlier instant that a figure shows, and the words of its time.
struct Timed {
  const sim::Snapshot* then = nullptr;
  std::string words;
};

/// Words of a film where they stand at an instant.
struct Standing {
  WordKey key;
  Point center, size;
  double strength = 1;  // as strong as what they name lets them be
  bool stays = false;   // they do not move, and go before others
};

/// How marks are drawn at one instant.
struct Annotating {
  Lettering lettering{};
  double film = std::numeric_limits<double>::quiet_NaN();  // s of the film; not a number: of none
  const LabelPlan* plan = nullptr;         // of a film; none: words find their places in this one picture
  std::vector<Offered>* survey = nullptr;  // of a film: collects words instead of drawing them
  std::map<WordKey, ValueRange>* ranges = nullptr;           // collects their values
  std::map<WordKey, EasedArrow>* arrows = nullptr;           // collects arrows, too
  double before = std::numeric_limits<double>::quiet_NaN();  // s of the film: the survey's sample before
  const Look* look = nullptr;                        // has the bodies' own arrows, which words keep off
  std::span<const std::vector<sim::Vec3>> behind{};  // what bodies leave behind them: trails and paths, too
  // of a picture that stands still: the earlier instants in it, those with times and whose they are, and a
  // list for the points and labels that lie outside of what it shows
  std::span<const SpaceGhost> ghosts{};
  std::span<const Timed> times{};
  int times_of = -1;
  std::vector<WordKey>* unseen = nullptr;
  std::vector<Standing>* standing = nullptr;  // of a film: collects where words stand, and draws none
};

/// The words of bodies that have some.
std::vector<Marks::Name> names_of(const Look& look);

/// Draws what marks say of an instant: arrows, angles, lengths, points, and their words where there is room
/// for them.
void annotate(const Marks& marks, const Scales& scales, const sim::SceneInfo& cast, const Palette& colours,
              const Projection& projection, const sim::Snapshot& now, List& list, const Annotating& how = {});

/// Rulers in metres along the lower and the left edge of a sheet's window, and how much room they take there.
void draw_rulers(const Layout& layout, const View& view, const Palette& colours, double type_scale,
                 List& list);
inline constexpr double kRulerBelow = 25, kRulerLeft = 27;  // pt at a type scale of 1, at the left at least
/// The same at the left, pt: more where the numbers of the upright ruler are wide, or its name is in a font.
/// `layout`: with any room there, for the heights that the ruler spans.
double ruler_left(const Layout& layout, double type_scale);

/// Whether a figure has a legend, and puts it down from `left` to `right` (page units): the room's scale, and
/// an arrow of each kind. `baseline`: of its first line. Returns that of the last.
bool has_legend(const Figure& figure);
double draw_legend(const Figure& figure, const Scales& scales, const Palette& colours, double scale,
                   double left, double right, double baseline, double type_scale, List& list);

/// The largest of 1, 2, 5 times a power of ten that is not above x.
double round_below(double x);

}  // namespace obscura::draw
