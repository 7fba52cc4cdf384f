#include "app/album.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "app/exit.h"
#include "app/interrupt.h"
#include "app/plots.h"
#include "app/trouble.h"
#include "draw/annotate.h"
#include "draw/depict.h"
#include "draw/formula.h"
#include "draw/sheet.h"
#include "sim/run.h"

namespace obscura::app {

namespace {

constexpr double kColumn = 84 * 72 / 25.4;   // pt
constexpr double kGutter = 8, kLetter = 13;  // pt: between panels; above one, for its letter
constexpr std::array<const char*, 5> kTold{"blue", "vermilion", "green", "purple",
                                           "orange"};  // lines of runs
constexpr std::size_t kMostPanels = 100;
constexpr int kMostExposures = 2000;
constexpr double kFormula = 10;                       // pt, em
constexpr double kFaintest = 0.18, kStrongest = 0.6;  // of exposures

// "crate.elasticity=0,0.5,1" as --set values, and the words of each
std::vector<std::pair<std::string, std::string>> values(const std::string& vary) {
  const auto equals = vary.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == vary.size())
    throw UsageError(fmt::format("--vary {}: expected PATH=VALUES, as in crate.elasticity=0,0.5,1", vary));
  const std::string path = vary.substr(0, equals), list = vary.substr(equals + 1);
  const std::string last = path.substr(path.rfind('.') == std::string::npos ? 0 : path.rfind('.') + 1);
  std::vector<std::pair<std::string, std::string>> all;
  std::size_t depth = 0, from = 0;
  for (std::size_t i = 0; i <= list.size(); ++i) {
    if (i < list.size() && list[i] == '[') ++depth;
    if (i < list.size() && list[i] == ']' && depth > 0) --depth;
    if (i < list.size() && (list[i] != ',' || depth > 0)) continue;
    const std::string value = list.substr(from, i - from);
    from = i + 1;
    all.emplace_back(path + "=" + value, last + " = " + value);
  }
  return all;
}

// the run at an instant, or what ended it
sim::Snapshot moment(sim::Run& run, sim::Rational t, const scene::Scene& scene) {
  auto found = run.at(t);
  if (const auto* trouble = std::get_if<sim::Trouble>(&found)) throw TroubleError(scene.file, *trouble, "");
  if (std::holds_alternative<sim::Stopped>(found)) throw Interrupted();
  return std::get<sim::Snapshot>(std::move(found));
}

// the end of the first step in which the figure's body is struck
sim::Rational impact(const scene::Scene& scene) {
  const auto run = scene.run();
  run->heed(interrupted);
  const int body = scene.figure.impact;
  for (std::int64_t step = 1; sim::rational(step) / run->rate() <= scene.duration; ++step) {
    const sim::Rational t = sim::rational(step) / run->rate();
    const sim::Snapshot now = moment(*run, t, scene);
    for (const sim::Snapshot::Contact& each : now.contacts)
      if ((each.body == body || each.other == body) && each.impulse.norm() > 0) return t;
  }
  throw UsageError(fmt::format("{}: {} strikes nothing within the duration", scene.file,
                               run->cast().bodies[std::size_t(body)].name));
}

draw::Text words(const std::string& text, draw::Face face, double size, const draw::Point& at,
                 draw::Color color, draw::Align align = draw::Align::left) {
  return {at,
          align,
          {{.text = text, .face = face, .size = size * draw::kPoint, .color = color, .tabular = true}}};
}

}  // namespace

Album::Album(const std::string& file, const std::vector<std::string>& sets, const AlbumOptions& options) {
  // one scene for each value, all combinations
  std::vector<std::pair<std::vector<std::string>, std::string>> variants{{sets, ""}};
  std::vector<std::string> varies = options.vary;
  if (varies.empty() && file != "-")
    if (const std::string own = scene::read(file, sets).figure.vary; !own.empty()) varies = {own};
  for (const std::string& vary : varies) {
    std::vector<std::pair<std::vector<std::string>, std::string>> more;
    for (const auto& [so_far, said] : variants) {
      for (const auto& [set, text] : values(vary)) {
        more.emplace_back(so_far, said.empty() ? text : said + ", " + text);
        more.back().first.push_back(set);
      }
    }
    variants = std::move(more);
  }
  if (file == "-" && variants.size() > 1)
    throw UsageError("--vary reads its scene more than once: name a file");

  int wanted = 0;
  for (const auto& [changes, said] : variants) {
    scene::Scene scene = scene::read(file, changes);
    if (options.theme) scene.look.theme = *options.theme;
    const draw::Figure& figure = scene.figure;
    std::vector<sim::Rational> times = options.at.empty() ? figure.at : options.at;
    if (figure.impact >= 0) {
      const sim::Rational struck = impact(scene);
      if (times.empty()) times = {{0, 1}};
      for (sim::Rational& time : times) {
        time = struck + time;
        if (time < sim::Rational{0, 1}) time = {0, 1};
      }
    }
    if (times.empty()) times = {scene.duration / sim::rational(4)};
    std::sort(times.begin(), times.end(), [](auto a, auto b) { return a < b; });
    width_ = options.width.value_or(figure.width ? *figure.width * 72 / 25.4 : kColumn);
    every_ = options.every ? options.every : figure.every;
    wanted = options.columns ? *options.columns : figure.columns;
    if (times.size() * variants.size() > kMostPanels)
      throw UsageError(fmt::format("{}: {} panels are more than {}, the most a figure has", scene.file,
                                   times.size() * variants.size(), kMostPanels));
    if (every_ && sim::value(times.back()) / sim::value(*every_) > kMostExposures)
      throw UsageError(fmt::format("{}: {:.0f} exposures are more than {}, the most a panel has", scene.file,
                                   sim::value(times.back()) / sim::value(*every_), kMostExposures));
    take(scene, times, said);
    const auto value = said.rfind(" = ");
    variants_.push_back({scene, value == said.npos ? said : said.substr(value + 3)});
  }
  const int n = int(panels_.size());
  columns_ = std::min(n, wanted > 0 ? wanted : n <= 4 ? n : int(std::ceil(std::sqrt(n))));
}

void Album::take(const scene::Scene& scene, const std::vector<sim::Rational>& times,
                 const std::string& said) {
  const auto run = scene.run();
  run->heed(interrupted);
  std::vector<int> trailed;
  for (std::size_t i = 0; i < scene.look.bodies.size(); ++i)
    if (scene.look.bodies[i].trail > 0) trailed.push_back(int(i));
  run->track(trailed);

  const auto at = [&](sim::Rational t) { return moment(*run, t, scene); };
  std::vector<sim::Snapshot> before;
  std::vector<std::shared_ptr<const sim::Track>> ways;
  sim::Rational next;
  for (const sim::Rational& time : times) {
    for (; every_ && next < time; next = next + *every_) before.push_back(at(next));
    Panel panel{scene, run->cast(), at(time), before, {}, said};
    ways.push_back(std::make_shared<const sim::Track>(run->take_track()));
    panel.ways = ways;
    if (times.size() > 1)
      panel.words += (said.empty() ? "" : ", ") + fmt::format("t = {:g} s", sim::value(time));
    panels_.push_back(std::move(panel));
  }
}

draw::Picture Album::picture() const {
  if (panels_.front().cast.dimension == 3) return in_space();
  const double each = (width_ - kGutter * (columns_ - 1)) / columns_;
  const draw::Palette colours = draw::palette(panels_.front().scene.look.theme);

  // one scale for the arrows of all panels
  const draw::Figure& figure = panels_.front().scene.figure;
  std::vector<sim::Snapshot> moments;
  for (const Panel& panel : panels_) moments.push_back(panel.now);
  const draw::Depictor first = depictor(panels_.front(), each);
  const draw::Scales scales = draw::scales(figure, panels_.front().cast, moments, first.layout());

  draw::List all;
  double top = 0;
  if (!figure.formula.empty()) {
    const draw::Formula formula = draw::formula(figure.formula, kFormula * draw::kPoint, colours.ink);
    top += draw::kPoint * 3 + formula.ascent;
    draw::add(formula, {draw::kPoint * 2, top}, all);
    top += formula.descent + draw::kPoint * 5;
  }
  double row_height = 0;
  for (std::size_t i = 0; figure.room && i < panels_.size(); ++i) {
    const int column = int(i) % columns_;
    if (column == 0) top += row_height, row_height = 0;
    double height = 0;
    const draw::List list = panel(int(i), each, scales, height);
    all.add(list, 1, {column * (each + kGutter) * draw::kPoint, top});
    row_height = std::max(row_height, height);
  }
  top += row_height;
  if (figure.room && draw::has_legend(figure)) {
    const draw::Layout& layout = first.layout();
    const double margin = layout.clipped ? 2 * draw::kPoint : layout.weight * draw::kBand;
    top += 10 * draw::kPoint;
    draw::draw_legend(figure, scales, colours, layout.scale, margin, width_ * draw::kPoint - margin, top,
                      all);
    top += 4 * draw::kPoint;
  }
  // plots below each other, as wide as the figure
  const std::vector<draw::Plot> plots = this->plots();
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (top > 0) top += 4 * draw::kPoint;
    const double height = figure.plots[i].height * 72 / 25.4 * draw::kPoint;
    draw::draw_plot(plots[i], colours, {2 * draw::kPoint, top, (width_ - 4) * draw::kPoint, height}, all);
    top += height;
  }
  draw::Picture page;
  page.aspect = width_ * draw::kPoint / top;
  page.ground = colours.ground;
  page.moving.add(all, 1080 / top, {0, 0});
  return page;
}

// of several runs, their lines in one plot, each with the value that sets it apart
std::vector<draw::Plot> Album::plots() const {
  std::vector<double> marks;
  if (panels_.front().scene.figure.room)
    for (const Panel& panel : panels_) marks.push_back(panel.now.time);
  std::vector<draw::Plot> all = app::plots(variants_.front().scene, marks);
  if (variants_.size() == 1) return all;
  const draw::Color ink = draw::palette(variants_.front().scene.look.theme).ink;
  for (draw::Plot& plot : all) plot.lines.clear();
  for (std::size_t v = 0; v < variants_.size(); ++v) {
    const std::vector<draw::Plot> own = app::plots(variants_[v].scene, marks);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (draw::Series line : own[i].lines) {
        const std::string what = own[i].lines.size() > 1 ? line.label + " " : "";
        line.label = what + "\"" + variants_[v].name + "\"";
        line.color = draw::mix(*draw::color(kTold[all[i].lines.size() % kTold.size()]), ink, 0.2);
        all[i].lines.push_back(std::move(line));
      }
    }
  }
  return all;
}

draw::Depictor Album::depictor(const Panel& panel, double width) const {
  draw::Look look = panel.scene.look;
  look.caption = false;
  draw::Sheet sheet{.width = width, .above = panels_.size() > 1 ? kLetter : 0};
  const draw::Figure& figure = panel.scene.figure;
  if (figure.low && figure.high) sheet.region = draw::Extent{*figure.low, *figure.high};
  return {panel.cast, look, panel.scene.extent, sheet};
}

draw::List Album::panel(int i, double width, const draw::Scales& scales, double& height) const {
  const Panel& panel = panels_[std::size_t(i)];
  const draw::Depictor depictor = this->depictor(panel, width);
  const draw::Palette colours = draw::palette(panel.scene.look.theme);

  // what stands still, earlier exposures from the oldest on, the instant itself, what is said of it
  draw::Picture picture = depictor.depict(panel.now, panel.ways);
  draw::List list = *picture.still;
  for (std::size_t k = 0; k < panel.before.size(); ++k) {
    const double age = double(k) / double(panel.before.size());
    depictor.ghosts(panel.before[k], kFaintest + (kStrongest - kFaintest) * age, list);
  }
  list.add(picture.moving, 1, {0, 0});
  draw::annotate(panel.scene.figure, scales, panel.cast, colours, depictor.layout(),
                 depictor.view(panel.now.time), panel.now, list);
  if (panels_.size() > 1) {
    const double baseline = 9 * draw::kPoint;
    list.add(words(fmt::format("({})", char('a' + i % 26)), draw::Face::bold, 9, {2 * draw::kPoint, baseline},
                   colours.ink));
    list.add(words(panel.words, draw::Face::regular, 8.5, {18 * draw::kPoint, baseline}, colours.ink));
  }
  height = depictor.layout().height;
  return list;
}

draw::Picture Album::in_space() const {
  if (panels_.size() > 1) throw UsageError("in space a figure is of one instant");
  const Panel& panel = panels_.front();
  draw::Look look = panel.scene.look;
  look.caption = false;
  const scene::Film& film = panel.scene.film;
  const draw::Depictor depictor(panel.cast, look, panel.scene.cameras, panel.scene.extent,
                                double(film.width) / film.height);
  return depictor.depict(panel.now, panel.ways);
}

}  // namespace obscura::app
