// What a machine refuses, and what a scene of a few bytes asks for: one line and exit code 4, and no crash.

#include <algorithm>
#include <map>

#include "../app/program.h"
#include "where.h"

namespace obscura::app {
namespace {

namespace fs = std::filesystem;

class Limits : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    scene(kCrateAndBall);
  }

  // how a run that fails ends: this exit code, one line that has these words, nothing else in the folder
  void expect_refused(const Outcome& outcome, int exit, const std::string& words) const {
    EXPECT_EQ(outcome.exit, exit) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }

  // what lies in the folder under a final name
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string name = fs::relative(entry.path(), folder_).string();
      if (entry.is_regular_file() && name.find(".parts/") == std::string::npos && name != "scene.toml" &&
          name != ".stderr")
        names.push_back(name);
    }
    return names;
  }
};

const std::string kRun = OBSCURA_NOT_FOR_EVER OBSCURA_BINARY " ";

TEST_F(Limits, AFileThatMayNotGrowIsAnErrorAndNoSignal) {
  // SIGXFSZ kills who does not look out; a block is 512 bytes
  for (const char* command : {"render scene.toml --size 64x36 --fps 5 --progress none -o a.mp4",
                              "render scene.toml --at 0.5 --size 64x36 --progress none -o a.png",
                              "figure scene.toml -o a.svg", "export scene.toml -o a.glb"}) {
    expect_refused(shell("ulimit -f 1; " + kRun + command), 4, "a.");
    EXPECT_EQ(left(), std::vector<std::string>{}) << command;
  }
  const Outcome out = shell("ulimit -f 1; " + kRun + "states scene.toml --every 0.1 > states.json");
  expect_refused(out, 4, "standard output");
}

TEST_F(Limits, AFullStandardOutputIsNoSuccess) {
  for (const char* command : {"states scene.toml", "check scene.toml", "docs keys", "docs schema",
                              "render scene.toml --pipe rgba --size 64x36 --progress none -o -"}) {
    const Outcome run = shell(kRun + command + " > /dev/full");
    EXPECT_EQ(run.exit, 4) << command << "\n" << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
  // who reads no more has read enough
  EXPECT_EQ(shell("{ " + kRun + "docs schema; echo $? > code; } | true; cat code").out, "0\n");
}

TEST_F(Limits, ADiskThatIsFullIsAnError) {
  if (shell("mkdir disk && mount -t tmpfs -o size=16k none disk").exit != 0)
    GTEST_SKIP() << "a small disk can be mounted by root alone";
  const Outcome run = shell(kRun + "render scene.toml --size 320x180 --progress none -o disk/a.mp4");
  const bool there = fs::exists(path("disk/a.mp4"));
  shell("umount disk");
  expect_refused(run, 4, "disk/a.mp4");
  EXPECT_FALSE(there);
}

TEST_F(Limits, AFolderThatIsNoneOrGoesAwayIsAnError) {
  shell("touch file");
  expect_refused(shell(kRun + "render scene.toml --size 64x36 -o file/a.mp4"), 4, "file");
  // it goes away where the fifth picture is placed: the program stands still until it is gone
  const Outcome run =
      shell(meeting("STOP", 5, "rename") +
            "render scene.toml --size 64x36 --fps 30 --progress none -o 'out/{frame}.png' & pid=$!; " +
            until_stopped("$pid") + "mv out away; kill -CONT $pid; wait $pid");
  expect_refused(run, 4, "out/");
}

TEST_F(Limits, AMissingCodecIsToldBeforeAnythingIsSimulated) {
  // a run of days
  expect_refused(
      shell(kRun + "render scene.toml --set duration=1e6 --set physics.rate=1e6 --codec none -o a.mp4 "
                   "--progress none"),
      4, "none");
}

TEST_F(Limits, SignalsEndItAndTheSecondAtOnce) {
  for (const std::string signal : {"INT", "TERM", "HUP"}) {
    // when its twelfth file is placed: two or three a take, in whichever order
    const std::string film =
        "render scene.toml --set duration=60 --size 64x36 --fps 5 --progress none -o out/a.mp4";
    const Outcome once = shell(meeting(signal, 12, "rename") + film);
    EXPECT_EQ(once.exit, 130) << signal << once.err;
    EXPECT_FALSE(fs::exists(path("out/a.mp4"))) << signal;
    EXPECT_TRUE(fs::exists(path("out/a.partial.mp4"))) << signal;
    shell("rm -rf out");
    // the second, at what is placed after it, ends it as signals end programs: nothing is put together any
    // more
    const Outcome twice = shell(meeting(signal, 12, "rename", "FAULTS_ON=from") + film);
    EXPECT_NE(twice.exit, 0) << signal;
    EXPECT_FALSE(fs::exists(path("out/a.partial.mp4"))) << signal;
    shell("rm -rf out");
  }
}

#ifndef __SANITIZE_ADDRESS__
TEST_F(Limits, WithoutMemoryItSaysSoAndNeverCrashes) {
  // from where it just starts to where all is well; libraries that do not look are among those refused
  int refused = 0, done = 0;
  std::map<std::string, std::string> right;  // what each writes where there is no limit
  for (int megabytes = 40; megabytes <= 1400; megabytes += megabytes < 400 ? 20 : 200) {
    const std::string limit = "ulimit -v " + std::to_string(megabytes * 1000) + "; ";
    if (shell(limit + OBSCURA_BINARY " docs keys > /dev/null").exit == 127) continue;  // the loader's
    for (const char* command :
         {"render scene.toml --size 640x360 --fps 10 --progress none -o a.mp4",
          "render scene.toml --at 0.5 -o a.png", "figure scene.toml -o a.pdf", "states scene.toml"}) {
      const auto made = [&] {
        std::string all;
        for (const std::string& name : left())
          if (name != "out") all += contents(path(name));
        return all;
      };
      if (!right.contains(command)) {
        ASSERT_EQ(shell(kRun + command + " > out").exit, 0);
        right[command] = made();
        shell("rm -f a.*");
      }
      const Outcome run = shell(limit + kRun + command + " > out");
      ASSERT_TRUE(run.exit == 0 || run.exit == 4)
          << megabytes << " MB, " << command << ": exit " << run.exit << "\n"
          << run.err;
      ++(run.exit == 0 ? done : refused);
      ASSERT_EQ(made(), run.exit == 0 ? right.at(command) : "") << megabytes << " MB, " << command;
      shell("rm -f a.*");
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(done, 0);
}

TEST_F(Limits, AFewBytesCannotAskForMoreMemoryThanTheyMayHave) {
  const std::pair<const char*, int> scenes[] = {
      {"[[ball]]\nposition = [1, 1]\ncopies = { count = 1000000000 }", 3},
      {"[[ball]]\nposition = [1, 1]\ncopies = { count = [1000000, 1000000, 1000000, 1000000] }", 3},
      {"[physics]\ncollision = \"handout\"\n[[particle]]\nposition = [1, 1]\ncopies = { count = 1000000 }",
       4},
      {"[film]\nsize = [16384, 16384]\n[[ball]]\nposition = [1, 1]", 4},
      {"duration = 1e6\n[film]\nfps = 1000\n[[ball]]\nposition = [1, 1]", 4},
  };
  for (const auto& [text, exit] : scenes) {
    scene(text, "few.toml");
    const char* command = exit == 4 && std::string(text).find("fps") != std::string::npos
                              ? "export few.toml --memory-limit 300MB"
                              : "render few.toml --to 1000 --memory-limit 300MB --progress none";
    const Outcome run = shell(kRun + command);
    EXPECT_EQ(run.exit, exit) << text << "\n" << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.err.find("300.0 MB") != std::string::npos, exit == 4) << run.err;
  }
}

TEST_F(Limits, AHundredThousandBodiesAreCheckedInAGigabyte) {
  shell(
      "awk 'BEGIN { print \"[room]\\nsize = [100, 100]\"; for (i = 0; i < 100000; ++i) "
      "printf \"[[ball]]\\nradius = 0.1\\nposition = [%g, %g]\\n\", 0.2 + 0.3 * (i % 317), "
      "0.2 + 0.3 * int(i / 317) }' > tables.toml");
  scene(
      "[room]\nsize = [100, 100]\n[[box]]\nsize = [0.2, 0.2]\nposition = [0.2, 0.2]\n"
      "copies = { count = [400, 250], offset = [[0.24, 0], [0, 0.24]] }",
      "plane.toml");
  scene(
      "[room]\nsize = [100, 100, 100]\n[[ball]]\nradius = 0.1\nposition = [-40, 0.2, -40]\n"
      "copies = { count = [50, 50, 40], offset = [[0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]] }",
      "space.toml");
  // the direct solver lists couples: of points there are those with the walls alone
  scene(
      "[room]\nsize = [100, 100]\n[physics]\nsolver = \"direct\"\n[[particle]]\nposition = [0.2, 0.2]\n"
      "copies = { count = [400, 250], offset = [[0.24, 0], [0, 0.24]] }",
      "direct.toml");
  for (const std::string name : {"tables", "plane", "space", "direct"}) {
    const Outcome run = shell(OBSCURA_BINARY " check --memory-limit 1GB " + name + ".toml");
    EXPECT_EQ(run.exit, 0) << name << "\n" << run.err;
    EXPECT_NE(run.out.find("100000"), std::string::npos) << run.out;
  }
}

TEST_F(Limits, EveryCommandHoldsToAMemoryLimit) {
  for (const char* command : {"render", "join", "figure", "new", "check", "states", "sweep", "submit",
                              "export", "compare", "verify", "golden", "docs"})
    EXPECT_NE(obscura(std::string(command) + " --help").out.find("--memory-limit"), std::string::npos)
        << command;
  // two pictures of 16 MB each
  for (const char* at : {"0", "1"})
    ASSERT_EQ(
        obscura(std::string("render scene.toml --size 2000x2000 --at ") + at + " -o " + at + ".png").exit, 0);
  for (const char* command : {"compare 0.png 1.png", "golden scene.toml"}) {
    const Outcome run = shell(kRun + command + " --memory-limit 30MB");
    EXPECT_EQ(run.exit, 4) << command << "\n" << run.err;
    // of a picture that cannot be read its need is told, of all else the limit
    EXPECT_TRUE(run.err.find("30.0 MB") != run.err.npos ||
                run.err.find("pixels need 16.0 MB") != run.err.npos)
        << command << "\n"
        << run.err;
  }
}

TEST_F(Limits, APictureTooLargeToBeReadSaysWhatItNeeds) {
  // as large as its head says, and never read so far that what follows would have to be right
  const auto number = [](std::uint32_t n) {
    return std::string{char(n >> 24), char(n >> 16), char(n >> 8), char(n)};
  };
  const auto chunk = [&](const std::string& name, const std::string& bytes) {
    std::uint32_t crc = ~0u;
    for (const char c : name + bytes) {
      crc ^= static_cast<unsigned char>(c);
      for (int i = 0; i < 8; ++i) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
    }
    return number(std::uint32_t(bytes.size())) + name + bytes + number(~crc);
  };
  const std::string head = number(30000) + number(30000) + std::string("\1\0\0\0\0", 5);  // a bit a pixel
  for (const std::string name : {"a", "b"})
    std::ofstream(path(name + ".png"), std::ios::binary)
        << "\x89PNG\r\n\x1A\n"
        << chunk("IHDR", head) << chunk("IDAT", std::string(150'000, name[0]));
  expect_refused(shell(kRun + "compare a.png b.png --memory-limit 1GB"), 4,
                 "a.png: its 30000 x 30000 pixels need 3.60 GB of memory");
}
#endif

TEST_F(Limits, SizesOfMemoryAreReadOrRefused) {
  for (const char* good : {"2GB", "500MB", "1.5GiB", "3000000000", "1T", "900 MB"})
    EXPECT_EQ(obscura(std::string("check scene.toml --memory-limit '") + good + "'").exit, 0) << good;
  for (const char* bad : {"", "GB", "-1GB", "2XB", "2GBs", "nan", "1e40"})
    EXPECT_EQ(obscura(std::string("check scene.toml --memory-limit '") + bad + "'").exit, 2) << bad;
}

TEST_F(Limits, WhatTakesLongSaysSoOnATerminalAndNowhereElse) {
  if (shell("command -v script").exit != 0) GTEST_SKIP() << "there is no terminal to be had";
  // two that wait for what is written into pipes, until the one on a terminal has said so
  const Outcome run =
      shell("mkfifo one two; script -qfec '" OBSCURA_BINARY
            " check one' log < /dev/null > /dev/null & a=$!; " OBSCURA_BINARY
            " check two > out 2> err & b=$!; exec 3> one 4> two; "
            "for i in $(seq 12000); do grep -q 'check  reading one' log && break; sleep 0.1; done; "
            "cat scene.toml >&3; cat scene.toml >&4; exec 3>&- 4>&-; wait $a && wait $b");
  EXPECT_EQ(run.exit, 0) << run.err;
  const std::string log = contents(path("log"));
  EXPECT_NE(log.find("check  reading one"), std::string::npos) << log;
  EXPECT_NE(log.find("one: good"), std::string::npos) << log;
  EXPECT_NE(contents(path("out")).find("two: good"), std::string::npos);
  EXPECT_EQ(contents(path("err")), "");
}

TEST_F(Limits, ALongFilmIsAnnouncedAndAShortOneIsNot) {
  const Outcome check = obscura("check scene.toml --set duration=100000");
  EXPECT_EQ(check.exit, 0) << check.err;
  EXPECT_NE(check.out.find("6000000 frames"), std::string::npos) << check.out;
  for (const char* word : {"disk     about", "memory   about", "takes    about", "an estimate"})
    EXPECT_NE(check.out.find(word), std::string::npos) << word;
  const Outcome film =
      shell(meeting("INT", 1) + "render scene.toml --set duration=100000 --size 64x36 -o out/a.mp4");
  EXPECT_NE(film.err.find("6000000 frames, about"), std::string::npos) << film.err;
  EXPECT_EQ(obscura("render scene.toml --frames 0 --size 64x36 -o b.mp4").err.find("estimate"),
            std::string::npos);
}

}  // namespace
}  // namespace obscura::app
