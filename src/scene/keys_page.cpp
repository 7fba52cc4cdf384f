// The page that documents the language: keys_page.md says a few words on each part; under them are the rows
// of the table of keys.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "scene/keys.h"
#include "scene/keys_page.h"
#include "scene/table.h"

namespace obscura::scene {

namespace {

const char* const kNotes[][2] = {
    {"room",
     "Without `size` and `walls` the room is 8 m by 4.5 m. With `walls` alone it has only those walls, and "
     "may be open. Without a size, the reference pixel of the mouse is 1/480 of the height that the camera "
     "fits."},
    {"physics",
     "In the plane, balls, polygons and bodies of several shapes need `collision = \"contact\"` or "
     "`\"event\"`. In space `handout` takes bodies of every shape; they collide only with walls. Joints, "
     "friction and collisions between bodies need `contact` or `event`, in the plane and in space.\n\n"
     "In `contact` and `event` a body comes to rest, to the bit, where contacts and joints hold it. Motion "
     "that they leave free continues: a puck on ice, a rolling ball, a pendulum. Let g be gravity and L the "
     "room's height. A body is put to rest when three things are true of it and all that it touches. It has "
     "been slower than 0.002 s g for a quarter of a second. Forces within the laws of contact leave it less "
     "acceleration than g / 1,000,000. The part of its velocity that contacts and joints leave free, or that "
     "their spare friction would not stop within 0.01 s, is less than 1e-8 sqrt(g L). The direct solver "
     "asks only for a velocity below 1e-8 sqrt(g L) and an acceleration below 1e-10 g. All this scales with "
     "the scene; without gravity a body rests only if it does not move at all."},
    {"mouse",
     "The reference pixel is 1/480 of the room's height, so that a larger picture shows the same motion."},
    {"camera",
     "`center` and `width` give a fixed view; with `keys` the camera moves from key to key, and stands still "
     "before the first and after the last. In space it looks at `center` from `azimuth` and `elevation`, or "
     "from `eye`."},
};

std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
  return text;
}

// the type of value, in a word or two
std::string type(const Key& key) {
  switch (key.form) {
    case Form::table:
      return "table";
    case Form::tables:
      return "tables";
    case Form::cameras:
      return "table, or tables";
    case Form::number:
      return "number";
    case Form::integer:
      return "whole number";
    case Form::boolean:
      return "true, false";
    case Form::text:
      return "string";
    case Form::name:
    case Form::label:
    case Form::thing:
      return "name";
    case Form::things:
      return "list of names";
    case Form::rational:
      return "number or fraction";
    case Form::speeds:
      return "number or fraction, or tables";
    case Form::choice:
      return fmt::format("`{}`", fmt::join(key.choices, "`, `"));
    case Form::choices:
      return fmt::format("list of `{}`", fmt::join(key.choices, "`, `"));
    case Form::color:
      return "colour";
    case Form::vector:
      return key.dimension == 3 ? "[x, y, z]" : "[x, y]";
    case Form::spin:
      return "number; in space [x, y, z]";
    case Form::turn:
      return "[x, y, z], deg, or { axis, angle }";
    case Form::walls:
      return "`ground`, `none`, or tables";
    case Form::pixels:
      return "[width, height]";
    case Form::count:
      return "whole number, or one per direction";
    case Form::offset:
      return "[x, y], or a list of them";
    case Form::which:
      return "true, false, or which copies";
    case Form::points:
      return key.dimension == 3 ? "[[x, y, z], ...]" : "[[x, y], ...]";
    case Form::pairs:
      return "pairs of names";
    case Form::limits:
      return "[lowest, highest]";
    case Form::ends:
      return "two ends";
    case Form::places:
      return "places, or points of bodies";
    case Form::couple:
      return "two names";
    case Form::path:
      return "[[t, x, y], ...]";
    case Form::curve:
      return "places, arcs, splines";
    case Form::place:
      return "a place, or a point of a body";
    case Form::times:
      return "number, or a list of them";
    case Form::cue:
      return "number, a mark, or { time, after }";
    case Form::trails:
      return "number, or table of them";
    case Form::states:
      return "true, false, or a file";
    case Form::bodies:
      return "name, or list of names";
    case Form::expression:
      return "expression";
    case Form::expressions:
      return "one expression a dimension";
    case Form::torque:
      return "expression; in space three";
    case Form::numbers:
      return "numbers with names";
    case Form::any:
      return "value";
    case Form::moment:
      return "number or fraction, or a mark";
  }
  return "";
}

std::string range_text(const Key& key) {
  const bool worth = key.form != Form::integer || key.path != "version";
  if (!worth || (!std::isfinite(key.range.low) && !std::isfinite(key.range.high))) return "";
  if (key.range.low == 0 && (!std::isfinite(key.range.high) || key.range.high >= 1e6))
    return key.range.above ? "> 0" : ">= 0";
  return fmt::format(
      "{} {}",
      key.range.above ? fmt::format("more than {} to", key.range.low) : fmt::format("{} to", key.range.low),
      key.range.high);
}

std::string row(const Key& key, const std::string& section) {
  std::string name = key.path;
  if (!section.empty()) name = name.substr(section.size() + 1);
  std::string kind = type(key);
  if (!key.unit.empty()) kind += ", " + key.unit;
  if (const std::string r = range_text(key); !r.empty()) kind += ", " + r;
  if (key.varies) kind += key.form == Form::color || key.form == Form::text ? "; or a list" : "; *varies*";
  const std::string absent = key.required                                  ? "needed"
                             : !key.absent.empty()                         ? key.absent
                             : key.fallback.empty()                        ? ""
                             : key.dimension == 3 && !key.in_space.empty() ? "`" + key.in_space + "`"
                                                                           : "`" + key.fallback + "`";
  const bool told = key.dimension != 3 || key.doc.find("space") != key.doc.npos;
  const std::string example =
      key.example.empty() ? "" : "`" + std::string(key.last()) + " = " + key.example + "`";
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", name, cell(kind), cell(absent),
                     cell(told ? key.doc : "In space. " + key.doc), cell(example));
}

constexpr const char* kHead = "| key | takes | left out | what it is | example |\n|---|---|---|---|---|\n";

bool section(const Key& key) {
  return key.form == Form::table || key.form == Form::tables || key.form == Form::cameras ||
         key.form == Form::numbers;
}

void rows_under(std::string& page, const std::string& owner, const std::string& section) {
  for (const Key* each : keys_of(owner)) {
    // the marks of a film are those of a figure
    if (owner == "film" && each->form == Form::tables && each->path != "film.plot" &&
        key("figure." + std::string(each->last()))) {
      Key same = *each;
      same.doc += fmt::format(" Keys as in `[[figure.{}]]`.", each->last());
      page += row(same, section);
      continue;
    }
    page += row(*each, section);
    if (each->form == Form::table || each->form == Form::tables || each->form == Form::walls ||
        each->form == Form::speeds)
      rows_under(page, each->path, section);
  }
}

}  // namespace

std::string keys_page() {
  std::string page = std::string(kKeysPageOpening) + "## The keys\n\n### At the top\n\n" + kHead;
  for (const Key* each : keys_of(""))
    if (!section(*each)) page += row(*each, "");
  for (const Key* each : keys_of("")) {
    if (!section(*each)) continue;
    page += fmt::format("\n### {}\n\n{}\n\n",
                        each->form != Form::tables ? "[" + each->path + "]" : "[[" + each->path + "]]",
                        each->doc);
    for (const auto& note : kNotes)
      if (each->path == note[0]) page += std::string(note[1]) + "\n\n";
    if (each->form == Form::numbers) {
      page += "    " + each->example + "\n";
      continue;
    }
    page += kHead;
    rows_under(page, each->path, each->path);
  }
  return page;
}

}  // namespace obscura::scene
