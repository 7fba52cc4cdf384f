#include "media/gif.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "media/command.h"
#include "media/palette.h"
#include "media/pictures.h"
#include "media/read.h"

namespace obscura::media {
namespace {

using ::testing::ElementsAre;

// a movie of the frames, in segments
void write_gif(const std::string& path, const MovieSpec& spec, const std::vector<Image>& frames) {
  MovieWriter writer(path, spec);
  for (std::size_t n = 0; n < frames.size();) {
    SegmentEncoder encoder(path, spec);
    for (int k = 0; k < segment_frames(spec) && n < frames.size(); ++k) encoder.add(frames[n++]);
    writer.add(encoder.finish());
  }
  writer.close();
}

MovieSpec gif_spec(int width, int height, int num, int den = 1) {
  MovieSpec spec;
  spec.width = width, spec.height = height, spec.fps_num = num, spec.fps_den = den;
  return spec;
}

TEST(Gif, FewColoursComeBackToTheBit) {
  Folder folder;
  // noise of 200 colours: the string table fills and starts anew many times
  std::vector<Image> frames;
  for (unsigned n = 0; n < 7; ++n) {
    Image image = random_image(203, 151, n);
    for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
      const int c = image.pixels[i] % 200;
      image.pixels[i] = std::uint8_t(c), image.pixels[i + 1] = std::uint8_t(255 - c);
      image.pixels[i + 2] = std::uint8_t(3 * c), image.pixels[i + 3] = 255;
    }
    frames.push_back(image);
    frames.push_back(image);  // nothing changes
    image.row(100)[4 * 50] ^= 1, image.row(100)[4 * 50 + 1] = 0;
    frames.push_back(image);  // a pixel does
  }
  write_gif(folder / "a.gif", gif_spec(203, 151, 5), frames);
  MovieReader reader(folder / "a.gif");
  Image frame;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    ASSERT_TRUE(reader.next(frame));
    ASSERT_EQ(frame, frames[n]) << n;
    EXPECT_NEAR(reader.time(), double(n) / 5, 1e-9);
  }
  EXPECT_FALSE(reader.next(frame));
}

// 255 colours for thousands: the ground and the fills exact, edges within the nearest of boxes that small.
TEST(Gif, OfManyColoursTheFrequentStayExact) {
  Folder folder;
  const MovieSpec spec = gif_spec(320, 180, 10);
  std::vector<Image> frames;
  for (int n = 0; n < 20; ++n) frames.push_back(moving_picture(320, 180, n / 10.0));
  write_gif(folder / "a.gif", spec, frames);
  MovieReader reader(folder / "a.gif");
  Image frame;
  for (const Image& image : frames) {
    ASSERT_TRUE(reader.next(frame));
    std::size_t same = 0;
    int worst = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const int d = std::abs(frame.pixels[i] - image.pixels[i]);
      worst = std::max(worst, d);
      same += d == 0;
    }
    EXPECT_GT(double(same) / double(image.pixels.size()), 0.98);
    EXPECT_LE(worst, 40);
  }
}

// 30000/1001 frames a second in hundredths: 3 or 4 each, and frame n never ends half a hundredth off.
TEST(Gif, DelaysNeverDrift) {
  Folder folder;
  const std::vector<Image> frames(62, moving_picture(16, 16, 0));
  write_gif(folder / "a.gif", gif_spec(16, 16, 30000, 1001), frames);
  const auto times = probe(folder / "a.gif", "packet=pts");
  ASSERT_EQ(times.size(), 62u);
  for (int n = 0; n < 62; ++n)
    EXPECT_EQ(std::stol(times[std::size_t(n)]), std::lround(n * 100.0 * 1001 / 30000));
}

TEST(Gif, OpensInFfprobe) {
  Folder folder;
  write_gif(folder / "a.gif", gif_spec(320, 180, 25), std::vector<Image>(3, moving_picture(320, 180, 0)));
  EXPECT_THAT(probe(folder / "a.gif", "stream=codec_name,width,height,r_frame_rate,nb_frames"),
              ElementsAre("gif", "320", "180", "25/1", "3"));
}

TEST(Palette, TakesFewColoursAsTheyAreAndOfManyTheMostFrequent) {
  EXPECT_THAT(palette({{7, 1}, {3, 1}}, 4), ElementsAre(3u, 7u));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> many;
  for (std::uint32_t i = 0; i < 1000; ++i) many.push_back({i * 16769, i == 500 ? 1000 : 1});
  const auto colours = palette(many, 16);
  EXPECT_LE(colours.size(), 16u);
  EXPECT_EQ(colours[nearest(colours, 500 * 16769)], 500u * 16769);
  std::reverse(many.begin(), many.end());
  EXPECT_EQ(palette(many, 16), colours);
}

}  // namespace
}  // namespace obscura::media
