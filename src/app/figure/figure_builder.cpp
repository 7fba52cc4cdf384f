#include "app/figure/figure_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/say.h"
#include "app/run/ahead.h"
#include "app/run/description.h"
#include "app/run/plots.h"
#include "app/run/run_marks.h"
#include "app/run/shown.h"
#include "app/run/simulation.h"
#include "app/run/telling.h"
#include "app/run/trouble.h"
#include "app/run/variation.h"
#include "draw/compose/annotate.h"
#include "draw/compose/annotations.h"
#include "draw/compose/arrow_scales.h"
#include "draw/compose/depict.h"
#include "draw/page/sheet.h"
#include "draw/picture/formula.h"
#include "draw/picture/type.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

constexpr double kColumn = 84 * 72 / 25.4;   // pt
constexpr double kGutter = 8, kLetter = 17;  // pt: between panels; above one, for its letter
constexpr double kRows = 6;                  // pt: between panels below each other
// lines of runs: ink, and colours that mean nothing else
constexpr std::array<const char*, 5> kTold{"", "orange", "purple", "sky", "grey"};
constexpr std::int64_t kMostPanels = 100;
constexpr int kMostExposures = 2000;
constexpr double kPathError = 0.2;                    // page units
constexpr double kFormula = 10, kTitle = 8.5;         // pt, em
constexpr double kLeastTitle = 0.6;                   // of a panel's title's size, where it is long
constexpr double kFaintest = 0.18, kStrongest = 0.6;  // of exposures
constexpr double kNoFilm = std::numeric_limits<double>::quiet_NaN();

// the end of the first step in which the figure's body is struck
sim::Rational impact(const scene::Scene& scene) {
  const auto run = scene.shown_run();
  run->heed(interrupted);
  const int body = scene.figure.impact;
  for (std::int64_t step = 1; sim::rational(step) / run->rate() <= scene.duration; ++step) {
    const sim::Rational t = sim::rational(step) / run->rate();
    const sim::Snapshot now = moment(*run, t, scene);
    for (const sim::Snapshot::Contact& each : now.contacts)
      if ((each.body == body || each.other == body) && each.impulse.norm() > 0) return t;
  }
  throw UsageError(fmt::format("{}: {} strikes nothing within the duration", scene.file,
                               run->scene_info().bodies[std::size_t(body)].name));
}

// "0.351 "s"", as mathematics: to the millisecond
std::string seconds_words(double time) {
  // three decimals, of times below a hundredth three digits
  const double size = std::abs(time);
  const int more = size < 0.01 && size > 1e-12 ? -int(std::floor(std::log10(size))) - 1 : 0;
  std::string number = fmt::format("{:.{}f}", size > 1e-12 ? time : 0.0, std::max(3, 3 + more));
  while (number.back() == '0') number.pop_back();
  if (number.back() == '.') number.pop_back();
  return number + " \"s\"";
}

// what a panel shows of a figure's marks, but for ghosts
draw::Marks marks_of(const draw::Figure& figure, int panel) {
  draw::Marks marks = figure;
  const auto leave = [&](auto& all) {
    std::erase_if(all, [&](const auto& mark) { return !mark.shown.in(panel); });
  };
  leave(marks.points), leave(marks.vectors), leave(marks.angles), leave(marks.lengths);
  leave(marks.cones), leave(marks.labels), leave(marks.paths);
  return marks;
}

bool traced(const draw::Marks& marks, int body) {
  return std::any_of(marks.paths.begin(), marks.paths.end(),
                     [&](const auto& path) { return path.at.body == body; });
}

// in one line; the panels are told where not all of several have lost it
void tell_unseen(const scene::Scene& scene, const std::map<std::string, std::string>& unseen,
                 std::size_t panels) {
  std::vector<std::string> all;
  for (const auto& [what, letters] : unseen) {
    all.push_back(what);
    if (letters.size() < panels)
      all.back() += fmt::format(" of panel{} {}", letters.size() > 1 ? "s" : "", fmt::join(letters, ", "));
  }
  if (!all.empty())
    say(stderr, "{}: warning: outside of what the figure shows, and left out: {}\n", scene.file,
        telling::together(all));
}

// Of axes that go by powers of ten nothing that is not positive has a place; what is over time begins at 0.
void tell_left_out(const scene::Scene& scene, const std::vector<draw::Plot>& plots) {
  for (const draw::Plot& plot : plots) {
    std::size_t all = 0, left = 0;
    for (const draw::Series& line : plot.lines)
      for (std::size_t i = 0; i < line.values.size(); ++i, ++all)
        left += !(line.values[i] > 0) || (!line.along.empty() && !(line.along[i] > 0));
    if (plot.log && left > 0)
      say(stderr,
          "{}: warning: the plot of {} leaves out {} of its {} values: scale \"log\" has no place for "
          "what is not positive\n",
          scene.file, draw::formula_in_letters(plot.title), left, all);
  }
}

}  // namespace

FigureBuilder::FigureBuilder(const std::string& file, const std::vector<std::string>& sets,
                             const AlbumOptions& options)
    : FigureBuilder(
          file, sets, [&](const std::vector<std::string>& with) { return scene::read(file, with); },
          options) {}

FigureBuilder::FigureBuilder(const scene::Scene& scene, const AlbumOptions& options)
    : FigureBuilder(
          scene.file == "-" ? "scene" : scene.file, scene.sets,
          [&](const std::vector<std::string>& with) { return scene.again(with); }, options) {}

FigureBuilder::FigureBuilder(const std::string& file, const std::vector<std::string>& sets, const Read& read,
                             const AlbumOptions& options)
    : apart_(options.latex) {
  // one scene for each value, all combinations
  std::vector<std::string> varies = options.vary;
  if (varies.empty() && file != "-")
    if (const std::string own = read(sets).figure.vary; !own.empty()) varies = {own};
  const Variations variants(varies);
  if (file == "-" && variants.size > 1)
    throw UsageError("--vary reads its scene more than once: name a file");

  int wanted = 0;
  for (std::int64_t run = 0; run < variants.size; ++run) {
    const std::string said = variants.formula(run);
    scene::Scene scene = with_run_marks(options.vary.empty() ? read(variants.sets(run, sets))
                                                             : varied_by_flag(variants, run, sets, read));
    if (options.theme) scene.look.theme = *options.theme;
    const draw::Figure& figure = scene.figure;
    std::vector<sim::Rational> times = options.at.empty() ? figure.at : options.at;
    if (options.at.empty() && scene.figure_waits)
      throw UsageError(file + ": the run does not come to the mark of [figure]");
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
    if (times.front() < sim::Rational{0, 1})
      throw UsageError(fmt::format("{}: 'at' of [figure] is {:g} s before the run, which starts at 0 s",
                                   scene.file, -sim::value(times.front())));
    width_ = options.width.value_or(figure.width ? *figure.width * 72 / 25.4 : kColumn);
    every_ = options.every ? options.every : figure.every;
    wanted = options.columns ? *options.columns : figure.columns;
    if (const std::int64_t panels = std::int64_t(times.size()) * variants.size; panels > kMostPanels)
      throw UsageError(fmt::format("{}: {} panels are more than {}, the most a figure has", scene.file,
                                   panels, kMostPanels));
    if (every_ && sim::value(times.back()) / sim::value(*every_) > kMostExposures)
      throw UsageError(fmt::format("{}: {:.0f} exposures are more than {}, the most a panel has", scene.file,
                                   sim::value(times.back()) / sim::value(*every_), kMostExposures));
    take(scene, times, said);
    const std::vector<std::string>& titles = figure.titles;
    const bool entitled = !figure.room && std::size_t(run) < titles.size();
    std::string name = entitled ? titles[std::size_t(run)] : "";
    const std::string words = entitled ? name : said;
    if (!entitled && !variants.keys.empty()) name = '"' + Variation::spoken(variants[run].back()) + '"';
    variants_.push_back({scene, name, words});
  }
  const int n = int(panels_.size()) *
                (panels_.front().cast.dimension == 3 ? int(panels_.front().scene.cameras.size()) : 1);
  columns_ = std::min(n, wanted > 0 ? wanted : n <= 4 ? n : int(std::ceil(std::sqrt(n))));
  // arrows of one name have the same numbers in all panels
  std::vector<sim::Snapshot> moments;
  for (const Cell& cell : cells()) moments.push_back(cell.panel->now);
  draw::Marks numbered = panels_.front().scene.figure;
  draw::number_arrows(numbered, panels_.front().cast, moments);
  for (Panel& panel : panels_) {
    std::vector<draw::Marks::Vector>& its = panel.scene.figure.vectors;
    for (std::size_t i = 0; i < its.size(); ++i) its[i].numbered = numbered.vectors[i].numbered;
  }
}

void FigureBuilder::take(const scene::Scene& scene, const std::vector<sim::Rational>& times,
                         const std::string& said) {
  const auto run = scene.shown_run();
  run->heed(interrupted);
  std::vector<int> trailed;
  for (std::size_t i = 0; i < scene.look.bodies.size(); ++i)
    if (scene.look.bodies[i].trail > 0 || traced(scene.figure, int(i))) trailed.push_back(int(i));
  run->track(trailed);

  const auto at = [&](sim::Rational t) { return moment(*run, t, scene); };
  std::vector<sim::Snapshot> before;
  std::vector<std::shared_ptr<const sim::Track>> ways;
  sim::Rational next;
  std::vector<std::pair<sim::Rational, std::size_t>> ghosts;  // those to come
  for (std::size_t i = 0; i < scene.figure.ghosts.size(); ++i)
    ghosts.emplace_back(scene.figure.ghosts[i].time, i);
  std::stable_sort(ghosts.begin(), ghosts.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::optional<sim::Snapshot>> then(ghosts.size());
  std::size_t ghost = 0;
  const auto haunt = [&](sim::Rational until) {
    for (; ghost < ghosts.size() && ghosts[ghost].first <= until; ++ghost)
      then[ghosts[ghost].second] = at(ghosts[ghost].first);
  };
  for (const sim::Rational& time : times) {
    for (; every_ && next < time; next = next + *every_) haunt(next), before.push_back(at(next));
    haunt(time);
    Panel panel{scene, run->scene_info(), at(time), before, then, {}, said};
    ways.push_back(std::make_shared<const sim::Track>(run->take_track()));
    panel.ways = ways;
    if (times.size() > 1) panel.words += (said.empty() ? "t = " : ", t = ") + seconds_words(sim::value(time));
    panels_.push_back(std::move(panel));
  }
  tell_limits(scene, limit_notes(*run));
}

std::vector<FigureBuilder::Cell> FigureBuilder::cells() const {
  const std::vector<draw::Camera>& cameras = panels_.front().scene.cameras;
  const int seen = panels_.front().cast.dimension == 3 ? int(cameras.size()) : 1;
  const std::vector<std::string>& titles = panels_.front().scene.figure.titles;
  std::vector<Cell> all;
  for (int camera = 0; camera < seen; ++camera) {
    for (const Panel& panel : panels_) {
      const std::string name = seen > 1 ? '"' + cameras[std::size_t(camera)].name + '"' : "";
      const std::size_t index = all.size();
      const std::string title = index < titles.size() ? titles[index] : "";
      all.push_back({&panel, camera, int(index),
                     name + (name.empty() || panel.words.empty() ? "" : ", ") + panel.words, title});
    }
  }
  return all;
}

Page FigureBuilder::page() const {
  const std::vector<Cell> cells = this->cells();
  const bool space = panels_.front().cast.dimension == 3;
  const int columns = std::min(columns_, int(cells.size()));
  const double each = (width_ - kGutter * (columns - 1)) / columns;
  const draw::Palette colours = draw::palette(panels_.front().scene.look.theme);

  // one scale for the arrows of all panels
  const draw::Figure& figure = panels_.front().scene.figure;
  std::vector<sim::Snapshot> moments;
  for (const Panel& panel : panels_) moments.push_back(panel.now);
  const draw::Illustrator first = depictor(cells.front(), each);
  draw::Rect window;
  double scale = 1;  // page units a metre
  if (space) {
    const draw::CameraProjection lens = first.lens(moments.front());
    const double k = each * draw::kPoint / lens.window.width;
    window = {0, 0, k * lens.window.width, k * lens.window.height}, scale = k * lens.scale;
  } else {
    window = first.layout().window, scale = first.layout().scale;
  }
  std::vector<draw::SeenInstant> seen;
  for (const Cell& cell : cells) {
    const draw::Illustrator artist = depictor(cell, each);
    seen.push_back({&cell.panel->now, artist.projection(0, cell.panel->now)});
  }
  draw::Scales scales = draw::kept_whole(figure, panels_.front().cast, seen, draw::Lettering{}.arrow,
                                         draw::scales(figure, panels_.front().cast, moments, window, scale));
  // beside the bodies' own arrows, and where the scene says it, theirs
  const draw::Scales given = given_scales(panels_.front().scene, panels_.front().cast);
  if (given.velocity > 0) scales.velocity = given.velocity;
  if (given.force > 0) scales.force = given.force;

  Page page;
  draw::List all;
  all.apart = apart_;
  double top = 0;
  const double point = panels_.front().scene.look.type_scale * draw::kPoint;  // page units, of type
  if (!figure.formula.empty()) {
    const draw::Formula formula = draw::formula(figure.formula, kFormula * point, colours.ink);
    top += point * 3 + formula.ascent;
    draw::add(formula, {draw::kPoint * 2, top}, all);
    top += formula.descent + point * 5;
    tell_wide("the formula", formula.width, width_ * draw::kPoint - 4 * draw::kPoint);
  }
  double row_height = 0;
  Unseen unseen;
  for (std::size_t i = 0; figure.room && i < cells.size(); ++i) {
    const int column = int(i) % columns;
    if (column == 0) top += row_height + (i > 0 ? kRows * draw::kPoint : 0), row_height = 0;
    double height = 0;
    const draw::Point corner(column * (each + kGutter) * draw::kPoint, top);
    const draw::Illustrator artist = depictor(cells[i], each);
    draw::List list;
    list.apart = apart_;
    if (space) {
      Lit lit;
      list = in_space(artist, cells[i], scales, each, height, lit, unseen);
      lit.where.x += corner.x(), lit.where.y += corner.y();
      page.lit.push_back(std::move(lit));
    } else {
      list = in_plane(artist, cells[i], scales, height, unseen);
    }
    if (cells.size() > 1) {
      const double baseline = 9 * point, room = each * draw::kPoint - 18 * point;
      list.add(draw::Text{{2 * draw::kPoint, baseline},
                          draw::Align::left,
                          {{.text = fmt::format("({})", char('a' + i % 26)),
                            .face = draw::Face::bold,
                            .size = 9 * point,
                            .color = colours.ink,
                            .tabular = true}}});
      // what the scene says, or what sets it apart
      const std::string& said = cells[i].title.empty() ? cells[i].words : cells[i].title;
      draw::Formula title = draw::formula(said, kTitle * point, colours.ink);
      // a long one is smaller
      if (title.width > room)
        title = draw::formula(said, kTitle * point * std::max(kLeastTitle, room / title.width), colours.ink);
      tell_wide(fmt::format("the title of panel ({})", char('a' + i % 26)), title.width, room);
      draw::add(title, {18 * point, baseline}, list);
    }
    all.add(list, 1, corner);
    row_height = std::max(row_height, height);
  }
  top += row_height;
  tell_unseen(scene(), unseen, cells.size());
  if (figure.room && draw::has_legend(figure)) {
    // in space a panel reaches to the page's edges, and the scale is that where its camera looks
    double left = 2 * draw::kPoint, right = width_ * draw::kPoint - left;
    if (!space) {
      const draw::Layout& layout = first.layout();
      const double margin = layout.clipped ? 2 * draw::kPoint : layout.weight * draw::kBand;
      left = layout.window.x + margin, right = width_ * draw::kPoint - margin;
    }
    const double type = panels_.front().scene.look.type_scale;
    top += 10 * point;
    top = draw::draw_legend(figure, scales, colours, scale, left, right, top, type, all) + 4 * point;
  }
  // plots below each other, as wide as the figure
  const std::vector<draw::Plot> plots = this->plots();
  std::vector<draw::Rect> rects;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (top > 0) top += 4 * draw::kPoint;
    const double height = figure.plots[i].height * 72 / 25.4 * draw::kPoint;
    rects.push_back({2 * draw::kPoint, top, (width_ - 4) * draw::kPoint, height});
    top += height;
  }
  tell_left_out(scene(), plots);
  draw::draw_plots(plots, colours, rects, panels_.front().scene.look.type_scale, all);
  draw::set_decimal_mark(all, panels_.front().scene.look.decimal);
  const double unit = 1080 / top;
  page.picture.aspect = width_ * draw::kPoint / top;
  page.picture.ground = colours.ground;
  page.picture.moving.add(all, unit, {0, 0});
  for (Lit& lit : page.lit)
    lit.where = {unit * lit.where.x, unit * lit.where.y, unit * lit.where.width, unit * lit.where.height};
  return page;
}

// what is wider than its place goes over what is beside it, or the page's edge; both in page units
void FigureBuilder::tell_wide(const std::string& what, double width, double room) const {
  if (width <= room * (1 + 1e-9)) return;
  const auto mm = [](double units) { return units / draw::kPoint * 25.4 / 72; };
  say(stderr, "{}: warning: {} is {:.0f} mm wide, and its place {:.0f} mm; a larger width has room for it\n",
      scene().file, what, mm(width), mm(room));
}

std::string FigureBuilder::text() const {
  std::string all;
  const Panel& front = panels_.front();
  const draw::Figure& figure = front.scene.figure;
  const auto add = [&](const std::string& sentence) { all += (all.empty() ? "" : " ") + sentence; };
  if (!figure.room && !front.scene.look.title.empty()) add(telling::headline(front.scene.look));
  for (std::size_t i = 0; figure.room && i < panels_.size(); ++i) {
    const Panel& panel = panels_[i];
    if (i > 0) all += " ";
    if (panels_.size() > 1) all += fmt::format("({}) ", char('a' + i % 26));
    all += i == 0 ? picture_text(panel.scene, panel.cast, panel.now) : instant_text(panel.cast, panel.now);
  }
  if (figure.room)
    for (const std::string& sentence : shown_marks(figure, front.scene.look, front.cast)) add(sentence);
  for (const draw::Figure::Plot& plot : figure.plots) {
    add(shown_plot(plot, front.cast, plot.over.substr(0, plot.over.find('=')), !plot.reference.empty()));
  }
  if (variants_.size() > 1 && !figure.plots.empty()) {
    std::vector<std::string> names;
    for (const auto& variant : variants_) names.push_back(draw::formula_in_letters(variant.name));
    add(fmt::format("Its lines are of {} runs: {}.", variants_.size(), telling::together(names)));
  }
  return all;
}

// the lines of several runs in one plot, each labelled with its value
std::vector<draw::Plot> FigureBuilder::plots() const {
  std::vector<double> marks;
  if (panels_.front().scene.figure.room)
    for (const Panel& panel : panels_) marks.push_back(panel.now.time);
  std::vector<draw::Plot> all = app::plots(variants_.front().scene, marks);
  if (variants_.size() == 1) return all;
  const draw::Color ink = draw::palette(variants_.front().scene.look.theme).ink;
  for (draw::Plot& plot : all) plot.lines.clear();
  const draw::Figure& figure = panels_.front().scene.figure;
  for (std::size_t v = 0; v < variants_.size(); ++v) {
    const std::vector<draw::Plot> own = app::plots(variants_[v].scene, marks);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (draw::Series line : own[i].lines) {
        const std::string what = own[i].lines.size() > 1 ? line.label + " " : "";
        // a key has room for more than a value, which no panel says either
        const bool alone = !figure.room && !figure.plots[i].against.empty();
        line.label = what + (alone ? variants_[v].words : variants_[v].name);
        const auto told = draw::color(kTold[all[i].lines.size() % kTold.size()]);
        line.color = told ? draw::mix(*told, ink, 0.2) : ink;
        line.weight = 1;
        all[i].lines.push_back(std::move(line));
      }
    }
  }
  for (draw::Plot& plot : all) draw::tell_apart(plot);
  return all;
}

draw::Illustrator FigureBuilder::depictor(const Cell& cell, double width) const {
  const Panel& panel = *cell.panel;
  draw::Look look = panel.scene.look;
  look.caption = false;
  for (draw::BodyLook& body : look.bodies) body.label.clear();  // they are among the marks
  if (panel.cast.dimension == 3) {
    const scene::Film& film = panel.scene.film;
    return {panel.cast, look, panel.scene.cameras[std::size_t(cell.camera)], panel.scene.extent,
            double(film.width) / film.height};
  }
  const draw::Figure& figure = panel.scene.figure;
  draw::Sheet sheet{.width = width, .above = panels_.size() > 1 ? look.type_scale * kLetter : 0};
  if (figure.low && figure.high) sheet.region = draw::Extent{*figure.low, *figure.high};
  if (figure.axes) {
    sheet.below = look.type_scale * draw::kRulerBelow, sheet.left = look.type_scale * draw::kRulerLeft;
    sheet.left =
        draw::ruler_left(draw::lay_out(panel.cast, look, panel.scene.extent, sheet), look.type_scale);
  }
  return {panel.cast, look, panel.scene.extent, sheet};
}

std::vector<draw::SpaceGhost> FigureBuilder::ghosts_of(const Cell& cell) {
  static const std::vector<int> all;
  const Panel& panel = *cell.panel;
  std::vector<draw::SpaceGhost> ghosts;
  for (std::size_t k = 0; k < panel.before.size(); ++k) {
    const double age = double(k) / double(panel.before.size());
    ghosts.push_back({&panel.before[k], &all, kFaintest + (kStrongest - kFaintest) * age});
  }
  for (std::size_t i = 0; i < panel.ghosts.size(); ++i) {
    const draw::Marks::Ghost& ghost = panel.scene.figure.ghosts[i];
    if (panel.ghosts[i] && ghost.shown.in(cell.index) && ghost.shown.has(panel.now.time, kNoFilm))
      ghosts.push_back({&*panel.ghosts[i], &ghost.bodies, draw::kGhost});
  }
  return ghosts;
}

// arrows, lines and words over a panel's picture: what lies outside of it is left out, and told
void FigureBuilder::annotate(const Cell& cell, const draw::Marks& marks, const draw::Scales& scales,
                             const std::vector<draw::SpaceGhost>& ghosts,
                             const std::vector<draw::WorldLine>& paths, const draw::Projection& projection,
                             Unseen& unseen, draw::List& list) const {
  const Panel& panel = *cell.panel;
  const draw::Look& look = panel.scene.look;
  std::vector<draw::Timed> times;
  for (const sim::Snapshot& then : panel.before)
    if (panel.scene.figure.times_of >= 0) times.push_back({&then, seconds_words(then.time)});
  std::vector<std::vector<sim::Vec3>> behind;
  for (const draw::WorldLine& path : paths) {
    std::vector<sim::Vec3>& way = behind.emplace_back();
    for (const draw::WorldLine::Node& node : path.nodes) way.push_back(node.at);
  }
  std::vector<draw::WordKey> outside;
  draw::Annotating how{.look = &look,
                       .behind = behind,
                       .ghosts = ghosts,
                       .times = times,
                       .times_of = panel.scene.figure.times_of,
                       .unseen = &outside};
  how.lettering.point *= look.type_scale;
  list.clip(projection.window());
  draw::annotate(marks, scales, panel.cast, draw::palette(look.theme), projection, panel.now, list, how);
  list.unclip();
  for (const draw::WordKey& key : outside) {
    const auto i = std::size_t(key.index);
    const bool point = key.kind == draw::WordKey::point;
    const std::string words = draw::formula_in_letters(point ? marks.points[i].label : marks.labels[i].text);
    unseen[fmt::format("the {}{}", point ? "point" : "label", words.empty() ? "" : " '" + words + "'")] +=
        char('a' + cell.index % 26);
  }
}

draw::List FigureBuilder::in_plane(const draw::Illustrator& depictor, const Cell& cell,
                                   const draw::Scales& scales, double& height, Unseen& unseen) const {
  const Panel& panel = *cell.panel;

  // fixed things, earlier exposures from the oldest on, the instant itself, its annotations
  const draw::Marks marks = marks_of(panel.scene.figure, cell.index);
  draw::Picture picture = depictor.depict(panel.now, panel.ways);
  draw::List list;
  list.apart = apart_;
  list.add(*picture.still, 1, {0, 0});
  const std::vector<draw::SpaceGhost> ghosts = ghosts_of(cell);
  for (const draw::SpaceGhost& ghost : ghosts)
    depictor.ghosts(*ghost.then, ghost.strength, list, *ghost.bodies);
  const draw::View view = depictor.view(panel.now.time);
  const auto paths = draw::path_lines(
      marks, draw::paths_of(marks, panel.ways, kPathError / view.scale, &panel.now), panel.now, kNoFilm);
  list.clip(view.window);
  depictor.draw_lines(view, paths, false, list);
  list.add(picture.moving, 1, {0, 0});
  list.clip(view.window);
  depictor.draw_lines(view, paths, true, list);
  annotate(cell, marks, scales, ghosts, paths, draw::Projection(view), unseen, list);
  if (panel.scene.figure.axes)
    draw::draw_rulers(depictor.layout(), view, draw::palette(panel.scene.look.theme),
                      panel.scene.look.type_scale, list);
  height = depictor.layout().height;
  return list;
}

// a camera's picture, as wide as the panel, under the panel's letter
draw::List FigureBuilder::in_space(const draw::Illustrator& depictor, const Cell& cell,
                                   const draw::Scales& scales, double width, double& height, Lit& lit,
                                   Unseen& unseen) const {
  const Panel& panel = *cell.panel;
  const draw::Marks marks = marks_of(panel.scene.figure, cell.index);
  const double at_target = depictor.scale(panel.now);
  const std::vector<draw::SpaceGhost> ghosts = ghosts_of(cell);
  const auto paths = draw::path_lines(
      marks, draw::paths_of(marks, panel.ways, kPathError / at_target, &panel.now), panel.now, kNoFilm);
  lit.picture = depictor.depict(panel.now, panel.ways, paths, ghosts);
  const double scale = width * draw::kPoint / (1080 * lit.picture.aspect);
  const bool has_letter = panels_.size() * panel.scene.cameras.size() > 1;
  const draw::Point corner(0, has_letter ? panel.scene.look.type_scale * kLetter * draw::kPoint : 0);
  lit.where = {corner.x(), corner.y(), 1080 * lit.picture.aspect * scale, 1080 * scale};
  height = corner.y() + lit.where.height;
  draw::List list;
  list.apart = apart_;
  list.add(lit.picture.moving, scale, corner);
  lit.picture.moving = {};
  annotate(cell, marks, scales, ghosts, paths, draw::Projection(depictor.lens(panel.now), scale, corner),
           unseen, list);
  return list;
}

}  // namespace obscura::app
