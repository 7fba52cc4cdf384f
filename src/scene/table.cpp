#include "scene/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace obscura::scene {

namespace {

const Range kAny{};
const Range kPositive{0, std::numeric_limits<double>::infinity(), true};
const Range kNotNegative{0};
const Range kUnit{0, 1};

// rows of body.* stand for particle.* and box.*
std::vector<Key> written() {
  using enum Form;
  return {
      {.path = "version",
       .form = integer,
       .fallback = "1",
       .range = {1, 1},
       .doc = "Of the language. Left out: the newest.",
       .example = "1"},
      {.path = "title",
       .form = text,
       .fallback = "\"\"",
       .doc = "In bold above the room.",
       .example = "\"A bouncing box\""},
      {.path = "subtitle",
       .form = text,
       .fallback = "\"\"",
       .doc = "In grey beside the title.",
       .example = "\"e = 0.8\""},
      {.path = "duration",
       .form = rational,
       .unit = "s",
       .fallback = "10",
       .range = {0, 1e6, true},
       .doc = "How long the scene lasts.",
       .example = "12.5"},
      {.path = "seed",
       .form = integer,
       .fallback = "0",
       .range = kNotNegative,
       .doc = "Of everything random. The same seed gives the same scene everywhere.",
       .example = "4"},

      {.path = "room",
       .form = table,
       .doc = "The room: its walls and what acts everywhere in it. Left out: 8 m by 4.5 m, four walls."},
      {.path = "room.size",
       .form = vector,
       .unit = "m",
       .fallback = "[8, 4.5]",
       .range = {0, 1e6, true},
       .doc = "Width and height. Gives four walls, in this order: floor, left, right, ceiling. Left out "
              "beside `walls`: no walls but those.",
       .example = "[4, 3]"},
      {.path = "room.corner",
       .form = vector,
       .unit = "m",
       .fallback = "[0, 0]",
       .doc = "Where the left end of the floor is.",
       .example = "[-4, 0]"},
      {.path = "room.gravity",
       .form = vector,
       .unit = "m/s^2",
       .fallback = "[0, -9.81]",
       .doc = "Acceleration of what falls.",
       .example = "[0, -1.62]"},
      {.path = "room.drag",
       .form = number,
       .unit = "N s/m",
       .fallback = "0",
       .range = kNotNegative,
       .doc = "Linear drag c of every body that has none of its own: f = -c v.",
       .example = "0.1"},
      {.path = "room.elasticity",
       .form = number,
       .absent = "each body's own holds",
       .range = kUnit,
       .doc = "Of the walls. Given, a wall and a body bounce with the root of the product of theirs.",
       .example = "0.5"},
      {.path = "room.walls",
       .form = tables,
       .doc = "Walls at any angle, beside the four of `size` or instead of them."},
      {.path = "room.walls.point",
       .form = vector,
       .unit = "m",
       .required = true,
       .doc = "Any point on the wall.",
       .example = "[6, 0]"},
      {.path = "room.walls.normal",
       .form = vector,
       .required = true,
       .doc = "Into the room, of any length but zero.",
       .example = "[-1, 1]"},
      {.path = "room.walls.elasticity",
       .form = number,
       .absent = "`room.elasticity`",
       .range = kUnit,
       .doc = "Of this wall.",
       .example = "0.9"},

      {.path = "physics", .form = table, .doc = "How time passes. The defaults are right for most scenes."},
      {.path = "physics.rate",
       .form = rational,
       .unit = "1/s",
       .fallback = "600",
       .range = {0, 1e6, true},
       .doc = "Steps per second.",
       .example = "1000"},
      {.path = "physics.integrator",
       .form = choice,
       .fallback = "\"rk4\"",
       .choices = {"rk4", "midpoint", "euler", "semi-implicit"},
       .doc = "The scheme of a step; of fourth, second, first and first order.",
       .example = "\"midpoint\""},
      {.path = "physics.collision",
       .form = choice,
       .fallback = "\"handout\"",
       .choices = {"handout"},
       .later = {"contact", "event"},
       .doc = "What happens at a wall. `handout`: put back onto the wall, then an impulse; what rests there "
              "jitters.",
       .example = "\"handout\""},

      {.path = "particle",
       .form = tables,
       .doc = "A point mass, or with a `radius` a ball. It does not turn."},
      {.path = "box", .form = tables, .doc = "A rectangular rigid body."},
      {.path = "body.name",
       .form = name,
       .absent = "`KIND[0]`, `KIND[1]`, ... in the order of the file",
       .doc = "What springs, trails and `--set` call it.",
       .example = "\"ball\""},
      {.path = "body.position",
       .form = vector,
       .unit = "m",
       .absent = "the middle of the room",
       .varies = true,
       .doc = "Of its centre of mass, at the start.",
       .example = "[1, 3]"},
      {.path = "body.velocity",
       .form = vector,
       .unit = "m/s",
       .fallback = "[0, 0]",
       .varies = true,
       .doc = "At the start.",
       .example = "[1.2, 0]"},
      {.path = "particle.mass",
       .form = number,
       .unit = "kg",
       .fallback = "1",
       .range = kPositive,
       .varies = true,
       .doc = "How heavy it is.",
       .example = "0.5"},
      {.path = "particle.radius",
       .form = number,
       .unit = "m",
       .absent = "a point, drawn as a dot",
       .range = kPositive,
       .varies = true,
       .doc = "Walls stop it at its rim.",
       .example = "0.06"},
      {.path = "box.size",
       .form = vector,
       .unit = "m",
       .fallback = "[0.8, 0.5]",
       .range = {0, 1e6, true},
       .doc = "Width and height, in its own frame.",
       .example = "[1.0, 0.5]"},
      {.path = "box.angle",
       .form = number,
       .unit = "deg",
       .fallback = "0",
       .varies = true,
       .doc = "At the start, counter-clockwise.",
       .example = "30"},
      {.path = "box.spin",
       .form = number,
       .unit = "deg/s",
       .fallback = "0",
       .varies = true,
       .doc = "At the start, counter-clockwise.",
       .example = "90"},
      {.path = "box.density",
       .form = number,
       .unit = "kg/m^2",
       .fallback = "1",
       .range = kPositive,
       .varies = true,
       .doc = "Mass for its area.",
       .example = "2"},
      {.path = "box.mass",
       .form = number,
       .unit = "kg",
       .absent = "`density` times its area",
       .range = kPositive,
       .varies = true,
       .doc = "How heavy it is: instead of `density`.",
       .example = "0.5"},
      {.path = "body.elasticity",
       .form = number,
       .fallback = "0.8",
       .range = kUnit,
       .varies = true,
       .doc = "The handout's e: 0 stays where it lands, 1 comes back as fast as it came.",
       .example = "0.9"},
      {.path = "body.drag",
       .form = number,
       .unit = "N s/m",
       .absent = "`room.drag`",
       .range = kNotNegative,
       .varies = true,
       .doc = "Linear drag c: f = -c v.",
       .example = "0.2"},
      {.path = "body.fixed",
       .form = which,
       .fallback = "false",
       .doc = "Held where it starts; of copies, all, or those of a list.",
       .example = "\"0..4\""},
      {.path = "body.color",
       .form = color,
       .absent = "the palette's next",
       .varies = true,
       .doc = "A name (orange sky green blue vermilion purple yellow grey black white) or #rrggbb. A list is "
              "gone through again and again.",
       .example = "\"blue\""},
      {.path = "body.trail",
       .form = number,
       .unit = "s",
       .absent = "`look.trails`",
       .range = {0, 1e6},
       .doc = "How long its trail lasts.",
       .example = "1.5"},
      {.path = "body.arrows",
       .form = choices,
       .absent = "`look.arrows`",
       .choices = {"velocity"},
       .later = {"contact", "force"},
       .doc = "What is drawn on it as arrows.",
       .example = "[\"velocity\"]"},
      {.path = "body.copies",
       .form = table,
       .doc = "More of the same: a row, a grid, a ring. They are called `ball[0]`, `ball[1]`, ..."},
      {.path = "body.copies.count",
       .form = count,
       .range = {1, 1e6},
       .required = true,
       .doc = "How many, or how many in each direction of a grid; the first direction counts fastest.",
       .example = "[6, 2]"},
      {.path = "body.copies.offset",
       .form = offset,
       .unit = "m",
       .absent = "none",
       .doc = "From one to the next; in a grid, one for each direction.",
       .example = "[[0.3, 0], [0, 0.3]]"},
      {.path = "body.copies.jitter",
       .form = number,
       .unit = "m",
       .fallback = "0",
       .range = kNotNegative,
       .doc = "Each is put aside by up to this in x and in y, as `seed` says.",
       .example = "0.02"},
      {.path = "body.copies.turn",
       .form = number,
       .unit = "deg",
       .fallback = "0",
       .doc = "Each is turned by this from the one before, velocity and all, about `around`.",
       .example = "30"},
      {.path = "body.copies.around",
       .form = vector,
       .unit = "m",
       .absent = "its own centre",
       .doc = "The place that `turn` turns about.",
       .example = "[4, 2]"},

      {.path = "spring",
       .form = tables,
       .doc = "A spring between two points: f = -(k (l - l_rest) + c dl/dt) d."},
      {.path = "spring.name",
       .form = name,
       .absent = "`spring[0]`, ...",
       .doc = "What `--set` calls it.",
       .example = "\"left\""},
      {.path = "spring.between",
       .form = ends,
       .required = true,
       .doc = "Its ends, each a body (its centre), a point of one, or a place. With `ball[*]` or "
              "`ball[0..4]` it is many springs.",
       .example = "[\"ball\", { body = \"crate\", at = \"top\" }]"},
      {.path = "spring.stiffness",
       .form = number,
       .unit = "N/m",
       .fallback = "40",
       .range = kNotNegative,
       .varies = true,
       .doc = "k.",
       .example = "60"},
      {.path = "spring.damping",
       .form = number,
       .unit = "N s/m",
       .fallback = "0",
       .range = kNotNegative,
       .varies = true,
       .doc = "c, along the spring.",
       .example = "0.2"},
      {.path = "spring.rest_length",
       .form = number,
       .unit = "m",
       .absent = "as long as it is at the start",
       .range = kNotNegative,
       .varies = true,
       .doc = "l_rest: shorter, it pushes; longer, it pulls.",
       .example = "0.5"},

      {.path = "net",
       .form = tables,
       .doc = "Springs between neighbours: of a row of copies a chain, of a grid a net."},
      {.path = "net.name",
       .form = name,
       .absent = "`net[0]`, ...",
       .doc = "What `--set` calls it.",
       .example = "\"cloth\""},
      {.path = "net.of",
       .form = thing,
       .required = true,
       .doc = "The body whose copies it joins.",
       .example = "\"knot\""},
      {.path = "net.diagonals",
       .form = boolean,
       .fallback = "false",
       .doc = "Springs across the meshes of a grid as well, against shear.",
       .example = "true"},
      {.path = "net.stiffness",
       .form = number,
       .unit = "N/m",
       .fallback = "40",
       .range = kNotNegative,
       .doc = "k of each spring.",
       .example = "200"},
      {.path = "net.damping",
       .form = number,
       .unit = "N s/m",
       .fallback = "0",
       .range = kNotNegative,
       .doc = "c of each spring.",
       .example = "0.1"},
      {.path = "net.rest_length",
       .form = number,
       .unit = "m",
       .absent = "as long as each is at the start",
       .range = kNotNegative,
       .doc = "l_rest of each spring; across a mesh it is given by the sides.",
       .example = "0.3"},

      {.path = "mouse",
       .form = tables,
       .doc = "A scripted click and drag: a spring from a moving pointer to the closest particle or vertex, "
              "taken once, when pressed."},
      {.path = "mouse.name",
       .form = name,
       .absent = "`mouse[0]`, ...",
       .doc = "What `--set` calls it.",
       .example = "\"hand\""},
      {.path = "mouse.path",
       .form = path,
       .unit = "m",
       .required = true,
       .doc = "Time (s), x, y: pressed at the first time, released at the last, smooth through the points.",
       .example = "[[1, 4, 3], [1.6, 5.5, 3.8], [3, 7, 3.5]]"},
      {.path = "mouse.stiffness",
       .form = number,
       .unit = "N/m",
       .fallback = "60",
       .range = kNotNegative,
       .doc = "k of its spring.",
       .example = "30"},
      {.path = "mouse.damping",
       .form = number,
       .unit = "N s/m",
       .fallback = "0",
       .range = kNotNegative,
       .doc = "c of its spring.",
       .example = "0.5"},
      {.path = "mouse.rest_length",
       .form = number,
       .unit = "m",
       .absent = "twenty reference pixels: 20/480 of the room's height",
       .range = kNotNegative,
       .doc = "l_rest of its spring.",
       .example = "0.2"},

      {.path = "camera",
       .form = table,
       .doc = "What the picture shows. Left out: the room, as large as it fits."},
      {.path = "camera.center",
       .form = vector,
       .unit = "m",
       .absent = "the room's",
       .doc = "What it looks at.",
       .example = "[4, 2]"},
      {.path = "camera.width",
       .form = number,
       .unit = "m",
       .absent = "as much as fits the room",
       .range = {0, 1e7, true},
       .doc = "How much it shows across.",
       .example = "6"},
      {.path = "camera.keys",
       .form = tables,
       .doc = "Where it is at given times, instead of `center` and `width`."},
      {.path = "camera.keys.time",
       .form = number,
       .unit = "s",
       .range = {0, 1e6},
       .required = true,
       .doc = "When.",
       .example = "2"},
      {.path = "camera.keys.center",
       .form = vector,
       .unit = "m",
       .absent = "the room's",
       .doc = "What it looks at then.",
       .example = "[6, 1]"},
      {.path = "camera.keys.width",
       .form = number,
       .unit = "m",
       .absent = "as much as fits the room",
       .range = {0, 1e7, true},
       .doc = "How much it shows across then.",
       .example = "3"},
      {.path = "camera.keys.ease",
       .form = choice,
       .fallback = "\"in-out\"",
       .choices = {"linear", "in", "out", "in-out", "hold"},
       .doc = "How it comes here from the key before.",
       .example = "\"linear\""},

      {.path = "look", .form = table, .doc = "How it is drawn."},
      {.path = "look.theme",
       .form = choice,
       .fallback = "\"paper\"",
       .choices = {"paper", "screen"},
       .doc = "White for print and handouts, dark for projectors.",
       .example = "\"screen\""},
      {.path = "look.trails",
       .form = trails,
       .unit = "s",
       .fallback = "0",
       .doc = "How long trails last, of every body that moves, or by name.",
       .example = "{ ball = 1.5 }"},
      {.path = "look.arrows",
       .form = choices,
       .fallback = "[]",
       .choices = {"velocity"},
       .later = {"contact", "force"},
       .doc = "What is drawn as arrows on every body that moves.",
       .example = "[\"velocity\"]"},
      {.path = "look.velocity_scale",
       .form = number,
       .unit = "s",
       .fallback = "0.1",
       .range = kPositive,
       .doc = "Metres of arrow for a metre per second.",
       .example = "0.25"},
      {.path = "look.springs",
       .form = choice,
       .fallback = "\"auto\"",
       .choices = {"auto", "coils", "lines"},
       .doc = "Coils, or plain lines; `auto` draws a net of many springs as lines.",
       .example = "\"coils\""},
      {.path = "look.caption",
       .form = boolean,
       .fallback = "true",
       .doc = "Title, subtitle and time above the room.",
       .example = "false"},
      {.path = "look.clock",
       .form = boolean,
       .fallback = "true",
       .doc = "The time, at the right of the caption.",
       .example = "false"},
      {.path = "look.hatching",
       .form = boolean,
       .fallback = "true",
       .doc = "Strokes on the outside of the walls.",
       .example = "false"},
      {.path = "look.axes",
       .form = boolean,
       .fallback = "true",
       .doc = "The two axes of each box's own frame.",
       .example = "false"},
      {.path = "look.pointer",
       .form = boolean,
       .fallback = "true",
       .doc = "The mouse: its pointer, its spring and its path.",
       .example = "false"},

      {.path = "film", .form = table, .doc = "How it is filmed. Flags of the command line go first."},
      {.path = "film.size",
       .form = pixels,
       .unit = "pixels",
       .fallback = "[1920, 1080]",
       .range = {16, 16384},
       .doc = "Width and height of the picture; even for movies.",
       .example = "[1280, 720]"},
      {.path = "film.fps",
       .form = rational,
       .unit = "1/s",
       .fallback = "60",
       .range = {0, 1000, true},
       .doc = "Frames per second.",
       .example = "\"30000/1001\""},
      {.path = "film.crf",
       .form = number,
       .absent = "18 for H.264, its like for others",
       .range = {0, 63},
       .doc = "Quality of a movie; less is better and larger.",
       .example = "23"},
      {.path = "film.preset",
       .form = text,
       .fallback = "\"\"",
       .absent = "quick to encode",
       .doc = "The encoder's preset.",
       .example = "\"medium\""},
      {.path = "film.codec",
       .form = text,
       .fallback = "\"\"",
       .absent = "H.264 where the container takes it",
       .doc = "The encoder, as libavcodec names it.",
       .example = "\"libvpx-vp9\""},
  };
}

std::vector<Key> built() {
  std::vector<Key> all;
  const std::vector<Key> rows = written();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool of_bodies = rows[i].path.starts_with("body.") || rows[i].path.starts_with("particle") ||
                           rows[i].path.starts_with("box");
    if (!of_bodies) {
      all.push_back(rows[i]);
      continue;
    }
    // the run of rows about bodies, once for each kind
    std::size_t end = i;
    while (end < rows.size() && (rows[end].path.starts_with("body.") ||
                                 rows[end].path.starts_with("particle") || rows[end].path.starts_with("box")))
      ++end;
    for (const std::string kind : {"particle", "box"}) {
      for (std::size_t k = i; k < end; ++k) {
        Key key = rows[k];
        if (key.path.starts_with("body.")) key.path = kind + key.path.substr(4);
        for (std::size_t at; (at = key.absent.find("KIND")) != std::string::npos;)
          key.absent.replace(at, 4, kind);
        if (key.path == kind || key.path.starts_with(kind + ".")) all.push_back(key);
      }
    }
    i = end - 1;
  }
  return all;
}

struct Language {
  std::vector<Key> all = built();
  std::map<std::string, std::size_t, std::less<>> index;
  std::map<std::string, Node, std::less<>> fallbacks;

  Language() {
    for (std::size_t i = 0; i < all.size(); ++i) {
      index.emplace(all[i].path, i);
      if (!all[i].fallback.empty())
        fallbacks.emplace(all[i].path, document("x = " + all[i].fallback, all[i].path).table().front().node);
    }
  }
};

const Language& language() {
  static const Language it;
  return it;
}

constexpr std::string_view kLater[] = {"joint",
                                       "polygon",
                                       "chain",
                                       "bond",
                                       "explosion",
                                       "body",
                                       "contact",
                                       "golden",
                                       "room.friction",
                                       "room.walls.friction",
                                       "particle.friction",
                                       "particle.group",
                                       "box.friction",
                                       "box.group",
                                       "spring.breaks"};

}  // namespace

std::span<const Key> keys() { return language().all; }

const Key* key(std::string_view path) {
  const auto found = language().index.find(path);
  return found == language().index.end() ? nullptr : &language().all[found->second];
}

std::vector<const Key*> keys_of(std::string_view owner) {
  std::vector<const Key*> own;
  for (const Key& each : keys())
    if (each.owner() == owner) own.push_back(&each);
  return own;
}

const Node& fallback(std::string_view path) { return language().fallbacks.find(path)->second; }

std::span<const std::string_view> later_keys() { return kLater; }

std::string unit_words(std::string_view unit) {
  static const std::map<std::string_view, std::string_view> words = {{"m", "metres"},
                                                                     {"kg", "kilograms"},
                                                                     {"s", "seconds"},
                                                                     {"deg", "degrees"},
                                                                     {"m/s", "metres per second"},
                                                                     {"m/s^2", "metres per second squared"},
                                                                     {"deg/s", "degrees per second"},
                                                                     {"N/m", "newtons per metre"},
                                                                     {"N s/m", "newton seconds per metre"},
                                                                     {"kg/m^2", "kilograms per square metre"},
                                                                     {"1/s", "per second"}};
  const auto found = words.find(unit);
  return std::string(found == words.end() ? unit : found->second);
}

std::string expected(const Key& key) {
  const std::string of = key.unit.empty() ? "" : (key.unit == "1/s" ? " " : " of ") + unit_words(key.unit);
  const std::string in = key.unit.empty() ? "" : " in " + unit_words(key.unit);
  switch (key.form) {
    case Form::table:
      return "a table";
    case Form::tables:
      return "a list of tables";
    case Form::number:
      return "a number" + of;
    case Form::integer:
      return "a whole number" + of;
    case Form::boolean:
      return "true or false";
    case Form::text:
      return "a string";
    case Form::name:
      return "a name: a string of letters, digits, _ and -";
    case Form::rational:
      return "a number" + of + ", or a fraction such as \"30000/1001\"";
    case Form::choice:
      return fmt::format("one of \"{}\"", fmt::join(key.choices, "\", \""));
    case Form::choices:
      return fmt::format("a list of \"{}\"", fmt::join(key.choices, "\", \""));
    case Form::color:
      return "a colour: a name or \"#rrggbb\"";
    case Form::vector:
      return "two numbers [x, y]" + in;
    case Form::pixels:
      return "two whole numbers [width, height]";
    case Form::count:
      return "a whole number, or two [columns, rows]";
    case Form::offset:
      return "two numbers [x, y]" + in + ", or a list of such";
    case Form::which:
      return "true, false, or which copies: \"0..4\", \"0,5\"";
    case Form::ends:
      return "two ends, each a body's name, { body = \"name\", local = [x, y] } or a place [x, y]";
    case Form::thing:
      return "the name of a body with copies";
    case Form::path:
      return "points in time [[t, x, y], ...], two at least";
    case Form::trails:
      return "a number of seconds, or a table of them by body";
  }
  return "";
}

std::string bounds(const Range& range, const std::string& unit, double x) {
  const std::string of = unit.empty() ? "" : " " + (unit == "1/s" ? unit_words(unit) : unit);
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  if (low && high && range.high <= 100 && !range.above)
    return fmt::format("must be between {} and {}{}", range.low, range.high, of);
  if (high && x > range.high) return fmt::format("must be at most {}{}", std::int64_t(range.high), of);
  if (range.low == 0) return range.above ? "must be positive" : "must not be negative";
  return fmt::format("must be at least {}{}", range.low, of);
}

}  // namespace obscura::scene
