#include "page/reel.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "draw/picture/solids.h"
#include "draw/picture/type.h"
#include "page/letters.h"

namespace obscura::page {

namespace {

using draw::Kind;
using draw::Point;
using Json = nlohmann::ordered_json;

// bounds of the parts of a thing's place, whose sum is below kReelBound
constexpr double kPlace = 1.0 / 16;    // each coordinate
constexpr double kLetter = 1.0 / 128;  // of a line of type, which is rounded to pixels
constexpr double kTurn = 0.04;         // what an angle moves the farthest point by, and what a scale does
constexpr double kForm = 0.03;         // how far a form may be from one that only moves
constexpr double kWidth = 1.0 / 32;    // of a line, a radius
constexpr int kPoint = 64;             // steps a page unit of points that are written once
constexpr int kLoose = 16;             // of those that are written each frame
constexpr double kTrailScale = 2e-5;

double wrapped_near(double angle, double before) {
  return angle + 2 * std::numbers::pi * std::round((before - angle) / (2 * std::numbers::pi));
}

}  // namespace

// A line or polygon of one frame.
struct Reel::Outline {
  std::vector<Point> points;
  std::vector<double> widths;  // of a line
  std::vector<int> colors;     // of a line's nodes, or the polygon's
  bool plain() const {
    for (const double w : widths)
      if (std::abs(w - widths[0]) > 1e-3) return false;
    return std::all_of(colors.begin(), colors.end(), [&](int c) { return c == colors[0]; });
  }
};

int Reel::color(draw::Color c) {
  const std::uint32_t rgba =
      std::uint32_t(c.r) << 24 | std::uint32_t(c.g) << 16 | std::uint32_t(c.b) << 8 | c.a;
  return colors_.emplace(rgba, int(colors_.size())).first->second;
}

int Reel::clip(const draw::Rect& r) {
  const auto whole = [](double x) { return int(std::lround(x * kPoint)); };
  return clips_
      .emplace(std::array{whole(r.x), whole(r.y), whole(r.width), whole(r.height)}, int(clips_.size()))
      .first->second;
}

int Reel::glyph(draw::Face face, std::uint32_t index) {
  const auto [at, fresh] = glyphs_.emplace(std::pair(int(face), index), int(outlines_.size()));
  if (fresh) outlines_.push_back(glyph_outline(face, index));
  return at->second;
}

int Reel::line(const draw::Text& text) {
  const draw::Line line = draw::shape(text);
  const Point from = text.whole ? Point(text.at - *text.whole) : Point::Zero();
  double start = from.x();
  if (text.align == draw::Align::center) start -= line.width / 2;
  if (text.align == draw::Align::right) start -= line.width;
  std::string json = "[";
  for (const draw::Shaped& span : line.spans) {
    if (span.glyphs.empty()) continue;
    json += fmt::format("{}[{:.3f},{}", json.size() > 1 ? "," : "", span.size, color(span.color));
    for (const draw::Glyph& each : span.glyphs)
      json += fmt::format(",{},{:.4f},{:.4f}", glyph(span.face, each.index), start + each.at.x(),
                          from.y() + each.at.y());
    json += "]";
  }
  json += "]";
  const auto [at, fresh] = lines_.emplace(json, int(line_texts_.size()));
  if (fresh) line_texts_.push_back(json);
  return at->second;
}

int Reel::number(double bound) {
  numbers_.push_back({bound, {}});
  return int(numbers_.size()) - 1;
}

Reel::Thing& Reel::thing(const Key& key) {
  const auto [at, fresh] = known_.emplace(key, int(things_.size()));
  if (fresh) {
    Thing it;
    it.key = key;
    things_.push_back(std::move(it));
    // new ones lie over those that were before them in this frame
    places_.push_back(order_.insert(after_ == order_.end() ? order_.begin() : std::next(after_), at->second));
  }
  after_ = places_[std::size_t(at->second)];
  return things_[std::size_t(at->second)];
}

void Reel::live(Thing& it, std::vector<double> numbers, std::vector<double> bounds,
                const std::vector<int>& steps) {
  if (hang_ && !numbers.empty()) {
    // the last of its numbers
    const auto put = [&](const Eigen::Vector3d& place) {
      numbers.insert(numbers.end(), place.begin(), place.end());
    };
    if (it.key.style.through) {
      std::for_each(hang_->nodes.begin(), hang_->nodes.end(), put);
    } else {
      put(hang_->a);
      if (it.key.style.hang > 1) put(hang_->b);
    }
    bounds.resize(numbers.size(), hang_bound_);
  }
  if (it.lives.empty() || it.lives.back().second != frames_) {
    it.lives.emplace_back(frames_, frames_);
    it.courses.emplace_back(numbers.size());
    it.steps.emplace_back(steps.size());
  }
  it.lives.back().second = frames_ + 1;
  for (std::size_t i = 0; i < numbers.size(); ++i) it.courses.back()[i].add(numbers[i]);
  for (std::size_t i = 0; i < steps.size(); ++i) it.steps.back()[i].add(steps[i]);
  it.bounds = std::move(bounds);
}

bool Reel::add_rigid(Thing& it, const Outline& outline) {
  const std::size_t n = outline.points.size();
  if (n != it.points.size()) return false;
  const bool plain = it.widths.empty();
  if (plain != outline.plain()) return false;
  for (std::size_t i = 0; !plain && i < n; ++i)
    if (std::abs(outline.widths[i] - it.widths[i]) > kForm || outline.colors[i] != it.colors[i]) return false;
  Point middle = Point::Zero();
  for (const Point& p : outline.points) middle += p / double(n);
  std::complex<double> across = 0;
  double square = 0;
  const auto complex = [](const Point& p) { return std::complex<double>(p.x(), p.y()); };
  for (std::size_t i = 0; i < n; ++i) {
    across += std::conj(complex(it.points[i])) * complex(outline.points[i] - middle);
    square += it.points[i].squaredNorm();
  }
  if (!(square > 1e-12)) return false;
  const std::complex<double> turn = across / square;
  for (std::size_t i = 0; i < n; ++i)
    if (!(std::abs(turn * complex(it.points[i]) - complex(outline.points[i] - middle)) <= kForm))
      return false;
  const bool goes_on = !it.lives.empty() && it.lives.back().second == frames_;
  const double before = goes_on ? it.courses.back()[2].last() : 0;
  std::vector<double> numbers{middle.x(), middle.y(), wrapped_near(std::arg(turn), before), std::abs(turn)};
  std::vector<double> bounds{kPlace, kPlace, 0, 0};  // by its reach, when it is written
  if (it.key.style.kind == Kind::stroke) {
    numbers.push_back(plain ? outline.widths[0] : 1);
    bounds.push_back(kWidth);
  }
  live(it, numbers, bounds, {outline.colors[0]});
  return true;
}

bool Reel::add_grown(Thing& it, const Outline& outline) {
  if (!outline.plain() || outline.widths.empty() || it.key.style.closed) return false;
  const std::size_t n = outline.points.size() - 1, known = std::min(n, it.points.size());
  for (std::size_t i = 0; i < known; ++i)
    if ((outline.points[i] - it.points[i]).cwiseAbs().maxCoeff() > kForm) return false;
  it.points.insert(it.points.end(), outline.points.begin() + std::ptrdiff_t(known),
                   outline.points.begin() + std::ptrdiff_t(n));
  const Point& head = outline.points.back();
  live(it, {head.x(), head.y(), outline.widths[0]}, {kPlace, kPlace, kWidth}, {outline.colors[0], int(n)});
  return true;
}

void Reel::loosen(Thing& it) {
  if (it.form == Form::loose) return;
  std::vector<std::vector<int>> frames;
  for (std::size_t life = 0; life < it.lives.size(); ++life) {
    std::vector<std::vector<double>> numbers, steps;
    for (const Course& c : it.courses[life]) numbers.push_back(c.values());
    for (const Course& c : it.steps[life]) steps.push_back(c.values());
    for (std::size_t k = 0; k < numbers[0].size(); ++k) {
      Outline then;
      const bool stroke = it.key.style.kind == Kind::stroke;
      if (it.form == Form::rigid) {
        const std::complex<double> turn = std::polar(numbers[3][k], numbers[2][k]);
        for (const Point& p : it.points) {
          const std::complex<double> at = turn * std::complex<double>(p.x(), p.y());
          then.points.emplace_back(numbers[0][k] + at.real(), numbers[1][k] + at.imag());
        }
        if (stroke && it.widths.empty()) then.widths.assign(it.points.size(), numbers[4][k]);
        if (stroke && !it.widths.empty()) then.widths = it.widths;
        then.colors = it.colors.empty() ? std::vector<int>(it.points.size(), int(steps[0][k])) : it.colors;
      } else {
        then.points.assign(it.points.begin(), it.points.begin() + std::ptrdiff_t(steps[1][k]));
        then.points.emplace_back(numbers[0][k], numbers[1][k]);
        then.widths.assign(then.points.size(), numbers[2][k]);
        then.colors.assign(then.points.size(), int(steps[0][k]));
      }
      frames.push_back(loose_frame(then));
    }
  }
  it.form = Form::loose;
  it.frames = std::move(frames);
  it.courses.assign(it.lives.size(), {}), it.steps.assign(it.lives.size(), {});
  it.points.clear(), it.widths.clear(), it.colors.clear();
}

// how many nodes, whether their widths and colours differ, widths, colours, places
std::vector<int> Reel::loose_frame(const Outline& outline) {
  const auto whole = [](double x) { return int(std::lround(std::clamp(x, -1e6, 1e6) * kLoose)); };
  const bool plain = outline.plain();
  std::vector<int> all{int(outline.points.size()), plain ? 0 : 1};
  for (std::size_t i = 0;
       i < (plain ? std::min<std::size_t>(outline.widths.size(), 1) : outline.widths.size()); ++i)
    all.push_back(int(std::lround(outline.widths[i] * kPoint)));
  for (std::size_t i = 0; i < (plain ? 1 : outline.colors.size()); ++i) all.push_back(outline.colors[i]);
  for (const Point& p : outline.points) all.push_back(whole(p.x())), all.push_back(whole(p.y()));
  return all;
}

void Reel::add_outline(Thing& it, const Outline& outline) {
  if (it.lives.empty()) {
    // a form about its middle, so that it may turn
    it.form = Form::rigid;
    Point middle = Point::Zero();
    for (const Point& p : outline.points) middle += p / double(outline.points.size());
    for (const Point& p : outline.points) it.points.push_back(p - middle);
    if (!outline.plain()) it.widths = outline.widths, it.colors = outline.colors;
  }
  if (it.form == Form::rigid) {
    if (add_rigid(it, outline)) return;
    // a line that has stood still may begin to grow
    const bool still = std::all_of(it.courses.begin(), it.courses.end(), [](const auto& life) {
      return std::all_of(life.begin(), life.end(), [](const Course& c) { return c.constant(); });
    });
    if (still && !hang_ && it.lives.size() == 1 && it.key.style.kind == Kind::stroke && it.widths.empty()) {
      Thing grown;
      grown.key = it.key, grown.form = Form::grown;
      const Point middle(it.courses[0][0].first(), it.courses[0][1].first());
      for (const Point& p : it.points) grown.points.push_back(middle + p);
      const Point head = grown.points.back();
      grown.points.pop_back();
      grown.lives = it.lives, grown.bounds = {kPlace, kPlace, kWidth};
      const std::int64_t n = it.lives[0].second - it.lives[0].first;
      grown.courses.resize(1), grown.steps.resize(1);
      for (const double x : {head.x(), head.y(), it.courses[0][4].first()})
        grown.courses[0].emplace_back().add(x, n);
      for (const double x : {it.steps[0][0].first(), double(grown.points.size())})
        grown.steps[0].emplace_back().add(x, n);
      if (it.steps[0][0].constant() && add_grown(grown, outline)) {
        it = std::move(grown);
        return;
      }
    }
    loosen(it);
  } else if (it.form == Form::grown) {
    if (add_grown(it, outline)) return;
    loosen(it);
  }
  live(it, {}, {}, {});
  it.frames.push_back(loose_frame(outline));
}

void Reel::add_trail(Thing& it, const draw::Trail& trail) {
  if (it.lives.empty()) it.trail = trail;
  const double k = trail.scale / it.trail.scale;
  // its ends lie between the points of its way; but for the run's first
  const bool cut = trail.way.front().time <= trail.now - trail.lasting + 1e-9;
  for (std::size_t i = cut ? 1 : 0; i + 1 < trail.way.size(); ++i) {
    const draw::Trail::Point& p = trail.way[i];
    if (it.way.empty() || p.time > it.way.back().time)
      it.way.push_back({p.time, (p.at - trail.origin) / k, p.cusp});
  }
  const Point& head = trail.way.back().at;
  live(it, {head.x(), head.y(), trail.origin.x(), trail.origin.y(), k, trail.now, trail.widest},
       {kPlace, kPlace, kPlace, kPlace, kTrailScale, 1e-4, kWidth}, {});
}

void Reel::add(const draw::List& list, bool still) {
  std::array<std::vector<draw::About>, draw::kKinds> abouts;
  for (std::size_t kind = 0; kind < draw::kKinds; ++kind) abouts[kind] = list.about(Kind(kind));
  std::map<Key, int> count;
  std::size_t trail = 0;
  for (const draw::Batch& batch : list.batches) {
    const int clipped = batch.clip < 0 ? -1 : clip(list.clips[std::size_t(batch.clip)]);
    for (int i = batch.begin; i < batch.end; ++i) {
      const auto n = std::size_t(i);
      const auto& [subject, hang, none] = abouts[std::size_t(batch.kind)][n];
      if (subject.what == draw::kSeenLines.what && subject.index == draw::kSeenLines.index) continue;
      Style style{.kind = batch.kind, .still = still, .clip = clipped};
      hang_ = hang;
      if (hang) style.hang = hang->a == hang->b ? 1 : 2;
      if (hang && !hang->nodes.empty()) style.hang = int(hang->nodes.size()), style.through = true;
      Outline outline;
      if (batch.kind == Kind::text) style.whole = list.texts[n].whole.has_value();
      if (batch.kind == Kind::stroke) {
        while (trail < list.trails.size() && list.trails[trail].end <= i) ++trail;
        if (trail < list.trails.size() && list.trails[trail].begin <= i) {
          if (list.trails[trail].begin < i) continue;
          style.trail = true;
        }
        const draw::Stroke& stroke = list.strokes[n];
        style.closed = stroke.closed, style.round = stroke.cap == draw::Cap::round;
        style.blend = stroke.blend, style.turns = stroke.winding.turns;
      }
      Key key{subject, style, 0};
      key.place = count[key]++;
      Thing& it = thing(key);
      if (still) still_things_.push_back(int(&it - things_.data()));
      switch (batch.kind) {
        case Kind::disc: {
          const draw::Disc& d = list.discs[n];
          live(it, {d.center.x(), d.center.y(), d.radius, d.line}, {kPlace, kPlace, kWidth, kWidth},
               {color(d.fill), color(d.outline)});
          break;
        }
        case Kind::box: {
          const draw::Box& b = list.boxes[n];
          const bool goes_on = !it.lives.empty() && it.lives.back().second == frames_;
          const double angle =
              wrapped_near(std::atan2(b.x_axis.y(), b.x_axis.x()), goes_on ? it.courses.back()[2].last() : 0);
          const double reach = std::max(b.half.norm(), 1.0);
          live(it, {b.center.x(), b.center.y(), angle, b.half.x(), b.half.y(), b.line, b.axis, b.axis_line},
               {kPlace, kPlace, kTurn / reach, kWidth, kWidth, kWidth, kWidth, kWidth},
               {color(b.fill), color(b.outline), color(b.axis_color)});
          break;
        }
        case Kind::stroke: {
          const draw::Stroke& stroke = list.strokes[n];
          if (style.trail) {
            add_trail(it, list.trails[trail]);
            break;
          }
          const draw::Node *first = &list.nodes[std::size_t(stroke.begin)],
                           *last = &list.nodes[std::size_t(stroke.end - 1)];
          if (style.through) {
            live(it, {first->width}, {kWidth}, {color(first->color)});
            break;
          }
          if (style.turns > 0) {
            live(it,
                 {first->at.x(), first->at.y(), last->at.x(), last->at.y(), stroke.winding.lead,
                  stroke.winding.amplitude, first->width},
                 {kPlace, kPlace, kPlace, kPlace, kWidth, kWidth, kWidth}, {color(first->color)});
            break;
          }
          for (const draw::Node* node = first; node <= last; ++node) {
            outline.points.push_back(node->at);
            outline.widths.push_back(node->width);
            outline.colors.push_back(color(node->color));
          }
          add_outline(it, outline);
          break;
        }
        case Kind::polygon: {
          const draw::Polygon& polygon = list.polygons[n];
          if (style.through) {
            live(it, {0}, {kWidth}, {color(polygon.fill)});
            break;
          }
          for (int p = polygon.begin; p < polygon.end; ++p)
            outline.points.push_back(list.points[std::size_t(p)]);
          outline.colors.assign(outline.points.size(), color(polygon.fill));
          add_outline(it, outline);
          break;
        }
        case Kind::text: {
          const draw::Text& text = list.texts[n];
          const Point& at = text.whole ? *text.whole : text.at;
          live(it, {at.x(), at.y()}, {kLetter, kLetter}, {line(text)});
          break;
        }
      }
    }
  }
}

void Reel::add(const draw::Solids& solids, int panel) {
  hang_ = {};
  const double place = kPlace / solids.lens.scale, narrow = kWidth / solids.lens.scale;
  std::map<Key, int> count;
  const auto next = [&](int space, int nodes, int turns, int index = 0, bool front = false) -> Thing& {
    Style style{.turns = turns, .space = space, .nodes = nodes, .front = front};
    Key key{{draw::Subject::What::layer, index, solids.part}, style, 0};
    key.place = count[key]++;
    return thing(key);
  };
  const auto tubes = [&](int space, const std::vector<draw::Solids::Tube>& all, double width, int index) {
    for (const draw::Solids::Tube& tube : all) {
      std::vector<double> numbers, bounds(3 * tube.way.size(), place);
      for (const auto& p : tube.way) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
      numbers.insert(numbers.end(), {tube.radius, tube.winding.amplitude});
      bounds.insert(bounds.end(), {width, kWidth});
      live(next(space, int(tube.way.size()), tube.winding.turns, index), numbers, bounds,
           {color(tube.color)});
    }
  };
  tubes(5, solids.lines, kWidth, panel);
  if (panel > 0) return;
  tubes(1, solids.tubes, narrow, 0);
  for (const draw::Solids::Ball& ball : solids.balls)
    live(next(2, 0, 0), {ball.center.x(), ball.center.y(), ball.center.z(), ball.radius},
         {place, place, place, narrow}, {color(ball.color)});
  for (const draw::Solids::Plate& plate : solids.plates)
    live(next(3, 0, 0), {plate.center.x(), plate.center.y(), plate.center.z(), plate.half, plate.thick},
         {place, place, place, narrow, narrow}, {});
  for (const draw::Solids::Way& way : solids.ways) {
    Thing& it = next(4, way.path + 1, 0, way.body, way.front);
    if (it.lives.empty())
      it.trail.lasting = way.lasting, it.trail.strong = way.strong, it.trail.faint = way.faint;
    const bool cut = way.lasting > 0 && way.times.front() <= way.now - way.lasting + 1e-9;
    for (std::size_t i = cut ? 1 : 0; i + 1 < way.places.size(); ++i) {
      if (!it.way.empty() && way.times[i] <= it.way.back().time) continue;
      it.way.push_back({way.times[i], {0, 0}, false});
      it.places.push_back(way.places[i]);
    }
    const auto& head = way.places.back();
    live(it, {head.x(), head.y(), head.z(), way.now, way.widest}, {place, place, place, 1e-4, kWidth}, {});
  }
}

void Reel::add(const draw::Picture& picture) {
  after_ = order_.end();
  if (picture.still && picture.still == still_) {
    for (const int i : still_things_) {
      Thing& it = things_[std::size_t(i)];
      it.lives.back().second = frames_ + 1;
      for (Course& c : it.courses.back()) c.add(c.last());
      for (Course& c : it.steps.back()) c.add(c.last());
      if (it.form == Form::loose) it.frames.push_back(it.frames.back());
      after_ = places_[std::size_t(i)];
    }
  } else if (picture.still) {
    still_things_.clear();
    still_ = picture.still;
    add(*picture.still, true);
  }
  if (!picture.solids.empty()) hang_bound_ = kPlace / picture.solids.front()->lens.scale;
  add(picture.moving, false);
  // the cameras of a run see the same, but outlines
  int part = -1, panel = 0;
  for (const auto& solids : picture.solids) {
    panel = std::exchange(part, solids->part) == solids->part ? panel + 1 : 0;
    add(*solids, panel);
  }
  ++frames_;
}

void Reel::write(Thing& it, Json& json) {
  const Style& style = it.key.style;
  json["of"] = {int(it.key.subject.what), it.key.subject.index, it.key.subject.part};
  json["kind"] = int(style.kind);
  if (style.clip >= 0) json["clip"] = style.clip;
  if (style.still) json["still"] = 1;
  if (style.whole) json["whole"] = 1;
  if (style.hang > 0 && it.form != Form::loose) json["hang"] = style.hang;
  if (style.through) json["through"] = 1;
  if (style.kind == Kind::stroke) {
    json["style"] = (style.closed ? 1 : 0) | (style.round ? 2 : 0) | int(style.blend) << 2;
    if (style.turns > 0) json["turns"] = style.turns;
  }
  if (style.kind == Kind::stroke || style.kind == Kind::polygon) json["form"] = int(it.form);
  Json lives = Json::array();
  for (const auto& [from, to] : it.lives) lives.push_back(from), lives.push_back(to);
  if (lives != Json{0, frames_}) json["lives"] = lives;
  const auto whole = [](double x) { return std::int64_t(std::llround(x * kPoint)); };
  std::int64_t x = 0, y = 0;  // the point before
  const auto write_point = [&](const Point& p) {
    const std::int64_t px = whole(p.x()), py = whole(p.y());
    points_.add(px - x), points_.add(py - y);
    x = px, y = py;
  };
  if (style.space > 0) {
    json["space"] = style.space;
    if (style.space == 1 || style.space == 5) json["nodes"] = style.nodes, json["turns"] = style.turns;
  }
  if (style.space == 4) {
    json["trail"] = {it.trail.lasting, color(it.trail.strong), color(it.trail.faint)};
    if (style.nodes > 0) json["path"] = style.front ? 2 : 1;
    json["points"] = it.way.size();
    std::int64_t before = 0;
    Eigen::Matrix<std::int64_t, 3, 1> last = Eigen::Matrix<std::int64_t, 3, 1>::Zero();
    for (std::size_t i = 0; i < it.way.size(); ++i) {
      const auto time = std::int64_t(std::llround(it.way[i].time * 1e4));
      points_.add(time - before), before = time;
      for (int k = 0; k < 3; ++k) {
        const std::int64_t steps = std::llround(it.places[i][k] / double(float(it.bounds[0])));
        points_.add(steps - last[k]), last[k] = steps;
      }
    }
  } else if (style.trail) {
    json["trail"] = {it.trail.lasting, color(it.trail.strong), color(it.trail.faint)};
    json["points"] = it.way.size();
    // times by the tenth of a millisecond, beside whether the way breaks there
    std::int64_t before = 0;
    for (const draw::Trail::Point& p : it.way) {
      const auto time = std::int64_t(std::llround(p.time * 1e4));
      points_.add((time - before) * 2 + (p.cusp ? 1 : 0)), before = time;
      write_point(p.at);
    }
  } else if (it.form == Form::rigid || it.form == Form::grown) {
    json["points"] = it.points.size();
    for (const Point& p : it.points) write_point(p), it.reach = std::max(it.reach, p.norm());
    if (!it.widths.empty()) {
      json["profile"] = 1;
      for (std::size_t i = 0; i < it.points.size(); ++i)
        points_.add(whole(it.widths[i])), points_.add(it.colors[i]);
    }
  }
  if (it.form == Form::rigid) {
    double scale = 0;
    for (const auto& life : it.courses)
      for (const double s : life[3].values()) scale = std::max(scale, s);
    it.bounds[2] = kTurn / std::max(it.reach * scale, 1.0);
    it.bounds[3] = kTurn / std::max(it.reach, 1.0);
  }
  if (it.form == Form::loose) {
    const std::vector<int>* before = nullptr;
    for (const std::vector<int>& frame : it.frames) {
      const bool same = before && before->size() == frame.size() && (*before)[1] == frame[1];
      loose_.add(same ? 0 : frame[0]);
      if (!same) loose_.add(frame[1]);
      for (std::size_t i = 2; i < frame.size(); ++i)
        loose_.add(frame[i] - (same ? (*before)[i] : i >= 4 ? frame[i - 2] : 0));
      before = &frame;
    }
    return;
  }
  Json bounds = Json::array();
  for (const double bound : it.bounds) bounds.push_back(double(float(bound)));
  json["bounds"] = bounds;
  for (std::size_t life = 0; life < it.lives.size(); ++life) {
    for (std::size_t i = 0; i < it.bounds.size(); ++i)
      write_keys(it.courses[life][i].values(), double(float(it.bounds[i])), keys_);
    for (const Course& step : it.steps[life]) {
      // the value, and for how long
      std::int64_t run = 0;
      double value = step.first();
      const auto flush = [&] { steps_.add(std::int64_t(value)), steps_.add(run); };
      for (const double v : step.values()) {
        if (v != value) flush(), value = v, run = 0;
        ++run;
      }
      flush();
    }
  }
}

std::string Reel::finish(Json& json) {
  json["frames"] = frames_;
  Json things = Json::array();
  for (const int i : order_) {
    Json each;
    write(things_[std::size_t(i)], each);
    things.push_back(std::move(each));
  }
  Json numbers = Json::array();
  for (const Number& number : numbers_) {
    const double bound = double(float(number.bound));
    numbers.push_back(bound);
    write_keys(number.course.values(), bound, keys_);
  }
  std::vector<std::uint32_t> colors(colors_.size());
  for (const auto& [rgba, at] : colors_) colors[std::size_t(at)] = rgba;
  Json clips = Json::array();
  clips.get_ptr<Json::array_t*>()->resize(clips_.size());
  for (const auto& [rect, at] : clips_)
    clips[std::size_t(at)] = {rect[0] / double(kPoint), rect[1] / double(kPoint), rect[2] / double(kPoint),
                              rect[3] / double(kPoint)};
  json["colors"] = colors, json["clips"] = clips;
  json["glyphs"] = outlines_;
  Json lines = Json::array();
  for (const std::string& line : line_texts_) lines.push_back(Json::parse(line));
  json["lines"] = lines;
  json["numbers"] = numbers;
  json["things"] = std::move(things);
  std::string streams;
  Json sizes = Json::array();
  for (const Numbers* each :
       {&keys_.starts, &keys_.gaps, &keys_.ends, &keys_.bends, &points_, &steps_, &loose_}) {
    sizes.push_back(each->bytes().size());
    streams += each->bytes();
  }
  json["streams"] = sizes;
  return streams;
}

}  // namespace obscura::page
