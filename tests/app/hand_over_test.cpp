// What a film is handed over as: with alpha, with a poster, as pages, as a GIF that is small enough.

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "media/movie.h"
#include "media/png.h"
#include "needs.h"
#include "page/page.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

using HandOver = Program;

const std::string kQuarter = " --size 160x90 --fps 20 ";

/// The mean and the largest difference of the alphas of two pictures, levels of 255.
std::pair<double, int> apart(const media::Image& a, const media::Image& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  double sum = 0;
  int most = 0;
  for (std::size_t i = 3; i < std::min(a.pixels.size(), b.pixels.size()); i += 4) {
    const int d = std::abs(int(a.pixels[i]) - int(b.pixels[i]));
    sum += d, most = std::max(most, d);
  }
  return {4 * sum / double(a.pixels.size()), most};
}

/// FFmpeg reads back the alpha of each frame as the PNGs have it. ProRes keeps it without loss, to the level
/// that ten bits round to; VP9 compresses it as it does light.
TEST_F(HandOver, MoviesCarryTheirAlpha) {
  OBSCURA_NEEDS(installed("ffmpeg"), "ffmpeg");
  scene(kCrateAndBall);
  ASSERT_EQ(obscura("render scene.toml --transparent -o 'p/{frame:03}.png'" + kQuarter).exit, 0);
  for (const auto& [file, decoder, mean, most] :
       {std::tuple("f.webm", "-c:v libvpx-vp9", 1.0, 90), std::tuple("f.mov", "", 0.01, 1)}) {
    const Outcome made = obscura("render scene.toml --transparent -o " + std::string(file) + kQuarter);
    ASSERT_EQ(made.exit, 0) << made.err;
    fs::create_directory(path(std::string(file) + ".d"));
    const Outcome read = shell("ffmpeg -v error " + std::string(decoder) + " -i " + file +
                               " -pix_fmt rgba -start_number 0 " + file + ".d/%03d.png");
    ASSERT_EQ(read.exit, 0) << read.err;
    for (const int frame : {0, 7, 19}) {
      const std::string number = std::to_string(1000 + frame).substr(1), name = number + ".png";
      const auto [average, largest] = apart(media::read_png(path("p/" + name)).image,
                                            media::read_png(path(std::string(file) + ".d/" + name)).image);
      EXPECT_LE(average, mean) << file << " " << frame;
      EXPECT_LE(largest, most) << file << " " << frame;
    }
    EXPECT_FALSE(fs::exists(path(std::string(file) + ".d/020.png")));
  }
}

/// Two films of one colour that differ in nothing but alpha.
TEST_F(HandOver, CompareSeesTheAlphaOfAMovie) {
  for (const std::string ending : {".webm", ".mov"}) {
    for (const auto& [name, alpha] : {std::pair("a", 255), {"b", 128}}) {
      const media::MovieSpec spec{.width = 64, .height = 32, .fps_num = 10, .alpha = true};
      const std::string file = path(name + ending);
      media::SegmentEncoder encoder(file, spec);
      media::Image image{64, 32, std::vector<std::uint8_t>(4 * 64 * 32, 100)};
      for (std::size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = std::uint8_t(alpha);
      for (int frame = 0; frame < 3; ++frame) encoder.add(image);
      media::MovieWriter writer(file, spec);
      writer.add(encoder.finish());
      writer.close();
    }
    const Outcome run = obscura("compare --format json a" + ending + " b" + ending);
    EXPECT_EQ(run.exit, 1) << run.out;
    const auto json = nlohmann::json::parse(run.out);
    ASSERT_EQ(json["differing"].size(), 3u) << ending;
    EXPECT_EQ(json["differing"][0]["alpha_only"], true) << ending;
    // to the level that ten bits round to
    EXPECT_NEAR(json["differing"][0]["largest"].get<int>(), 255 - 128, 1) << ending;
  }
}

/// The same bytes from shards.
TEST_F(HandOver, ShardsOfAMovieWithAlphaAreTheMovie) {
  scene(kCrateAndBall);
  for (const std::string file : {"f.webm", "f.mov"}) {
    const std::string film = "render scene.toml --transparent -o " + file + " --set duration=2.5" + kQuarter;
    ASSERT_EQ(obscura(film).exit, 0);
    const std::string whole = contents(path(file));
    fs::remove(path(file));
    for (const char* shard : {"--shard 1/2", "--shard 2/2"}) {
      const Outcome made = obscura(film + shard);
      ASSERT_EQ(made.exit, 0) << made.err;
    }
    ASSERT_EQ(obscura("join " + file).exit, 0);
    EXPECT_TRUE(contents(path(file)) == whole) << file;
    EXPECT_THAT(obscura("verify " + file).out, HasSubstr("movie: the same, byte by byte")) << file;
  }
}

TEST_F(HandOver, ProResIsForOpaqueFilmsToo) {
  OBSCURA_NEEDS(installed("ffprobe"), "ffmpeg");
  scene(kCrateAndBall);
  const Outcome made = obscura("render scene.toml --codec prores -o f.mov" + kQuarter);
  ASSERT_EQ(made.exit, 0) << made.err;
  EXPECT_THAT(shell("ffprobe -v error -show_entries stream=codec_name,nb_frames -of csv f.mov").out,
              HasSubstr("prores,20"));
}

TEST_F(HandOver, OtherMoviesSayWhichHaveAlpha) {
  scene(kCrateAndBall);
  for (const char* file : {"f.mp4", "f.gif", "f.mkv"}) {
    const Outcome made = obscura("render scene.toml --transparent -o " + std::string(file));
    EXPECT_EQ(made.exit, 2) << file;
    EXPECT_THAT(made.err, HasSubstr(".webm (VP9), .mov (ProRes 4444) and PNG"));
  }
  const Outcome other = obscura("render scene.toml --transparent --codec libx264 -o f.mov");
  EXPECT_EQ(other.exit, 4);
  EXPECT_THAT(other.err, HasSubstr("with transparency the codec of a .mov is prores_ks, not libx264"));
}

TEST_F(HandOver, APosterIsTheStillOfItsInstant) {
  scene(kCrateAndBall);
  ASSERT_EQ(obscura("render scene.toml -o f.mp4 --poster 0.5" + kQuarter).exit, 0);
  ASSERT_EQ(obscura("render scene.toml -o still.png --at 0.5" + kQuarter).exit, 0);
  EXPECT_TRUE(media::read_png(path("f.poster.png")).image.pixels ==
              media::read_png(path("still.png")).image.pixels);
  EXPECT_EQ(obscura("render scene.toml -o a.png --at 0 --poster 0.5").exit, 2);
}

/// A page for each frame, 160 mm wide, vectors with type.
TEST_F(HandOver, PagesAreTheFrames) {
  OBSCURA_NEEDS(page::writes(page::Form::pdf), "libcairo2-dev, where it is built");
  OBSCURA_NEEDS(installed("pdftotext"), "poppler-utils");
  scene(kCrateAndBall);
  const Outcome made = obscura("render scene.toml -o f.pdf --size 320x180 --fps 10");
  ASSERT_EQ(made.exit, 0) << made.err;
  const std::string info = shell("pdfinfo f.pdf").out;
  EXPECT_THAT(info, testing::ContainsRegex("Pages: +10"));
  EXPECT_THAT(info, testing::ContainsRegex("Page size: +453.54[0-9]* x 255.1[0-9]* pts"));
  EXPECT_THAT(shell("pdftotext -f 4 -l 4 f.pdf -").out, HasSubstr("0.30 s"));
  const std::string bytes = contents(path("f.pdf"));
  ASSERT_EQ(obscura("render scene.toml -o f.pdf --size 320x180 --fps 10").exit, 0);
  EXPECT_TRUE(contents(path("f.pdf")) == bytes);
  EXPECT_EQ(obscura("render scene.toml -o g.pdf --shard 1/2").exit, 2);
}

/// Its pages are pixels where surfaces are lit, and lines over them.
TEST_F(HandOver, PagesOfSpaceHaveTheirSurfaces) {
  OBSCURA_NEEDS(page::writes(page::Form::pdf), "libcairo2-dev, where it is built");
  OBSCURA_NEEDS(installed("pdftocairo"), "poppler-utils");
  scene(
      "duration = 0.2\n[room]\nsize = [4, 2, 4]\nwalls = \"ground\"\n[[box]]\nsize = [0.6, 0.6, 0.6]\n"
      "position = [0, 0.31, 0]\n");
  const std::string how = " --size 320x180 --fps 10";
  ASSERT_EQ(obscura("render scene.toml -o f.pdf" + how).exit, 0);
  ASSERT_EQ(obscura("render scene.toml -o f.png --at 0" + how).exit, 0);
  // 320 px on 453.54 pt
  ASSERT_EQ(shell("pdftocairo -f 1 -singlefile -scale-to-x 320 -scale-to-y 180 -png f.pdf page").exit, 0);
  const media::Image drawn = media::read_png(path("f.png")).image,
                     page = media::read_png(path("page.png")).image;
  ASSERT_EQ(page.width, 320);
  double sum = 0;
  for (std::size_t i = 0; i < drawn.pixels.size(); ++i)
    if (i % 4 != 3) sum += std::abs(int(drawn.pixels[i]) - int(page.pixels[i]));
  EXPECT_LT(sum / (0.75 * double(drawn.pixels.size())), 2);  // lines are smoothed by another rasteriser
}

TEST_F(HandOver, AGifIsUnderTheSizeThatOneNames) {
  scene(kCrateAndBall);
  const std::string how = " --size 480x270 --fps 10";
  ASSERT_EQ(obscura("render scene.toml -o whole.gif" + how).exit, 0);
  const auto whole = fs::file_size(path("whole.gif"));
  const auto limit = whole / 2;
  const Outcome made =
      obscura("render scene.toml -o f.gif --under " + std::to_string(limit / 1000) + "kB" + how);
  ASSERT_EQ(made.exit, 0) << made.err;
  EXPECT_LE(fs::file_size(path("f.gif")), limit);
  EXPECT_GT(fs::file_size(path("f.gif")), limit / 3) << "smaller than it needs to be";
  for (const auto& left : fs::directory_iterator(path(".")))
    EXPECT_EQ(left.path().filename().string().find("sizing"), std::string::npos) << left.path();
  // its trials are nobody's concern
  EXPECT_EQ(std::count(made.out.begin(), made.out.end(), '\n'), 1) << made.out;
  EXPECT_THAT(made.out, testing::StartsWith("f.gif: "));
  EXPECT_THAT(made.err, testing::Not(HasSubstr("sizing")));
  // what fits is left as it is
  ASSERT_EQ(obscura("render scene.toml -o g.gif --under 1GB" + how).exit, 0);
  EXPECT_EQ(fs::file_size(path("g.gif")), whole);
  const Outcome tiny = obscura("render scene.toml -o h.gif --under 1kB" + how);
  EXPECT_EQ(tiny.exit, 2);
  EXPECT_FALSE(fs::exists(path("h.gif")));
  EXPECT_EQ(obscura("render scene.toml -o f.mp4 --under 1MB").exit, 2);
  // its captions are those of the film
  scene(std::string(kCrateAndBall) + "[[film.caption]]\ntext = \"a word\"\n");
  ASSERT_EQ(obscura("render scene.toml -o c.gif --under 1GB" + how).exit, 0);
  EXPECT_TRUE(fs::exists(path("c.vtt")));
  EXPECT_FALSE(fs::exists(path("c.gif.sizing.vtt")));
}

}  // namespace
}  // namespace obscura::app
