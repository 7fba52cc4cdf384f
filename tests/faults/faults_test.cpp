// Every call that writes fails once, or from then on: nobody is told of a success that is none, and nothing
// wrong stands under a final name.

#include <algorithm>
#include <cstdlib>
#include <map>

#include "../app/program.h"
#include "where.h"

namespace obscura::app {
namespace {

namespace fs = std::filesystem;

/// A way of failing: with what, whether all after it fails too, which calls, and whether the program must
/// come through.
struct Way {
  const char* name;
  const char* with;
  bool on;
  const char* calls;
  bool harmless;
};

// what a full disk refuses, what a broken one does, what a signal interrupts, and what may write less
constexpr Way kFull{"a full disk", "ENOSPC", true, "write,fsync,open,mkdir,ftruncate,rename,close", false};
constexpr Way kBroken{"a broken disk", "EIO", false, "write,fsync,open,mkdir,ftruncate,rename,close,unlink",
                      false};
constexpr Way kInterrupted{"a signal", "EINTR", false, "write,fsync,open,ftruncate,close", true};
constexpr Way kShort{"short writes", "short", false, "write", true};
constexpr Way kAllShort{"short writes all the way", "short", true, "write", true};

using Files = std::map<std::string, std::string>;

/// What a command writes under out/, and its walk through all faults.
class Faults : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(std::string(kCrateAndBall) + "[golden]\nat = [0, 0.5]\nsize = [64, 36]\n");
  }

  std::string out() const { return path("out"); }

  // what lies in out/ under final names; what is on its way there is left out
  Files files() const {
    Files all;
    if (!fs::exists(out())) return all;
    for (const auto& entry : fs::recursive_directory_iterator(out())) {
      const std::string name = fs::relative(entry.path(), out()).string();
      if (entry.is_regular_file() && name.find(".parts/") == std::string::npos &&
          name.find(".partial.") == std::string::npos)
        all[name] = contents(entry.path().string());
    }
    return all;
  }

  Outcome run(const std::string& command, const Way& way, long n) const {
    return shell("FAULTS_UNDER='" + out() + "' FAULTS_LOG='" + path("log") + "' FAULTS_WITH=" + way.with +
                 " FAULTS_CALLS=" + way.calls + " FAULTS_NTH=" + std::to_string(n) +
                 (way.on ? " FAULTS_ON=from" : "") +
                 " ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0 LD_PRELOAD=" OBSCURA_FAULTS
                 " " OBSCURA_NOT_FOR_EVER OBSCURA_BINARY " " +
                 command);
  }

  /// Walks n = 1, 2, ... until no fault fires; by strides of 13 beyond the first, but for
  /// OBSCURA_TEST_FAULTS=all. `again`: what repairs a failed run; empty: the command itself.
  /// `over`: it writes over an earlier file.
  void walk(const std::string& command, const Way& way, const std::string& again, bool over) {
    fs::remove_all(out());
    ASSERT_EQ(obscura(command).exit, 0);
    const Files right = files();
    ASSERT_FALSE(right.empty());

    long n = 1;
    const char* asked = std::getenv("OBSCURA_TEST_FAULTS");
    const long stride = asked && std::string(asked) == "all" ? 1 : 13;
    for (bool fired = true; fired; n += n < 3 ? 1 : stride) {
      ASSERT_LT(n, 2000) << "there is no end to it";
      // an earlier file is there in every second run: where there is none, folders are made
      Files before;
      fs::remove_all(out());
      if (over && n % 2 == 0) {
        for (const auto& [name, bytes] : right) {
          fs::create_directories(fs::path(out() + "/" + name).parent_path());
          std::ofstream(out() + "/" + name) << "what was there before";
          before[name] = "what was there before";
        }
      }
      fs::remove(path("log"));
      const Outcome outcome = run(command, way, n);
      fired = fs::exists(path("log"));
      walked_ += fired;
      const std::string what = std::string(way.name) + ", call " + contents(path("log")).substr(0, 40) +
                               "exit " + std::to_string(outcome.exit) + ": " + outcome.err;
      const bool unlinked = contents(path("log")).find("unlink") != std::string::npos;

      const Files after = files();
      if (way.harmless || !fired) {
        ASSERT_EQ(outcome.exit, 0) << what;
      }
      if (outcome.exit == 0) {
        for (const auto& [name, bytes] : right)
          ASSERT_TRUE(after.contains(name) && after.at(name) == bytes) << name << " is not right: " << what;
        ASSERT_TRUE(unlinked || after.size() == right.size()) << what;
        ASSERT_TRUE(unlinked || outcome.err.empty()) << what;
      } else {
        ASSERT_EQ(outcome.exit, 4) << what;
        // `golden` tells of its files in its table
        const bool table = command.starts_with("golden ") && outcome.err.empty();
        const std::string& told = table ? outcome.out : outcome.err;
        ASSERT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), table ? 0 : 1) << what;
        ASSERT_NE(told.find("out"), std::string::npos) << "names no path: " << what;
        for (const auto& [name, bytes] : after) {
          ASSERT_TRUE(unlinked || right.contains(name)) << name << " is left: " << what;
          if (!right.contains(name)) continue;
          ASSERT_TRUE(bytes == right.at(name) || (before.contains(name) && bytes == before.at(name)))
              << name << " is wrong: " << what;
        }
        for (const auto& [name, bytes] : before) ASSERT_TRUE(after.contains(name)) << name << ": " << what;
        // what is left over is in nobody's way; a quarter of the runs is tried
        if (n % 4 != 1) continue;
        if (!over) fs::remove_all(out());
        // of more than a minute of work nothing is thrown away: a slow machine has not worked for longer
        for (const auto& entry : fs::recursive_directory_iterator(folder_))
          if (entry.path().filename() == "seconds") std::ofstream(entry.path()) << "0";
        const Outcome repaired = obscura(again.empty() ? command : again);
        ASSERT_EQ(repaired.exit, 0) << "again: " << repaired.err << what;
        const Files then = files();
        for (const auto& [name, bytes] : right)
          ASSERT_TRUE(then.contains(name) && then.at(name) == bytes) << "again: " << name << ": " << what;
      }
    }
    // the walk is one: some call was met
    EXPECT_GT(n, 2) << way.name << " never came";
  }

  void walk_all(const std::string& command, const std::string& again = "", bool over = true) {
    for (const Way& way : {kFull, kBroken, kInterrupted, kShort, kAllShort}) {
      walk(command, way, again, over);
      if (HasFatalFailure()) return;
    }
    RecordProperty("faults", int(walked_));
    std::printf("%ld faults\n", walked_);
  }

  long walked_ = 0;
};

// two closed segments, or so many pictures
constexpr const char* kFilm = "--size 64x36 --fps 5 --set duration=2 --progress none";

TEST_F(Faults, AMovieIsRightOrIsNotThere) {
  const std::string film = std::string("render scene.toml -o out/deep/a.mp4 ") + kFilm;
  walk_all(film, film + " --resume");
}

TEST_F(Faults, AMatroskaIsRightOrIsNotThere) {
  walk_all(std::string("render scene.toml -o out/a.mkv ") + kFilm);
}

TEST_F(Faults, AGifIsRightOrIsNotThere) { walk_all(std::string("render scene.toml -o out/a.gif ") + kFilm); }

TEST_F(Faults, EachPictureIsRightOrIsNotThere) {
  const std::string film = std::string("render scene.toml -j 1 -o 'out/{frame}.png' ") + kFilm;
  walk_all(film, film + " --resume");
}

TEST_F(Faults, AStillIsRightOrIsNotThere) {
  walk_all("render scene.toml --at 0.5 --size 64x36 --progress none -o out/a.png");
}

TEST_F(Faults, AFigureIsRightOrIsNotThere) {
  walk_all("figure scene.toml -o out/a.svg");
  if (HasFatalFailure()) return;
  walk_all("figure scene.toml -o out/a.pdf");
}

TEST_F(Faults, AnExportIsRightOrIsNotThere) { walk_all("export scene.toml -o out/a.glb"); }

TEST_F(Faults, ReferencesAreRightOrAreNotThere) {
  walk_all("golden scene.toml --references out --update -j 1", "", false);
}

TEST_F(Faults, ANewSceneIsRightOrIsNotThere) { walk_all("new out/a.toml", "", false); }

}  // namespace
}  // namespace obscura::app
