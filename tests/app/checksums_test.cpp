#include "app/run/checksums.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/run/origin.h"

namespace obscura::app {
namespace {

/// A film of bodies that stand at their numbers, but for what `change` does to a frame.
template <class Change>
Checksums film(std::int64_t frames, std::size_t bodies, Change change) {
  Checksums all(frames, bodies);
  for (std::int64_t i = 0; i < frames; ++i) {
    sim::Snapshot moment;
    moment.bodies.resize(bodies);
    for (std::size_t k = 0; k < bodies; ++k) moment.bodies[k].position = {double(k), double(i), 0};
    change(i, moment);
    std::string state;
    for (const auto& body : moment.bodies)
      state += fmt::format("{:a} {:a} ", body.position.y(), body.velocity.x());
    all.add(i, hash(state + std::to_string(moment.step)), moment);
  }
  all.close();
  return all;
}
Checksums film(std::int64_t frames, std::size_t bodies) {
  return film(frames, bodies, [](std::int64_t, sim::Snapshot&) {});
}

TEST(Checksums, OfTheSameFilmAreTheSameAndReadBack) {
  const Checksums a = film(600, 2);
  EXPECT_EQ(Checksums::apart(a, film(600, 2)), std::nullopt);
  const auto again = Checksums::read(nlohmann::json::parse(a.json().dump()));
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, a);
}

TEST(Checksums, NameTheFirstFrameAndTheBodiesThatDifferThere) {
  const auto moved = [](std::int64_t i, sim::Snapshot& moment) {
    if (i >= 137) moment.bodies[1].position.y() += 1e-15 * double(i);
    if (i >= 137) moment.bodies[2].velocity.x() = 1e-300;
  };
  const auto apart = Checksums::apart(film(600, 4), film(600, 4, moved));
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->first, 137);
  EXPECT_EQ(apart->same, 136);
  EXPECT_EQ(apart->bodies_at, 137);
  EXPECT_EQ(apart->bodies, (std::vector<std::size_t>{1, 2}));
}

TEST(Checksums, OfALongFilmOfManyBodiesTellTheFramesBetweenWhichItParts) {
  const auto moved = [](std::int64_t i, sim::Snapshot& moment) {
    if (i >= 5001) moment.bodies[99].position.y() = -1;
  };
  // of 8000 frames each fourth, of 100 bodies those of each 200th
  const Checksums a = film(8000, 100), b = film(8000, 100, moved);
  EXPECT_LT(a.json().dump().size(), 13'000);
  const auto apart = Checksums::apart(a, b);
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->same, 5000);
  EXPECT_EQ(apart->first, 5004);
  EXPECT_EQ(apart->bodies_at, 5200);
  EXPECT_EQ(apart->bodies, std::vector<std::size_t>{99});
}

TEST(Checksums, SayWhereOneEndsAndWhereNoBodyIsAnywhereElse) {
  auto apart = Checksums::apart(film(60, 2), film(50, 2));
  ASSERT_TRUE(apart);
  EXPECT_TRUE(apart->ended);
  EXPECT_EQ(apart->first, 50);
  apart = Checksums::apart(film(60, 2), film(60, 2, [](std::int64_t i, sim::Snapshot& moment) {
                             if (i == 3) moment.step = 1;
                           }));
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->first, 3);
  EXPECT_TRUE(apart->bodies_known);
  EXPECT_TRUE(apart->bodies.empty());
}

TEST(Checksums, OfPartsAreThoseOfTheWhole) {
  const Checksums whole = film(100, 3);
  Checksums joined(100, 3), second(100, 3), third(100, 3);
  Checksums* const parts[] = {&joined, &second, &third};
  for (std::int64_t i = 0; i < 100; ++i) {
    sim::Snapshot moment;
    moment.bodies.resize(3);
    std::string state;
    for (std::size_t k = 0; k < 3; ++k) {
      moment.bodies[k].position = {double(k), double(i), 0};
      state += fmt::format("{:a} {:a} ", double(i), 0.0);
    }
    parts[i / 40]->add(i, hash(state + "0"), moment);
  }
  joined.append(second), joined.append(third);
  joined.close();
  EXPECT_EQ(joined, whole);
}

TEST(Checksums, ThatAreDamagedAreNone) {
  const nlohmann::json good = nlohmann::json::parse(film(10, 2).json().dump());
  for (const char* key : {"frames", "hash", "of_frames"}) {
    nlohmann::json bad = good;
    bad.erase(key);
    EXPECT_FALSE(Checksums::read(bad)) << key;
  }
  for (const nlohmann::json& value :
       {nlohmann::json(0), nlohmann::json(-1), nlohmann::json(1e30), nlohmann::json("x")}) {
    nlohmann::json bad = good;
    bad["of_bodies"]["width"] = value;
    EXPECT_FALSE(Checksums::read(bad)) << value;
    bad = good;
    bad["frames"] = value;
    EXPECT_FALSE(Checksums::read(bad)) << value;
  }
  // fewer letters than frames, and widths that do not divide them
  nlohmann::json cut = good;
  cut["of_frames"]["sums"] = "abc", cut["of_bodies"]["sums"] = "abcdefg";
  const auto it = Checksums::read(cut);
  ASSERT_TRUE(it);
  EXPECT_TRUE(Checksums::apart(*it, film(10, 2)));
  EXPECT_TRUE(Checksums::apart(film(10, 2), *it));
}

}  // namespace
}  // namespace obscura::app
