// What is there of a film or a sweep that is not whole: it is not lost without being asked.

#include <gmock/gmock.h>

#include <algorithm>

#include "program.h"

namespace obscura::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Leftovers : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(kRoom);
  }
  Outcome render(const std::string& flags, const std::string& file = "scene.toml") const {
    return obscura("render " + file + " -o film.mp4 --to 4 --size 96x54 --fps 10 --progress none " + flags);
  }
  int parts() const {
    int n = 0;
    if (fs::exists(path("film.mp4.parts")))
      for (const auto& entry : fs::directory_iterator(path("film.mp4.parts")))
        n += entry.path().filename().string().starts_with("take-");
    return n;
  }
  // two of four seconds, as one process leaves them that was interrupted after so much work
  void interrupted_after(const std::string& seconds) const {
    fs::remove_all(path("film.mp4.parts"));
    ASSERT_EQ(render("--shard 1/2").exit, 0);
    ASSERT_EQ(shell("sed -i '/\"shards\"/d' film.mp4.parts/journal.json").exit, 0);
    if (seconds.empty())
      fs::remove(path("film.mp4.parts/seconds"));
    else
      worked_for(seconds);
    ASSERT_EQ(parts(), 2);
  }
  void worked_for(const std::string& seconds) const {
    std::ofstream(path("film.mp4.parts/seconds")) << seconds;
  }
  void edit(const std::string& file = "scene.toml") const {
    std::string text = kRoom;
    scene(text.replace(text.find("spin     = 90"), 13, "spin     = 80"), file);
  }
};

TEST_F(Leftovers, OfShardsAreNotThrownAway) {
  ASSERT_EQ(render("").exit, 0);
  const std::string bytes = contents(path("film.mp4"));
  ASSERT_EQ(render("--shard 1/2").exit, 0);
  // a second of work is told: how long it took is not a clock's to say here
  worked_for("0.9");
  Outcome run = render("");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.err, HasSubstr("film.mp4.parts: holds 20 of 40 frames, work of 2 shards"));
  EXPECT_THAT(run.err, HasSubstr("--resume continues from there, --anew discards it"));
  EXPECT_EQ(parts(), 2);
  // of another scene neither
  edit("other.toml");
  run = render("", "other.toml");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.err,
              HasSubstr("work of 2 shards of another film: the scene's crate.spin is 90 there, and 80 here"));
  worked_for("1.5");
  EXPECT_THAT(render("", "other.toml").err, HasSubstr("work of 2 shards, 1.5 s of work of another film: "));
  run = render("--resume", "other.toml");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.err, HasSubstr("--anew discards them"));
  EXPECT_EQ(parts(), 2);
  EXPECT_EQ(render("--resume").exit, 0);
  EXPECT_EQ(contents(path("film.mp4")), bytes);
  EXPECT_FALSE(fs::exists(path("film.mp4.parts")));
}

TEST_F(Leftovers, OfPreparationsAreNotThrownAway) {
  for (const std::string out : {"film.mp4", "f/{frame}.png"}) {
    const std::string command =
        "render scene.toml --to 4 --size 96x54 --fps 10 --progress none -o '" + out + "' ";
    ASSERT_EQ(obscura(command + "--prepare 3").exit, 0);
    const Outcome run = obscura(command);
    EXPECT_EQ(run.exit, 4);
    EXPECT_THAT(run.err, HasSubstr("holds the states of 3 shards"));
    // one more preparation is no loss
    EXPECT_EQ(obscura(command + "--prepare 4").exit, 0);
    EXPECT_EQ(obscura(command + "--anew").exit, 0);
  }
}

TEST_F(Leftovers, OfOneProcessAreReplacedWithinAMinute) {
  interrupted_after("59.9");
  const Outcome run = render("");
  EXPECT_EQ(run.exit, 0);
  EXPECT_EQ(run.err, "");
}

TEST_F(Leftovers, OfMoreThanAMinuteAreNot) {
  for (const char* seconds : {"60.1", "86400", ""}) {
    interrupted_after(seconds);
    for (const char* flags : {"", "--theme screen"}) {
      const Outcome run = render(flags);
      EXPECT_EQ(run.exit, 4) << seconds;
      EXPECT_THAT(run.err, HasSubstr("holds 20 of 40 frames"));
      EXPECT_THAT(run.err, HasSubstr("--anew"));
      EXPECT_EQ(parts(), 2);
    }
  }
  const Outcome run = render("--anew");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(parts(), 0);
}

TEST_F(Leftovers, OfASceneEditedSinceAreReplacedWithALine) {
  for (const char* seconds : {"1.5", "3600"}) {
    scene(kRoom);
    interrupted_after(seconds);
    edit();
    const Outcome run = render("");
    EXPECT_EQ(run.exit, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("film.mp4.parts: replaces 20 of 40 frames, "));
    EXPECT_THAT(run.err,
                HasSubstr(" of work of an earlier film: the scene's crate.spin is 90 there, and 80 here\n"));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1);
    interrupted_after(seconds);
    const Outcome set = render("--set crate.spin=70");
    EXPECT_EQ(set.exit, 0);
    EXPECT_THAT(set.err, HasSubstr("crate.spin is 80 there, and 70 here"));
  }
  // another scene under the same name of a film is none that was edited
  interrupted_after("3600");
  scene(kRoom, "other.toml");
  const Outcome run = render("", "other.toml");
  EXPECT_EQ(run.exit, 4);
  EXPECT_EQ(parts(), 2);
}

TEST_F(Leftovers, WorkIsCountedFromOneProcessToTheNext) {
  interrupted_after("30");
  ASSERT_EQ(render("--shard 2/2").exit, 0);
  EXPECT_GE(std::stod(contents(path("film.mp4.parts/seconds"))), 30);
}

TEST_F(Leftovers, ADamagedJournalNamesTheWayOnAndResumeIsIt) {
  ASSERT_EQ(render("").exit, 0);
  const std::string bytes = contents(path("film.mp4"));
  fs::remove(path("film.mp4"));
  for (const char* damage : {"truncate -s 40", "sed -i s/takes/cakes/", "rm"}) {
    ASSERT_EQ(render("--shard 1/2").exit, 0);
    ASSERT_EQ(shell(std::string(damage) + " film.mp4.parts/journal.json").exit, 0);
    const std::string before = shell("ls -i film.mp4.parts/take-00000[01]-*").out;
    const Outcome joined = obscura("join film.mp4 --partial");
    EXPECT_EQ(joined.exit, 4);
    if (std::string(damage) != "rm") {
      EXPECT_THAT(joined.err, HasSubstr("journal.json: is damaged; the same render with --resume rewrites it "
                                        "and keeps the complete parts"));
      EXPECT_EQ(render("").exit, 4);
    }
    // parts of another film are not taken for this one's
    const Outcome other = render("--resume --set crate.mass=3");
    EXPECT_EQ(other.exit, 4);
    EXPECT_THAT(other.err, HasSubstr("crate.mass is none there, and 3 here"));
    ASSERT_EQ(parts(), 2);
    const Outcome mended = render("--shard 2/2");
    ASSERT_EQ(mended.exit, 0) << mended.err;
    if (std::string(damage) != "rm") {
      EXPECT_THAT(mended.err, HasSubstr("journal.json: was damaged, and is written anew"));
    }
    EXPECT_EQ(parts(), 4);
    EXPECT_EQ(shell("ls -i film.mp4.parts/take-00000[01]-*").out, before) << "made again";
    ASSERT_EQ(obscura("join film.mp4").exit, 0);
    EXPECT_EQ(contents(path("film.mp4")), bytes);
  }
}

TEST_F(Leftovers, FlagsThatContradictEachOtherAreRefused) {
  EXPECT_EQ(render("--anew --resume").exit, 2);
  EXPECT_EQ(render("--anew --shard 1/2").exit, 2);
  EXPECT_EQ(obscura("render scene.toml --at 1 -o a.png --anew").exit, 2);
  EXPECT_EQ(obscura("sweep scene.toml --vary seed=1:3 --measure hash@1 -o a.csv --anew --resume").exit, 2);
}

TEST_F(Leftovers, JoinPrintsWhichShardsAreMissing) {
  for (const char* shard : {"--shard 2/4", "--shard 3/4"}) ASSERT_EQ(render(shard).exit, 0);
  Outcome run = obscura("join film.mp4 --missing");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(run.out, "1,4\n");
  ASSERT_EQ(render("--shard 4/4").exit, 0);
  EXPECT_EQ(obscura("join film.mp4 --missing").out, "1\n");
  ASSERT_EQ(render("--shard 1/4").exit, 0);
  run = obscura("join film.mp4 --missing");
  EXPECT_EQ(run.exit, 0);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(parts(), 4);
  // what was not made in shards has none
  interrupted_after("1");
  run = obscura("join film.mp4 --missing");
  EXPECT_EQ(run.exit, 4);
  EXPECT_THAT(run.err, HasSubstr("is not made in shards"));
}

class SweepLeftovers : public Leftovers {
 protected:
  static constexpr const char* kSweep =
      "sweep scene.toml --vary seed=1:5 --measure hash@1 --progress none -o runs.csv ";
  // some rows, as a process leaves them that was interrupted after so much work
  void interrupted_after(const std::string& seconds) const {
    ASSERT_EQ(obscura(std::string(kSweep) + "--anew").exit, 0);
    ASSERT_EQ(shell("head -n 3 runs.csv >runs.partial.csv").exit, 0);
    EXPECT_FALSE(fs::exists(path(".runs.partial.csv.seconds")));
    if (!seconds.empty()) std::ofstream(path(".runs.partial.csv.seconds")) << seconds;
  }
};

TEST_F(SweepLeftovers, OfMoreThanAMinuteAreNotThrownAway) {
  for (const char* seconds : {"60.1", ""}) {
    interrupted_after(seconds);
    const std::string whole = contents(path("runs.csv")), left = contents(path("runs.partial.csv"));
    const Outcome run = obscura(kSweep);
    EXPECT_EQ(run.exit, 4);
    EXPECT_THAT(run.err, HasSubstr("runs.partial.csv: holds 3 lines of a sweep that is not whole"));
    EXPECT_THAT(run.err, HasSubstr("--resume continues from there, --anew discards them"));
    EXPECT_EQ(contents(path("runs.partial.csv")), left);
    EXPECT_EQ(obscura(std::string(kSweep) + "--resume").exit, 0);
    EXPECT_EQ(contents(path("runs.csv")), whole);
    EXPECT_EQ(shell("ls -A | grep seconds").out, "");
  }
}

TEST_F(SweepLeftovers, OfLessAreReplaced) {
  interrupted_after("59");
  EXPECT_EQ(obscura(kSweep).exit, 0);
  EXPECT_FALSE(fs::exists(path("runs.partial.csv")));
}

}  // namespace
}  // namespace obscura::app
