// GIF89a (CompuServe, 1990), written by hand: libav's encoder keeps one palette and one state for the whole
// film, and so cannot encode segments side by side.
//
//   header | logical screen, global palette | loop extension | comment
//   then for each frame: delay and transparency | rectangle, palette unless the global one | LZW blocks
//   trailer

#include "media/gif.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <memory>
#include <new>

#include "media/error.h"
#include "media/palette.h"
#include "media/tags.h"

namespace obscura::media {

namespace {

constexpr std::size_t kColours = 255;
constexpr std::uint8_t kAsBefore = 255;  // the index that leaves the pixel as it was

struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

void put16(std::vector<std::uint8_t>& out, int value) {
  out.push_back(std::uint8_t(value));
  out.push_back(std::uint8_t(value >> 8));
}

// a stream of codes of growing width, least bit first, in blocks of at most 255 bytes
class Blocks {
 public:
  explicit Blocks(std::vector<std::uint8_t>& out) : out_(out) {}

  void put(unsigned code, int bits) {
    held_ |= code << count_;
    count_ += bits;
    for (; count_ >= 8; count_ -= 8, held_ >>= 8) byte(std::uint8_t(held_));
  }
  void end() {
    if (count_ > 0) byte(std::uint8_t(held_));
    flush();
    out_.push_back(0);
  }

 private:
  void byte(std::uint8_t b) {
    block_[size_++] = b;
    if (size_ == block_.size()) flush();
  }
  void flush() {
    if (size_ == 0) return;
    out_.push_back(std::uint8_t(size_));
    out_.insert(out_.end(), block_.begin(), block_.begin() + std::ptrdiff_t(size_));
    size_ = 0;
  }

  std::vector<std::uint8_t>& out_;
  std::array<std::uint8_t, 255> block_{};
  std::size_t size_ = 0;
  unsigned held_ = 0;
  int count_ = 0;
};

// Welch's variant of Lempel and Ziv's second method, as GIF has it: 8-bit indices, codes of 9 to 12 bits
void put_lzw(std::vector<std::uint8_t>& out, std::span<const std::uint8_t> indices) {
  constexpr unsigned kClear = 256, kEnd = 257, kFirst = 258, kFull = 4096;
  out.push_back(8);
  Blocks blocks(out);

  // the strings known so far: (code of the string, next index) -> code of the longer string
  constexpr std::size_t kSlots = 1 << 13;
  std::vector<std::uint32_t> keys(kSlots);
  std::vector<std::uint16_t> codes(kSlots);
  constexpr std::uint32_t kNone = 0xffffffff;
  std::fill(keys.begin(), keys.end(), kNone);
  unsigned next = kFirst;
  int bits = 9;
  blocks.put(kClear, bits);

  unsigned current = indices[0];
  for (const std::uint8_t index : indices.subspan(1)) {
    const std::uint32_t key = current << 8 | index;
    std::size_t slot = key * 2654435761u >> 19;
    while (keys[slot] != kNone && keys[slot] != key) slot = (slot + 1) % kSlots;
    if (keys[slot] == key) {
      current = codes[slot];
      continue;
    }
    blocks.put(current, bits);
    current = index;
    if (next < kFull) {
      // the reader's table is one string behind ours, so codes widen when the one just made needs it
      if (next == 1u << bits) ++bits;
      keys[slot] = key;
      codes[slot] = std::uint16_t(next++);
    } else {
      blocks.put(kClear, bits);
      std::fill(keys.begin(), keys.end(), kNone);
      next = kFirst;
      bits = 9;
    }
  }
  blocks.put(current, bits);
  // the reader makes one more string of that last code
  if (next == 1u << bits && bits < 12) ++bits;
  blocks.put(kEnd, bits);
  blocks.end();
}

// the difference of two pictures
Rectangle changed(const std::vector<std::uint8_t>& before, const std::vector<std::uint8_t>& now, int width,
                  int height) {
  int x0 = width, x1 = -1, y0 = height, y1 = -1;
  for (int y = 0; y < height; ++y) {
    const std::uint8_t *a = before.data() + std::size_t(width) * y, *b = now.data() + std::size_t(width) * y;
    if (std::memcmp(a, b, std::size_t(width)) == 0) continue;
    y0 = std::min(y0, y), y1 = y;
    const int first = int(std::mismatch(a, a + width, b).first - a);
    int last = width - 1;
    while (a[last] == b[last]) --last;
    x0 = std::min(x0, first), x1 = std::max(x1, last);
  }
  // a frame must be of something: one pixel, as before
  return x1 < 0 ? Rectangle{0, 0, 1, 1} : Rectangle{x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

std::uint32_t packed(const std::uint8_t* p) { return std::uint32_t(p[0]) << 16 | p[1] << 8 | p[2]; }

}  // namespace

void check_gif(const std::string& path, const MovieSpec& spec) {
  if (spec.width <= 0 || spec.height <= 0 || spec.width > 65535 || spec.height > 65535) {
    throw Error(
        fmt::format("{}: no GIF of {}x{} pixels: a side is 1 to 65535", path, spec.width, spec.height));
  }
  if (spec.fps_num <= 0 || spec.fps_den <= 0) {
    throw Error(fmt::format("{}: no movie of {}/{} frames a second", path, spec.fps_num, spec.fps_den));
  }
  if (spec.fps_num > 50 * spec.fps_den) {
    throw Error(fmt::format(
        "{}: a GIF counts in hundredths of a second and plays at most 50 frames in one: try 25 or 50 "
        "frames a second",
        path));
  }
}

GifEncoder::GifEncoder(const std::string& path, const MovieSpec& spec)
    : width_(spec.width), height_(spec.height) {
  check_gif(path, spec);
}

void GifEncoder::add(const Image& frame) {
  assert(frame.width == width_ && frame.height == height_);
  // count the colours, run by run
  const std::size_t pixels = std::size_t(width_) * height_;
  const std::uint8_t* p = frame.pixels.data();
  for (std::size_t i = 0; i < pixels;) {
    const std::uint32_t colour = packed(p + 4 * i);
    std::size_t run = i + 1;
    while (run < pixels && packed(p + 4 * run) == colour) ++run;
    counts_[colour] += std::uint32_t(run - i);
    i = run;
  }

  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(1), libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::vector<std::uint8_t> bytes(libdeflate_deflate_compress_bound(compressor.get(), 4 * pixels));
  bytes.resize(libdeflate_deflate_compress(compressor.get(), p, 4 * pixels, bytes.data(), bytes.size()));
  bytes.shrink_to_fit();
  waiting_.push_back(std::move(bytes));
}

Segment GifEncoder::finish() {
  Segment segment;
  segment.frames = int(waiting_.size());
  const std::vector<std::uint32_t> colours = palette({counts_.begin(), counts_.end()}, kColours);
  for (const std::uint32_t colour : colours) {
    for (const int shift : {16, 8, 0}) segment.extradata.push_back(std::uint8_t(colour >> shift));
  }
  segment.extradata.resize(3 * 256);

  std::vector<std::uint8_t> index_of(std::size_t(1) << 24);
  for (const auto& [colour, count] : counts_) index_of[colour] = std::uint8_t(nearest(colours, colour));

  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  const std::size_t pixels = std::size_t(width_) * height_;
  std::vector<std::uint8_t> rgba(4 * pixels), before(pixels), now(pixels), indices;
  for (int n = 0; n < segment.frames; ++n) {
    const std::vector<std::uint8_t>& bytes = waiting_[std::size_t(n)];
    if (libdeflate_deflate_decompress(decompressor.get(), bytes.data(), bytes.size(), rgba.data(),
                                      rgba.size(), nullptr) != LIBDEFLATE_SUCCESS) {
      throw Error("libdeflate does not give back a picture");
    }
    for (std::size_t i = 0; i < pixels; ++i) now[i] = index_of[packed(&rgba[4 * i])];

    // the first frame whole, so that a segment needs none before it; later ones only where they changed
    const Rectangle part = n == 0 ? Rectangle{0, 0, width_, height_} : changed(before, now, width_, height_);
    indices.clear();
    for (int y = part.y; y < part.y + part.height; ++y) {
      for (int x = part.x; x < part.x + part.width; ++x) {
        const std::size_t i = std::size_t(width_) * y + x;
        indices.push_back(n > 0 && now[i] == before[i] ? kAsBefore : now[i]);
      }
    }
    Segment::Packet packet;
    for (const int v : {part.x, part.y, part.width, part.height}) put16(packet.bytes, v);
    put_lzw(packet.bytes, indices);
    packet.pts = packet.dts = n;
    packet.key = n == 0;
    segment.packets.push_back(std::move(packet));
    std::swap(before, now);
  }
  return segment;
}

GifWriter::GifWriter(const std::string& path, const MovieSpec& spec) : spec_(spec), file_(path) {
  check_gif(path, spec);
}

void GifWriter::add(const Segment& segment) {
  std::vector<std::uint8_t> out;
  if (frames_ == 0) {
    palette_ = segment.extradata;
    for (const char c : {'G', 'I', 'F', '8', '9', 'a'}) out.push_back(std::uint8_t(c));
    put16(out, spec_.width), put16(out, spec_.height);
    for (const int b : {0xf7, 0, 0})
      out.push_back(std::uint8_t(b));  // a palette of 256, ground 0, square pixels
    out.insert(out.end(), palette_.begin(), palette_.end());
    for (const int b : {0x21, 0xff, 11}) out.push_back(std::uint8_t(b));
    for (const char c : {'N', 'E', 'T', 'S', 'C', 'A', 'P', 'E', '2', '.', '0'})
      out.push_back(std::uint8_t(c));
    for (const int b : {3, 1, 0, 0, 0}) out.push_back(std::uint8_t(b));  // for ever
    const std::string text = comment(spec_.tags);
    out.push_back(0x21), out.push_back(0xfe);
    for (std::size_t at = 0; at < text.size(); at += 255) {
      const std::string block = text.substr(at, 255);
      out.push_back(std::uint8_t(block.size()));
      out.insert(out.end(), block.begin(), block.end());
    }
    out.push_back(0);
  }

  const auto end_of = [&](std::int64_t n) {  // hundredths, rounded
    return (200 * n * spec_.fps_den + spec_.fps_num) / (2 * spec_.fps_num);
  };
  for (const Segment::Packet& packet : segment.packets) {
    const std::int64_t delay = std::min<std::int64_t>(end_of(frames_ + 1) - end_of(frames_), 65535);
    ++frames_;
    // graphic control: leave the frame in place, index 255 transparent
    for (const int b : {0x21, 0xf9, 4, 0x05}) out.push_back(std::uint8_t(b));
    put16(out, int(delay));
    out.push_back(kAsBefore), out.push_back(0);
    out.push_back(0x2c);
    out.insert(out.end(), packet.bytes.begin(), packet.bytes.begin() + 8);
    const bool own = segment.extradata != palette_;
    out.push_back(own ? 0x87 : 0);
    if (own) out.insert(out.end(), segment.extradata.begin(), segment.extradata.end());
    out.insert(out.end(), packet.bytes.begin() + 8, packet.bytes.end());
  }
  file_.write(out);
}

Part gif_part(const std::string& path, std::span<const std::uint8_t> bytes) {
  const auto take = [&](std::size_t n) {
    if (bytes.size() < n) throw Error(path + ": is no whole GIF");
    const auto taken = bytes.first(n);
    bytes = bytes.subspan(n);
    return taken;
  };
  // blocks of up to 255 bytes, each after its length, to the empty one
  const auto take_blocks = [&](std::vector<std::uint8_t>* into, bool sizes) {
    for (;;) {
      const std::uint8_t size = take(1)[0];
      if (into && sizes) into->push_back(size);
      if (size == 0) return;
      const auto block = take(size);
      if (into) into->insert(into->end(), block.begin(), block.end());
    }
  };
  Part part;
  Segment& segment = part.segment;
  std::vector<std::uint8_t> words;
  take(13);
  const auto palette = take(3 * 256);
  segment.extradata.assign(palette.begin(), palette.end());
  for (;;) {
    const std::uint8_t kind = take(1)[0];
    if (kind == 0x3b && bytes.empty()) break;
    if (kind == 0x21) {
      const bool comment = take(1)[0] == 0xfe;
      take_blocks(comment ? &words : nullptr, false);
      continue;
    }
    if (kind != 0x2c) throw Error(path + ": is no whole GIF");
    Segment::Packet packet;
    const auto place = take(8);
    packet.bytes.assign(place.begin(), place.end());
    take(1);  // no palette of its own
    packet.bytes.push_back(take(1)[0]);
    take_blocks(&packet.bytes, true);
    packet.pts = packet.dts = segment.frames;
    packet.key = segment.frames++ == 0;
    segment.packets.push_back(std::move(packet));
  }
  if (segment.frames == 0) throw Error(path + ": is no whole GIF");
  part.tags = tags_of_comment({words.begin(), words.end()});
  return part;
}

void GifWriter::close(const std::string& instead) {
  const std::uint8_t trailer[] = {0x3b};
  file_.write(trailer);
  file_.place(true, instead);
}

}  // namespace obscura::media
