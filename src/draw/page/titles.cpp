// Cards cover the page; captions stand in a strip at its foot that is left free for them, the first line
// at its top; the badge is a small frame before the clock.

#include "draw/page/titles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace obscura::draw {
namespace {

constexpr double kCardTitle = 62, kText = 32, kCaption = 32;  // em, page units at the weight 1
constexpr double kLead = 1.35;                                // em: a line
constexpr double kAbove = 0.98;                               // em: what a line takes above its baseline
constexpr double kOffTall = 0.1;                              // em: from tall mathematics to what is beside
constexpr double kFoot = 26;                                  // from the page's edge to the captions
constexpr double kCaptionFade = 0.2;                          // s: captions come and go
constexpr double kCaptionWidth = 0.86;                        // of the page

/// The same number of lines, as even as can be.
std::vector<std::string> balanced(const std::string& words, Face face, double size, double width) {
  const std::size_t count = wrapped(words, face, size, width).size();
  double low = width / 4, high = width;
  while (high - low > 0.25 * size) {
    const double middle = (low + high) / 2;
    (wrapped(words, face, size, middle).size() > count ? low : high) = middle;
  }
  return wrapped(words, face, size, high);
}

void centered(const std::vector<std::string>& lines, Face face, double size, double x, double& baseline,
              Color color, List& list) {
  for (const std::string& line : lines) {
    add_prose(line, face, size, color, {x, baseline}, Align::center, list);
    baseline += kLead * size;
  }
}

double opacity(const Card& card, double film) {
  if (film < card.begin - 1e-9 || film >= card.end - 1e-9) return 0;
  if (!(card.fade > 0)) return 1;
  double strength = 1;
  if (!card.first) strength = std::min(strength, (film - card.begin) / card.fade);
  if (!card.last) strength = std::min(strength, (card.end - film) / card.fade);
  strength = std::clamp(strength, 0.0, 1.0);
  return strength * strength * (3 - 2 * strength);
}

void draw_card(const Card& card, double strength, const Rect& page, double weight, const Palette& colours,
               List& list) {
  const auto faded = [&](Color color) {
    color.a = std::uint8_t(std::lround(255 * strength));
    return color;
  };
  const Point low(page.x, page.y), high(page.width, page.height);
  list.halo(true);
  list.add({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, faded(colours.ground));
  list.halo(false);
  const double width = 0.8 * page.width;
  const auto title = wrapped(card.title, Face::bold, kCardTitle * weight, width),
             text = wrapped(card.text, Face::regular, kText * weight, width);
  const double gap = card.title.empty() || card.text.empty() ? 0 : 0.9 * kText * weight;
  const double height = (card.title.empty() ? 0 : kLead * kCardTitle * weight * double(title.size())) + gap +
                        (card.text.empty() ? 0 : kLead * kText * weight * double(text.size()));
  double baseline = (page.height - height) / 2;
  if (!card.title.empty()) {
    baseline += kCardTitle * weight;
    centered(title, Face::bold, kCardTitle * weight, page.width / 2, baseline, faded(colours.ink), list);
    baseline -= kCardTitle * weight - gap;
  }
  if (!card.text.empty()) {
    baseline += kText * weight;
    centered(text, Face::regular, kText * weight, page.width / 2, baseline, faded(colours.quiet), list);
  }
}

// how strong a caption is: it comes within its interval and goes within it, what stands from the first frame
// on is there at once
double opacity(const Caption& caption, double film) {
  const double fade = std::min(kCaptionFade, (caption.end - caption.begin) / 2);
  double strength = 1;
  if (!(fade > 0)) return strength;
  if (caption.begin > 0) strength = std::min(strength, (film - caption.begin) / fade);
  return std::clamp(std::min(strength, (caption.end - film) / fade), 0.0, 1.0);
}

void draw_captions(const Titles& titles, const Rect& page, double weight, double time, double film, Color ink,
                   List& list) {
  const double size = kCaption * weight;
  double top = page.height - titles.foot;
  for (const Caption& caption : titles.captions) {
    if (!caption.shown.has(time, film)) continue;
    Color color = ink;
    if (!titles.still) color.a = std::uint8_t(std::lround(color.a * opacity(caption, film)));
    for (std::size_t k = 0; k < caption.lines.size(); ++k) {
      add_prose(caption.lines[k], Face::medium, size, color, {page.width / 2, top + caption.room[k].x()},
                Align::center, list);
      top += caption.room[k].sum();
    }
  }
}

// from the page's colour and to it
double covered(const Titles& titles, double film) {
  if (!(titles.fade > 0)) return 0;
  const double u = std::clamp(std::min(film, titles.length - film) / titles.fade, 0.0, 1.0);
  return 1 - u * u * (3 - 2 * u);
}

void draw_badge(double speed, const Rect& page, const Layout& layout, double weight, const Palette& colours,
                List& list) {
  // before the clock, or where that would be
  const double size = kBadge * weight, high = 1.5 * size, inset = 0.55 * size;
  double right = page.width - std::max(36 * weight, 0.045 * page.width), middle = 0.75 * size + 16 * weight;
  if (layout.caption && !layout.clock.spans.empty()) {
    const Span& clock = layout.clock.spans[0];
    right = layout.clock_left - size;
    middle = layout.clock.at.y() - 0.36 * clock.size;
  }
  const double top = middle - high / 2;
  const std::string words = speed > 0 ? fmt::format("{:.2g} ×", speed) : "";
  const double width = speed > 0 ? width_of(words, Face::medium, size, true) : 0.62 * size;
  const double left = right - width - 2 * inset;
  const double line = 2 * weight;
  const auto node = [&](double x, double y) { return Node{{x, y}, line, colours.quiet}; };
  list.add({node(left, top), node(right, top), node(right, top + high), node(left, top + high)}, Cap::butt,
           Blend::over, true);
  if (speed > 0) {
    list.add(
        Text{{left + inset, top + 0.5 * high + 0.36 * size},
             Align::left,
             {{.text = words, .face = Face::medium, .size = size, .color = colours.quiet, .tabular = true}}});
    return;
  }
  // it stands still: two bars
  for (const double x : {left + inset + 0.08 * size, left + inset + 0.42 * size})
    list.add({{x, top + 0.42 * size},
              {x + 0.14 * size, top + 0.42 * size},
              {x + 0.14 * size, top + high - 0.42 * size},
              {x, top + high - 0.42 * size}},
             colours.quiet);
}

}  // namespace

Titles laid_out(const Titles& titles, double aspect, double type_scale) {
  Titles all = titles;
  all.type_scale = type_scale;
  all.foot = 0;
  const double size = kCaption * page_weight(aspect) * type_scale;
  for (Caption& caption : all.captions) {
    caption.lines = balanced(caption.text, Face::medium, size, kCaptionWidth * 1080 * aspect);
    caption.room.clear();
    for (const std::string& line : caption.lines) {
      const Formula set = prose(line, Face::medium, size, {});
      const auto room = [&](double usual, double own) {
        return own > usual * size ? own + kOffTall * size : usual * size;
      };
      caption.room.emplace_back(room(kAbove, set.ascent), room(kLead - kAbove, set.descent));
    }
  }
  // the highest at one instant: one at which a caption begins
  for (const Caption& at : all.captions) {
    double high = 0;
    for (const Caption& each : all.captions)
      if (each.begin <= at.begin && at.begin < each.end)
        for (const Point& room : each.room) high += room.sum();
    all.foot = std::max(all.foot, high + kFoot * page_weight(aspect));
  }
  return all;
}

void draw_titles(const Titles& titles, const Layout& layout, double aspect, const Palette& colours,
                 double time, double film, double speed, List& list) {
  if (titles.empty()) return;
  const Rect page{0, 0, 1080 * aspect, 1080};
  const double weight = layout.weight, type = weight * titles.type_scale;
  const bool carded = std::any_of(titles.cards.begin(), titles.cards.end(),
                                  [&](const Card& card) { return opacity(card, film) > 0; });
  if (titles.badge && std::abs(speed - 1) > 0.005 && !carded)
    draw_badge(speed, page, layout, type, colours, list);
  draw_captions(titles, page, type, time, film, colours.ink, list);
  for (const Card& card : titles.cards)
    if (const double strength = opacity(card, film); strength > 0)
      draw_card(card, strength, page, type, colours, list);
  if (const double cover = covered(titles, film); cover > 0) {
    Color color = colours.ground;
    color.a = std::uint8_t(std::lround(255 * cover));
    list.halo(true);
    list.add({{0, 0}, {page.width, 0}, {page.width, page.height}, {0, page.height}}, color);
    list.halo(false);
  }
}

}  // namespace obscura::draw
