#include "app/album.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/exit.h"
#include "app/interrupt.h"
#include "app/trouble.h"
#include "draw/depict.h"
#include "draw/sheet.h"
#include "sim/run.h"

namespace obscura::app {

namespace {

constexpr double kColumn = 84 * 72 / 25.4;            // pt
constexpr double kGutter = 8, kLetter = 13;           // pt: between panels; above one, for its letter
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
  for (const std::string& vary : options.vary) {
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

  for (const auto& [changes, said] : variants) {
    scene::Scene scene = scene::read(file, changes);
    if (options.theme) scene.look.theme = *options.theme;
    std::vector<sim::Rational> times = options.at;
    if (times.empty()) times = {scene.duration / sim::rational(4)};
    width_ = options.width.value_or(kColumn);
    every_ = options.every;
    take(scene, times, said, variants.size());
  }
  const int n = int(panels_.size());
  columns_ = std::min(n, options.columns.value_or(n <= 4 ? n : int(std::ceil(std::sqrt(n)))));
}

void Album::take(const scene::Scene& scene, const std::vector<sim::Rational>& times, const std::string& said,
                 std::size_t values) {
  const auto run = scene.run();
  run->heed(interrupted);
  std::vector<int> trailed;
  for (std::size_t i = 0; i < scene.look.bodies.size(); ++i)
    if (scene.look.bodies[i].trail > 0) trailed.push_back(int(i));
  run->track(trailed);

  const auto at = [&](sim::Rational t) {
    auto moment = run->at(t);
    if (const auto* trouble = std::get_if<sim::Trouble>(&moment))
      throw TroubleError(scene.file, *trouble, "");
    if (std::holds_alternative<sim::Stopped>(moment)) throw Interrupted();
    return std::get<sim::Snapshot>(std::move(moment));
  };
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
  (void)values;
}

draw::Picture Album::picture() const {
  if (panels_.front().cast.dimension == 3) return in_space();
  const bool several = panels_.size() > 1;
  const double each = (width_ - kGutter * (columns_ - 1)) / columns_;
  draw::List all;
  double row_top = 0, row_height = 0;
  draw::Color ground;
  for (std::size_t i = 0; i < panels_.size(); ++i) {
    const Panel& panel = panels_[i];
    draw::Look look = panel.scene.look;
    look.caption = false;
    const draw::Depictor depictor(panel.cast, look, panel.scene.extent,
                                  draw::Sheet{.width = each, .above = several ? kLetter : 0});
    const int column = int(i) % columns_;
    if (column == 0) row_top += row_height, row_height = 0;

    // what stands still, earlier exposures from the oldest on, the instant itself
    draw::Picture picture = depictor.depict(panel.now, panel.ways);
    ground = picture.ground;
    draw::List list = *picture.still;
    for (std::size_t k = 0; k < panel.before.size(); ++k) {
      const double age = double(k) / double(panel.before.size());
      depictor.ghosts(panel.before[k], kFaintest + (kStrongest - kFaintest) * age, list);
    }
    list.add(picture.moving, 1, {0, 0});
    const draw::Layout& layout = depictor.layout();
    if (several) {
      const draw::Palette colours = draw::palette(look.theme);
      const double baseline = 9 * draw::kPoint;
      list.add(words(fmt::format("({})", char('a' + int(i % 26))), draw::Face::bold, 9, {2, baseline},
                     colours.ink));
      list.add(words(panel.words, draw::Face::regular, 8.5, {18 * draw::kPoint, baseline}, colours.ink));
    }
    all.add(list, 1, {column * (each + kGutter) * draw::kPoint, row_top});
    row_height = std::max(row_height, layout.height);
  }
  const double height = row_top + row_height, width = width_ * draw::kPoint;
  draw::Picture page;
  page.aspect = width / height;
  page.ground = ground;
  page.moving.add(all, 1080 / height, {0, 0});
  return page;
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
