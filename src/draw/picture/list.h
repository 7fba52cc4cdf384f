#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "draw/picture/color.h"

namespace obscura::draw {

// The picture as data. Coordinates are page units: one unit is 1/1080 of the picture's height, x to the right
// from the left edge, y down from the top edge. Depict has put the world through the camera already, so that
// GL and Cairo only put down what is here, in this order.

using Point = Eigen::Vector2d;

/// A disc with an outline drawn inside its rim.
struct Disc {
  Point center;
  double radius = 0;  // to the outer rim
  double line = 0;    // outline width, 0: none
  Color fill{}, outline{};
  bool operator==(const Disc&) const = default;
};

/// A rectangle turned about its centre, with an outline drawn inside its edges, and the two axes of its own
/// frame, which leave its centre of mass in a dot three times as wide as they are.
struct Box {
  Point center;
  Point x_axis;          // unit, page frame: the body's x
  Point half;            // to the outer edges
  double line = 0;       // outline width
  double axis = 0;       // length of the frame's two axes, 0: none
  double axis_line = 0;  // their width
  Color fill{}, outline{}, axis_color{};
  bool operator==(const Box&) const = default;
};

/// A vertex of a stroke.
struct Node {
  Point at;
  double width = 1;
  Color color{};
  bool operator==(const Node&) const = default;
};

enum class Cap : std::uint8_t { butt, round };
enum class Blend : std::uint8_t {
  over,  // alpha over
  // Per-channel minimum, maximum with what lies below: overlapping pieces leave no beads. A colour's alpha
  // says how far it is from Picture::ground; in a transparent picture, the most opaque wins.
  darken,
  lighten,
};

/// The form of a coil between two ends (draw/plane/springs.h): what else its line follows from.
struct Winding {
  int turns = 0;  // 0: no coil
  double lead = 0, amplitude = 0;
  bool operator==(const Winding&) const = default;
};

/// An open or closed line through nodes [begin, end) of List::nodes, width and colour linear in between,
/// joints mitred.
struct Stroke {
  int begin = 0, end = 0;
  bool closed = false;
  Cap cap = Cap::round;
  Blend blend = Blend::over;
  Winding winding{};
  // a level line whose sides are brought to whole pixels: two that touch share none
  bool whole = false;
  bool operator==(const Stroke&) const = default;
};

/// A filled polygon through points [begin, end) of List::points, star-shaped about its first point's
/// neighbourhood (arrow heads, pointers, wall grounds): every point is visible from their mean.
struct Polygon {
  int begin = 0, end = 0;
  Color fill{};
  bool operator==(const Polygon&) const = default;
};

enum class Face : std::uint8_t { regular, medium, bold, math, math_italic, math_bold_italic };
enum class Align : std::uint8_t { left, center, right };

/// A piece of a line of type in one face.
struct Span {
  std::string text;  // UTF-8
  Face face = Face::regular;
  double size = 24;  // em, page units
  Color color{};
  double rise = 0;       // page units up from the baseline
  double lead = 0;       // space before it, page units
  bool tabular = false;  // figures of equal width
  bool operator==(const Span&) const = default;
};

/// A line of type on a baseline.
struct Text {
  Point at;
  Align align = Align::left;
  std::vector<Span> spans;
  // a place that is brought to a whole pixel wherever it moves, and the words with it
  std::optional<Point> whole = {};
  bool operator==(const Text&) const = default;
};

/// The height of words at which they are placed.
enum class Level : std::uint8_t { baseline, top, middle, bottom };

/// A line of LaTeX that another program sets over the picture, in fonts that are not known here.
struct Words {
  std::string latex{};
  Point at;  // of its end or middle along the line, at `level`
  Align align = Align::left;
  Level level = Level::baseline;
  double size = 24;  // em, page units
  Color color{};
};

enum class Kind : std::uint8_t { disc, box, stroke, polygon, text };
inline constexpr std::size_t kKinds = 5;

/// What a thing of the picture is of, by which it is known again in the next picture of the same run.
struct Subject {
  enum class What : std::uint8_t {
    page,   // captions, titles, the clock: they stay where they are when the view is moved
    chart,  // a plot's lines
    layer,  // other things of the world
    body,
    spring,
    joint,
    trail,
  };
  What what = What::page;
  int index = 0;  // of its kind; of a layer its place among them
  int part = 0;   // of a page of several runs: which
  auto operator<=>(const Subject&) const = default;
};

/// Where in space a thing of the page hangs, m: at a place, or between two, or a line and a polygon node by
/// node. Seen from elsewhere it is there.
struct Hang {
  Eigen::Vector3d a, b;
  std::vector<Eigen::Vector3d> nodes{};
  bool operator==(const Hang&) const = default;
};

/// From the counts `first` of the kinds of things on, they are of this subject.
struct About {
  Subject subject;
  std::optional<Hang> hang;
  std::array<int, kKinds> first{};
};

/// A trail: its strokes, and the way along which they lie, up to now.
struct Trail {
  struct Point {
    double time = 0;  // s
    draw::Point at;
    bool cusp = false;
  };
  int begin = 0, end = 0;       // strokes
  double now = 0, lasting = 0;  // s
  double widest = 0;
  Color strong{}, faint{};   // of its head, and of its end
  draw::Point origin{0, 0};  // where the world's lies on the page
  double scale = 1;          // page units a metre
  std::vector<Point> way{};  // its nodes, from the oldest; the first may lie between two
  Subject subject{};
};

/// Consecutive things of one kind, which are drawn in one go.
struct Batch {
  Kind kind;
  int begin = 0, end = 0;  // into the list of that kind
  int clip = -1;           // index into List::clips, -1: the page
  bool halo = false;       // they keep others off what lies below
  bool operator==(const Batch&) const = default;
};

struct Rect {
  double x = 0, y = 0, width = 0, height = 0;  // page units
  bool operator==(const Rect&) const = default;
};

struct List {
  std::vector<Batch> batches;  // in painter's order
  std::vector<Disc> discs;
  std::vector<Box> boxes;
  std::vector<Stroke> strokes;
  std::vector<Polygon> polygons;
  std::vector<Text> texts;
  std::vector<Node> nodes;
  std::vector<Point> points;
  std::vector<Rect> clips;
  std::vector<Words> words;  // those set apart, over all else
  bool apart = false;        // whether type goes there
  std::vector<About> abouts;
  std::vector<Trail> trails;  // in the order of their strokes
  int part = 0;               // of the subjects that come

  void add(const Disc& disc);
  void add(const Box& box);
  void add(const Text& text);
  /// A stroke through `line`.
  void add(const std::vector<Node>& line, Cap cap = Cap::round, Blend blend = Blend::over,
           bool closed = false, const Winding& winding = {});
  /// A level stroke, its sides on whole pixels.
  void add_row(const std::vector<Node>& line);
  /// A filled polygon.
  void add(const std::vector<Point>& outline, Color fill);
  /// Clips everything that is added after this call to `rect`, until the next call of clip or unclip.
  void clip(const Rect& rect);
  void unclip();
  /// Everything that is added after this call is a halo or a plate, which covers what lies below it with the
  /// colour of the ground, until the next call.
  void halo(bool is);
  /// Everything that is added after this call is of this subject, until the next call.
  void of(Subject subject);
  /// Everything that is added after this call hangs there, until the next call of this or of `of`.
  void hang(const std::optional<Hang>& at);
  /// What the things of a kind are said to be, each `first` left out.
  std::vector<About> about(Kind kind) const;
  /// Another list on top of this one: each of its lengths times `scale`, its origin at `at`.
  void add(const List& list, double scale, const Point& at);

 private:
  int clip_ = -1;
  bool halo_ = false;
  void mark(Kind kind, int end);
  void of(const Subject& subject, const std::optional<Hang>& hang);
};

struct Solids;

/// One frame: a ground, what stands still (shared by all frames that have it, so that it is drawn once), what
/// is drawn by depth in space, what moves.
struct Picture {
  double aspect = 16.0 / 9;  // width over height
  Color ground;
  bool transparent = false;  // leave the ground out: halos of its colour take away what lies below
  std::shared_ptr<const List> still;
  std::vector<std::shared_ptr<const Solids>> solids;  // one a panel
  List moving;
};

}  // namespace obscura::draw
