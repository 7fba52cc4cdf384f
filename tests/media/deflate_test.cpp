// Streams are read back by libdeflate, which did not write them, and held against its own in length.

#include "media/deflate.h"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "media/png.h"
#include "where.h"

namespace obscura::media {
namespace {

using Bytes = std::vector<std::uint8_t>;

// what a stream says, of so many bytes; empty where it is none
Bytes inflated(const Bytes& stream, std::size_t size) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> reader(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  Bytes bytes(size + 1);
  std::size_t got = 0, used = 0;
  const auto result = libdeflate_zlib_decompress_ex(reader.get(), stream.data(), stream.size(), bytes.data(),
                                                    bytes.size(), &used, &got);
  EXPECT_EQ(result, LIBDEFLATE_SUCCESS);
  EXPECT_EQ(used, stream.size());
  bytes.resize(got);
  return bytes;
}

std::size_t level_five(const Bytes& bytes) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> writer(
      libdeflate_alloc_compressor(5), libdeflate_free_compressor);
  Bytes out(libdeflate_zlib_compress_bound(writer.get(), bytes.size()));
  return libdeflate_zlib_compress(writer.get(), bytes.data(), bytes.size(), out.data(), out.size());
}

// rows of a picture as PNG has them
Bytes rows_of(const Image& image, std::size_t pixel) {
  Bytes rows;
  for (int y = 0; y < image.height; ++y) {
    rows.push_back(0);
    for (int x = 0; x < image.width; ++x)
      rows.insert(rows.end(), image.row(y) + 4 * x, image.row(y) + 4 * x + pixel);
  }
  return rows;
}

TEST(Deflate, AnyBytesComeBack) {
  std::mt19937 random(1);
  for (int round = 0; round < 400; ++round) {
    // few letters and many, runs, and pieces from far back
    const std::size_t size = random() % (round < 300 ? 700 : 90000),
                      letters = 1 + random() % (round % 3 ? 4 : 256);
    Bytes bytes;
    while (bytes.size() < size) {
      const std::size_t many = 1 + random() % 600;
      if (!bytes.empty() && random() % 2) {
        const std::size_t from = random() % bytes.size();
        for (std::size_t i = 0; i < many; ++i) bytes.push_back(bytes[from + i]);
      } else if (random() % 2) {
        bytes.insert(bytes.end(), many, std::uint8_t(random() % letters));
      } else {
        for (std::size_t i = 0; i < many % 40; ++i) bytes.push_back(std::uint8_t(random() % letters));
      }
    }
    bytes.resize(size);
    for (const auto& [row, pixel] : std::initializer_list<std::pair<std::size_t, std::size_t>>{
             {1 + random() % 3000, 3}, {40000, 4}, {1, 1}})
      ASSERT_EQ(inflated(deflated(bytes, row, pixel), size), bytes) << round << " " << size << " " << row;
  }
}

// the longest match is of 258, the shortest of 3: whatever is left of a run is in pieces of these
TEST(Deflate, RunsOfEveryLength) {
  for (std::size_t size = 0; size < 1100; ++size) {
    const Bytes bytes(size, 7);
    ASSERT_EQ(inflated(deflated(bytes, 5000, 3), size), bytes) << size;
  }
}

// codes of more than 15 bits are evened out: of counts as Fibonacci's numbers, Huffman's are as deep as can
// be
TEST(Deflate, CodesAreNoLongerThanTheyMayBe) {
  Bytes bytes;
  for (std::uint32_t letter = 0, many = 1, before = 1; letter < 18; ++letter) {
    bytes.insert(bytes.end(), many, std::uint8_t(letter));
    many += std::exchange(before, many);
  }
  std::shuffle(bytes.begin(), bytes.end(), std::mt19937(2));
  EXPECT_EQ(inflated(deflated(bytes, 100, 3), bytes.size()), bytes);
}

TEST(Deflate, DrawnPicturesTakeNoMoreThanByLibdeflatesLevelFive) {
  for (const char* name : {"room.png", "explosion.png", "room-screen.png", "scenes/bounce.png"}) {
    const Image image = read_png(std::string(OBSCURA_SOURCE_DIR "/docs/") + name).image;
    const Bytes rows = rows_of(image, 3);
    const Bytes stream = deflated(rows, 1 + 3 * std::size_t(image.width), 3);
    EXPECT_EQ(inflated(stream, rows.size()), rows);
    EXPECT_LE(stream.size(), level_five(rows)) << name;
  }
}

}  // namespace
}  // namespace obscura::media
