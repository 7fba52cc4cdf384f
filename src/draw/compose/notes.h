#pragma once

#include <map>
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

/// Around words in print, of their height.
inline constexpr double kMarginInPrint = 0.25;

/// The cost of a name over something, as against that of other words: it has room all around its body, and
/// goes out of the way sooner.
inline constexpr double kNameCovered = 6;

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
        const sim::Snapshot& now, const Annotating& how, List& list);

  void vector(int index, const Marks::Vector& vector, Scales scales);
  void angle(int index, const Marks::Angle& angle);
  void length(int index, const Marks::Length& length);
  void point(int index, const Marks::Point& point);
  void label(int index, const Marks::Label& label);
  void name(int index, const Marks::Name& name, const Marks& marks);
  void times();
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
  static int outer_side(const std::vector<Point>& way);
  std::optional<double> past(std::optional<int> body, const Point& tail, const Point& tip) const;
  Point beside_axes(const Point& center, const Point& size, std::size_t sides) const;
  std::vector<Point> steady_arrows(int body, const Marks& marks) const;
  static constexpr std::size_t kNoForm = std::size_t(-1);
  struct Word {
    WordKey key;
    Formula set;
    std::vector<Placing::Candidate> places;
    Point anchor;
    std::optional<std::pair<Point, Point>> arrow;
    std::optional<Hang> hang;
    Point along{0, 0};             // the body that the arrow goes with
    double ball = 0;               // its radius, where the arrow begins in its middle
    std::vector<Point> outline{};  // convex: of the body that it names, where a leader ends
    int shown = -1;                // of the arrows: that which it names
    std::size_t form = kNoForm;    // among the forms of its kind: that of what it names
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
  void avoid_arrow(const Point& tail, const Point& tip);
  void avoid_areas();
  void avoid_springs();
  void avoid_joints();
  void avoid_rails();
  void avoid_ghosts();
  void avoid_own_arrows();
  std::vector<std::vector<Point>> forms(int body, int corners, const sim::Snapshot& at) const;
  std::vector<Point> outline_of(int body, const sim::Snapshot& at) const;
  Formula set(const WordKey& key, const std::string& text, double value, std::string_view unit, int body,
              Color ink);
  Placing::Candidate planned(const Word& word, double& leader) const;
  Point on_page(const Word& word, const Point& center) const;
  std::vector<Placing::Candidate> places_on_page(const Word& word) const;
  bool in_window(const Point& p) const;
  bool is_unseen(const WordKey& key, const Point& at) const;
  std::optional<std::pair<Point, Point>> seen(const Point& a, const Point& b) const;
  double astray(const Word& word, const Point& center) const;
  static double reach_of(const std::vector<Point>& outline, const Point& from, const Point& u);
  std::pair<Point, double> end_of_leader(const Word& word, const Point& center) const;
  std::pair<Point, Point> room_window() const;
  std::vector<Placed> still_places();
  std::vector<Placed> planned_places() const;
  void plate(const Point& center, const Point& size, std::uint8_t strength);
  static Point led_to(const Word& word, const Point& center);
  void lead(const Word& word, const Placed& placed);
  static Hold hold(const Word& word, const Point& center);
  void offer_places();
  void yield(std::vector<Placed>& placed);
  void tell_standing(const std::vector<Placed>& placed) const;
  bool covers(const WordKey& key) const;
  const std::vector<std::vector<Point>>& outlines();
  bool on_body(const Point& p);
  double bare(const Point& tail, const Point& tip);
  EasedArrow::Ends eased(const WordKey& key, const Point& tail, const Point& tip, const Point& center) const;
  double most_growth(const WordKey& key) const;
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
  /// Until the next call of this; none where there are no words, or what they name is not seen.
  Word* word(const WordKey& key, Formula set, std::vector<Placing::Candidate> places, const Point& anchor,
             std::optional<std::pair<Point, Point>> arrow = {}, const Point& along = {0, 0}) {
    if (set.empty() || (!film() && !in_window(anchor))) return nullptr;
    words_.push_back({key, std::move(set), std::move(places), anchor, arrow, hang_, along});
    return &words_.back();
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
  /// Of what words name: convex, or the ends of a line, or a point.
  struct Form {
    std::vector<Point> outline;
    Point middle{0, 0}, half{0, 0};  // of the rectangle around it
    explicit Form(std::vector<Point> all);
    double off(const Point& center, const Point& size) const;
  };
  std::map<WordKey::Kind, std::vector<Form>> forms_;
};

}  // namespace obscura::draw
