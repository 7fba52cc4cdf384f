// What an end that is asked for ends.

#include <gmock/gmock.h>

#include "program.h"

namespace obscura::app {
namespace {

class Interrupt : public Program {
 protected:
  // starts a command that reads `pipe`, waits until it heeds SIGTERM, sends one, and waits for its end while
  // the pipe stays open
  static std::string interrupted_at(const std::string& command) {
    return "mkfifo pipe; " + command + " & p=$!; exec 3>pipe; printf 'what is no scene, nor a table' >&3; " +
           until_heeding("$p") + "kill -TERM $p; wait $p; echo $?";
  }
};

TEST_F(Interrupt, TheFirstSigtermEndsAReadOfAnIdlePipe) {
  for (const char* command : {"check - <pipe", "check pipe", "render scene.toml --states pipe -o a.mp4"}) {
    scene(kCrateAndBall);
    std::filesystem::remove(path("pipe"));
    const Outcome run = shell(interrupted_at(std::string(OBSCURA_BINARY " ") + command));
    EXPECT_EQ(run.out, "130\n") << command << run.err;
    EXPECT_EQ(run.err, "") << command;
  }
}

// a pipe that is closed by what wrote to it, with half a scene, or half a table
TEST_F(Interrupt, AtWhateverMomentOfReadingASignalComesTheEndIsSilent) {
  scene(kCrateAndBall);
  std::filesystem::create_directories(path("out"));
  for (const auto& [command, moments] : {std::pair{"check - <out/pipe", 8},
                                         {"check out/pipe", 9},
                                         {"render scene.toml --states out/pipe -o a.mp4", 9}}) {
    for (const std::string signal : {"TERM", "INT"}) {
      int n = 0;
      for (bool came = true; came;) {
        std::filesystem::remove(path("out/pipe"));
        const Outcome run = shell("mkfifo out/pipe; { printf 'time, half' >out/pipe; } & " +
                                  meeting(signal, ++n, "poll,after-poll,read,after-read,close") + command);
        came = met();
        const std::string when = signal + ", " + contents(path("met")) + command;
        if (!came) {
          EXPECT_THAT(run.exit, testing::AnyOf(3, 4)) << when;
          continue;
        }
        EXPECT_EQ(run.exit, 130) << when;
        EXPECT_EQ(run.err, "") << when;
      }
      // what there is, and the end of it: before and after a wait and a read of each
      EXPECT_GT(n, moments) << command;
    }
  }
}

TEST_F(Interrupt, ASceneIsReadFromAPipeToItsEnd) {
  scene(kCrateAndBall);
  std::string as_file = obscura("states scene.toml --at 0.5").out;
  for (const char* command :
       {"cat scene.toml | " OBSCURA_BINARY " states - --at 0.5",
        "mkfifo pipe; { cat scene.toml >pipe & } ; " OBSCURA_BINARY " states pipe --at 0.5"}) {
    const Outcome run = shell(command);
    EXPECT_EQ(run.exit, 0) << run.err;
    EXPECT_EQ(run.out.substr(run.out.find("\"states\"")), as_file.substr(as_file.find("\"states\"")))
        << command;
  }
}

}  // namespace
}  // namespace obscura::app
