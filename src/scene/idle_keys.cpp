#include "scene/idle_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <span>
#include <string>
#include <variant>

#include "scene/body_kinds.h"
#include "scene/fields.h"
#include "scene/when_names.h"

namespace obscura::scene {

namespace {

template <class Act>
void each_table(const Node& top, const char* kind, Act&& act) {
  const Node* all = top.find(kind);
  for (std::size_t k = 0; all && k < all->list().size(); ++k) act(Fields(all->list()[k], kind));
}

template <class Act>
void each_body(const Node& top, Act&& act) {
  for (const BodyKind& kind : body_kinds())
    each_table(top, std::string(kind.name).c_str(), [&](const Fields& fields) { act(fields); });
}

bool is(const Node* flag, bool value) {
  return flag && std::holds_alternative<bool>(flag->value) && std::get<bool>(flag->value) == value;
}

// a number, or a list of them, that is not zero
bool nonzero(const Node* node) {
  if (!node) return false;
  if (node->is_list()) return std::ranges::any_of(node->list(), [](const Node& it) { return nonzero(&it); });
  if (node->is_table())
    return std::ranges::any_of(node->table(), [](const Entry& it) { return nonzero(&it.node); });
  return !node->is_text() && !std::holds_alternative<bool>(node->value) && node->number() != 0;
}

// whether the room, a body, a copy of one or an event gives any of these
bool any_given(const Node& top, std::span<const CopySet> copies, std::initializer_list<const char*> keys) {
  const Node* room = top.find("room");
  bool any = false;
  for (const char* key : keys) {
    any = any || std::ranges::any_of(copies, [&](const CopySet& it) { return it.path.front().name == key; });
    any = any || (room && room->find(key));
    each_body(top, [&](const Fields& body) { any = any || body.given(key); });
    each_action(top, [&](const Node& action) {
      const Node* set = action.find("set");
      any = any || (set && set->is_text() && set->text().ends_with(std::string(".") + key));
    });
  }
  return any;
}

// what would begin when the run is over
void refuse_after_end(const Node& top, Diagnostics& complaints) {
  const Fields words(top, "");
  const Node* duration = words.given("duration");
  if (duration && duration->place.set > 0) return;
  const sim::Rational end = words.rational("duration");
  const auto refuse = [&](const Fields& fields, const char* key, const char* what) {
    if (!fields.given(key) || !(end < fields.rational(key))) return;
    complaints.add(fields.place(key), fmt::format("{} at {:g} s never comes: the scene ends at {:g} s", what,
                                                  sim::value(fields.rational(key)), sim::value(end)));
  };
  each_table(top, "when", [&](const Fields& when) { refuse(when, "time", "an event"); });
  each_table(top, "explosion", [&](const Fields& explosion) { refuse(explosion, "start", "an explosion"); });
  each_body(top, [&](const Fields& body) { refuse(body, "release", "a release"); });
}

void refuse_idle_fields(const Node& top, std::span<const CopySet> copies, Diagnostics& complaints) {
  const Node* found = top.find("room");
  if (!found) return;
  const Fields room(*found, "room");
  const auto needs = [&](const char* key, std::initializer_list<const char*> others, const char* why) {
    if (nonzero(room.given(key)) && !any_given(top, copies, others)) complaints.add(room.place(key), why);
  };
  needs("wind", {"drag", "quadratic_drag"},
        "'wind' does nothing: it acts by 'drag' or 'quadratic_drag', which neither the room nor a body has");
  needs("softening", {"gravitation", "coulomb"},
        "'softening' does nothing: it is of 'gravitation' and 'coulomb', and the room has neither");
  needs("electric", {"charge"}, "'electric' does nothing: no body has a 'charge'");
  needs("magnetic", {"charge"}, "'magnetic' does nothing: no body has a 'charge'");
  needs("coulomb", {"charge"}, "'coulomb' does nothing: no body has a 'charge'");
  const Node* walls = room.given("walls");
  if (!walls || !walls->is_text() || walls->text() != "none") return;
  const char* const hovers = "'ground_drag' does nothing: the room has no walls to lie on";
  if (nonzero(room.given("ground_drag"))) complaints.add(room.place("ground_drag"), hovers);
  each_body(top, [&](const Fields& body) {
    if (nonzero(body.given("ground_drag"))) complaints.add(body.place("ground_drag"), hovers);
  });
}

void refuse_idle_body_keys(const Node& top, Diagnostics& complaints) {
  const Node* rotation = Fields::of(top, "physics").given("rotation");
  each_body(top, [&](const Fields& body) {
    const Node *own = body.given("rotation"), *fixed = body.given("fixed");
    if (body.given("inertia") && is(own ? own : rotation, false) && (own ? own : rotation)->place.set == 0)
      complaints.add(body.place("inertia"),
                     "'inertia' does nothing: the body does not turn, as 'rotation' is false");
    if (!is(fixed, true) || fixed->place.set > 0) return;
    for (const char* key : {"velocity", "spin"}) {
      if (!nonzero(body.given(key)) || body.given("motion")) continue;
      complaints.add(
          body.place(key),
          fmt::format("'{}' does nothing: what is 'fixed' stands still, and begins at rest where it is "
                      "let go; a 'motion' moves it",
                      key));
    }
  });
}

}  // namespace

void refuse_idle_keys(const Node& top, std::span<const CopySet> copies, Diagnostics& complaints) {
  refuse_after_end(top, complaints);
  refuse_idle_fields(top, copies, complaints);
  refuse_idle_body_keys(top, complaints);
  each_table(top, "when", [&](const Fields& when) {
    if (when.given("time") && is(when.given("again"), true))
      complaints.add(when.place("again"), "'again' does nothing: a time comes once");
  });
  each_table(top, "explosion", [&](const Fields& explosion) {
    if (explosion.given("interval") && explosion.text("scheme") != "paper")
      complaints.add(explosion.place("interval"),
                     "'interval' is of scheme = \"paper\"; by \"smooth\" forces are not held");
  });
}

}  // namespace obscura::scene
