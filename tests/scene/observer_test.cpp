// A run as one of its bodies sees it, against the same run seen from the room: in the plane and in space.

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr const char* kSees = "observer = \"table\"\n";

std::string turntable(const Manner& manner, const std::string& observer) {
  return plane_without_walls(manner, "gravity = [0, -2]\n" + observer) +
         "[[ball]]\nname = \"table\"\nposition = [1, 2]\nradius = 3\nmotion = { angle = \"60*t\", x = "
         "\"0.2*t\" }\n"
         "[[ball]]\nname = \"puck\"\nposition = [0, 2]\nvelocity = [0.5, 0.3]\nradius = 0.1\nmass = 2\n"
         "[[box]]\nname = \"weight\"\nsize = [0.4, 0.2]\nposition = [7, 2]\nspin = 90\n"
         "[[spring]]\nbetween = [\"weight\", [8, 3]]\nstiffness = 3\nrest_length = 0.5\n"
         "[contact]\nignore = [[\"table\", \"puck\"], [\"table\", \"weight\"]]\n";
}

// What flies straight goes around where it is seen from a turntable: x' = x0 + R(-w t) (x - x_table).
TEST(Observer, OnATurntableSeesWhatFliesGoAround) {
  for (const Manner& manner : kManners) {
    const TextRun seen(turntable(manner, kSees)), room(turntable(manner, ""));
    const std::size_t table = number_of(room, "table"), puck = number_of(room, "puck"),
                      weight = number_of(room, "weight");
    const double w = std::acos(-1.0) / 3;
    for (const double t : {0.0, 0.7, 2.003}) {
      const sim::Snapshot then = seen.at(t), now = room.at(t);
      EXPECT_NEAR((then.bodies[table].position - sim::Vec3(1, 2, 0)).norm(), 0, 1e-12) << manner.name;
      EXPECT_NEAR(then.bodies[table].velocity.norm(), 0, 1e-12) << manner.name;
      EXPECT_NEAR(then.bodies[table].spin.norm(), 0, 1e-12) << manner.name;
      EXPECT_NEAR(then.bodies[table].angle, 0, 1e-12) << manner.name;
      const Eigen::Matrix3d R = Eigen::AngleAxisd(-w * t, sim::Vec3::UnitZ()).toRotationMatrix();
      for (const std::size_t body : {puck, weight}) {
        const sim::Vec3 d = now.bodies[body].position - now.bodies[table].position;
        EXPECT_NEAR((then.bodies[body].position - sim::Vec3(1, 2, 0) - R * d).norm(), 0, 1e-12);
        // what moves with the table
        const sim::Vec3 carried = sim::Vec3(0.2, 0, 0) + sim::Vec3(0, 0, w).cross(d);
        EXPECT_NEAR((then.bodies[body].velocity - R * (now.bodies[body].velocity - carried)).norm(), 0,
                    1e-12);
        EXPECT_NEAR(then.bodies[body].angle, now.bodies[body].angle - w * t, 1e-12);
      }
      ASSERT_EQ(then.springs.size(), 1u);
      EXPECT_NEAR((then.springs[0].force - R * now.springs[0].force).norm(), 0, 1e-12);
      EXPECT_EQ(then.energies.total(), now.energies.total());
      ASSERT_TRUE(then.gravity && now.gravity);
      EXPECT_NEAR((*then.gravity - R * *now.gravity).norm(), 0, 1e-12);
      EXPECT_EQ(seen.run->words(), room.run->words()) << "a state is the room's";
    }
  }
}

// In space, about an axis that leans, on its way up; and a body that sees itself fall freely sees all that
// falls freely beside it move evenly
TEST(Observer, InSpaceFallsAndTumblesWithIt) {
  for (const Manner& manner : kManners) {
    const auto text = [&](const std::string& observer) {
      return space_without_walls(manner, "gravity = [0, -9, 0]\n" + observer) +
             "[[box]]\nname = \"table\"\nsize = [1, 2, 3]\nposition = [0, 3, 0]\nspin = [80, 20, -50]\n"
             "velocity = [0, 4, 1]\n"
             "[[ball]]\nname = \"b\"\nradius = 0.1\nposition = [5, 1, 0]\nvelocity = [1, 2, 0]\n";
    };
    const TextRun seen(text(kSees)), room(text(""));
    for (const double t : {0.4, 1.1}) {
      const sim::Snapshot then = seen.at(t), now = room.at(t);
      const std::size_t table = number_of(room, "table"), b = number_of(room, "b");
      const sim::Snapshot::Body& it = now.bodies[table];
      EXPECT_NEAR((then.bodies[table].position - sim::Vec3(0, 3, 0)).norm(), 0, 1e-12);
      EXPECT_NEAR(then.bodies[table].orientation.vec().norm(), 0, 1e-12);
      const Eigen::Quaterniond back = it.orientation.conjugate();
      const sim::Vec3 d = now.bodies[b].position - it.position;
      EXPECT_NEAR((then.bodies[b].position - sim::Vec3(0, 3, 0) - back * d).norm(), 0, 1e-12) << manner.name;
      EXPECT_NEAR(
          (then.bodies[b].velocity - back * (now.bodies[b].velocity - it.velocity - it.spin.cross(d))).norm(),
          0, 1e-12);
      EXPECT_NEAR((d - sim::Vec3(5 + t, -2 - 2 * t, -t)).norm(), 0, 1e-9);
    }
  }
}

// Ways, from which trails are drawn, are as the body saw them at each time: the numbers of snapshots.
TEST(Observer, SeesWaysAsItSawThemAtTheTime) {
  for (const Manner& manner : kManners) {
    const TextRun tracked(turntable(manner, kSees)), seen(turntable(manner, kSees));
    const int puck = int(number_of(seen, "puck"));
    tracked.run->track({puck});
    std::vector<sim::Track::Point> way;
    for (const double t : {0.31, 1.0, 1.72}) {
      tracked.at(t);
      const sim::Track track = tracked.run->take_track();
      ASSERT_EQ(track.bodies, std::vector{puck});
      way.insert(way.end(), track.points[0].begin(), track.points[0].end());
    }
    ASSERT_GT(way.size(), 100u);
    for (std::size_t i = 0; i < way.size(); i += 17) {
      const sim::Snapshot now = seen.at(way[i].time);
      const sim::Snapshot::Body& it = now.bodies[std::size_t(puck)];
      // at() is asked to a microsecond, in which they go 1.5e-6 m and gain 4e-6 m/s at most
      EXPECT_NEAR((way[i].place - it.position).norm(), 0, 2e-6) << manner.name;
      EXPECT_NEAR((way[i].velocity - it.velocity).norm(), 0, 4e-6) << manner.name;
    }
  }
}

TEST(Observer, WhatWouldHaveToTurnIsRefused) {
  const std::string ball = "[[ball]]\nname = \"table\"\nradius = 0.1\nposition = [1, 1]\n";
  EXPECT_NE(refusal("[room]\nobserver = \"table\"\n" + ball).find("without walls"), std::string::npos);
  EXPECT_NE(refusal("[room]\nwalls = \"none\"\nobserver = \"tabel\"\n" + ball).find("did you mean"),
            std::string::npos);
  EXPECT_EQ(refusal("[room]\nwalls = \"none\"\nobserver = \"table\"\n" + ball), "");
}

}  // namespace
}  // namespace obscura::scene
