#include "scene/picture.h"

#include <fmt/format.h>

#include <algorithm>

#include "draw/picture/prose.h"
#include "draw/space/camera.h"
#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

constexpr double kLeastSide = 9.0 / 16;  // of the widest: no side of a small scene is less

// a place of the plane at z = 0
template <int D>
sim::Vec3 in_space(const sim::Vec<D>& v) {
  sim::Vec3 place = sim::Vec3::Zero();
  place.head<D>() = v;
  return place;
}

draw::CameraKey::Ease ease(const std::string& word) {
  using enum draw::CameraKey::Ease;
  return word == "linear" ? linear : word == "in" ? in : word == "out" ? out : word == "hold" ? hold : in_out;
}

template <int D>
draw::CameraKey camera_key(const Fields& fields) {
  draw::CameraKey key;
  if (const Node* center = fields.given("center")) key.center = in_space<D>(vector<D>(*center));
  if (const Node* width = fields.given("width")) key.width = width->number();
  if (D == 3 && fields.given("height")) key.height = fields.given("height")->number();
  if (const Node* eye = fields.given("eye")) key.eye = in_space<D>(vector<D>(*eye));
  return key;
}

}  // namespace

const std::string& prose(const Fields& fields, const char* key, Diagnostics& complaints) {
  const std::string& words = fields.text(key);
  if (const auto wrong = draw::prose_mistake(words))
    complaints.add(fields.place(key), fmt::format("'{}', column {}: {}", key, wrong->column, wrong->what));
  return words;
}

void look(const Node& top, const NameTable& roster, draw::Look& look, Diagnostics& complaints) {
  const Fields words = Fields(top, ""), fields = Fields::of(top, "look");
  look.title = prose(words, "title", complaints);
  look.subtitle = prose(words, "subtitle", complaints);
  look.theme = fields.text("theme") == "screen" ? draw::Theme::screen : draw::Theme::paper;
  look.velocity_scale = fields.number("velocity_scale");
  look.velocity_scale_given = fields.given("velocity_scale") != nullptr;
  if (const Node* scale = fields.given("force_scale"))
    look.force_scale = scale->number(), look.force_scale_given = true;
  look.caption = fields.flag("caption");
  look.clock = fields.flag("clock");
  look.duration = sim::value(words.rational("duration"));
  look.badge = Fields::of(top, "film").flag("badge");
  look.hatching = fields.flag("hatching");
  look.axes = fields.flag("axes");
  look.type_scale = fields.number("type_scale");
  look.decimal = fields.text("decimal");
  look.pointer = fields.flag("pointer");
  const std::string& springs = fields.text("springs");
  look.springs = springs == "coils"   ? draw::Look::Springs::coils
                 : springs == "lines" ? draw::Look::Springs::lines
                                      : draw::Look::Springs::automatic;
  look.light = fields.vector<3>("light");
  if (look.light.isZero(0)) {
    complaints.add(fields.place("light"), "'light' is zero: expected a direction such as [-0.6, 1, 0.4]");
    look.light = sim::Vec3(0, 1, 0);
  }
  look.ground = fields.flag("ground");
  look.drop_lines = fields.flag("drop_lines");
  if (const Node* tile = fields.given("tile")) look.tile = tile->number();

  if (const Node* emphasis = fields.given("emphasis")) {
    for (draw::BodyLook& body : look.bodies) body.quiet = true;
    for (const Node& each : emphasis->list())
      for (const int body : roster.bodies(each.text(), each.place, complaints))
        if (std::size_t(body) < look.bodies.size()) look.bodies[std::size_t(body)].quiet = false;
  }

  // trails by name: of a body, or of all its copies
  const Node& trails = fields.node("trails");
  if (!trails.is_table()) return;
  for (const Entry& entry : trails.table()) {
    const auto whole = roster.index.find(entry.key);
    std::vector<int> bodies;
    if (whole != roster.index.end()) {
      const Group& group = roster.groups[std::size_t(whole->second)];
      for (int i = 0; i < group.count; ++i) bodies.push_back(group.first + i);
    } else {
      bodies = roster.bodies(entry.key, entry.place, complaints);
    }
    for (const int body : bodies)
      if (std::size_t(body) < look.bodies.size()) look.bodies[std::size_t(body)].trail = entry.node.number();
  }
}

namespace {

// the position of a camera in space
draw::Camera standing(const Fields& fields) {
  const std::string& view = fields.text("view");
  draw::Camera camera = view == "side" || view == "front" ? draw::side() : draw::slant();
  if (view == "front") camera.elevation = 0;
  // a plan: what is high would be huge beside what is low
  if (view == "top")
    camera.azimuth = 0, camera.elevation = radians(90),
    camera.projection = draw::Camera::Projection::orthographic;
  camera.name = fields.given("name") ? fields.text("name") : view;
  if (fields.given("projection"))
    camera.projection = fields.text("projection") == "orthographic" ? draw::Camera::Projection::orthographic
                                                                    : draw::Camera::Projection::perspective;
  if (const Node* field = fields.given("field")) camera.field = radians(field->number());
  if (const Node* azimuth = fields.given("azimuth")) camera.azimuth = radians(azimuth->number());
  if (const Node* elevation = fields.given("elevation")) camera.elevation = radians(elevation->number());
  camera.orbit = radians(fields.number("orbit"));
  camera.fits_run = fields.text("fit") == "run";
  return camera;
}

template <int D>
draw::Camera camera(const Fields& fields, const NameTable& roster, Diagnostics& complaints) {
  draw::Camera camera = D == 3 ? standing(fields) : draw::Camera{};
  const Node* keys = fields.given("keys");
  const bool high = D == 3 && fields.given("height");
  const bool stands = fields.given("center") || fields.given("width") || fields.given("eye") || high;
  if (high && fields.given("width"))
    complaints.add(fields.place("height"), "'width' and 'height' both say how much it shows; leave one out");
  if (fields.given("eye"))
    for (const char* key : {"azimuth", "elevation", "orbit"})
      if (const Node* both = fields.given(key))
        complaints.add(both->place,
                       fmt::format("'eye' and '{}' both say from where it looks; leave one out", key));
  if (keys && stands) {
    complaints.add(fields.place(fields.given("center")  ? "center"
                                : fields.given("width") ? "width"
                                : high                  ? "height"
                                                        : "eye"),
                   "the camera stands, or moves by 'keys'; leave one out");
    return camera;
  }
  if (const Node* follow = fields.given("follow")) {
    if (const Node* center = fields.given("center"))
      complaints.add(center->place, "the camera follows a body, or looks at 'center'; leave one out");
    const auto add = [&](const Node& one) {
      const std::vector<int> some = roster.bodies(one.text(), one.place, complaints);
      camera.follow.insert(camera.follow.end(), some.begin(), some.end());
    };
    if (follow->is_text())
      add(*follow);
    else
      for (const Node& one : follow->list()) add(one);
  }
  if (stands) camera.keys.push_back(camera_key<D>(fields));
  for (std::size_t i = 0; keys && i < keys->list().size(); ++i) {
    const Fields its(keys->list()[i], "camera.keys");
    if (!its.given("time")) continue;
    draw::CameraKey key = camera_key<D>(its);
    if (key.width && key.height)
      complaints.add(its.place("height"), "'width' and 'height' both say how much it shows; leave one out");
    if (const Node* azimuth = its.given("azimuth")) key.azimuth = radians(azimuth->number());
    if (const Node* elevation = its.given("elevation")) key.elevation = radians(elevation->number());
    key.time = its.number("time");
    key.ease = ease(its.text("ease"));
    if (!camera.keys.empty() && key.time <= camera.keys.back().time)
      complaints.add(its.place("time"), fmt::format("times must increase from key to key, got {} after {}",
                                                    key.time, camera.keys.back().time));
    camera.keys.push_back(key);
  }
  return camera;
}

}  // namespace

template <int D>
std::vector<draw::Camera> cameras(const Node& top, const NameTable& roster, Diagnostics& complaints) {
  const Node* all = top.find("camera");
  if (!all || all->is_table()) return {camera<D>(Fields::of(top, "camera"), roster, complaints)};
  std::vector<draw::Camera> several;
  for (const Node& each : all->list())
    several.push_back(camera<D>(Fields(each, "camera"), roster, complaints));
  for (std::size_t i = 0; i < several.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (several[i].name == several[k].name)
        complaints.add(all->list()[i].place, fmt::format("two cameras are called {}: give one another 'name'",
                                                         in_quotes(several[i].name)));
  if (several.empty())
    several.push_back(camera<D>(Fields(Node{{}, Node::Table{}}, "camera"), roster, complaints));
  return several;
}

namespace {

// How fast the run goes by, where it stands still, and the cards that are shown meanwhile.
draw::Pace speed(const Node& node, const Fields& film, sim::Rational duration, std::vector<draw::Card>& cards,
                 Diagnostics& complaints) {
  std::vector<draw::PaceKey> keys;
  struct Stop {
    draw::Freeze freeze;
    std::optional<draw::Card> card;
  };
  std::vector<Stop> stops;
  std::optional<sim::Rational> before;
  for (const Node& each : node.is_list() ? node.list() : Node::List{}) {
    const Fields its(each, "film.speed");
    if (!its.given("time")) continue;
    const sim::Rational time = its.rational("time");
    if (before && time <= *before)
      complaints.add(its.place("time"),
                     fmt::format("times must increase from key to key, got {:g} after {:g}", sim::value(time),
                                 sim::value(*before)));
    before = time;
    if (its.given("freeze")) {
      stops.push_back({{time, its.rational("freeze")}, {}});
      if (duration < time)
        complaints.add(its.place("time"),
                       fmt::format("the film cannot stand still at {:g} s: it ends at {:g} s",
                                   sim::value(time), sim::value(duration)));
    }
    // what stands still goes on as fast as before, unless it says otherwise
    if (!its.given("freeze") || its.given("speed"))
      keys.push_back({time, its.rational("speed"), ease(its.text("ease"))});
  }
  const Node* all = film.given("card");
  for (const Node& each : all ? all->list() : Node::List{}) {
    const Fields its(each, "film.card");
    const sim::Rational time = its.rational("time"), lasting = its.rational("lasting");
    draw::Card card{prose(its, "title", complaints), prose(its, "text", complaints)};
    card.fade = std::min(its.number("fade"), sim::value(lasting) / 2);
    card.first = time.num == 0, card.last = time == duration;
    if (card.title.empty() && card.text.empty())
      complaints.add(each.place, "a card needs 'title' or 'text': words to show");
    if (duration < time)
      complaints.add(its.place("time"),
                     fmt::format("a card at {:g} s is never shown: the scene ends at {:g} s",
                                 sim::value(time), sim::value(duration)));
    stops.push_back({{time, lasting}, card});
  }
  if (!complaints.none()) return {};
  draw::Pace pace = node.is_list() ? draw::Pace(keys) : draw::Pace(exact(node));
  // cards of the start come before what stands still there, others after it
  std::stable_sort(stops.begin(), stops.end(), [](const Stop& a, const Stop& b) {
    if (!(a.freeze.time == b.freeze.time)) return a.freeze.time < b.freeze.time;
    const bool first = a.freeze.time.num == 0;
    return first ? a.card.has_value() && !b.card.has_value() : !a.card.has_value() && b.card.has_value();
  });
  for (Stop& stop : stops) {
    const sim::Rational begin = pace.film(stop.freeze.time) + pace.frozen_at(stop.freeze.time);
    pace.freeze({stop.freeze.time, stop.freeze.seconds});
    if (!stop.card) continue;
    stop.card->begin = sim::value(begin), stop.card->end = sim::value(begin + stop.freeze.seconds);
    cards.push_back(*stop.card);
  }
  return pace;
}

// the words between semicolons
std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> all;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find(';', from), text.size());
    const std::size_t first = text.find_first_not_of(' ', from), last = text.find_last_not_of(' ', end - 1);
    all.push_back(first < end ? text.substr(first, last + 1 - first) : "");
    from = end + 1;
  }
  return all;
}

// film.vary: the runs that are filmed together
void vary(const Fields& fields, Film& film, Diagnostics& complaints) {
  film.vary = parts(fields.text("vary")), film.vary_names = parts(fields.text("vary_names"));
  film.over = fields.text("vary_place") == "over";
  film.vary_at = complaints.complaint(fields.place("vary"), "");
  for (const std::string& each : film.vary)
    if (const auto equals = each.find('='); equals == 0 || equals == each.npos || equals + 1 == each.size())
      return complaints.add(fields.place("vary"),
                            "'vary': expected a path and its values, as in \"crate.elasticity=0,0.5,1\"");
}

}  // namespace

Film film(const Node& top, Diagnostics& complaints) {
  const Fields fields = Fields::of(top, "film");
  Film film;
  const sim::Vec<2> size = fields.vector<2>("size");
  film.width = int(size.x()), film.height = int(size.y());
  film.fps = fields.rational("fps");
  film.shutter = fields.number("shutter");
  film.speed = speed(fields.node("speed"), fields, Fields(top, "").rational("duration"), film.titles.cards,
                     complaints);
  vary(fields, film, complaints);
  prose(fields, "vary_names", complaints);
  film.titles.badge = fields.flag("badge");
  const sim::Rational duration = Fields(top, "").rational("duration");
  film.titles.fade = fields.number("fade");
  film.titles.length = sim::value(film.speed.film(duration) + film.speed.frozen_at(duration));
  if (const Node* crf = fields.given("crf")) film.crf = crf->number();
  film.preset = fields.text("preset");
  film.codec = fields.text("codec");
  return film;
}

Golden golden(const Node& top, sim::Rational duration, Diagnostics& complaints) {
  const Fields fields = Fields::of(top, "golden");
  const auto whole = [&](const char* key) {
    return int(std::min<std::int64_t>(std::get<std::int64_t>(fields.node(key).value), 1 << 30));
  };
  Golden golden;
  golden.given = top.find("golden") != nullptr;
  if (golden.given && fields.place().set == 0) golden.line = fields.place().line;
  if (const Node* at = fields.given("at")) {
    const Node::List one{*at};
    for (const Node& each : at->is_list() ? at->list() : one) {
      const sim::Rational time = exact(each);
      if (!golden.at.empty() && time <= golden.at.back())
        complaints.add(each.place, fmt::format("times must increase in 'at', got {} after {}",
                                               sim::value(time), sim::value(golden.at.back())));
      golden.at.push_back(time);
    }
  } else {
    golden.at = {sim::rational(0), duration / sim::rational(2)};
  }
  const sim::Vec<2> size = fields.vector<2>("size");
  golden.width = int(size.x()), golden.height = int(size.y());
  golden.level = whole("level"), golden.pixels = whole("pixels");
  const Node& states = fields.node("states");
  if (states.is_text() && states.text().empty())
    complaints.add(states.place, "'states': expected the file of a run (CSV), got an empty name");
  if (states.is_text())
    golden.run = states.text();
  else
    golden.states = fields.flag("states");
  golden.hashes = fields.text("keep") == "hash";
  golden.reason = fields.text("reason");
  const bool lenient = golden.level > 0 || golden.pixels > 0 || !golden.states;
  if (lenient && golden.reason.empty())
    complaints.add(fields.place(), "[golden] tolerates differences without saying why: give it a 'reason'");
  return golden;
}

template <int D>
draw::Extent extent(const Room<D>& room, const sim::World<D>& world) {
  using Vec = sim::Vec<D>;
  if (room.bounds) return {in_space<D>(room.bounds->low), in_space<D>(room.bounds->high)};
  std::vector<Vec> points;
  for (std::size_t i = 0; i < world.state.x.size(); ++i) {
    const double reach = sim::bounding_radius(world.model.bodies[i].shape);
    points.push_back(world.state.x[i] - Vec::Constant(reach));
    points.push_back(world.state.x[i] + Vec::Constant(reach));
  }
  for (const sim::Wall<D>& wall : room.walls) points.push_back(wall.point);
  const auto add_curve = [&](int body, const sim::Curve<D>& curve) {
    const sim::BodyMotion<D> at = body < 0 ? sim::BodyMotion<D>{} : sim::body_motion(world.state, body);
    for (const Vec& x : curve.places(0.001 * curve.length())) points.push_back(at.x + at.arm(x));
  };
  for (const sim::Rail<D>& rail : world.model.rails) add_curve(rail.body, *rail.curve);
  for (const sim::Joint<D>& joint : world.model.joints)
    if (joint.curve) add_curve(joint.b.body, *joint.curve);
  for (const sim::Spring<D>& spring : world.model.springs)
    for (const sim::End<D>& end : {spring.a, spring.b})
      if (end.body < 0) points.push_back(end.local);
  for (const sim::Mouse<D>& mouse : world.model.mice)
    for (const sim::Knot<D>& knot : mouse.path) points.push_back(knot.place);
  if (points.empty()) points = {Vec(Vec::Zero())};
  Vec low = points.front(), high = points.front();
  for (const Vec& point : points) low = low.cwiseMin(point), high = high.cwiseMax(point);
  // a tenth around, and a metre at least; of what is smaller, as high as a film that is so wide
  const Vec around = (high - low) * 1.2, middle = (low + high) / 2;
  const double widest = around.maxCoeff();
  const Vec size = around.cwiseMax(widest > 0 ? std::min(1.0, kLeastSide * widest) : 1.0);
  return {in_space<D>(middle - size / 2), in_space<D>(middle + size / 2)};
}

template std::vector<draw::Camera> cameras<2>(const Node&, const NameTable&, Diagnostics&);
template std::vector<draw::Camera> cameras<3>(const Node&, const NameTable&, Diagnostics&);
template draw::Extent extent<2>(const Room<2>&, const sim::World<2>&);
template draw::Extent extent<3>(const Room<3>&, const sim::World<3>&);

}  // namespace obscura::scene
