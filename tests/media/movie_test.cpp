#include "media/movie.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

#include "media/codec.h"
#include "media/command.h"
#include "media/error.h"
#include "media/pictures.h"
#include "media/png.h"
#include "media/read.h"

namespace obscura::media {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

MovieSpec spec_of(int width, int height, std::int64_t num, std::int64_t den = 1) {
  MovieSpec spec;
  spec.width = width, spec.height = height;
  spec.fps_num = num, spec.fps_den = den;
  return spec;
}

Image frame_at(const MovieSpec& spec, int n) {
  return moving_picture(spec.width, spec.height, n * double(spec.fps_den) / double(spec.fps_num));
}

Segment encoded(const std::string& path, const MovieSpec& spec, int from, int to) {
  SegmentEncoder encoder(path, spec);
  for (int n = from; n < to; ++n) encoder.add(frame_at(spec, n));
  return encoder.finish();
}

void write_movie(const std::string& path, const MovieSpec& spec, int frames) {
  MovieWriter writer(path, spec);
  const int each = segment_frames(spec);
  for (int n = 0; n < frames; n += each) writer.add(encoded(path, spec, n, std::min(n + each, frames)));
  EXPECT_EQ(writer.frames(), frames);
  writer.close();
}

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// ---- what is refused, before anything is made

std::string refusal(const std::string& path, MovieSpec spec) {
  return message_of([&] { check(path, spec); });
}

TEST(MovieCheck, NamesTheNearestEvenSize) {
  EXPECT_EQ(refusal("a.mp4", spec_of(1919, 1080, 60)),
            "a.mp4: 1919x1080: H.264 4:2:0 needs even sizes: try 1920x1080");
  EXPECT_THAT(refusal("a.webm", spec_of(640, 359, 60)), HasSubstr("VP9 4:2:0 needs even sizes: try 640x360"));
  EXPECT_EQ(refusal("a.gif", spec_of(641, 359, 25)), "no error");
}

TEST(MovieCheck, ListsTheEndingsItKnows) {
  EXPECT_EQ(refusal("a.avi", spec_of(64, 64, 60)),
            "a.avi: no movie format '.avi': movies end in .mp4 .mkv .mov .webm .gif");
  EXPECT_THAT(refusal("movie", spec_of(64, 64, 60)), HasSubstr("a movie's name needs an ending"));
  EXPECT_EQ(refusal("A.MP4", spec_of(64, 64, 60)), "no error");
}

TEST(MovieCheck, RefusesUnknownCodecsPresetsAndQualities) {
  MovieSpec spec = spec_of(64, 64, 60);
  spec.codec = "divx";
  EXPECT_THAT(refusal("a.mp4", spec), HasSubstr("a.mp4: no codec 'divx' for a .mp4 file: there is lib"));
  spec.codec = "libx264";
  EXPECT_THAT(refusal("a.webm", spec), HasSubstr("no codec 'libx264' for a .webm file: there is libvpx-vp9"));
  spec.codec = "";
  spec.preset = "quick";
  EXPECT_THAT(refusal("a.mp4", spec), HasSubstr("no preset 'quick': they are ultrafast superfast"));
  spec.preset = "";
  spec.crf = 0;
  EXPECT_THAT(refusal("a.mp4", spec), HasSubstr("crf is from 1 to 51, got 0"));
  spec.crf = std::nan("");
  EXPECT_THAT(refusal("a.mp4", spec), HasSubstr("crf is from 1 to 51"));
  EXPECT_THAT(refusal("a.mp4", spec_of(64, 64, 0)), HasSubstr("no movie of 0/1 frames a second"));
  EXPECT_THAT(refusal("a.mp4", spec_of(0, 64, 60)), HasSubstr("no movie of 0x64 pixels"));
  EXPECT_THAT(refusal("a.gif", spec_of(64, 64, 60)), HasSubstr("at most 50 frames in one"));
}

TEST(MovieCheck, WithoutLibx264TakesAnotherEncoderOrOffersWebm) {
  const MovieSpec spec = spec_of(64, 64, 60);
  const auto with = [&](std::vector<std::string> names) {
    return [names](const std::string& name) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
  };
  EXPECT_EQ(encoder_name("a.mp4", spec, with({"libopenh264", "libvpx-vp9"})), "libopenh264");
  EXPECT_EQ(message_of([&] { encoder_name("out/a.mp4", spec, with({"libvpx-vp9"})); }),
            "out/a.mp4: the FFmpeg in use has no encoder of H.264 (libx264, libopenh264): install an FFmpeg "
            "that has "
            "one, or write a.webm (VP9)");
  EXPECT_EQ(message_of([&] { encoder_name("a.mkv", spec, with({})); }),
            "a.mkv: the FFmpeg in use has no encoder of H.264 (libx264, libopenh264): install an FFmpeg that "
            "has one");
}

// ---- time

class EveryRate : public ::testing::TestWithParam<std::pair<int, int>> {};
INSTANTIATE_TEST_SUITE_P(Movie, EveryRate,
                         ::testing::Values(std::pair{24, 1}, std::pair{25, 1}, std::pair{30, 1},
                                           std::pair{50, 1}, std::pair{60, 1}, std::pair{30000, 1001}),
                         [](const auto& rate) {
                           return std::to_string(rate.param.first) + "over" +
                                  std::to_string(rate.param.second);
                         });

// Both ways of ordering: as shown (ours), and with frames that refer to later ones (x264's medium).
TEST_P(EveryRate, FramesAreCountedTimedAndSeekableExactly) {
  const auto [num, den] = GetParam();
  Folder folder;
  for (const char* preset : {"", "medium"}) {
    const std::string path = folder / "a.mp4";
    MovieSpec spec = spec_of(160, 90, num, den);
    spec.preset = preset;
    const int each = segment_frames(spec), frames = 2 * each + each / 3 + 1;
    write_movie(path, spec, frames);

    const std::string rate = std::to_string(num) + "/" + std::to_string(den);
    const auto says =
        probe(path, "stream=r_frame_rate,avg_frame_rate,time_base,start_pts,nb_frames:format=duration");
    ASSERT_EQ(says.size(), 6u);
    EXPECT_EQ(says[0], rate);
    EXPECT_EQ(says[1], rate);
    EXPECT_EQ(says[3], "0");
    EXPECT_EQ(says[4], std::to_string(frames));
    // the last frame lasts as long as any; ffprobe prints microseconds, the file's head counts milliseconds
    EXPECT_NEAR(std::stod(says[5]), frames * double(den) / num, 1e-3);

    // every time is n / fps exactly: pts * time_base as fractions
    long base_num = 0, base_den = 0;
    ASSERT_EQ(std::sscanf(says[2].c_str(), "%ld/%ld", &base_num, &base_den), 2);
    const auto packets = probe(path, "packet=pts,flags");
    ASSERT_EQ(int(packets.size()), 2 * frames);
    std::vector<long> times;
    for (int n = 0; n < frames; ++n) {
      times.push_back(std::stol(packets[std::size_t(2 * n)]));
      EXPECT_EQ(packets[std::size_t(2 * n + 1)][0] == 'K', n % each == 0) << "packet " << n;
    }
    std::sort(times.begin(), times.end());
    for (int n = 0; n < frames; ++n) {
      EXPECT_EQ(times[std::size_t(n)] * base_num * num, long(n) * den * base_den) << "frame " << n;
    }
  }
}

TEST(Movie, SegmentsOfOneSecond) {
  EXPECT_EQ(segment_frames(spec_of(2, 2, 60)), 60);
  EXPECT_EQ(segment_frames(spec_of(2, 2, 30000, 1001)), 30);
  EXPECT_EQ(segment_frames(spec_of(2, 2, 24000, 1001)), 24);
  EXPECT_EQ(segment_frames(spec_of(2, 2, 1, 3)), 1);
}

// ---- what players ask for

// one-line facts of the stream
std::vector<std::string> facts(const std::string& path) {
  return probe(path,
               "stream=codec_name,profile,codec_tag_string,pix_fmt,color_range,color_space,color_transfer,"
               "color_primaries,chroma_location");
}

TEST(Movie, IsH264HighTaggedAsConvertedAndStartsFast) {
  Folder folder;
  write_movie(folder / "a.mp4", spec_of(320, 180, 30), 31);
  EXPECT_THAT(facts(folder / "a.mp4"),
              ElementsAre("h264", "High", "avc1", "yuv420p", "tv", "bt709", "bt709", "bt709", "center"));
  // the index stands before the pictures
  std::vector<std::string> atoms;
  const auto bytes = bytes_of(folder / "a.mp4");
  for (std::size_t at = 0; at + 8 <= bytes.size();) {
    const std::size_t size =
        std::size_t(bytes[at]) << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3];
    atoms.emplace_back(bytes.begin() + std::ptrdiff_t(at) + 4, bytes.begin() + std::ptrdiff_t(at) + 8);
    ASSERT_GE(size, 8u);
    at += size;
  }
  EXPECT_THAT(atoms, ElementsAre("ftyp", "moov", "free", "mdat"));
}

TEST(Movie, StaysWithinLevel42At1080p60) {
  Folder folder;
  for (const char* preset : {"", "medium", "slower"}) {
    MovieSpec spec = spec_of(1920, 1080, 60);
    spec.preset = preset;
    write_movie(folder / "a.mp4", spec, 3);
    const auto level = probe(folder / "a.mp4", "stream=level");
    EXPECT_LE(std::stoi(level[0]), 42) << preset;
  }
}

TEST(Movie, CarriesItsTags) {
  Folder folder;
  for (const char* name : {"a.mp4", "a.mkv", "a.mov", "a.webm"}) {
    MovieSpec spec = spec_of(64, 64, 4);
    spec.tags = {
        {"Title", "Ein Würfel ✓"}, {"Scene", "[room]\n\"size\" = 4\n"}, {"obscura", "{\"b\":1,\"a\":[0.1]}"}};
    write_movie(folder / name, spec, 5);
    EXPECT_EQ(MovieReader(folder / name).facts().tags, spec.tags) << name;
  }
  EXPECT_THAT(
      probe(folder / "a.mp4", "format_tags=comment"),
      ElementsAre(
          R"({"Scene":"[room]\n\"size\" = 4\n","Title":"Ein Würfel ✓","obscura":{"b":1,"a":[0.1]}})"));
}

// ---- pixels

struct Likeness {
  double luma_psnr, bias[3];
};

// Bars of the project: luma PSNR at least 45 dB, mean bias of each channel under half a level.
Likeness likeness(const Image& a, const Image& b) {
  double square = 0, sum[3] = {};
  const std::size_t pixels = std::size_t(a.width) * a.height;
  for (std::size_t i = 0; i < pixels; ++i) {
    double d[3];
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] += d[k] = double(b.pixels[4 * i + k]) - double(a.pixels[4 * i + k]);
    const double luma = 0.2126 * d[0] + 0.7152 * d[1] + 0.0722 * d[2];
    square += luma * luma;
  }
  const double n = double(pixels);
  return {10 * std::log10(255 * 255 / (square / n)), {sum[0] / n, sum[1] / n, sum[2] / n}};
}

class EveryMovie : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Movie, EveryMovie,
                         ::testing::Values(std::pair{"a.mp4", ""}, std::pair{"a.mp4", "medium"},
                                           std::pair{"a.mkv", ""}, std::pair{"a.mov", ""},
                                           std::pair{"a.webm", ""}),
                         [](const auto& movie) {
                           return std::string(movie.param.first + 2) + movie.param.second;
                         });

TEST_P(EveryMovie, ShowsTheFramesThatWereAddedInOrder) {
  Folder folder;
  MovieSpec spec = spec_of(640, 360, 10);
  spec.preset = GetParam().second;
  const std::string path = folder / GetParam().first;
  write_movie(path, spec, 24);

  MovieReader reader(path);
  EXPECT_EQ(reader.facts().fps_num, 10 * reader.facts().fps_den);
  Image frame;
  double bias[3] = {};
  for (int n = 0; n < 24; ++n) {
    ASSERT_TRUE(reader.next(frame)) << n;
    // Matroska counts in milliseconds
    EXPECT_NEAR(reader.time(), n / 10.0, 1e-9);
    const Likeness like = likeness(frame_at(spec, n), frame);
    EXPECT_GE(like.luma_psnr, 45) << "frame " << n;
    for (int k = 0; k < 3; ++k) bias[k] += like.bias[k] / 24;
  }
  EXPECT_FALSE(reader.next(frame));
  for (const double b : bias) EXPECT_LT(std::abs(b), 0.5);
}

// A whole-number check of the colours' way there and back, that no compression blurs.
TEST(Movie, FlatColoursComeBackWithinTheRoundingOfEightBits) {
  Folder folder;
  MovieSpec spec = spec_of(64, 64, 5);
  spec.crf = 1;
  const std::uint8_t colours[][3] = {{255, 255, 255}, {0, 0, 0}, {230, 159, 0}, {0, 114, 178}, {213, 94, 0}};
  MovieWriter writer(folder / "a.mp4", spec);
  SegmentEncoder encoder(folder / "a.mp4", spec);
  for (const auto& c : colours) {
    Image image{64, 64, {}};
    for (int i = 0; i < 64 * 64; ++i) image.pixels.insert(image.pixels.end(), {c[0], c[1], c[2], 255});
    encoder.add(image);
  }
  writer.add(encoder.finish());
  writer.close();
  MovieReader reader(folder / "a.mp4");
  Image frame;
  for (const auto& c : colours) {
    ASSERT_TRUE(reader.next(frame));
    const std::uint8_t* middle = frame.row(32) + 4 * 32;
    // half a step of luma is 0.58 levels; of chroma up to 1.06 in blue, 0.9 in red
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(middle[k], c[k], 2);
  }
}

// ---- the same bytes

TEST(Movie, IsTheSameBytesTwiceAndFromSegmentsEncodedSideBySide) {
  Folder folder;
  for (const char* name : {"a.mp4", "a.mkv", "a.gif"}) {
    const MovieSpec spec = spec_of(320, 180, 12);
    write_movie(folder / name, spec, 48);
    const auto first = bytes_of(folder / name);

    std::vector<Segment> segments(4);
    {
      std::vector<std::jthread> threads;
      for (int k = 0; k < 4; ++k) {
        threads.emplace_back(
            [&, k] { segments[std::size_t(k)] = encoded(folder / name, spec, 12 * k, 12 * k + 12); });
      }
    }
    MovieWriter writer(folder / name, spec);
    for (const Segment& segment : segments) writer.add(segment);
    writer.close();
    EXPECT_EQ(bytes_of(folder / name), first) << name;
  }
}

// What did not change may be left out of the conversion, by every pixel format: the bytes are the same.
TEST(Movie, IsTheSameBytesWhereOnlyChangesAreConverted) {
  Folder folder;
  for (const char* name : {"a.mp4", "a.webm", "a.mov", "a.gif"}) {
    MovieSpec spec = spec_of(320, 180, 12);
    spec.alpha = std::string(name) == "a.mov";
    SegmentEncoder all(folder / name, spec), parts(folder / name, spec);
    Image image = frame_at(spec, 0);
    for (int n = 0; n < 12; ++n) {
      const Rect rect{64 + 16 * n, 32, 32, 180 - 32};
      const Image other = frame_at(spec, n);
      for (int y = rect.y; y < rect.y + rect.height; ++y)
        std::copy_n(other.row(y) + 4 * rect.x, 4 * rect.width, image.row(y) + 4 * rect.x);
      const std::vector<Rect> changed{{rect.x, rect.y, 16, rect.height},
                                      {rect.x + 16, rect.y, 16, rect.height}};
      all.add(image), parts.add(image, &changed);
    }
    const Segment a = all.finish(), b = parts.finish();
    ASSERT_EQ(a.packets.size(), b.packets.size()) << name;
    for (std::size_t i = 0; i < a.packets.size(); ++i)
      EXPECT_EQ(a.packets[i].bytes, b.packets[i].bytes) << name;
  }
}

// a disc with a soft edge that drifts over a flat ground: most of each frame is what it was
Image quiet_picture(int width, int height, double t) {
  Image image{width, height, std::vector<std::uint8_t>(std::size_t(4) * width * height)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double from = std::hypot(x - 0.3 * width - 20 * t, y - 0.5 * height) - 0.2 * height;
      const double ink = std::clamp(0.5 - from, 0.0, 1.0);
      std::uint8_t* pixel = image.row(y) + 4 * x;
      for (int c = 0; c < 3; ++c) pixel[c] = std::uint8_t(245 - ink * (60 + 50 * c));
      pixel[3] = 255;
    }
  }
  return image;
}

// what a film of segments of `each` frames loses: mean squared error of a channel, and its bytes
std::pair<double, std::size_t> loss(const MovieSpec& spec, int frames, int each) {
  const std::string path = testing::TempDir() + "/quiet.mp4";
  const auto picture = [&](int n) {
    return quiet_picture(spec.width, spec.height, n / double(spec.fps_num));
  };
  std::size_t bytes = 0;
  MovieWriter writer(path, spec);
  for (int from = 0; from < frames; from += each) {
    SegmentEncoder encoder(path, spec);
    for (int n = from; n < from + each; ++n) encoder.add(picture(n));
    const Segment segment = encoder.finish();
    for (const auto& packet : segment.packets) bytes += packet.bytes.size();
    writer.add(segment);
  }
  writer.close();
  MovieReader reader(path);
  Image image;
  double sum = 0;
  for (int n = 0; reader.next(image); ++n) {
    const Image right = picture(n);
    for (int y = 0; y < spec.height; ++y) {
      for (int i = 0; i < 4 * spec.width; ++i) {
        const double off = image.row(y)[i] - right.row(y)[i];
        sum += off * off;
      }
    }
  }
  return {sum / (3.0 * frames * spec.width * spec.height), bytes};
}

TEST(Movie, OfSegmentsIsAsGoodAsOfOneEncoder) {
  MovieSpec spec = spec_of(320, 180, 30);
  for (const char* preset : {"", "medium"}) {
    spec.preset = preset;
    const auto [one, one_bytes] = loss(spec, 120, 120);
    const auto [segments, bytes] = loss(spec, 120, 30);
    // a tenth of a decibel, for a twentieth more bytes and what x264 says of itself in each segment
    EXPECT_LT(10 * std::log10(segments / one), 0.1) << preset;
    EXPECT_LT(double(bytes), 1.05 * double(one_bytes) + 3 * 720) << preset;
  }
}

TEST(Movie, RefusesASegmentOfOtherSettings) {
  Folder folder;
  MovieSpec other = spec_of(64, 64, 5);
  other.preset = "ultrafast";
  const MovieSpec spec = spec_of(64, 64, 5);
  MovieWriter writer(folder / "a.mp4", spec);
  writer.add(encoded(folder / "a.mp4", spec, 0, 5));
  EXPECT_THAT(message_of([&] { writer.add(encoded(folder / "a.mp4", other, 0, 5)); }),
              HasSubstr("a segment of other settings"));
}

// ---- files

TEST(Movie, AppearsWhenItIsWholeAndLeavesNothingOtherwise) {
  Folder folder;
  const MovieSpec spec = spec_of(64, 64, 5);
  {
    MovieWriter writer(folder / "a.mp4", spec);
    writer.add(encoded(folder / "a.mp4", spec, 0, 5));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.mp4"));
    EXPECT_EQ(folder.names().size(), 1u);
  }
  EXPECT_THAT(folder.names(), IsEmpty());
  {
    MovieWriter writer(folder / "a.mp4", spec);
    writer.add(encoded(folder / "a.mp4", spec, 0, 5));
    writer.close(folder / "a.partial.mp4");
  }
  EXPECT_THAT(folder.names(), ElementsAre("a.partial.mp4"));
  EXPECT_THAT(probe(folder / "a.partial.mp4", "stream=nb_frames"), ElementsAre("5"));
}

TEST(Movie, KeepsAnEarlierFileUntilTheNewOneIsWhole) {
  Folder folder;
  std::ofstream(folder / "a.mp4") << "before";
  const MovieSpec spec = spec_of(64, 64, 5);
  {
    MovieWriter writer(folder / "a.mp4", spec);
    writer.add(encoded(folder / "a.mp4", spec, 0, 5));
    EXPECT_EQ(bytes_of(folder / "a.mp4").size(), 6u);
  }
  EXPECT_EQ(bytes_of(folder / "a.mp4").size(), 6u);
  write_movie(folder / "a.mp4", spec, 5);
  EXPECT_GT(bytes_of(folder / "a.mp4").size(), 1000u);
}

// a disk that fills: files of this process end at `bytes`
struct SmallDisk {
  rlimit before{};
  explicit SmallDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit small{bytes, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallDisk() { setrlimit(RLIMIT_FSIZE, &before); }
};

TEST(Movie, ADiskThatFillsIsAnErrorAndNoFile) {
  Folder folder;
  for (const char* name : {"a.mp4", "a.mkv", "a.gif"}) {
    const MovieSpec spec = spec_of(320, 180, 12);
    // too small at once, and too small at the end only
    write_movie(folder / name, spec, 36);
    const auto whole = std::filesystem::file_size(folder / name);
    std::filesystem::remove(folder / name);
    for (const std::uintmax_t room : {whole / 3, whole - 1}) {
      const SmallDisk disk(room);
      EXPECT_THAT(message_of([&] { write_movie(folder / name, spec, 36); }),
                  testing::AllOf(HasSubstr(folder / name), HasSubstr("File too large")))
          << name;
      EXPECT_THAT(folder.names(), IsEmpty());
    }
  }
}

TEST(Movie, AFullDeviceIsAnError) {
  Folder folder;
  for (const char* name : {"full.mp4", "full.mkv", "full.gif"}) {
    std::filesystem::create_symlink("/dev/full", folder / name);
    EXPECT_THAT(message_of([&] { write_movie(folder / name, spec_of(64, 64, 5), 5); }),
                HasSubstr("No space left on device"));
  }
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
  EXPECT_THAT(message_of([&] { MovieWriter(folder / "no/such/a.mp4", spec_of(64, 64, 5)); }),
              HasSubstr("no/such/a.mp4: cannot write: No such file or directory"));
}

TEST(Movie, NamesWithColonsAndPercentsAreOnlyNames) {
  Folder folder;
  for (const char* name : {"http:a %d.mp4", "pipe:1.mkv", "-.mov"})
    write_movie(folder / name, spec_of(64, 64, 5), 6);
  EXPECT_THAT(folder.names(), ElementsAre("-.mov", "http:a %d.mp4", "pipe:1.mkv"));
  EXPECT_EQ(MovieReader(folder / "http:a %d.mp4").facts().frames, 6);
}

TEST(MovieReader, NamesWhatItCannotRead) {
  Folder folder;
  EXPECT_THAT(message_of([&] { MovieReader(folder / "none.mp4"); }),
              HasSubstr("none.mp4: cannot read: No such file"));
  std::ofstream(folder / "text.mp4") << "not a movie";
  EXPECT_THAT(message_of([&] { MovieReader(folder / "text.mp4"); }), HasSubstr("text.mp4: cannot read"));
  write_movie(folder / "a.mp4", spec_of(320, 180, 10), 20);
  std::filesystem::resize_file(folder / "a.mp4", std::filesystem::file_size(folder / "a.mp4") * 2 / 3);
  EXPECT_THAT(message_of([&] {
                MovieReader reader(folder / "a.mp4");
                Image frame;
                while (reader.next(frame)) {
                }
              }),
              HasSubstr("a.mp4: "));
}

TEST(Libraries, SayTheirVersionsAndLicence) {
  EXPECT_THAT(libraries(), testing::ContainsRegex("libavcodec [0-9]+\\.[0-9]+\\.[0-9]+ \\(.*GPL"));
  EXPECT_THAT(libraries(), HasSubstr("libpng 1."));
}

}  // namespace
}  // namespace obscura::media
