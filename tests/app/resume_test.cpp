// A film that is stopped, divided or moved to another day is the film: the same bytes as in one go.

#include <algorithm>
#include <functional>

#include <nlohmann/json.hpp>

#include "app/run/origin.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSmall = " --size 96x54 --fps 10 --progress none";
constexpr const char* kSmallest = " --size 96x54 --fps 4 --set physics.rate=120 --progress none";

class Resume : public Program {
 protected:
  /// Kills `command` at each change that it makes in out/, until it comes to its end: `begin` comes before
  /// each run and `left` after it, with its number.
  void kill_everywhere(const std::string& command, const std::function<void()>& begin,
                       const std::function<void(long)>& left);
};
using Shards = Program;
using Checkpoints = Program;

// every file of a folder, one after the other
std::string all_of(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string all;
  for (const fs::path& file : files) all += file.filename().string() + "\n" + contents(file.string());
  return all;
}

int parts_in(const std::string& folder) {
  int n = 0;
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      n += entry.path().filename().string().starts_with("take-");
  return n;
}

void Resume::kill_everywhere(const std::string& command, const std::function<void()>& begin,
                             const std::function<void(long)>& left) {
  // between two of these calls a kill leaves the same behind, wherever it comes
  constexpr const char* kChanges = "write,open,rename,mkdir,unlink,ftruncate";
  for (long n = 1; !HasFatalFailure(); ++n) {
    begin();
    const Outcome run = shell(meeting("KILL", n, kChanges) + command);
    if (!met()) {
      ASSERT_EQ(run.exit, 0) << run.err;
      ASSERT_GT(n, 10) << "nothing was killed";
      return;
    }
    ASSERT_NE(run.exit, 0) << "the call " << contents(path("met"));
    left(n);
  }
}

TEST_F(Resume, OfAMovieThatWasKilledIsTheSameMovie) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o out/film.mp4 --to 2 -j 2") + kSmallest;
  const Outcome whole = obscura(command);
  ASSERT_EQ(whole.exit, 0) << whole.err;
  const std::string film = path("out/film.mp4"), bytes = contents(film);
  EXPECT_FALSE(fs::exists(film + ".parts"));

  int part_way = 0;
  kill_everywhere(
      command, [&] { fs::remove_all(path("out")); },
      [&](long n) {
        // what is whole is neither lost nor wrong, and nothing stands under the film's name that is not the
        // film
        if (fs::exists(film)) {
          EXPECT_EQ(contents(film), bytes);
        }
        const int before = parts_in(film + ".parts");
        part_way += before > 0;
        const Outcome rest = obscura(command + " --resume");
        ASSERT_EQ(rest.exit, 0) << "killed at " << n << ": " << rest.err;
        ASSERT_EQ(contents(film), bytes) << "killed at " << n << " with " << before << " parts";
        ASSERT_FALSE(fs::exists(film + ".parts"));
        ASSERT_EQ(shell("ls -A out | grep tmp").out, "");
      });
  EXPECT_GT(part_way, 10);
}

TEST_F(Resume, OfPicturesThatWereKilledIsTheSamePictures) {
  scene(kRoom);
  const std::string command =
      std::string("render scene.toml -o 'out/{frame:03}.png' --to 2 -j 2") + kSmallest;
  const Outcome whole = obscura(command);
  ASSERT_EQ(whole.exit, 0) << whole.err;
  const std::string bytes = all_of(path("out"));

  int part_way = 0;
  kill_everywhere(
      command, [&] { fs::remove_all(path("out")); },
      [&](long n) {
        // every picture that is there is whole
        int there = 0;
        for (int i = 0; i < 8; ++i) {
          const std::string name = path("out/00" + std::to_string(i) + ".png");
          if (!fs::exists(name)) continue;
          ++there;
          ASSERT_EQ(contents(name).substr(contents(name).size() - 8, 4), "IEND");
        }
        part_way += there > 0 && there < 8;
        const Outcome rest = obscura(command + " --resume");
        ASSERT_EQ(rest.exit, 0) << "killed at " << n << ": " << rest.err;
        ASSERT_EQ(all_of(path("out")), bytes) << "killed at " << n;
      });
  EXPECT_GT(part_way, 10);
}

TEST_F(Resume, AJoinThatWasKilledIsDoneAgain) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o out/film.mp4 --to 3") + kSmallest;
  ASSERT_EQ(obscura(command).exit, 0);
  const std::string film = path("out/film.mp4"), bytes = contents(film);
  fs::remove(film);
  for (const char* shard : {" --shard 1/2", " --shard 2/2"}) ASSERT_EQ(obscura(command + shard).exit, 0);
  shell("cp -r out/film.mp4.parts kept");
  const auto begin = [&] { shell("rm -rf out; mkdir out; cp -r kept out/film.mp4.parts"); };
  begin();
  const Outcome joined = obscura("join out/film.mp4");
  ASSERT_EQ(joined.exit, 0) << joined.err;
  ASSERT_EQ(contents(film), bytes);

  kill_everywhere("join out/film.mp4", begin, [&](long n) {
    if (fs::exists(film)) {
      ASSERT_EQ(contents(film), bytes);
    }
    // it goes on either way
    const Outcome rest = n % 2 ? obscura(command + " --resume") : obscura("join out/film.mp4");
    if (rest.exit != 0) {
      ASSERT_FALSE(fs::exists(film + ".parts/journal.json")) << rest.err;
    }
    ASSERT_EQ(contents(film), bytes) << "killed at " << n;
  });
}

TEST_F(Resume, IsRefusedForAnotherFilm) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o film.mp4") + kSmall;
  ASSERT_EQ(obscura(command + " --shard 1/5").exit, 0);
  const Outcome other = obscura(command + " --resume --set crate.mass=3");
  EXPECT_EQ(other.exit, 4);
  EXPECT_NE(other.err.find("crate.mass is none there, and 3 here"), std::string::npos) << other.err;
  EXPECT_EQ(std::count(other.err.begin(), other.err.end(), '\n'), 1);
  const Outcome size = obscura(command + " --resume --theme screen");
  EXPECT_EQ(size.exit, 4);
  EXPECT_NE(size.err.find("the theme is paper there, and screen here"), std::string::npos) << size.err;
  // what was there is there still, and a film from the beginning takes its place where that is asked for
  EXPECT_EQ(parts_in(path("film.mp4.parts")), 2);
  EXPECT_EQ(obscura(command + " --set crate.mass=3 --anew").exit, 0);
}

TEST_F(Resume, MendsADamagedPart) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o film.mp4") + kSmall;
  ASSERT_EQ(obscura(command).exit, 0);
  const std::string bytes = contents(path("film.mp4"));
  ASSERT_EQ(obscura(command + " --shard 1/1").exit, 0);
  shell("f=$(ls film.mp4.parts/take-000004-*); printf x | dd of=$f bs=1 seek=900 conv=notrunc status=none");
  ASSERT_EQ(obscura(command + " --resume").exit, 0);
  EXPECT_EQ(contents(path("film.mp4")), bytes);
  const Outcome again = obscura(command + " --resume");
  EXPECT_EQ(again.exit, 0);
  EXPECT_NE(again.out.find("is whole already"), std::string::npos) << again.out;
}

TEST_F(Resume, AnInterruptLeavesAPlayableBeginningAndTheRest) {
  scene(kRoom);
  const std::string command = "render scene.toml -o out/film.mp4 -j 1 --size 160x90 --fps 30 --progress none";
  ASSERT_EQ(obscura(command).exit, 0);
  const std::string film = path("out/film.mp4"), bytes = contents(film);
  fs::remove(film);
  // when its twelfth file is placed: two or three a take, in whichever order, and few takes are under way
  const Outcome cut = shell(meeting("TERM", 12, "rename") + command);
  EXPECT_EQ(cut.exit, 130) << cut.err;
  const int parts = parts_in(film + ".parts");
  ASSERT_GE(parts, 2);
  ASSERT_LT(parts, 10);
  const Outcome frames = shell(
      "ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 out/film.partial.mp4");
  EXPECT_GE(std::atoi(frames.out.c_str()), 30 * parts) << frames.err;
  // each part plays by itself
  const Outcome part = shell(
      "ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "
      "out/film.mp4.parts/take-000001-*");
  EXPECT_EQ(std::atoi(part.out.c_str()), 30) << part.err;
  ASSERT_EQ(obscura(command + " --resume").exit, 0);
  EXPECT_EQ(contents(film), bytes);
}

TEST_F(Resume, TwoAtOnceOnOneFilmAreOne) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o out/film.mp4") + kSmall;
  // the first stands still where it places its third file, until the second has been told of it
  const Outcome both =
      shell(meeting("STOP", 3, "rename") + command + " & p=$!; " + until_stopped("$p") + OBSCURA_BINARY " " +
            command + "; echo second $?; kill -CONT $p; wait $p; echo first $?");
  EXPECT_EQ(both.out, "second 4\nfirst 0\n") << both.err;
  EXPECT_NE(both.err.find("another obscura is making this film"), std::string::npos) << both.err;
}

TEST_F(Shards, AJournalOfPiecesThatCannotBeIsRefusedAtOnce) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o film.mp4 --to 1") + kSmall;
  ASSERT_EQ(obscura(command + " --shard 1/2").exit, 0);
  const std::string file = path("film.mp4.parts/journal.json"), whole = contents(file);
  for (const auto& [right, wrong] : {std::pair{"\"takes\": 1,", "\"takes\": 1000000000000000,"},
                                     {"\"takes\": 1,", "\"takes\": -1,"},
                                     {"\"takes\": 1,", "\"takes\": 1e300,"},
                                     {"\"take_frames\": 10,", "\"take_frames\": 0,"},
                                     {"\"shards\": 2,", "\"shards\": 4000000000,"}}) {
    std::string other = whole;
    const auto at = other.find(right);
    ASSERT_NE(at, std::string::npos) << right << whole;
    std::ofstream(file) << other.replace(at, std::string(right).size(), wrong);
    const Outcome joined = shell(OBSCURA_NOT_FOR_EVER OBSCURA_BINARY " join film.mp4");
    EXPECT_EQ(joined.exit, 4) << wrong;
    EXPECT_NE(joined.err.find("journal.json: is damaged"), std::string::npos) << wrong << joined.err;
  }
}

TEST_F(Shards, JoinedAreTheFilmInOneGo) {
  scene(kRoom);
  for (const std::string out : {"film.mp4", "film.mkv", "film.webm", "film.gif"}) {
    const std::string command = "render scene.toml -o " + out + " --to 4.5" + kSmall;
    ASSERT_EQ(obscura(command).exit, 0) << out;
    const std::string bytes = contents(path(out));
    fs::remove(path(out));
    ASSERT_EQ(obscura(command + " --prepare 3").exit, 0);
    EXPECT_EQ(obscura(command + " --shard 3/3").exit, 0);
    const Outcome early = obscura("join " + out);
    EXPECT_EQ(early.exit, 4);
    EXPECT_NE(early.err.find("missing: frames 0 to 29 (of 3 shards: 1, 2)"), std::string::npos) << early.err;
    EXPECT_EQ(obscura(command + " --shard 1/3").exit, 0);
    EXPECT_EQ(obscura(command + " --shard 2/3").exit, 0);
    const Outcome joined = obscura("join " + out);
    ASSERT_EQ(joined.exit, 0) << joined.err;
    EXPECT_EQ(contents(path(out)), bytes) << out;
  }
}

TEST_F(Shards, OfPicturesAreThePicturesInOneGo) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o 'a/{frame:03}.png' --from 1 --to 4") + kSmall;
  ASSERT_EQ(obscura(command).exit, 0);
  const std::string bytes = all_of(path("a"));
  fs::remove_all(path("a"));
  for (const char* shard : {" --shard 2/3", " --shard 1/3"}) ASSERT_EQ(obscura(command + shard).exit, 0);
  const Outcome early = obscura("join 'a/{frame:03}.png'");
  EXPECT_EQ(early.exit, 4);
  EXPECT_NE(early.err.find("of 3 shards: 3"), std::string::npos) << early.err;
  ASSERT_EQ(obscura(command + " --shard 3/3").exit, 0);
  const Outcome joined = obscura("join 'a/{frame:03}.png'");
  EXPECT_EQ(joined.exit, 0) << joined.err;
  EXPECT_EQ(all_of(path("a")), bytes);
}

// as seen from the room, and from a body whose impacts come at other times
TEST_F(Shards, HaveTheSameOldEndsOfTrails) {
  const std::string falling = R"(
title = "Trails"
duration = 2
[[ball]]
name = "a"
radius = 0.1
position = [1, 2]
velocity = [1, 0]
[[ball]]
name = "b"
radius = 0.1
position = [2, 1.5]
velocity = [-1.3, 0]
[[box]]
name = "floor"
size = [9, 0.5]
position = [2, 0]
fixed = true
[look]
trails = 0.7
[film]
size = [160, 90]
shutter = 180
[room]
size = [4, 3]
walls = "none"
)";
  for (const std::string& given : {falling, falling + "observer = \"b\"\n"}) {
    scene(given);
    for (const char* fps : {"60", "24"}) {
      const std::string command = std::string("render scene.toml --progress none --fps ") + fps;
      const std::string pictures = " -o 'a/{frame:03}.png'";
      ASSERT_EQ(obscura(command + pictures).exit, 0);
      const std::string bytes = all_of(path("a"));
      const std::string still = contents(path("a/0" + std::string(fps) + ".png"));
      fs::remove_all(path("a"));
      for (const char* shard : {" --shard 1/3", " --shard 2/3", " --shard 3/3"})
        ASSERT_EQ(obscura(command + pictures + shard).exit, 0);
      ASSERT_EQ(obscura("join 'a/{frame:03}.png'").exit, 0);
      EXPECT_EQ(all_of(path("a")), bytes) << fps;
      fs::remove_all(path("a"));
      ASSERT_EQ(obscura(command + " --at 1 -o at.png").exit, 0);
      EXPECT_TRUE(contents(path("at.png")) == still) << fps;
    }
  }
}

TEST_F(Shards, OfAnotherOriginAreNotJoined) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o film.mp4") + kSmall;
  ASSERT_EQ(obscura(command + " --shard 1/2").exit, 0);
  const Outcome native = obscura(command + " --shard 2/2 --native");
  EXPECT_EQ(native.exit, 4);
  EXPECT_NE(native.err.find("--native is off there, and on here"), std::string::npos) << native.err;
}

TEST_F(Shards, MovieBytesDoNotDependOnTheNumberOfWorkers) {
  scene(kRoom);
  const std::string command = std::string("render scene.toml -o film.mp4") + kSmall;
  ASSERT_EQ(obscura(command + " -j 1").exit, 0);
  const std::string bytes = contents(path("film.mp4"));
  for (const char* workers : {" -j 2", " -j 8"}) {
    ASSERT_EQ(obscura(command + workers).exit, 0);
    EXPECT_EQ(contents(path("film.mp4")), bytes) << workers;
  }
}

TEST_F(Checkpoints, GoOnToTheSameStatesAndFrames) {
  scene(kRoom);
  ASSERT_EQ(obscura(std::string("render scene.toml -o film.mp4 --checkpoint-every 2.5") + kSmall).exit, 0);
  const std::string kept = "film.mp4.checkpoints/";
  ASSERT_TRUE(fs::exists(path(kept + "7.5.checkpoint")));
  ASSERT_FALSE(fs::exists(path("film.mp4.parts")));
  const Outcome whole = obscura("states scene.toml --at 7.5,9.25"),
                rest = obscura("states scene.toml --at 7.5,9.25 --from-checkpoint " + kept + "5.checkpoint");
  EXPECT_EQ(rest.exit, 0) << rest.err;
  EXPECT_EQ(rest.out, whole.out);
  // trails reach back half a second
  const std::string at = std::string(" --from 6 --to 7 -o ") + "'%d.png'" + kSmall;
  ASSERT_EQ(obscura("render scene.toml" + at).exit, 0);
  shell("mkdir one && mv *.png one && mkdir two");
  const Outcome from = obscura("render scene.toml --from-checkpoint " + kept + "5.checkpoint" + at);
  ASSERT_EQ(from.exit, 0) << from.err;
  shell("mv *.png two");
  EXPECT_EQ(all_of(path("one")), all_of(path("two")));

  const Outcome late = obscura("states scene.toml --at 1 --from-checkpoint " + kept + "5.checkpoint");
  EXPECT_EQ(late.exit, 2);
  EXPECT_NE(late.err.find("is of t = 5 s"), std::string::npos) << late.err;
}

// after an event that is no whole step, in every mode
TEST_F(Checkpoints, AfterAnEventWithinAStepGoOnToo) {
  for (const char* const mode : {"contact", "event"}) {
    scene(std::string("duration = 0.6\n[room]\nsize = [6, 4]\n[physics]\ncollision = \"") + mode +
          "\"\n[[particle]]\nname = \"a\"\nposition = [2, 2.5]\n[[when]]\ntime = 0.333\n"
          "do = [{ set = \"a.velocity\", to = [1, 1] }]\n");
    const Outcome film =
        obscura(std::string("render scene.toml -o film.mp4 --checkpoint-every 0.5") + kSmallest);
    ASSERT_EQ(film.exit, 0) << film.err;
    const Outcome on = obscura(
        "states scene.toml --at 0.6 --from-checkpoint film.mp4.checkpoints/0.5.checkpoint --set "
        "physics.rate=120");
    ASSERT_EQ(on.exit, 0) << mode << ": " << on.err;
    EXPECT_EQ(on.out, obscura("states scene.toml --at 0.6 --set physics.rate=120").out) << mode;
  }
}

TEST_F(Checkpoints, ThatAreDamagedOrForeignAreRefusedWithTheReason) {
  scene(kRoom);
  ASSERT_EQ(obscura(std::string("render scene.toml -o film.mp4 --checkpoint-every 1 --to 3") + kSmall).exit,
            0);
  const std::string file = "film.mp4.checkpoints/2.checkpoint";
  const std::string bytes = contents(path(file));
  const auto refused = [&](const std::string& with, const std::string& why) {
    const Outcome outcome = obscura("states scene.toml --at 3 --from-checkpoint " + with);
    EXPECT_EQ(outcome.exit, 4) << with;
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  for (const std::size_t at : {std::size_t(60), bytes.size() / 2, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] = char(damaged[at] ^ 1);
    scene(damaged, "damaged");
    refused("damaged", "damaged checkpoint");
  }
  scene(bytes.substr(0, bytes.size() - 9), "short");
  refused("short", "damaged checkpoint");
  refused("scene.toml", "is no checkpoint");
  // found by fuzzing: of another version that has a line's end in its name
  auto of = nlohmann::json::from_cbor(bytes.substr(bytes.find('\n') + 1));
  of["version"] = "0.2\n\x1b[2J";
  const std::vector<std::uint8_t> cbor = nlohmann::json::to_cbor(of);
  const std::string body(cbor.begin(), cbor.end());
  scene("obscura checkpoint 1 " + hash(body) + "\n" + body, "later");
  refused("later", "is of obscura 0.2  [2J, and this is ");
  refused("nobody", "cannot be read");
  refused(file + " --set ball.mass=2", "is of another scene: there ball.mass is not said, and here 2");
  // what only the picture knows may be another
  EXPECT_EQ(obscura("states scene.toml --at 3 --from-checkpoint " + file + " --set duration=12").exit, 0);
}

}  // namespace
}  // namespace obscura::app
