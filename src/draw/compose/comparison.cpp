#include "draw/compose/comparison.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "draw/page/layout.h"
#include "draw/picture/prose.h"
#include "draw/picture/solids.h"
#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

constexpr double kSmallestName = 0.55;
constexpr double kName = 26, kNameStrip = 46, kNameRise = 13;  // page units at the weight 1
constexpr double kPanelGap = 22, kPageEdge = 36, kBelowCaption = 8;
constexpr double kWords = 24, kRow = 34, kPlateAround = 6;  // of words in a window's corner
constexpr double kTitleLeft = 0.045;                        // of the width of the page
constexpr std::uint8_t kNamePlate = 200;
constexpr double kDarker = 0.35, kLighter = 0.45;  // runs whose colour others have had

Layout page_layout(const Look& look, double aspect, double right, double below, double& top) {
  Layout layout;
  layout.width = 1080 * aspect, layout.aspect = aspect, layout.weight = page_weight(aspect);
  layout.width -= right, layout.height -= below;
  const double strip = lay_caption(layout, look);
  top = strip > 0 ? strip + kBelowCaption * layout.weight : kPageEdge * layout.weight;
  return layout;
}

std::string words_of(const RunInstant& now) {
  switch (now.fate) {
    case Fate::diverges:
      return "diverges";
    case Fate::ended:
      return fmt::format("diverged at t = {:.2f} s", now.now->time);
    case Fate::well:
      break;
  }
  return "";
}

Rect both(const Rect& a, const Rect& b) {
  const double left = std::max(a.x, b.x), top = std::max(a.y, b.y);
  return {left, top, std::max(0.0, std::min(a.x + a.width, b.x + b.width) - left),
          std::max(0.0, std::min(a.y + a.height, b.y + b.height) - top)};
}

// a panel's own list, put down in it
void add_panel(const List& own, const Rect& panel, List& list) {
  List moved;
  moved.add(own, panel.height / 1080, {panel.x, panel.y});
  for (Rect& clip : moved.clips) clip = both(clip, panel);
  const int all = int(moved.clips.size());
  moved.clips.push_back(panel);
  for (Batch& batch : moved.batches)
    if (batch.clip < 0) batch.clip = all;
  list.add(moved, 1, {0, 0});
}

// words in the corner of a window, `down` from its upper edge, on a plate of the room's colour, perhaps
// behind a name with mathematics
void write_in_corner(const Formula& name, const std::vector<Span>& spans, const Rect& window, double weight,
                     double down, const Palette& colours, List& list) {
  const double size = kWords * weight, around = kPlateAround * weight;
  // not before the title's left end
  const double x = std::max(window.x + 3 * around, kTitleLeft * (window.x + window.width));
  const Point at(x, window.y + down);
  const Text text{at + Point(name.width, 0), Align::left, spans};
  const double width = name.width + shape(text).width;
  const double left = at.x() - around, right = at.x() + width + around;
  const double high = at.y() - std::max(0.74 * size, name.ascent) - around,
               low = at.y() + std::max(0.22 * size, name.descent) + around;
  Color plate = colours.room;
  plate.a = kNamePlate;
  list.halo(true);
  list.add({{left, high}, {right, high}, {right, low}, {left, low}}, plate);
  list.halo(false);
  add(name, at, list);
  if (!spans.empty()) list.add(text);
}

}  // namespace

Color compared_color(int run) {
  constexpr int kTurns = 6;
  const Color own = turn(run);
  return run < kTurns       ? own
         : run < 2 * kTurns ? mix(own, {0, 0, 0}, kDarker)
                            : mix(own, {255, 255, 255}, kLighter);
}

Paint compared_paint(int run, Theme theme) { return paint(compared_color(run), theme); }

std::vector<Rect> compared_panels(int n, double across, const Look& look, const std::vector<Chart>& charts,
                                  const Titles& titles, double aspect, int height) {
  const auto [right, below] = Charts::room(charts, aspect);
  double top = 0;
  const Layout layout = page_layout(look, aspect, right, below + titles.foot, top);
  const double w = layout.weight, strip = kNameStrip * w * look.type_scale, gap = kPanelGap * w;
  // from the caption's left end to its right one
  const double side = std::max(w * kPageEdge, kTitleLeft * layout.width), span = layout.width - 2 * side;
  const double low = layout.height - (below + titles.foot > 0 ? 0 : kPageEdge * w / 2);
  // as many columns as make the world largest
  int columns = 1;
  double best = -1;
  for (int c = 1; c <= n; ++c) {
    const int rows = (n + c - 1) / c;
    const double wide = (span - gap * (c - 1)) / c, high = (low - top - gap * (rows - 1)) / rows - strip;
    const double size = std::min(wide, high * across);
    if (size > best * (1 + 1e-9)) best = size, columns = c;
  }
  const int rows = (n + columns - 1) / columns;
  const double wide = (span - gap * (columns - 1)) / columns,
               high = (low - top - gap * (rows - 1)) / rows - strip;
  const double pixel = 1080.0 / height;
  const auto whole = [&](double x) { return std::round(x / pixel) * pixel; };
  std::vector<Rect> all;
  for (int i = 0; i < n; ++i) {
    const double x = side + i % columns * (wide + gap);
    const double y = top + strip + i / columns * (high + gap + strip);
    all.push_back({whole(x), whole(y), std::max(pixel, whole(wide)), std::max(pixel, whole(high))});
  }
  return all;
}

struct Comparison::Still {
  std::mutex mutex;
  std::vector<std::shared_ptr<const List>> parts;
  std::shared_ptr<const List> list;
};

Comparison::Comparison(std::vector<ComparedRun> runs, std::vector<Illustrator> artists,
                       std::vector<Rect> panels, const Look& look, double aspect, const Charts& charts,
                       const Titles& titles)
    : runs_(std::move(runs)),
      artists_(std::move(artists)),
      panels_(std::move(panels)),
      look_(look),
      charts_(charts),
      titles_(titles),
      colours_(palette(look.theme)),
      aspect_(aspect),
      still_(std::make_shared<Still>()) {
  double top = 0;
  layout_ = page_layout(look_, aspect, charts.right(), charts.empty() ? titles.foot : charts.below(), top);
  colours_ = artists_.front().colours();
}

Picture Comparison::depict(const std::vector<Instant>& runs, double time, double film, double speed) const {
  Picture picture;
  picture.aspect = aspect_;
  picture.ground = colours_.ground;
  std::vector<Picture> parts;
  for (std::size_t i = 0; i < artists_.size(); ++i)
    parts.push_back(
        artists_[i].depict(runs[i].now, runs[i].ways, {runs[i].frame, film, speed, runs[i].fate}));
  {
    const std::lock_guard lock(still_->mutex);
    std::vector<std::shared_ptr<const List>> seen;
    for (const Picture& part : parts) seen.push_back(part.still);
    if (!still_->list || still_->parts != seen) {
      auto list = std::make_shared<List>();
      for (std::size_t i = 0; i < parts.size(); ++i)
        if (seen[i]) list->part = int(i), add_panel(*seen[i], panels_[i], *list);
      list->part = 0;
      draw_words(layout_, *list);
      charts_.draw_still(*list);
      const double w = layout_.weight;
      // where they are too long for their panels they are all smaller, before one loses its end
      double size = kName * w * look_.type_scale, fit = 1;
      for (std::size_t i = 0; i < parts.size(); ++i)
        fit = std::min(fit, panels_[i].width / std::max(1.0, width_of(runs_[i].name, Face::bold, size)));
      size *= std::max(fit, kSmallestName);
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string name = fitted(runs_[i].name, Face::bold, size, panels_[i].width);
        const Point at(panels_[i].x + kPlateAround * w, panels_[i].y - kNameRise * w * look_.type_scale);
        add_prose(name, Face::bold, size, legible(runs_[i].color, colours_), at, Align::left, *list);
      }
      set_decimal_mark(*list, look_.decimal);
      still_->list = std::move(list), still_->parts = std::move(seen);
    }
    picture.still = still_->list;
  }
  List& list = picture.moving;
  std::vector<RunInstant> nows;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Rect& panel = panels_[i];
    for (const auto& solids : parts[i].solids) {
      Solids its = placed(*solids, panel.height / 1080, {panel.x, panel.y});
      its.part = int(i);
      picture.solids.push_back(std::make_shared<const Solids>(std::move(its)));
    }
    list.part = int(i);
    add_panel(parts[i].moving, panel, list);
    nows.push_back({&runs[i].frame, runs[i].fate});
  }
  list.part = 0;
  if (layout_.caption && look_.clock) {
    Text clock = layout_.clock;
    clock.spans[0].text = clock_text(time, look_.duration);
    list.of({Subject::What::page, 1});
    list.add(clock);
  }
  charts_.draw_lines(nows, list);
  list.of({Subject::What::page, 2});
  draw_titles(titles_, layout_, aspect_, colours_, time, film, speed, list);
  set_decimal_mark(list, look_.decimal);
  return picture;
}

void draw_run_names(const std::vector<ComparedRun>& runs, const std::vector<RunInstant>& nows,
                    const Rect& window, double full, const Palette& colours, List& list) {
  // of many runs smaller, so that they stay within the window
  const double weight = std::min(full, window.height / (kRow * (double(runs.size()) + 0.5)));
  double down = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string words = words_of(nows[i]);
    const double size = kWords * weight;
    const Color color = legible(runs[i].color, colours);
    std::vector<Span> spans;
    Formula name;
    if (contains_mathematics(runs[i].name))
      name = prose(runs[i].name, Face::bold, size, color);
    else
      spans.push_back({.text = in_letters(runs[i].name), .face = Face::bold, .size = size, .color = color});
    // high mathematics takes more of the column
    down += std::max(kRow * weight, name.ascent + name.descent + (kRow - kWords) * weight);
    if (!words.empty())
      spans.push_back({.text = " " + words,
                       .face = Face::medium,
                       .size = kWords * weight,
                       .color = colours.force,
                       .tabular = true});
    write_in_corner(name, spans, window, weight, down, colours, list);
  }
}

void draw_fate(const RunInstant& now, const Rect& window, double weight, const Palette& colours, List& list) {
  if (now.fate == Fate::well) return;
  write_in_corner({},
                  {{.text = words_of(now),
                    .face = Face::bold,
                    .size = kWords * weight,
                    .color = colours.force,
                    .tabular = true}},
                  window, weight, kRow * weight, colours, list);
}

}  // namespace obscura::draw
