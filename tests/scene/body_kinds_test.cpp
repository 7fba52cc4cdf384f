// Each row of the table of kinds: its table is a key of the language, its measure a key of that, and a scene
// with one body of it has a body that is counted as it.

#include "scene/body_kinds.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "scene/scene.h"

namespace obscura::scene {
namespace {

// the least table of one: what is required, as its examples have it
std::string least_table(const BodyKind& kind, int dimension) {
  const std::string owner(kind.name);
  std::string text = "[physics]\ncollision = \"contact\"\n[room]\nsize = " +
                     std::string(dimension == 2 ? "[9, 9]" : "[9, 9, 9]") + "\n[[" + owner + "]]\n";
  for (const Key* key : keys_of(owner)) {
    if (!key->required) continue;
    text += std::string(key->last()) + " = " +
            (key->form == Form::tables ? "[{ radius = 0.1 }, { radius = 0.2 }]" : key->example) + "\n";
  }
  return text;
}

template <int D>
void expect_made(const BodyKind& kind) {
  const Maker<D>& maker = kind.maker<D>();
  const bool here = kind.dimension == 0 || kind.dimension == D;
  EXPECT_EQ(maker.make != nullptr, here) << kind.name;
  EXPECT_EQ(maker.form >= 0, here) << kind.name;
  if (!here) {
    EXPECT_ANY_THROW(parse(least_table(kind, D), "a.toml")) << kind.name;
    return;
  }
  const Scene it = parse(least_table(kind, D), "a.toml");
  const auto& body = std::get<sim::World<D>>(it.world).model.bodies.at(0);
  EXPECT_EQ(kind_of(body).name, kind.name);
  EXPECT_EQ(int(body.shape.index()), maker.form) << kind.name;
  EXPECT_EQ(body.turns(), kind.turns) << kind.name;
}

TEST(BodyKinds, EachIsMadeByItsTableAndCountedAsItself) {
  for (const BodyKind& kind : body_kinds()) {
    expect_made<2>(kind);
    expect_made<3>(kind);
  }
}

TEST(BodyKinds, EachHasItsKeysAndAStreamOfItsOwn) {
  std::set<std::uint64_t> streams;
  for (const BodyKind& kind : body_kinds()) {
    const std::string name(kind.name);
    ASSERT_TRUE(key(name)) << name;
    EXPECT_EQ(key(name)->form, Form::tables) << name;
    EXPECT_EQ(key(name)->dimension, kind.dimension) << name;
    EXPECT_TRUE(key(name + "." + std::string(kind.measure))) << name;
    EXPECT_EQ(key(name + ".density") != nullptr, kind.turns) << name;
    EXPECT_EQ(key(name + ".collision") != nullptr, kind.handout) << name;
    EXPECT_EQ(kind.dimension == 0, kind.instead.empty()) << name;
    // tables of a kind count by two
    EXPECT_TRUE(streams.insert(kind.stream).second) << name;
    EXPECT_FALSE(kind.called.empty() || kind.plural.empty() || kind.doc.empty()) << name;
  }
}

// what does not turn and stands askew in space is held as a body of one part, and is counted as that part
TEST(BodyKinds, WhatStandsAskewIsCountedAsWhatItIs) {
  const Scene it = parse(
      "[room]\nsize = [9, 9, 9]\n[[box]]\nrotation = false\norientation = [0, 0, 30]\nposition = [0, 2, 0]\n"
      "[[ball]]\nrotation = false\nposition = [3, 2, 0]",
      "a.toml");
  EXPECT_EQ(kind_of(it.space().model.bodies[0]).name, "particle");
  EXPECT_EQ(kind_of(it.space().model.bodies[1]).name, "box");
}

}  // namespace
}  // namespace obscura::scene
