// The page. In units of weight, from the top: caption (baseline 50, of its second line 84), band of the
// hatching, room, band, margin. A room that is too wide to fill the height is centred with its caption.

#include "draw/page/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

constexpr double kTitle = 34, kSubtitle = 26.5, kClock = 28.5;   // em
constexpr double kStrip = 76, kSecondLine = 36, kBaseline = 50;  // heights
constexpr double kPageMargin = 36, kTitleGap = 18, kClockGap = 44;
constexpr double kUnderWords = 4;                      // between them and the hatching
constexpr double kSmallestType = 0.82;                 // before the caption takes another line
constexpr double kLetters = 0.25;                      // em: how far letters reach below their line
constexpr double kTitleLine = 42, kSubtitleLine = 34;  // of words in several lines
constexpr std::size_t kMostRows = 3;
constexpr double kSmallestTitle = 0.5;  // of its size, before words are left out
constexpr double kRounding = 1e-9;
constexpr double kLeastOfUnit = 0.2;  // a shorter run has a smaller unit of time

}  // namespace

Fitted fitted_world(const sim::SceneInfo& cast, const Extent& extent) {
  Fitted f{false, extent.low.cwiseMin(extent.high), extent.low.cwiseMax(extent.high)};
  const double reach = 1e4 * std::max({cast.scale, (f.high - f.low).norm(), 1e-9});
  const Point about = ((f.low + f.high) / 2).head<2>();
  Convex room = border({about.x() - reach, about.y() - reach, 2 * reach, 2 * reach});
  for (std::size_t i = 0; i < cast.walls.size(); ++i) {
    room = cut(room, {cast.walls[i].point.head<2>(), cast.walls[i].normal.head<2>()}, int(i));
  }
  if (room.closed()) {
    f.closed = true;
    f.low.head<2>() = f.high.head<2>() = room.corners[0].at;
    for (const Convex::Corner& c : room.corners) {
      f.low.head<2>() = f.low.head<2>().cwiseMin(c.at);
      f.high.head<2>() = f.high.head<2>().cwiseMax(c.at);
    }
    return f;
  }

  // a picture without a ground says less: take in walls that are not farther than the extent is wide
  const double near = std::max((f.high - f.low).head<2>().maxCoeff(), 0.25 * cast.scale);
  for (const sim::SceneInfo::Wall& wall : cast.walls) {
    const sim::Vec3 center = (f.low + f.high) / 2;
    const double distance = (center - wall.point).dot(wall.normal);
    if (distance <= 0 || distance > 1.5 * near) continue;
    const sim::Vec3 foot = center - distance * wall.normal;
    f.low = f.low.cwiseMin(foot);
    f.high = f.high.cwiseMax(foot);
  }
  // one body at rest is not looked at with a microscope
  const double least = 0.25 * cast.scale;
  for (int i = 0; i < 2; ++i) {
    const double missing = least - (f.high[i] - f.low[i]);
    if (missing > 0) f.low[i] -= missing / 2, f.high[i] += missing / 2;
  }
  return f;
}

namespace {

/// How the caption's words are set: their size, and in how many lines.
struct Setting {
  double size = 1;
  int lines = 1;
  double span = 0;  // width they take
  std::vector<std::string> title{}, subtitle{};
  double title_size = 1, subtitle_size = 1;  // smaller where that is what makes them fit
  double deep = 0;   // page units: how much farther down the title's mathematics reaches than its letters
  double below = 0;  // how much farther down that of the last line reaches than there is room
  double more() const { return deep + below; }

  /// How high they are, in units of weight.
  double height(double type) const {
    const auto more = [](const auto& rows) { return double(rows.empty() ? 0 : rows.size() - 1); };
    return type *
           (kStrip + (lines - 1) * kSecondLine + more(title) * kTitleLine + more(subtitle) * kSubtitleLine);
  }
};

/// In so many lines at most: smaller, by `smaller`, if it needs to be; what does not go in then is left out.
std::vector<std::string> rows_of(const std::string& words, Face face, double size, double width,
                                 double& smaller) {
  smaller = 1;
  if (words.empty()) return {};
  const auto fits = [&](double type) {
    const std::vector<std::string> rows = wrapped(words, face, type, width);
    return rows.size() <= kMostRows && std::all_of(rows.begin(), rows.end(), [&](const std::string& row) {
             return width_of(row, face, type) <= width * (1 + kRounding);
           });
  };
  while (smaller > kSmallestTitle && !fits(smaller * size)) smaller -= 0.05;
  size *= smaller;
  std::vector<std::string> rows = wrapped(words, face, size, width);
  for (std::size_t i = kMostRows; i < rows.size(); ++i) rows[kMostRows - 1] += " " + rows[i];
  rows.resize(std::min(rows.size(), kMostRows));
  for (std::string& row : rows) row = fitted(row, face, size, width);
  std::erase(rows, "");
  return rows;
}

// the unit in which a run's clock counts, s, and its name
std::pair<double, std::string_view> unit_of_time(double duration) {
  std::pair<double, std::string_view> unit{1, "s"};
  for (const std::string_view smaller : {"ms", "µs", "ns", "ps", "fs"})
    if (duration < kLeastOfUnit * unit.first) unit = {unit.first / 1000, smaller};
  return unit;
}

// the widest text of the clock, page units
double clock_width(double duration, double size) {
  const double widest = std::max(88.88 * unit_of_time(duration).first, duration);
  return width_of(clock_text(widest, duration), Face::medium, size, true);
}

Setting set_words(const Look& look, double weight, double room, double page) {
  weight *= look.type_scale;
  const double title = width_of(look.title, Face::bold, kTitle * weight);
  const double subtitle = width_of(look.subtitle, Face::medium, kSubtitle * weight);
  const double clock =
      look.clock ? clock_width(look.duration, kClock * weight) + (look.badge ? badge_room(weight) : 0) : 0;
  const double gap = weight * kClockGap;
  const double top = title + (title > 0 && clock > 0 ? gap : 0) + clock;
  const double all =
      subtitle > 0 ? top + subtitle + weight * kTitleGap + (title > 0 || clock == 0 ? 0 : gap) : top;

  // one line within the room's width; else the subtitle under the title; a narrow room's caption reaches
  // beyond it; words that are too long for the page go on in another line
  const auto reach = [](const std::string& words, Face face, double size) {
    return contains_mathematics(words) ? prose(words, face, size, {}).descent : 0;
  };
  const double spare = (kStrip - kBaseline - kUnderWords) * weight;
  if (all * kSmallestType <= room) {
    Setting found{
        std::min(1.0, room / all), 1, room, wrapped(look.title, Face::bold, kTitle * weight, 1e9), {}};
    const double unit = found.size * weight;
    found.below = std::max({0.0, reach(look.title, Face::bold, kTitle * unit) - spare,
                            reach(look.subtitle, Face::medium, kSubtitle * unit) - spare});
    return found;
  }
  const int lines = subtitle > 0 && top > 0 ? 2 : 1;
  const double longest = lines == 2 ? std::max(top, subtitle) : all;
  const double span = std::min(page, std::max(room, longest));
  Setting found{std::clamp(span / longest, kSmallestType, 1.0), lines, span, {}, {}};
  if (longest * kSmallestType > span) found.size = 1;
  const double unit = weight * found.size;
  const double beside = clock > 0 ? clock * found.size + kClockGap * unit : 0;
  found.title = rows_of(look.title, Face::bold, kTitle * unit, span - beside, found.title_size);
  if (lines == 2)
    found.subtitle = rows_of(look.subtitle, Face::medium, kSubtitle * unit, span, found.subtitle_size);
  if (!found.title.empty()) {
    const double size = found.title_size * kTitle * unit, deep = reach(found.title.back(), Face::bold, size);
    if (lines == 2)
      found.deep = std::max(0.0, deep - kLetters * size);
    else
      found.below = std::max(0.0, deep - spare);
  }
  if (!found.subtitle.empty())
    found.below = std::max(
        0.0, reach(found.subtitle.back(), Face::medium, found.subtitle_size * kSubtitle * unit) - spare);
  return found;
}

void write_caption(Layout& layout, const Look& look, const Palette& colours, const Setting& setting,
                   double left, double right, double top) {
  const double type = layout.weight * look.type_scale, unit = type * setting.size;
  double baseline = top + type * kBaseline;
  const double span = right - left;
  double clock = 0;
  if (look.clock) {
    const double widest = clock_width(look.duration, kClock * unit);
    layout.clock_left = right - widest;
    clock = widest + kClockGap * unit + (look.badge ? badge_room(unit) : 0);
    layout.clock = {
        {right, baseline},
        Align::right,
        {{.text = "", .face = Face::medium, .size = kClock * unit, .color = colours.ink, .tabular = true}}};
  }
  const auto write = [&](const std::string& words, Face face, double size, Color color, double x) {
    if (contains_mathematics(words))
      layout.prose.emplace_back(prose(words, face, size, color), Point(x, baseline));
    else if (!words.empty())
      layout.words.push_back({{x, baseline},
                              Align::left,
                              {{.text = in_letters(words), .face = face, .size = size, .color = color}}});
  };

  if (setting.lines == 1) {
    const std::string title = fitted(look.title, Face::bold, kTitle * unit, span - clock);
    // alone it may take several lines
    for (std::size_t i = 0; i < std::max<std::size_t>(setting.title.size(), 1); ++i) {
      if (i > 0) baseline += type * kTitleLine;
      const bool several = setting.title.size() > 1;
      write(several ? setting.title[i] : title, Face::bold,
            (several ? setting.title_size : 1) * kTitle * unit, colours.ink, left);
    }
    if (look.subtitle.empty()) return;
    const double taken = title.empty() ? 0 : width_of(title, Face::bold, kTitle * unit) + kTitleGap * unit;
    write(fitted(look.subtitle, Face::medium, kSubtitle * unit, span - clock - taken), Face::medium,
          kSubtitle * unit, colours.quiet, left + taken);
    return;
  }
  for (std::size_t i = 0; i < setting.title.size(); ++i) {
    if (i > 0) baseline += type * kTitleLine;
    write(setting.title[i], Face::bold, setting.title_size * kTitle * unit, colours.ink, left);
  }
  baseline += type * kSecondLine + setting.deep;
  for (std::size_t i = 0; i < setting.subtitle.size(); ++i) {
    if (i > 0) baseline += type * kSubtitleLine;
    write(setting.subtitle[i], Face::medium, setting.subtitle_size * kSubtitle * unit, colours.quiet, left);
  }
}

}  // namespace

double page_weight(double aspect) { return std::min(1.0, std::sqrt(1080 * aspect / 1440)); }

double badge_room(double type) {
  return width_of("0.88 ×", Face::medium, kBadge * type, true) + 2.1 * kBadge * type;
}

void draw_words(const Layout& layout, List& list) {
  for (const Text& text : layout.words) list.add(text);
  for (const auto& [line, at] : layout.prose) add(line, at, list);
}

double width_of(const std::string& words, Face face, double size, bool tabular) {
  if (words.empty()) return 0;
  if (contains_mathematics(words)) return prose(words, face, size, {}).width;
  return shape({{0, 0},
                Align::left,
                {{.text = in_letters(words), .face = face, .size = size, .tabular = tabular}}})
      .width;
}

std::string clock_text(double time, double duration) {
  const auto [seconds, name] = unit_of_time(duration);
  const double shown = time / seconds;
  return fmt::format("t = {:.2f} {}", std::abs(shown) < 0.005 ? 0.0 : shown, name);
}

std::vector<HalfPlane> half_planes(const sim::SceneInfo& cast, const View& view) {
  std::vector<HalfPlane> halves;
  halves.reserve(cast.walls.size());
  for (const sim::SceneInfo::Wall& wall : cast.walls) {
    halves.push_back({view.page(wall.point), Point(wall.normal.x(), -wall.normal.y()).normalized()});
  }
  return halves;
}

bool outside(const Rect& r, const Point& p, double reach) {
  return p.x() + reach < r.x || p.x() - reach > r.x + r.width || p.y() + reach < r.y ||
         p.y() - reach > r.y + r.height;
}

std::string fitted(const std::string& words, Face face, double size, double width) {
  // what was made to fit exactly does so but for rounding
  if (words.empty() || width_of(words, face, size) <= width * (1 + kRounding)) return words;
  // the ends of its characters; mathematics is one
  std::vector<std::size_t> ends;
  for (const Phrase& phrase : phrases(words)) {
    const std::size_t close = phrase.begin + phrase.text.size();
    if (phrase.mathematics) ends.push_back(close + 1);
    for (std::size_t i = phrase.begin + 1; i <= close && !phrase.mathematics; ++i)
      if (i == words.size() ||
          ((static_cast<unsigned char>(words[i]) & 0xC0) != 0x80 && words[i - 1] != '\\'))
        ends.push_back(i);
  }
  auto with_ellipsis = [&](std::size_t characters) {
    std::size_t end = characters == 0 ? 0 : ends[characters - 1];
    while (end > 0 && (words[end - 1] == ' ' || words[end - 1] == ',')) --end;
    return words.substr(0, end) + "…";
  };
  std::size_t low = 0, high = ends.size();
  while (low < high) {
    const std::size_t half = (low + high + 1) / 2;
    if (width_of(with_ellipsis(half), face, size) <= width)
      low = half;
    else
      high = half - 1;
  }
  return low == 0 ? std::string() : with_ellipsis(low);
}

std::vector<std::string> wrapped(const std::string& words, Face face, double size, double width) {
  std::vector<std::string> lines{""};
  const std::vector<Phrase> all = phrases(words);
  // spaces of mathematics do not end a line
  const auto space_from = [&](std::size_t at) {
    for (std::size_t i = words.find_first_of(" \n", at); i != words.npos;
         i = words.find_first_of(" \n", i + 1))
      if (std::none_of(all.begin(), all.end(), [&](const Phrase& phrase) {
            return phrase.mathematics && i >= phrase.begin && i < phrase.begin + phrase.text.size();
          }))
        return i;
    return words.size();
  };
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t end = space_from(at);
    const std::string word = words.substr(at, end - at);
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (!lines.back().empty() && width_of(longer, face, size) > width)
      lines.push_back(word);
    else
      lines.back() = longer;
    if (end < words.size() && words[end] == '\n') lines.emplace_back();
    at = end + 1;
  }
  return lines;
}

double lay_caption(Layout& layout, const Look& look) {
  const double w = layout.weight;
  layout.caption = look.caption && (look.clock || !look.title.empty() || !look.subtitle.empty());
  if (!layout.caption) return 0;
  const double page = layout.width - 2 * std::max(w * kPageMargin, 0.045 * layout.width);
  const Setting setting = set_words(look, w, page, page);
  write_caption(layout, look, palette(look.theme), setting, (layout.width - page) / 2,
                (layout.width + page) / 2, 0);
  return w * setting.height(look.type_scale) + setting.more();
}

Layout lay_out(const sim::SceneInfo& cast, const Look& look, const Camera& camera, const Extent& extent,
               double aspect, double right, double below) {
  Layout layout;
  layout.width = 1080 * aspect;
  layout.aspect = layout.width / 1080;
  layout.weight = page_weight(aspect) * look.weight;
  layout.width -= right, layout.height -= below;
  const double w = layout.weight;
  const Fitted world = fitted_world(cast, extent);
  layout.closed = world.closed;
  layout.center = (world.low + world.high) / 2;
  layout.caption = look.caption && (look.clock || !look.title.empty() || !look.subtitle.empty());

  // the largest scale at which the world fits under a strip of this height
  const double band = cast.walls.empty() ? 0 : w * (look.hatching ? kBand : kWallLine);
  const double around = w * kPageMargin + band;
  const Point size = (world.high - world.low).head<2>();
  auto scale = [&](double strip) {
    const double wide = std::max(1.0, layout.width - 2 * around),
                 high = std::max(1.0, layout.height - strip - band - around);
    return std::min(wide / size.x(), high / size.y());
  };

  const bool still = camera.keys.empty() && camera.follow.empty();
  // the caption's lines depend on the room's width, which depends on the strip's height
  double strip = w * kPageMargin;
  Setting setting;
  const double page = layout.width - 2 * std::max(w * kPageMargin, 0.045 * layout.width);
  if (layout.caption) {
    // a camera of the scene's own shows the room in another size
    auto room = [&] { return world.closed && still ? scale(strip) * size.x() + 2 * w * kWallLine : page; };
    strip = w * look.type_scale * kStrip;
    setting = set_words(look, w, room(), page);
    for (int k = 0; k < 3 && setting.height(look.type_scale) * w + setting.more() > strip; ++k) {
      const int lines = setting.lines;
      strip = w * setting.height(look.type_scale) + setting.more();
      setting = set_words(look, w, room(), page);
      // a lower room is narrower: what took two lines does so still
      if (lines != 2 || setting.lines == 2) continue;
      setting.lines = 2;
      setting.subtitle = rows_of(look.subtitle, Face::medium, kSubtitle * w * look.type_scale * setting.size,
                                 setting.span, setting.subtitle_size);
    }
  }
  layout.scale = scale(strip);
  layout.room_height = layout.height - strip - band - around;

  // height that is left over goes above and below in equal parts; with a camera that moves, or an unbounded
  // world, the caption stays at the top
  const double spare = layout.height - strip - 2 * band - w * kPageMargin - layout.scale * size.y();
  const double above = world.closed && still ? spare / 2 : 0;
  layout.clipped = !(world.closed && still);
  const double top = layout.caption ? strip + above - 0.12 * w * kStrip : 0;
  layout.window = {0, top, layout.width, layout.height - top};
  layout.middle = {layout.width / 2, strip + spare / 2 + band + layout.scale * size.y() / 2};

  if (layout.caption) {
    const double half = setting.span / 2;
    write_caption(layout, look, palette(look.theme), setting, layout.width / 2 - half,
                  layout.width / 2 + half, above);
  }
  return layout;
}

}  // namespace obscura::draw
