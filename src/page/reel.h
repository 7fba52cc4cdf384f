#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "draw/picture/list.h"
#include "page/keys.h"

namespace obscura::page {

/// No point that a reel gives is farther than this from its picture's, in page units: 1/1080 of the page's
/// height.
inline constexpr double kReelBound = 0.25;

/// The pictures of a film as things that move, for a page that draws them: each thing of the list once, and
/// its numbers as keys. Things are known again by their subject, their form and their place among those of
/// the same (draw::Subject); a form that only moves and turns is one form, a coil its ends, a trail the way
/// of its body, a plot's line as many of its points as there are; what else changes is written frame by
/// frame.
class Reel {
 public:
  /// The next frame.
  void add(const draw::Picture& picture);
  std::int64_t frames() const { return frames_; }

  /// A number of the run, to be put once a frame; its keys are within `bound`.
  int number(double bound);
  /// Another bound for it: keys are written when all frames are there.
  void bound(int number, double bound) { numbers_[std::size_t(number)].bound = bound; }
  void put(int number, double value) { numbers_[std::size_t(number)].course.add(value); }

  /// The structure as JSON, and the streams that it names the lengths of.
  std::string finish(nlohmann::ordered_json& json);

 private:
  // what a thing is, apart from its numbers
  struct Style {
    draw::Kind kind{};
    bool trail = false, closed = false, round = false, still = false, whole = false;
    draw::Blend blend{};
    int turns = 0;
    int clip = -1;
    int space = 0;         // what stands in space: 1 a tube, 2 a ball, 3 a plate, 4 a trail, 5 a line
    int nodes = 0;         // of a tube
    int hang = 0;          // at so many places of space
    bool through = false;  // which are its nodes
    bool front = false;    // a trail over the bodies
    auto operator<=>(const Style&) const = default;
  };
  struct Key {
    draw::Subject subject;
    Style style;
    int place = 0;
    auto operator<=>(const Key&) const = default;
  };
  enum class Form { numbers, rigid, grown, loose };
  struct Thing {
    Key key;
    Form form = Form::numbers;
    std::vector<std::pair<std::int64_t, std::int64_t>> lives;  // [from, to)
    // of each life, each number, and each step
    std::vector<std::vector<Course>> courses, steps;
    std::vector<double> bounds;
    // rigid: the form about its middle; grown: the whole line; with the widths and colours of its nodes
    // where those are not all alike
    std::vector<draw::Point> points;
    std::vector<double> widths;
    std::vector<int> colors;
    double reach = 0;  // of a rigid form
    // loose: of each frame of its lives
    std::vector<std::vector<int>> frames;
    // a trail's way
    std::vector<draw::Trail::Point> way;
    std::vector<Eigen::Vector3d> places;  // of one in space
    draw::Trail trail;
  };
  struct Number {
    double bound;
    Course course;
  };
  struct Outline;

  void add(const draw::List& list, bool still);
  void add(const draw::Solids& solids, int panel);
  Thing& thing(const Key& key);
  void live(Thing& it, std::vector<double> numbers, std::vector<double> bounds,
            const std::vector<int>& steps);
  void add_outline(Thing& it, const Outline& outline);
  void loosen(Thing& it);
  std::vector<int> loose_frame(const Outline& outline);
  bool add_rigid(Thing& it, const Outline& outline);
  bool add_grown(Thing& it, const Outline& outline);
  void add_trail(Thing& it, const draw::Trail& trail);
  int color(draw::Color color);
  int clip(const draw::Rect& rect);
  int line(const draw::Text& text);
  int glyph(draw::Face face, std::uint32_t index);
  void write(Thing& it, nlohmann::ordered_json& json);

  std::int64_t frames_ = 0;
  std::shared_ptr<const draw::List> still_;
  std::vector<int> still_things_;
  std::map<Key, int> known_;
  std::vector<Thing> things_;
  std::list<int> order_;  // of painting
  std::vector<std::list<int>::iterator> places_;
  std::list<int>::iterator after_;
  std::optional<draw::Hang> hang_;  // of what is being added
  double hang_bound_ = 0;           // m

  std::map<std::uint32_t, int> colors_;
  std::map<std::array<int, 4>, int> clips_;
  std::map<std::string, int> lines_;
  std::vector<std::string> line_texts_;
  std::map<std::pair<int, std::uint32_t>, int> glyphs_;
  std::vector<std::string> outlines_;
  std::vector<Number> numbers_;
  KeyStreams keys_;
  Numbers points_, steps_, loose_;
};

}  // namespace obscura::page
