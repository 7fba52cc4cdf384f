#include "draw/compose/depict.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "draw/compose/annotations.h"
#include "draw/compose/comparison.h"
#include "draw/compose/travel.h"
#include "draw/page/measure.h"
#include "draw/page/sheet.h"
#include "draw/picture/formula.h"
#include "draw/picture/joint_look.h"
#include "draw/picture/type.h"
#include "draw/plane/gears.h"
#include "draw/plane/stage.h"
#include "draw/space/camera.h"
#include "draw/space/space.h"

namespace obscura::draw {
namespace {

constexpr double kPathLine = 3.6;    // the line of a path, page units at the weight 1
constexpr double kForceArrow = 0.1;  // of the room's height: an arrow of a usual force

constexpr double kSlenderArm = 0.5;  // of a wheel's radius: half the width of an arm that lies over it

constexpr int kMarks = 100;  // layers up to there are of bodies and what ties them

bool is_point(const sim::SceneInfo::Body& body) { return body.kind == sim::ShapeKind::point && !body.bare; }

// the bodies with flat sides
void draw_flats(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears, Rank rank,
                List& list) {
  draw_boxes(stage, view, now, gears, rank, list);
  draw_polygons(stage, view, now, rank, list);
  draw_belts(stage, view, now, rank, false, list);
}

// bodies, what ties them, their own arrows and names
void draw_forms(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const Gears gears = gears_of(stage.cast, now);
  int layer = 0;
  const auto draw = [&](auto&& things) {
    list.of({Subject::What::layer, layer++});
    things();
  };
  draw([&] { draw_brackets(stage, view, now, list); });
  draw([&] { draw_ways(stage, view, now, list); });
  draw([&] { draw_tracks(stage, view, now, list); });
  draw([&] {
    draw_rails(stage, view, now, list);
    draw_arms(stage, view, now, list);
  });
  draw([&] { draw_springs(stage, view, now, false, list); });
  draw([&] { draw_flats(stage, view, now, gears, Rank::fixed, list); });
  draw([&] { draw_flats(stage, view, now, gears, Rank::free, list); });
  draw([&] { draw_springs(stage, view, now, true, list); });
  draw([&] { draw_rods(stage, view, now, list); });
  draw([&] {
    draw_rounds(stage, view, now, gears, list);
    draw_belts(stage, view, now, Rank::free, true, list);
  });
  draw([&] { draw_gears(stage, view, now, gears, list); });
  draw([&] { draw_racks(stage, view, now, gears, list); });
  draw([&] { draw_flats(stage, view, now, gears, Rank::arm, list); });
  draw([&] { draw_pulleys(stage, view, now, list); });
  draw([&] { draw_pins(stage, view, now, list); });
  draw([&] { draw_contacts(stage, view, now, list); });
  draw([&] { draw_velocities(stage, view, now, list); });
  draw([&] { draw_gone(stage, view, now, list); });
  list.of({});
}

// of each body whether it is the arm of a gear: what carries its wheels, if it is slender enough to lie over
// them
std::vector<char> arms_of(const sim::SceneInfo& cast) {
  std::vector<char> arm(cast.bodies.size(), 0);
  for (const sim::SceneInfo::Joint& joint : cast.joints) {
    if (joint_look(joint.kind).plane != JointMark::teeth || joint.places.size() != 4 || joint.belt) continue;
    for (const auto& [wheel, radius] : {std::pair(0, joint.offset_a), std::pair(2, joint.offset_b)}) {
      const int of = joint.places[std::size_t(wheel)].body, by = joint.places[std::size_t(wheel) + 1].body;
      if (!(radius > 0) || of < 0 || by < 0 || cast.bodies[std::size_t(by)].fixed) continue;
      const sim::SceneInfo::Body& its = cast.bodies[std::size_t(by)];
      const double thick = its.kind == sim::ShapeKind::box       ? its.half.head<2>().minCoeff()
                           : its.kind == sim::ShapeKind::capsule ? its.radius
                                                                 : 1e300;
      if (thick < kSlenderArm * radius) arm[std::size_t(by)] = 1;
    }
  }
  return arm;
}

}  // namespace

std::vector<char> knots(const sim::SceneInfo& cast) {
  std::vector<int> count(cast.bodies.size(), 0);
  for (const sim::SceneInfo::Spring& spring : cast.springs) {
    for (int body : {spring.a, spring.b}) {
      if (body >= 0 && !cast.bodies[body].turns) ++count[body];
    }
  }
  std::vector<char> knot(cast.bodies.size(), 0);
  for (const sim::SceneInfo::Spring& spring : cast.springs) {
    for (auto [body, other] : {std::pair(spring.a, spring.b), std::pair(spring.b, spring.a)}) {
      if (body >= 0 && (count[body] >= 3 || (count[body] == 2 && other >= 0 && count[other] >= 3)))
        knot[body] = 1;
    }
  }
  return knot;
}

double newton(const sim::SceneInfo& cast) {
  // the heaviest, and all of them: a stack's lowest contacts carry much more than its highest
  double heaviest = 0, all = 0;
  for (const sim::SceneInfo::Body& body : cast.bodies) {
    if (body.fixed) continue;
    heaviest = std::max(heaviest, body.mass), all += body.mass;
  }
  const double g = cast.gravity.norm() > 0 ? cast.gravity.norm() : 10;
  const double usual = g * std::sqrt(heaviest * std::max(heaviest, all / 4));
  return usual > 0 ? kForceArrow * cast.scale / usual : 0;
}

Stage::Stage(const sim::SceneInfo& info, const Look& looks_, const Camera& camera_, const Layout& page,
             const Charts& beside)
    : cast(info),
      look(looks_),
      camera(camera_),
      colours(palette(looks_.theme)),
      layout(page),
      charts(beside) {
  arm = arms_of(cast);
  const std::vector<char> net = knots(cast);
  auto knot = [&](int body) { return body >= 0 && net[body]; };

  // springs: coils, or lines where they make a net or are many
  auto in_net = [&](const sim::SceneInfo::Spring& spring) { return knot(spring.a) || knot(spring.b); };
  const auto loose =
      std::count_if(cast.springs.begin(), cast.springs.end(), [&](const auto& s) { return !in_net(s); });
  double mesh = 1e300;  // a net's shortest spring, page units
  std::vector<char> tied(cast.bodies.size(), 0);
  for (const sim::SceneInfo::Spring& spring : cast.springs) {
    const bool line = look.springs == Look::Springs::lines ||
                      (look.springs == Look::Springs::automatic && (loose > kMany || in_net(spring)));
    const double rest = spring.rest_length * layout.scale;
    // a spring without a rest length still needs turns
    Coil form = coil(std::max(rest, 0.12 * cast.scale * layout.scale), layout.weight);
    if (line) form.turns = 0, form.rest = rest;
    coils.push_back(form);
    if (!line) continue;
    if (rest > 0) mesh = std::min(mesh, rest);
    for (int body : {spring.a, spring.b}) {
      if (body >= 0) tied[body] = 1;
    }
  }
  force_scale = look.force_scale > 0 ? look.force_scale : newton(cast);
  for (const sim::SceneInfo::Mouse& mouse : cast.mice) {
    // the hand's rest length is short and its pull long: turns for a pull across a part of the room
    const double rest = std::max(mouse.rest_length, 0.2 * cast.scale) * layout.scale;
    hands.push_back(coil(rest, 0.82 * layout.weight));
    hands.back().line = 0.86 * kSpringLine * layout.weight;
    if (look.springs == Look::Springs::lines) hands.back().turns = 0;
  }

  // bodies: the scene's colour, grey for what is held or knots a net, else the next of the palette
  const auto points = std::count_if(cast.bodies.begin(), cast.bodies.end(), is_point);
  const double dot =
      kDot * layout.weight * std::min(1.0, std::cbrt(60.0 / double(std::max<std::ptrdiff_t>(points, 1))));
  int taken = 0;
  for (int i = 0; i < int(cast.bodies.size()); ++i) {
    const sim::SceneInfo::Body& body = cast.bodies[i];
    const BodyLook own = looks(i);
    if (body.fixed) {
      paints.push_back(fixed_paint(own, look.theme));
    } else {
      const Color color = own.color ? *own.color : knot(i) ? neutral(look.theme) : turn(taken++);
      paints.push_back(paint(own.quiet ? neutral(look.theme) : color, look.theme));
      if (own.quiet) hush(paints.back(), colours);
    }
    dots.push_back(is_point(body) ? std::max(tied[i] ? std::min(dot, 0.2 * mesh) : dot, 1.6 * layout.weight)
                                  : 0);
    switch (body.kind) {
      case sim::ShapeKind::box:
        boxes.push_back(i);
        break;
      case sim::ShapeKind::polygon:
      case sim::ShapeKind::compound:
      case sim::ShapeKind::capsule:
      case sim::ShapeKind::hull:
        polygons.push_back(i);
        break;
      case sim::ShapeKind::point:
      case sim::ShapeKind::ball:
        if (!body.bare) rounds.push_back(i);
        break;
    }
    seams.push_back(seams_of(body));
    if (own.velocity) arrows.push_back(i);
  }
}

// A run in the plane.
struct Illustrator::Plan {
  Stage stage;
  // the last still list, and the view it is of
  mutable std::mutex mutex;
  mutable View seen;
  mutable std::shared_ptr<const List> still;

  View view(const sim::Snapshot& now) const {
    View view = view_at(stage.camera, stage.layout, now.time);
    if (const auto middle = followed(stage.camera, stage.cast, now))
      view.origin = stage.layout.middle - view.scale * Point(middle->x(), -middle->y());
    return view;
  }

  std::shared_ptr<const List> still_of(const View& view) const {
    const std::lock_guard lock(mutex);
    if (!still || seen.origin != view.origin || seen.scale != view.scale) {
      auto list = std::make_shared<List>();
      draw_still(stage, view, *list);
      set_decimal_mark(*list, stage.look.decimal);
      still = std::move(list);
      seen = view;
    }
    return still;
  }
};

Illustrator::Illustrator(const sim::SceneInfo& cast, const Look& look, const Camera& camera,
                         const Extent& extent, double aspect)
    : Illustrator(cast, look, std::vector{camera}, extent, aspect) {}

Illustrator::Illustrator(const sim::SceneInfo& cast, const Look& look, const std::vector<Camera>& cameras,
                         const Extent& extent, double aspect, const Charts& charts)
    : look_(look) {
  if (cast.dimension == 3) {
    space_ = std::make_shared<const SpaceStage>(cast, look, cameras, extent, aspect, charts);
    return;
  }
  const Camera& camera = cameras.at(0);
  const Layout layout = lay_out(cast, look, camera, extent, aspect, charts.right(), charts.below());
  plan_.reset(new Plan{Stage(cast, look, camera, layout, charts), {}, {}, {}});
}

Illustrator::Illustrator(const sim::SceneInfo& cast, const Look& look, const Extent& extent,
                         const Sheet& sheet)
    : look_(look), plan_(new Plan{Stage(cast, look, {}, lay_out(cast, look, extent, sheet)), {}, {}, {}}) {}

const Layout& Illustrator::layout() const { return plan_->stage.layout; }

Rect Illustrator::window() const {
  if (plan_) return plan_->stage.layout.window;
  Rect all = space_->panels.front().window;
  for (const Panel& panel : space_->panels) {
    const Rect& w = panel.window;
    const double right = std::max(all.x + all.width, w.x + w.width),
                 bottom = std::max(all.y + all.height, w.y + w.height);
    all.x = std::min(all.x, w.x), all.y = std::min(all.y, w.y);
    all.width = right - all.x, all.height = bottom - all.y;
  }
  return all;
}

View Illustrator::view(double t) const { return view_at(plan_->stage.camera, plan_->stage.layout, t); }

CameraProjection Illustrator::lens(const sim::Snapshot& now, int panel) const {
  return lens_of(*space_, space_->panels[panel], now);
}

Picture Illustrator::depict(const sim::Snapshot& now,
                            std::span<const std::shared_ptr<const sim::Track>> ways) const {
  return depict(now, ways, {now, now.time, 1});
}

Picture Illustrator::depict(const sim::Snapshot& now, std::span<const std::shared_ptr<const sim::Track>> ways,
                            std::span<const WorldLine> lines, std::span<const SpaceGhost> ghosts) const {
  if (space_) return depict_space(*space_, now, ways, now, lines, ghosts);
  Picture picture = depict(now, ways);
  const View view = plan_->view(now);
  draw_lines(view, lines, false, picture.moving);
  draw_lines(view, lines, true, picture.moving);
  return picture;
}

Picture Illustrator::depict(const sim::Snapshot& now, std::span<const std::shared_ptr<const sim::Track>> ways,
                            const FrameInstant& at) const {
  const sim::Snapshot& frame = at.now;
  const double film = at.film;
  std::vector<WorldLine> lines;
  if (annotations_) lines = annotations_->lines(frame, film);
  if (space_) {
    std::vector<SpaceGhost> earlier;
    if (annotations_)
      for (const auto& [then, ghost] : annotations_->ghosts(frame, film))
        earlier.push_back({then, &ghost->bodies, kGhost});
    Picture picture = depict_space(*space_, now, ways, frame, lines, earlier);
    space_->charts.draw_lines({{&frame, at.fate}}, picture.moving);
    for (int panel = 0; annotations_ && panel < panels(); ++panel) {
      const Projection seen = projection(panel, frame);
      picture.moving.part = panel;
      picture.moving.of({Subject::What::layer, kMarks + 1});
      picture.moving.clip(seen.window());
      annotations_->draw(panel, seen, frame, film, picture.moving);
      picture.moving.unclip();
    }
    draw_names(now, picture.moving);
    picture.moving.part = 0;
    picture.moving.of({Subject::What::page, 2});
    draw_fate({&frame, at.fate}, space_->layout.window, space_->layout.weight, space_->colours,
              picture.moving);
    draw_titles(titles_, space_->layout, space_->layout.aspect, space_->colours, frame.time, film, at.speed,
                picture.moving);
    set_decimal_mark(picture.moving, look_.decimal);
    return picture;
  }
  const Stage& stage = plan_->stage;
  const View view = plan_->view(now);
  Picture picture;
  picture.aspect = stage.layout.aspect;
  picture.ground = stage.colours.ground;
  picture.still = plan_->still_of(view);

  List& list = picture.moving;
  if (stage.layout.clipped) list.clip(view.window);
  draw_trails(stage, view, now, ways, list);
  list.of({Subject::What::layer, kMarks});
  if (annotations_) {
    draw_lines(view, lines, false, list);
    for (const auto& [then, ghost] : annotations_->ghosts(frame, film))
      ghosts(*then, kGhost, list, ghost->bodies, view);
  }
  draw_forms(stage, view, now, list);
  for (std::size_t i = 1; at.over && i < at.over->runs.size(); ++i) {
    const RunsOver::Run& run = at.over->runs[i];
    list.part = int(i);
    run.artist->draw_bodies(view, *run.now, run.ways, list);
  }
  list.part = 0;
  if (annotations_) {
    list.of({Subject::What::layer, kMarks + 1});
    draw_lines(view, lines, true, list);
    annotations_->draw(0, projection(0, frame), frame, film, list);
  }
  draw_names(now, list);
  list.of({Subject::What::layer, kMarks + 2});
  draw_hands(stage, view, now, list);
  list.of({});
  list.unclip();
  std::vector<RunInstant> nows{{&frame, at.fate}};
  if (at.over) {
    nows.clear();
    for (const RunsOver::Run& run : at.over->runs) nows.push_back({run.frame, run.fate});
    draw_run_names(*at.over->names, nows, view.window, stage.layout.weight, stage.colours, list);
  } else {
    draw_fate(nows.front(), view.window, stage.layout.weight, stage.colours, list);
  }
  if (stage.layout.caption && stage.look.clock) {
    Text clock = stage.layout.clock;
    clock.spans[0].text = clock_text(at.over ? at.over->time : frame.time, stage.look.duration);
    list.of({Subject::What::page, 1});
    list.add(clock);
  }
  stage.charts.draw_lines(nows, list);
  list.of({Subject::What::page, 2});
  draw_titles(titles_, stage.layout, stage.layout.aspect, stage.colours, frame.time, film, at.speed, list);
  set_decimal_mark(list, stage.look.decimal);
  return picture;
}

// of a picture of no film: what bodies are called
void Illustrator::draw_names(const sim::Snapshot& now, List& list) const {
  if (annotations_) return;
  Marks marks;
  marks.names = names_of(look_);
  if (marks.names.empty()) return;
  const Lettering lettering = film_lettering(weight(), look_.type_scale);
  list.of({Subject::What::layer, kMarks + 1});
  for (int panel = 0; panel < panels(); ++panel) {
    const Projection seen = projection(panel, now);
    list.part = panel;
    if (space_) list.clip(seen.window());
    draw::annotate(marks, {}, scene_info(), colours(), seen, now, list,
                   {.lettering = lettering, .look = &look_});
    if (space_) list.unclip();
  }
  list.part = 0;
}

void Illustrator::draw_bodies(const View& view, const sim::Snapshot& now,
                              std::span<const std::shared_ptr<const sim::Track>> ways, List& list) const {
  draw_trails(plan_->stage, view, now, ways, list);
  draw_forms(plan_->stage, view, now, list);
}

double Illustrator::travel(const sim::Snapshot& now, double seconds) const {
  const sim::Snapshot then = later(now, seconds);
  if (space_) return draw::travel(*space_, now, then);
  return draw::travel(plan_->stage, plan_->view(now), plan_->view(then), now, then);
}

const sim::SceneInfo& Illustrator::scene_info() const { return space_ ? space_->cast : plan_->stage.cast; }

const Palette& Illustrator::colours() const { return space_ ? space_->colours : plan_->stage.colours; }

Color Illustrator::line_color(int body) const {
  return space_ ? paint(space_->own[std::size_t(body)], look_.theme).outline
                : plan_->stage.paints[std::size_t(body)].outline;
}

std::string Illustrator::called(int body) const {
  const auto i = std::size_t(body);
  const bool labelled = i < look_.bodies.size() && !look_.bodies[i].label.empty();
  return labelled ? as_words(look_.bodies[i].label) : spoken(scene_info().bodies[i].name);
}

double Illustrator::weight() const { return space_ ? space_->layout.weight : plan_->stage.layout.weight; }

int Illustrator::panels() const { return space_ ? int(space_->panels.size()) : 1; }

Projection Illustrator::projection(int panel, const sim::Snapshot& now) const {
  return space_ ? Projection(lens(now, panel), 1, {0, 0}) : Projection(plan_->view(now));
}

double Illustrator::scale(const sim::Snapshot& now) const {
  return space_ ? lens(now).scale : plan_->view(now).scale;
}

void Illustrator::draw_lines(const View& view, std::span<const WorldLine> lines, bool front,
                             List& list) const {
  const Stage& stage = plan_->stage;
  for (const WorldLine& line : lines) {
    if (line.front != front || line.nodes.size() < 2) continue;
    const Color strong = line.color       ? *line.color
                         : line.body >= 0 ? stage.paints[std::size_t(line.body)].outline
                                          : stage.colours.ink;
    std::vector<Node> nodes;
    for (const WorldLine::Node& node : line.nodes)
      nodes.push_back({view.page(node.at), kPathLine * stage.layout.weight * (0.4 + 0.6 * node.strength),
                       mix(stage.colours.room, strong, node.strength)});
    list.add(nodes, Cap::round, stage.look.theme == Theme::paper ? Blend::darken : Blend::lighten);
  }
}

void Illustrator::ghosts(const sim::Snapshot& then, double strength, List& list,
                         const std::vector<int>& only) const {
  ghosts(then, strength, list, only, view_at(plan_->stage.camera, plan_->stage.layout, then.time));
}

void Illustrator::ghosts(const sim::Snapshot& then, double strength, List& list, const std::vector<int>& only,
                         const View& view) const {
  Stage faded = plan_->stage;
  faded.look.axes = false;
  for (Paint& paint : faded.paints) fade(paint, faded.colours.room, 1 - strength);
  // a held body does not move
  const auto still = [&](int body) {
    return faded.cast.bodies[std::size_t(body)].fixed ||
           (!only.empty() && std::find(only.begin(), only.end(), body) == only.end());
  };
  std::erase_if(faded.boxes, still);
  std::erase_if(faded.polygons, still);
  std::erase_if(faded.rounds, still);
  if (faded.layout.clipped) list.clip(view.window);
  Gears gears = gears_of(faded.cast, then);
  std::erase_if(gears.wheels, [&](const auto& each) { return still(each.first); });
  std::erase_if(gears.racks, [&](const auto& each) { return still(each.first); });
  draw_flats(faded, view, then, gears, Rank::free, list);
  draw_rounds(faded, view, then, gears, list);
  draw_gears(faded, view, then, gears, list);
  draw_racks(faded, view, then, gears, list);
  draw_flats(faded, view, then, gears, Rank::arm, list);
  if (faded.layout.clipped) list.unclip();
}

double Illustrator::longest_trail() const {
  double longest = 0;
  for (const BodyLook& body : look_.bodies) longest = std::max(longest, body.trail);
  return longest;
}

std::vector<int> Illustrator::trailed() const {
  std::vector<int> bodies;
  for (std::size_t i = 0; i < look_.bodies.size(); ++i) {
    if (look_.bodies[i].trail > 0) bodies.push_back(int(i));
  }
  return bodies;
}

}  // namespace obscura::draw
