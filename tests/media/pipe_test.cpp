#include "media/pipe.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "media/command.h"
#include "media/error.h"
#include "media/pictures.h"

namespace obscura::media {
namespace {

MovieSpec pipe_spec(int width, int height, int num, int den = 1) {
  MovieSpec spec;
  spec.width = width, spec.height = height, spec.fps_num = num, spec.fps_den = den;
  return spec;
}

std::vector<std::uint8_t> bytes_for(PipeFormat format, const Image& image) {
  std::vector<std::uint8_t> bytes;
  PipeFrames(format, pipe_spec(image.width, image.height, 60)).make(image, nullptr, bytes);
  return bytes;
}

TEST(Pipe, FfmpegReadsTheSamePlanesFromY4m) {
  Folder folder;
  const std::string path = folder / "a.y4m";
  const int file = ::open(path.c_str(), O_CREAT | O_WRONLY, 0666);
  const MovieSpec spec = pipe_spec(66, 50, 30000, 1001);
  PipeWriter pipe(file, PipeFormat::y4m, spec);
  std::vector<std::uint8_t> planes;
  for (unsigned n = 0; n < 4; ++n) {
    const Image image = random_image(66, 50, n);
    EXPECT_TRUE(pipe.write(bytes_for(PipeFormat::y4m, image)));
    std::vector<std::uint8_t> one(66 * 50 * 3 / 2);
    convert(image, {one.data(), one.data() + 66 * 50, one.data() + 66 * 50 * 5 / 4, 66, 33, 33});
    planes.insert(planes.end(), one.begin(), one.end());
  }
  ::close(file);

  EXPECT_THAT(probe(path, "stream=width,height,pix_fmt,color_range,chroma_location,r_frame_rate"),
              testing::ElementsAre("66", "50", "yuv420p", "tv", "center", "30000/1001"));
  output_of("ffmpeg -v error -i '" + path + "' -f rawvideo '" + (folder / "a.yuv") + "'");
  EXPECT_EQ(bytes_of(folder / "a.yuv"), planes);
}

TEST(Pipe, RawFramesAreThePixels) {
  Folder folder;
  const int file = ::open((folder / "a.rgba").c_str(), O_CREAT | O_WRONLY, 0666);
  PipeWriter pipe(file, PipeFormat::rgba, pipe_spec(7, 5, 60));
  const Image image = random_image(7, 5, 1);
  EXPECT_TRUE(pipe.write(bytes_for(PipeFormat::rgba, image)));
  EXPECT_TRUE(pipe.write(bytes_for(PipeFormat::rgba, image)));
  ::close(file);
  std::vector<std::uint8_t> twice = image.pixels;
  twice.insert(twice.end(), image.pixels.begin(), image.pixels.end());
  EXPECT_EQ(bytes_of(folder / "a.rgba"), twice);
}

TEST(Pipe, AClosedPipeIsFalse) {
  std::signal(SIGPIPE, SIG_IGN);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  PipeWriter pipe(ends[1], PipeFormat::y4m, pipe_spec(640, 480, 60));
  const Image image = random_image(640, 480, 1);
  // the reader takes a little of the first frame and goes
  std::jthread reader([&] {
    char some[1000];
    EXPECT_GT(::read(ends[0], some, sizeof some), 0);
    ::close(ends[0]);
  });
  EXPECT_FALSE(pipe.write(bytes_for(PipeFormat::y4m, image)));
  EXPECT_FALSE(pipe.write(bytes_for(PipeFormat::y4m, image)));
  ::close(ends[1]);
}

TEST(Pipe, WaitsForASlowReaderThatDoesNotBlock) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::fcntl(ends[1], F_SETFL, O_NONBLOCK);
  const Image image = random_image(640, 480, 1);
  std::vector<std::uint8_t> got;
  std::jthread reader([&] {
    std::uint8_t some[5000];
    for (ssize_t n; (n = ::read(ends[0], some, sizeof some)) > 0;) got.insert(got.end(), some, some + n);
  });
  PipeWriter pipe(ends[1], PipeFormat::rgba, pipe_spec(640, 480, 60));
  EXPECT_TRUE(pipe.write(bytes_for(PipeFormat::rgba, image)));
  ::close(ends[1]);
  reader.join();
  ::close(ends[0]);
  EXPECT_EQ(got, image.pixels);
}

TEST(Pipe, AFullDeviceIsAnError) {
  const int file = ::open("/dev/full", O_WRONLY);
  PipeWriter pipe(file, PipeFormat::rgba, pipe_spec(4, 4, 60));
  EXPECT_THROW(pipe.write(bytes_for(PipeFormat::rgba, random_image(4, 4, 1))), Error);
  ::close(file);
}

TEST(Pipe, OddSizesAreRefusedInY4m) {
  EXPECT_THROW(PipeWriter(1, PipeFormat::y4m, pipe_spec(5, 4, 60)), Error);
  EXPECT_THROW(PipeFrames(PipeFormat::y4m, pipe_spec(5, 4, 60)), Error);
}

// What alone has changed is converted alone: the same bytes as of the whole.
TEST(Pipe, OfWhatChangedTheBytesAreThoseOfTheWhole) {
  PipeFrames frames(PipeFormat::y4m, pipe_spec(64, 48, 60));
  Image image = random_image(64, 48, 1);
  std::vector<std::uint8_t> bytes;
  frames.make(image, nullptr, bytes);
  const std::vector<std::uint8_t> before = bytes;
  const std::vector<Rect> changed{{8, 4, 20, 10}, {40, 30, 24, 18}};
  const Image other = random_image(64, 48, 2);
  for (const Rect& rect : changed)
    for (int y = rect.y; y < rect.y + rect.height; ++y)
      std::copy_n(other.row(y) + 4 * rect.x, 4 * rect.width, image.row(y) + 4 * rect.x);
  frames.make(image, &changed, bytes);
  EXPECT_NE(bytes, before);
  EXPECT_EQ(bytes, bytes_for(PipeFormat::y4m, image));
}

}  // namespace
}  // namespace obscura::media
