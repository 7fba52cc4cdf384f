#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "draw/compose/annotate.h"
#include "draw/page/placing.h"
#include "draw/picture/formula.h"
#include "draw/plane/stage.h"

namespace obscura::draw {

/// Of the body in the middle of which an arrow begins, page units: the radius of a ball, how far any body
/// reaches, and where it is. `valued`: whether the arrow's words have a number.
/// `along_ground`: the body that friction holds where it lies.
struct AroundTail {
  double ball = 0, reach = 0;
  Point center{0, 0};
  bool valued = false;
  std::optional<int> along_ground{};
};

/// Puts marks on one page (draw/compose/annotate.h): lines at once, words when all lines are known.
class Notes {
 public:
  Notes(const sim::SceneInfo& cast, const Palette& colours, const Projection& projection,
        const sim::Snapshot& now, const Annotating& how, bool names, List& list);

  void vector(int index, const Marks::Vector& vector, Scales scales);
  void angle(int index, const Marks::Angle& angle);
  void length(int index, const Marks::Length& length);
  void point(int index, const Marks::Point& point);
  void label(int index, const Marks::Label& label);
  void name(int index, const Marks::Name& name, const Marks& marks);
  void cone(int index, const Marks::Cone& cone, const Scales& scales);
  void axes();
  void finish();

 private:
  bool begin_together(std::size_t i, std::size_t j) const;
  double on_one_line(std::size_t i, std::size_t j, double longer) const;
  std::vector<double> tails() const;
  void mark_tails(const std::vector<double>& strength);
  void set_apart();
  AroundTail around(const Marks::Vector& vector, const Reading& reading) const;
  Point center(int body) const;
  std::optional<double> past(std::optional<int> body, const Point& tail, const Point& tip) const;
  Point beside_axes(const Point& center, const Point& size, std::size_t sides) const;
  std::vector<Point> steady_arrows(int body, const Marks& marks) const;
  struct Word {
    WordKey key;
    Formula set;
    std::vector<Placing::Candidate> places;
    Point anchor;
    std::optional<std::pair<Point, Point>> arrow;
    std::optional<Hang> hang;
    Point along{0, 0};             // the body that the arrow goes with
    std::vector<Point> outline{};  // convex: of the body that it names, where a leader ends
    int shown = -1;                // of the arrows: that which it names
  };
  /// Where a word stands, and how much of its leader and of itself is seen.
  struct Placed {
    Placing::Candidate at;
    double leader = 1, strength = 1;
  };
  void hang(const sim::Vec3& a, const sim::Vec3& b);
  bool film() const { return how_.plan != nullptr || how_.survey != nullptr; }
  static Point size(const Formula& f) { return {f.width, f.ascent + f.descent}; }
  bool is_ground(int index) const;
  void avoid_bodies();
  void avoid_areas();
  void avoid_springs();
  void avoid_joints();
  void avoid_rails();
  void avoid_own_arrows();
  std::vector<std::vector<Point>> forms(int body, int corners) const;
  Formula set(const WordKey& key, const std::string& text, double value, std::string_view unit, int body,
              Color ink);
  Placing::Candidate planned(const Word& word, double& leader) const;
  Point on_page(const Word& word, const Point& center) const;
  std::vector<Placing::Candidate> places_on_page(const Word& word) const;
  void plate(const Point& center, const Point& size, std::uint8_t strength);
  static Point led_to(const Word& word, const Point& center);
  void lead(const Word& word, const Point& center, double strength);
  static Hold hold(const Word& word, const Point& center);
  void offer_places();
  void yield(std::vector<Placed>& placed);
  bool covers(const WordKey& key) const;
  const std::vector<std::vector<Point>>& outlines();
  bool on_body(const Point& p);
  double bare(const Point& tail, const Point& tip);
  EasedArrow::Ends eased(const WordKey& key, const Point& tail, const Point& tip, const Point& center) const;
  bool arrow(const WordKey& key, const Point& tail, const Point& tip, Formula label, Color ink,
             const AroundTail& around = {});
  void stroke(const std::vector<Point>& line, double width, Color color, double weight);
  void stroke_through(const std::vector<sim::Vec3>& way, double width, Color color, double weight);
  void by_nodes(const std::vector<sim::Vec3>& way);
  void dashes(const sim::Vec3& from, const sim::Vec3& to);
  void turn(const WordKey& key, const Marks::Vector& vector, const Reading& reading, const Formula& label,
            Color ink, int among);
  template <class At, class Place>
  void arc(const At& at, const Place& place, double radius, double from, double to, double width,
           Color color);
  void word(const WordKey& key, Formula set, std::vector<Placing::Candidate> places, const Point& anchor,
            std::optional<std::pair<Point, Point>> arrow = {}, const Point& along = {0, 0}) {
    if (!set.empty()) words_.push_back({key, std::move(set), std::move(places), anchor, arrow, hang_, along});
  }

  const sim::SceneInfo& cast_;
  const Palette& colours_;
  const Projection& view_;
  const sim::Snapshot& now_;
  const Annotating& how_;
  List& list_;
  Placing placing_;
  double point_, arrow_, type_, thin_, dot_radius_, gap_, millimetre_, normal_, angle_;  // page units
  std::optional<Hang> hang_;  // where what comes next is, in space
  std::vector<Word> words_;
  struct Dot {
    Point at;
    Color ink;
    std::optional<Hang> hang;
  };
  std::vector<Dot> dots_;
  std::vector<Arrow> axes_;  // those of the room
  std::vector<Arrow> arrows_;
  std::vector<Color> inks_;                   // theirs
  std::vector<std::vector<Point>> outlines_;  // of bodies, once they are asked for
};

}  // namespace obscura::draw
