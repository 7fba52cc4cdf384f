#include "media/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <fstream>

#include "media/error.h"
#include "media/pictures.h"

namespace obscura::media {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// "<length> IHDR ...": the names of a PNG's chunks
std::vector<std::string> chunks(const std::vector<std::uint8_t>& png) {
  std::vector<std::string> names;
  for (std::size_t at = 8; at + 8 <= png.size();) {
    const std::size_t length =
        std::size_t(png[at]) << 24 | png[at + 1] << 16 | png[at + 2] << 8 | png[at + 3];
    names.emplace_back(png.begin() + std::ptrdiff_t(at) + 4, png.begin() + std::ptrdiff_t(at) + 8);
    at += 12 + length;
  }
  return names;
}

std::string message_of_reading(const std::string& path) {
  try {
    read_png(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Png, ReadsBackTheOpaquePictureThatWasWritten) {
  Folder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {641, 357}}) {
    Image image = random_image(width, height, 1);
    write_png(folder / "a.png", image);
    for (std::size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = 255;
    EXPECT_EQ(read_png(folder / "a.png").image, image);
  }
  EXPECT_THAT(folder.names(), ElementsAre("a.png"));
}

TEST(Png, KeepsAlphaWhenAsked) {
  Folder folder;
  const Image image = random_image(37, 23, 2);
  write_png(folder / "a.png", image, {.alpha = true});
  EXPECT_EQ(read_png(folder / "a.png").image, image);
}

TEST(Png, CarriesTagsInAnyLanguage) {
  Folder folder;
  const Tags tags{{"Title", "Ein Würfel fällt, t = 3.42 s ✓"},
                  {"Scene", std::string(20000, 'x') + "\n[room]\n"},
                  {"Empty", ""}};
  write_png(folder / "a.png", random_image(4, 4, 3), {.tags = tags});
  EXPECT_EQ(read_png(folder / "a.png").tags, tags);
}

TEST(Png, SaysItIsSrgbAndNotWhenItWasMade) {
  const auto bytes = encode_png(random_image(8, 8, 4), {.tags = {{"Title", "a"}}});
  auto all = chunks(bytes);
  ASSERT_EQ(all.size(), 7u);
  std::sort(all.begin() + 1, all.begin() + 4);  // of one colour space: their order is libpng's
  EXPECT_THAT(all, ElementsAre("IHDR", "cHRM", "gAMA", "sRGB", "iTXt", "IDAT", "IEND"));
}

TEST(Png, IsTheSameBytesEveryTime) {
  const Image image = moving_picture(320, 180, 1.0);
  EXPECT_EQ(encode_png(image), encode_png(image));
}

// libpng's own default, for the size to compare with
std::size_t size_by_default(const Image& image) {
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
    rgb.insert(rgb.end(), image.pixels.begin() + std::ptrdiff_t(i),
               image.pixels.begin() + std::ptrdiff_t(i) + 3);
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(image.width);
  png.height = png_uint_32(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&png, nullptr, &size, 0, rgb.data(), 0, nullptr);
  return size;
}

// The bar is a tenth more than libpng's default settings give; 1080p frames of ours take 80 to 104 %.
TEST(Png, IsWithinATenthOfLibpngsDefaultSize) {
  const Image image = moving_picture(1280, 720, 2.0);
  EXPECT_LT(double(encode_png(image).size()), 1.1 * double(size_by_default(image)));
}

TEST(Png, ReadsPalettesGreysAndSixteenBits) {
  Folder folder;
  const auto write = [&](const char* name, png_uint_32 format, const void* pixels, const void* map) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = 2;
    png.height = 1;
    png.format = format;
    png.colormap_entries = map ? 2 : 0;
    ASSERT_TRUE(png_image_write_to_file(&png, (folder / name).c_str(), 0, pixels, 0, map)) << png.message;
  };
  const std::uint8_t grey[] = {7, 200}, indices[] = {1, 0}, map[] = {1, 2, 3, 250, 251, 252};
  write("grey.png", PNG_FORMAT_GRAY, grey, nullptr);
  write("map.png", PNG_FORMAT_RGB_COLORMAP, indices, map);
  EXPECT_THAT(read_png(folder / "grey.png").image.pixels, ElementsAre(7, 7, 7, 255, 200, 200, 200, 255));
  EXPECT_THAT(read_png(folder / "map.png").image.pixels, ElementsAre(250, 251, 252, 255, 1, 2, 3, 255));
}

TEST(Png, ReadingNamesThePathOfWhatIsMissingOrDamaged) {
  Folder folder;
  EXPECT_THAT(message_of_reading(folder / "none.png"), HasSubstr("none.png: cannot read: No such file"));

  const auto good = encode_png(moving_picture(64, 48, 0));
  const auto damaged = [&](const char* name, std::vector<std::uint8_t> bytes) {
    std::ofstream(folder / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return message_of_reading(folder / name);
  };
  EXPECT_THAT(damaged("empty.png", {}), HasSubstr("empty.png: not a readable PNG"));
  EXPECT_THAT(damaged("text.png", std::vector<std::uint8_t>(100, 'x')),
              HasSubstr("text.png: not a readable PNG"));
  // cut off at every length
  for (std::size_t n = 0; n < good.size(); n += 61) {
    EXPECT_THAT(damaged("cut.png", {good.begin(), good.begin() + std::ptrdiff_t(n)}),
                HasSubstr("cut.png: not a readable PNG"));
  }
  auto flipped = good;
  flipped[good.size() / 2] ^= 0x40;
  EXPECT_THAT(damaged("flipped.png", flipped), HasSubstr("flipped.png: not a readable PNG"));
}

TEST(Png, OfAPointerOfGitLfsSaysHowThePictureIsFetched) {
  Folder folder;
  std::ofstream(folder / "pointer.png")
      << "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2\nsize 12345\n";
  EXPECT_THAT(message_of_reading(folder / "pointer.png"),
              HasSubstr("pointer.png: not a readable PNG: it is a pointer of git-LFS; `git lfs pull`"));
}

TEST(Png, AShortFileThatPromisesAVastPictureTakesNoMemory) {
  Folder folder;
  auto bytes = encode_png(random_image(1, 1, 5));
  // 60000 x 60000 in the header, with its checksum
  const std::uint8_t header[] = {'I', 'H', 'D', 'R', 0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60, 8, 2, 0, 0, 0};
  std::uint32_t crc = 0xffffffff;
  for (const std::uint8_t byte : header) {
    crc ^= byte;
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1)));
  }
  crc = ~crc;
  std::copy(std::begin(header), std::end(header), bytes.begin() + 12);
  for (int k = 0; k < 4; ++k) bytes[std::size_t(29 + k)] = std::uint8_t(crc >> (24 - 8 * k));
  std::ofstream(folder / "vast.png", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  EXPECT_THAT(message_of_reading(folder / "vast.png"), HasSubstr("too short for its size"));
}

std::string message_of_writing(const std::string& path) {
  try {
    write_png(path, random_image(64, 64, 6));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Png, WritingNamesThePathThatCannotBe) {
  Folder folder;
  EXPECT_THAT(message_of_writing(folder / "no/such/a.png"),
              HasSubstr("no/such/a.png: cannot write: No such file or directory"));
  EXPECT_THAT(message_of_writing("/dev/full"), HasSubstr("/dev/full: cannot write: No space left on device"));
  std::filesystem::create_directory(folder / "dir.png");
  EXPECT_THAT(message_of_writing(folder / "dir.png"), HasSubstr("dir.png: cannot write: Is a directory"));
  EXPECT_THAT(folder.names(), ElementsAre("dir.png"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(Png, WritesThroughALink) {
  Folder folder;
  write_png(folder / "a.png", random_image(4, 4, 7));
  std::filesystem::create_symlink("a.png", folder / "b.png");
  const Image image = moving_picture(32, 32, 0);
  write_png(folder / "b.png", image);
  EXPECT_EQ(read_png(folder / "a.png").image, image);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "b.png"));
}

}  // namespace
}  // namespace obscura::media
