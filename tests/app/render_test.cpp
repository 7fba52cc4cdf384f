// The path from scene to movie, run as a user runs it and read back by other programs.

#include <unistd.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "media/png.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

namespace fs = std::filesystem;
using Render = Program;

nlohmann::json origin(const std::string& png) {
  return nlohmann::json::parse(media::read_png(png).tags.at("obscura"));
}

TEST_F(Render, TenSecondsHaveTheFramesThatEveryRateAsks) {
  scene(kRoom);
  const std::pair<const char*, int> rates[] = {{"24", 240}, {"25", 250}, {"30", 300},
                                               {"50", 500}, {"60", 600}, {"30000/1001", 300}};
  for (const auto& [fps, frames] : rates) {
    const Outcome run =
        obscura(std::string("render scene.toml -o a.mp4 --size 96x54 --progress none --fps ") + fps);
    ASSERT_EQ(run.exit, 0) << run.err;
    const Outcome probe = shell(
        "ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames,r_frame_rate "
        "-of csv=p=0 a.mp4");
    const std::string rate = std::string(fps).find('/') == std::string::npos ? std::string(fps) + "/1" : fps;
    EXPECT_EQ(probe.out, rate + "," + std::to_string(frames) + "\n");
  }
}

TEST_F(Render, TheStateAtFiveSecondsIsOneForAllRatesSizesAndCameras) {
  scene(kRoom);
  std::string hash;
  const auto expect_same = [&](const std::string& png) {
    const auto json = origin(path(png));
    EXPECT_EQ(json["time"], "5") << png;
    if (hash.empty()) hash = json["state"];
    EXPECT_EQ(json["state"], hash) << png;
  };
  for (const int fps : {24, 25, 30, 50, 60}) {
    const std::string n = std::to_string(5 * fps);
    const Outcome run = obscura("render scene.toml --size 96x54 --progress none --fps " +
                                std::to_string(fps) + " --frames 0.." + n + " -o 'f/{frame}.png'");
    ASSERT_EQ(run.exit, 0) << run.err;
    expect_same("f/" + n + ".png");
  }
  // at 30000/1001 no frame falls on it: a still does, after frames that lie between steps
  ASSERT_EQ(
      obscura("render scene.toml --size 100x80 --fps 30000/1001 --at 5 -o s.png -j 1 --theme screen").exit,
      0);
  expect_same("s.png");
  const auto states = nlohmann::json::parse(obscura("states scene.toml --at 0.0333333,1.7,5").out);
  EXPECT_EQ(states["states"][2]["hash"], hash);
}

TEST_F(Render, ADraftTakesPresetsOnlyWhereThereAreSome) {
  scene(kCrateAndBall);
  for (const char* out : {"a.webm", "a.mp4", "a.gif", "a.mkv"}) {
    const Outcome run =
        obscura(std::string("render scene.toml --draft --size 96x54 --to 0.2 --progress none -o ") + out);
    EXPECT_EQ(run.exit, 0) << run.err;
  }
  ASSERT_EQ(obscura("render scene.toml --preset ultrafast --fps 30 --size 96x54 --to 0.2 -o b.mp4").exit, 0);
  EXPECT_EQ(contents(path("a.mp4")), contents(path("b.mp4")));
  // one that was given is still told
  const Outcome run = obscura("render scene.toml --draft --preset slow --size 96x54 -o b.webm");
  EXPECT_EQ(run.exit, 4);
  EXPECT_NE(run.err.find("presets are those of libx264 and libx265"), std::string::npos) << run.err;
}

// Workers draw with copies of OSMesa in memory, which count as files: where they may not be so large, workers
// share one.
TEST_F(Render, FilesThatMayNotBeLargeAreNoLimitOnWorkers) {
  scene(kCrateAndBall);
  for (const char* blocks : {"200", "2000", "20000"}) {
    const Outcome run =
        shell(std::string("ulimit -f ") + blocks +
              "; " OBSCURA_BINARY " render scene.toml --size 96x54 --fps 10 -j 2 -o 'a/{frame:02}.png'");
    EXPECT_EQ(run.exit, 0) << blocks << run.err;
  }
}

TEST_F(Render, TwiceGivesTheSameBytesOnOneWorkerAndThree) {
  scene(kRoom);
  for (const char* flags : {"a.mp4 -j 1", "b.mp4 -j 3", "c.mp4 -j 3"}) {
    ASSERT_EQ(
        obscura(std::string("render scene.toml --to 3 --size 320x180 --fps 30 --progress none -o ") + flags)
            .exit,
        0);
  }
  EXPECT_GT(contents(path("a.mp4")).size(), 1000u);
  EXPECT_EQ(contents(path("a.mp4")), contents(path("b.mp4")));
  EXPECT_EQ(contents(path("b.mp4")), contents(path("c.mp4")));
  for (const char* flags : {"p/%04d.png -j 1", "q/%04d.png -j 3"}) {
    ASSERT_EQ(
        obscura(std::string("render scene.toml --from 2 --to 3 --size 320x180 --fps 30 --progress none -o ") +
                flags)
            .exit,
        0);
  }
  int pictures = 0;
  for (const auto& entry : fs::directory_iterator(path("p"))) {
    EXPECT_EQ(contents(entry.path().string()), contents(path("q/" + entry.path().filename().string())));
    ++pictures;
  }
  EXPECT_EQ(pictures, 30);
}

TEST_F(Render, DecodedFramesAgreeWithThePictures) {
  // luma PSNR at least 45 dB and mean bias under half a level: the bars, at CRF 18
  scene(kRoom);
  ASSERT_EQ(
      obscura("render scene.toml --from 1 --to 2 --size 640x360 --fps 10 --progress none -o m.mp4").exit, 0);
  ASSERT_EQ(
      obscura(
          "render scene.toml --from 1 --to 2 --size 640x360 --fps 10 --progress none -o 'f/{frame:02}.png'")
          .exit,
      0);
  ASSERT_EQ(
      shell("mkdir d && ffmpeg -v error -i m.mp4 -sws_flags accurate_rnd+full_chroma_int+bitexact "
            "-vf scale=in_color_matrix=bt709:in_range=limited -pix_fmt rgb24 -start_number 10 d/%02d.png")
          .exit,
      0);
  for (int n = 10; n < 20; ++n) {
    const std::string name = std::to_string(n) + ".png";
    const media::Image a = media::read_png(path("f/" + name)).image,
                       b = media::read_png(path("d/" + name)).image;
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    double squares = 0, bias[3] = {0, 0, 0};
    const double luma[3] = {0.2126, 0.7152, 0.0722};
    const std::size_t pixels = a.pixels.size() / 4;
    for (std::size_t i = 0; i < pixels; ++i) {
      double y = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double d = double(b.pixels[4 * i + c]) - a.pixels[4 * i + c];
        bias[c] += d;
        y += luma[c] * d;
      }
      squares += y * y;
    }
    EXPECT_GE(10 * std::log10(255 * 255 / (squares / double(pixels))), 45) << name;
    for (const double sum : bias) EXPECT_LT(std::abs(sum / double(pixels)), 0.5) << name;
  }
}

TEST_F(Render, APictureAndAMovieCarryTheirOrigin) {
  scene(kRoom);
  ASSERT_EQ(obscura("render scene.toml --at 1.25 --size 160x90 -o s.png --set ball.elasticity=0.5").exit, 0);
  const auto json = origin(path("s.png"));
  EXPECT_EQ(json["scene"]["text"], kRoom);
  EXPECT_EQ(json["scene"]["set"][0], "ball.elasticity=0.5");
  EXPECT_EQ(json["time"], "5/4");
  EXPECT_EQ(json["frame"], 75);
  EXPECT_EQ(json["state"].get<std::string>().size(), 32u);
  EXPECT_NE(json["gl"]["version"].get<std::string>().find("Mesa"), std::string::npos);
  ASSERT_EQ(obscura("render scene.toml --to 1 --size 160x90 -o m.mp4 --progress none").exit, 0);
  const Outcome probe = shell("ffprobe -v error -show_entries format_tags=comment -of json m.mp4");
  EXPECT_NE(probe.out.find("scene_hash") != std::string::npos || probe.out.find("hash") != std::string::npos,
            false);
  EXPECT_NE(probe.out.find("everything moves"), std::string::npos);
}

TEST_F(Render, AStreamGoesThroughAPipeAndAClosedPipeEndsItQuietly) {
  scene(kRoom);
  const std::string binary = OBSCURA_BINARY;
  const Outcome frames =
      shell(binary +
            " render scene.toml -o - --to 1 --size 96x54 --fps 30 --progress none | "
            "ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 -");
  EXPECT_EQ(frames.out, "30\n") << frames.err;
  const Outcome raw = shell(
      binary + " render scene.toml -o - --pipe rgba --to 1 --size 96x54 --fps 30 --progress none | wc -c");
  EXPECT_EQ(std::stol(raw.out), 30L * 96 * 54 * 4);
  const Outcome closed = shell("{ " + binary +
                               " render scene.toml -o - --size 640x360 --progress none ; echo $? > code ; } "
                               "| head -c 100 > /dev/null");
  EXPECT_EQ(contents(path("code")), "0\n");
  EXPECT_EQ(closed.err, "");
}

TEST_F(Render, AnInterruptLeavesAPlayablePartialMovie) {
  scene(kRoom);
  // when its twelfth file is placed: two or three a take, in whichever order
  const Outcome run =
      shell(meeting("INT", 12, "rename") +
            "render scene.toml -o out/m.mp4 --set duration=200 --size 160x90 --fps 30 --progress "
            "json");
  EXPECT_EQ(run.exit, 130);
  EXPECT_FALSE(fs::exists(path("out/m.mp4")));
  ASSERT_TRUE(fs::exists(path("out/m.partial.mp4"))) << run.err;
  EXPECT_EQ(shell("ffmpeg -v error -i out/m.partial.mp4 -f null -").err, "");
  int others = 0;
  for (const auto& entry : fs::directory_iterator(path("out")))
    others += entry.is_regular_file() && entry.path().filename().string().find(".mp4") != std::string::npos;
  EXPECT_EQ(others, 1);
  // and what --resume goes on from
  EXPECT_TRUE(fs::is_directory(path("out/m.mp4.parts")));
}

TEST_F(Render, AnInterruptEndsAFrameThatTakesForever) {
  // half a million steps a second of film: the first frame after t = 0 is minutes away. The signal comes when
  // the program has worked for a second, which is past its start, however long that takes here
  scene(kRoom);
  const std::string interrupted =
      " & pid=$!; " + until_heeding("$pid") +
      until("$pid", "[ $(cut -d ' ' -f 14 /proc/$pid/stat) -ge $(getconf CLK_TCK) ]") + "kill -";
  const Outcome run =
      shell("env --default-signal=INT " OBSCURA_BINARY
            " render scene.toml -o far.png --at 100000 --set physics.rate=500000 --progress none" +
            interrupted + "INT $pid; wait $pid");
  EXPECT_EQ(run.exit, 130) << run.err;
  EXPECT_FALSE(std::filesystem::exists(path("far.png")));
  const Outcome states = shell("env --default-signal=TERM " OBSCURA_BINARY
                               " states scene.toml --at 100000 --set physics.rate=500000" +
                               interrupted + "TERM $pid; wait $pid");
  EXPECT_EQ(states.exit, 130);
}

TEST_F(Render, TroubleKeepsTheFramesSoFarAndExitsWithSix) {
  scene(kTorn);
  const Outcome run = obscura("render scene.toml -o m.mp4 --size 96x54 --progress none");
  EXPECT_EQ(run.exit, 6);
  EXPECT_NE(run.err.find("2.828"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("ball"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(path("m.mp4")));
}

TEST_F(Render, WritesOverAnEarlierRenderUnlessToldNot) {
  scene(kRoom);
  ASSERT_EQ(obscura("render scene.toml --at 0 --size 96x54 -o s.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 1 --size 96x54 -o s.png").exit, 0);
  const Outcome refused = obscura("render scene.toml --at 2 --size 96x54 -o s.png --no-overwrite");
  EXPECT_EQ(refused.exit, 4);
  EXPECT_NE(refused.err.find("s.png"), std::string::npos);
  EXPECT_EQ(origin(path("s.png"))["time"], "1");
}

TEST_F(Render, WithoutAnOutputItIsUnderRenderOut) {
  scene(kRoom);
  const Outcome run = obscura("render scene.toml --to 0.2 --size 96x54");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_TRUE(fs::exists(path("render_out/scene.mp4")));
  EXPECT_NE(run.out.find("render_out/scene.mp4"), std::string::npos);
}

TEST_F(Render, BadInputGetsOneLineAndItsCodeAndWritesNothing) {
  scene(kRoom);
  const std::pair<const char*, int> cases[] = {
      {"render", 2},
      {"render scene.toml --size 10", 2},
      {"render scene.toml --fps 0", 2},
      {"render scene.toml --frames 9999 -o x.mp4", 2},
      {"render scene.toml -o x.png", 2},
      {"render scene.toml --nonsense", 2},
      {"render scene.toml --at -1", 2},
      {"rendr scene.toml", 2},
      {"render scene.toml --transparent -o x.mp4", 2},
      {"render missing.toml", 3},
      {"render scene.toml --set nonsense.key=1", 3},
      {"render scene.toml -o x.xyz", 2},
      {"render scene.toml --size 101x75 -o x.mp4", 4},
      {"render scene.toml --codec nonsense -o x.mp4", 4},
      {"render scene.toml -o /proc/x/y.mp4", 4},
      {"render scene.toml --size 20000x16 --at 0 -o x.png", 5},
  };
  for (const auto& [arguments, code] : cases) {
    const Outcome run = obscura(arguments);
    EXPECT_EQ(run.exit, code) << arguments << "\n" << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << arguments << "\n" << run.err;
    EXPECT_EQ(run.out, "") << arguments;
  }
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "scene.toml" || name == ".stderr") << name;
  }
}

TEST_F(Render, GoesOnWhenNobodyReadsItsWordsAnyMore) {
  scene(kRoom);
  const std::string binary = OBSCURA_BINARY;
  shell(
      "{ " + binary +
      " render scene.toml --to 0.5 --size 96x54 -o m.mp4 --progress plain 2>&1 ; echo $? > code ; } | true");
  EXPECT_EQ(contents(path("code")), "0\n");
  EXPECT_TRUE(fs::exists(path("m.mp4")));
}

TEST_F(Render, ADraftDoesNotTakeTheFilmsPlace) {
  scene(kRoom);
  const Outcome run = obscura("render scene.toml --draft --to 0.2");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_TRUE(fs::exists(path("render_out/scene.draft.mp4")));
  EXPECT_FALSE(fs::exists(path("render_out/scene.mp4")));
}

TEST_F(Render, AGifTakesTheNextRateThatGifCanTell) {
  scene(kRoom);
  const Outcome run = obscura("render scene.toml --to 0.5 --size 96x54 -o m.gif");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.err.find("50 frames per second"), std::string::npos);
  EXPECT_EQ(shell("ffprobe -v error -show_entries stream=r_frame_rate -of csv=p=0 m.gif").out, "50/1\n");
}

TEST_F(Render, ProgressForProgramsIsJsonLines) {
  scene(kRoom);
  const Outcome run = obscura("render scene.toml --to 0.5 --size 96x54 --progress json");
  ASSERT_EQ(run.exit, 0);
  EXPECT_EQ(run.out, "");
  std::istringstream lines(run.err);
  nlohmann::json last;
  for (std::string line; std::getline(lines, line);) last = nlohmann::json::parse(line);
  EXPECT_EQ(last["event"], "done");
  EXPECT_EQ(last["frames"], 30);
}

}  // namespace
}  // namespace obscura::app
