// Cards cover the page; a caption is a line or two on a plate at its foot; the badge is a small frame at the
// right end of the caption strip's second line.

#include "draw/page/titles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace obscura::draw {
namespace {

constexpr double kCardTitle = 62, kText = 32, kCaption = 32, kBadge = 23;  // em, page units at the weight 1
constexpr double kLead = 1.35;                                             // of a line
constexpr double kFoot = 30;    // from the page's edge to a caption's plate
constexpr double kInset = 14;   // of a plate around its words
constexpr double kPlate = 215;  // alpha

/// As many lines as words need to be no wider than `width`.
std::vector<std::string> wrapped(const std::string& words, Face face, double size, double width) {
  std::vector<std::string> lines{""};
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t end = std::min(words.find_first_of(" \n", at), words.size());
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

void centered(const std::vector<std::string>& lines, Face face, double size, double x, double& baseline,
              Color color, List& list) {
  for (const std::string& line : lines) {
    list.add(
        Text{{x, baseline}, Align::center, {{.text = line, .face = face, .size = size, .color = color}}});
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
  list.add({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, faded(colours.ground));
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

void draw_caption(const std::vector<std::string>& lines, const Rect& page, double weight,
                  const Palette& colours, List& list) {
  const double size = kCaption * weight, inset = kInset * weight;
  double width = 0;
  for (const std::string& line : lines) width = std::max(width, width_of(line, Face::medium, size));
  const double height = kLead * size * double(lines.size());
  const double bottom = page.height - kFoot * weight, top = bottom - height - inset;
  const double left = (page.width - width) / 2 - 1.4 * inset, right = page.width - left;
  Color plate = colours.room;
  plate.a = std::uint8_t(kPlate);
  list.add({{left, top}, {right, top}, {right, bottom}, {left, bottom}}, plate);
  double baseline = top + inset / 2 + 0.98 * size;
  centered(lines, Face::medium, size, page.width / 2, baseline, colours.ink, list);
}

void draw_badge(double speed, const Rect& page, const Layout& layout, const Palette& colours, List& list) {
  // before the clock, or where that would be
  const double weight = layout.weight, size = kBadge * weight, high = 1.5 * size, inset = 0.55 * size;
  double right = page.width - std::max(36 * weight, 0.045 * page.width), middle = 0.75 * size + 16 * weight;
  if (layout.caption && !layout.clock.spans.empty()) {
    const Span& clock = layout.clock.spans[0];
    right = layout.clock.at.x() - width_of(clock_text(88.88), clock.face, clock.size, true) - size;
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

void draw_titles(const Titles& titles, const Layout& layout, double aspect, const Palette& colours,
                 double time, double film, double speed, List& list) {
  if (titles.empty()) return;
  const Rect page{0, 0, 1080 * aspect, 1080};
  const double weight = layout.weight;
  if (titles.badge && std::abs(speed - 1) > 0.005) draw_badge(speed, page, layout, colours, list);
  std::vector<std::string> lines;
  for (const Caption& caption : titles.captions)
    if (caption.shown.has(time, film))
      for (std::string& line : wrapped(caption.text, Face::medium, kCaption * weight, 0.86 * page.width))
        lines.push_back(std::move(line));
  if (!lines.empty()) draw_caption(lines, page, weight, colours, list);
  for (const Card& card : titles.cards)
    if (const double strength = opacity(card, film); strength > 0)
      draw_card(card, strength, page, weight, colours, list);
}

}  // namespace obscura::draw
