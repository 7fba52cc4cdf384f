// Deflate (RFC 1951) for pictures that are drawn: flat colours, thin antialiased edges, rows that repeat.
//
// Nearly all bytes of such a picture repeat the pixel before or the row above. A match is sought there first,
// and a long one is taken at once: nothing within it is looked at. Only what is left, edges of bodies and
// letters, is sought from pixel to pixel in chains of hashes, and one step ahead (lazy matching), as zlib
// does everywhere. A match is worth the bits that it saves: kLiteral for each of its bytes, less what its
// distance costs. A run of one pixel costs least, so what is as far back as a row is taken in one piece at
// most, and then looked at again.
//
// Frames of 1080p against libdeflate's level 5, ms and kB: bounce 2.8 for 8.2 and 45 for 49, the crowd of the
// benchmarks 11 for 13 and 305 for 307.

#include "media/deflate.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace obscura::media {

namespace {
constexpr int kWindow = 32768, kLeast = 3, kMostOfMatch = 258;
constexpr int kLong = 48;    // bytes of a match that is taken at once
constexpr int kLiteral = 8;  // bits of a byte without a match
constexpr int kCode = 8;     // bits of a match, beside those of its distance
constexpr int kDepth = 8;    // how many places of a hash are tried
constexpr int kHashBits = 15;
constexpr std::size_t kBlock = 4096;  // symbols that share one code

// ---- lengths and distances as symbols with further bits (RFC 1951, 3.2.5)

constexpr int kLengths = 29, kDistances = 30, kLiterals = 286, kEnd = 256;

struct Codes {
  std::array<std::uint16_t, kLengths> length{};
  std::array<std::uint8_t, kLengths> length_bits{};
  std::array<std::uint16_t, kDistances> distance{};
  std::array<std::uint8_t, kDistances> distance_bits{};
  std::array<std::uint8_t, kMostOfMatch + 1> of_length{};
  std::array<std::uint8_t, 512> of_distance{};  // of distance - 1: below 256, and in 128s

  constexpr Codes() {
    for (int code = 0, least = kLeast; code < kLengths; ++code) {
      const int bits = code < 8 || code == 28 ? 0 : code / 4 - 1;
      if (code == 28) least = kMostOfMatch;
      length[std::size_t(code)] = std::uint16_t(least), length_bits[std::size_t(code)] = std::uint8_t(bits);
      for (int n = least; n < least + (1 << bits) && n <= kMostOfMatch; ++n)
        of_length[std::size_t(n)] = std::uint8_t(code);
      least += 1 << bits;
    }
    for (int code = 0, least = 1; code < kDistances; ++code) {
      const int bits = code < 4 ? 0 : code / 2 - 1;
      distance[std::size_t(code)] = std::uint16_t(least),
      distance_bits[std::size_t(code)] = std::uint8_t(bits);
      for (int n = least - 1; n < least - 1 + (1 << bits); ++n) {
        if (n < 256)
          of_distance[std::size_t(n)] = std::uint8_t(code);
        else
          of_distance[std::size_t(256 + n / 128)] = std::uint8_t(code);
      }
      least += 1 << bits;
    }
  }
  int distance_code(int back) const {
    const int n = back - 1;
    return of_distance[std::size_t(n < 256 ? n : 256 + n / 128)];
  }
};
constexpr Codes kCodes;

// ---- bits, the lowest first

class Bits {
 public:
  explicit Bits(std::vector<std::uint8_t>& out) : out_(out), used_(out.size()) {}
  void put(std::uint32_t bits, int count) {
    held_ |= std::uint64_t(bits) << count_;
    count_ += count;
    if (count_ < 32) return;
    if (used_ + 4 > out_.size()) out_.resize(2 * out_.size() + 4096);
    for (int k = 0; k < 4; ++k) out_[used_++] = std::uint8_t(held_ >> (8 * k));
    held_ >>= 32;
    count_ -= 32;
  }
  void finish() {
    out_.resize(used_);
    for (; count_ > 0; count_ -= 8, held_ >>= 8) out_.push_back(std::uint8_t(held_));
  }

 private:
  std::vector<std::uint8_t>& out_;
  std::size_t used_;
  std::uint64_t held_ = 0;
  int count_ = 0;
};

// ---- Huffman's codes, of at most so many bits

struct Code {
  std::vector<std::uint8_t> lengths;
  std::vector<std::uint16_t> bits;  // reversed, as they are written
};

// Huffman's lengths by two queues; where one is above `most`, lengths are evened out: as many of each length
// as keep Kraft's sum, the short ones for what is frequent.
Code code_of(std::span<const std::uint32_t> counts, int most) {
  const std::size_t n = counts.size();
  Code code{std::vector<std::uint8_t>(n), std::vector<std::uint16_t>(n)};
  std::vector<std::uint16_t> order;
  for (std::size_t i = 0; i < n; ++i)
    if (counts[i] > 0) order.push_back(std::uint16_t(i));
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return counts[a] < counts[b]; });
  const std::size_t used = order.size();
  // a code of one symbol, or none, is written as one of two
  for (std::size_t i = 0; used < 2 && i < 2; ++i) code.lengths[i] = 1;
  if (used == 1 && order[0] > 1) code.lengths[order[0]] = 1, code.lengths[1] = 0;
  std::vector<int> of_length(std::size_t(most) + 1);
  if (used >= 2) {
    std::vector<std::uint64_t> weight(2 * used - 1);
    std::vector<std::size_t> parent(2 * used - 1);
    for (std::size_t i = 0; i < used; ++i) weight[i] = counts[order[i]];
    std::size_t leaf = 0, inner = used;
    for (std::size_t made = used; made < 2 * used - 1; ++made) {
      for (int k = 0; k < 2; ++k) {
        const std::size_t next =
            leaf < used && (inner >= made || weight[leaf] <= weight[inner]) ? leaf++ : inner++;
        weight[made] += weight[next], parent[next] = made;
      }
    }
    std::vector<int> depth(2 * used - 1);
    for (std::size_t i = 2 * used - 2; i-- > 0;) depth[i] = depth[parent[i]] + 1;
    for (std::size_t i = 0; i < used; ++i) ++of_length[std::size_t(std::min(depth[i], most))];
    std::int64_t over = -(std::int64_t(1) << most);
    for (int length = 1; length <= most; ++length)
      over += std::int64_t(of_length[std::size_t(length)]) << (most - length);
    for (; over > 0; --over) {
      --of_length[std::size_t(most)];
      int length = most - 1;
      while (of_length[std::size_t(length)] == 0) --length;
      --of_length[std::size_t(length)];
      of_length[std::size_t(length) + 1] += 2;
    }
    std::size_t next = 0;
    for (int length = most; length >= 1; --length)
      for (int i = 0; i < of_length[std::size_t(length)]; ++i)
        code.lengths[order[next++]] = std::uint8_t(length);
  }

  std::array<std::uint32_t, 17> first{}, many{};
  for (const std::uint8_t length : code.lengths) ++many[length];
  many[0] = 0;
  for (std::size_t length = 1; length <= 16; ++length)
    first[length] = (first[length - 1] + many[length - 1]) << 1;
  for (std::size_t i = 0; i < n; ++i) {
    const int length = code.lengths[i];
    if (length == 0) continue;
    std::uint32_t bits = first[std::size_t(length)]++, turned = 0;
    for (int k = 0; k < length; ++k) turned = turned << 1 | (bits >> k & 1);
    code.bits[i] = std::uint16_t(turned);
  }
  return code;
}

// ---- blocks

// A literal, or a match: kMatch | length << 16 | distance - 1.
constexpr std::uint32_t kMatch = 0x80000000;

class DeflateBlocks {
 public:
  explicit DeflateBlocks(std::vector<std::uint8_t>& out) : bits_(out) { symbols_.reserve(kBlock + 1); }

  void literal(std::uint8_t byte) {
    symbols_.push_back(byte);
    ++literals_[byte];
    if (symbols_.size() >= kBlock) write(false);
  }
  // splits what is longer than a match may be
  void match(std::size_t length, int distance) {
    const int code = kCodes.distance_code(distance);
    while (length > 0) {
      std::size_t part = std::min<std::size_t>(length, kMostOfMatch);
      if (length > kMostOfMatch && length < kMostOfMatch + kLeast) part = kMostOfMatch - kLeast;
      symbols_.push_back(kMatch | std::uint32_t(part) << 16 | std::uint32_t(distance - 1));
      ++literals_[257u + kCodes.of_length[part]];
      ++distances_[std::size_t(code)];
      length -= part;
      if (symbols_.size() >= kBlock) write(false);
    }
  }
  void finish() {
    write(true);
    bits_.finish();
  }

 private:
  void write(bool last);
  void write_codes(const Code& literals, const Code& distances);

  Bits bits_;
  std::vector<std::uint32_t> symbols_;
  std::array<std::uint32_t, kLiterals> literals_{};
  std::array<std::uint32_t, kDistances> distances_{};
};

void DeflateBlocks::write(bool last) {
  ++literals_[kEnd];
  const Code literals = code_of(literals_, 15), distances = code_of(distances_, 15);
  bits_.put(last ? 1 : 0, 1);
  bits_.put(2, 2);
  write_codes(literals, distances);
  for (const std::uint32_t symbol : symbols_) {
    if (!(symbol & kMatch)) {
      bits_.put(literals.bits[symbol], literals.lengths[symbol]);
      continue;
    }
    const int length = int(symbol >> 16 & 0x7fff), distance = int(symbol & 0xffff) + 1;
    const std::size_t l = kCodes.of_length[std::size_t(length)],
                      d = std::size_t(kCodes.distance_code(distance));
    bits_.put(literals.bits[257 + l], literals.lengths[257 + l]);
    bits_.put(std::uint32_t(length - kCodes.length[l]), kCodes.length_bits[l]);
    bits_.put(distances.bits[d], distances.lengths[d]);
    bits_.put(std::uint32_t(distance - kCodes.distance[d]), kCodes.distance_bits[d]);
  }
  bits_.put(literals.bits[kEnd], literals.lengths[kEnd]);
  symbols_.clear();
  literals_.fill(0), distances_.fill(0);
}

// the lengths of both codes, by runs, in a code of their own (3.2.7)
void DeflateBlocks::write_codes(const Code& literals, const Code& distances) {
  std::size_t many = kLiterals, far = kDistances;
  while (many > 257 && literals.lengths[many - 1] == 0) --many;
  while (far > 1 && distances.lengths[far - 1] == 0) --far;
  std::vector<std::uint8_t> all(literals.lengths.begin(), literals.lengths.begin() + std::ptrdiff_t(many));
  all.insert(all.end(), distances.lengths.begin(), distances.lengths.begin() + std::ptrdiff_t(far));

  struct Run {
    std::uint8_t symbol, bits, rest;
  };
  std::vector<Run> runs;
  std::array<std::uint32_t, 19> counts{};
  const auto add = [&](int symbol, int bits, std::size_t rest) {
    runs.push_back({std::uint8_t(symbol), std::uint8_t(bits), std::uint8_t(rest)});
    ++counts[std::size_t(symbol)];
  };
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i + 1;
    while (end < all.size() && all[end] == all[i]) ++end;
    std::size_t run = end - i;
    if (all[i] == 0) {
      for (; run >= 11; run -= std::min<std::size_t>(run, 138))
        add(18, 7, std::min<std::size_t>(run, 138) - 11);
      if (run >= 3) add(17, 3, run - 3), run = 0;
    } else {
      add(all[i], 0, 0), --run;
      for (; run >= 3; run -= std::min<std::size_t>(run, 6)) add(16, 2, std::min<std::size_t>(run, 6) - 3);
    }
    for (; run > 0; --run) add(all[i], 0, 0);
    i = end;
  }
  const Code code = code_of(counts, 7);
  static constexpr std::uint8_t kOrder[19] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                              11, 4,  12, 3, 13, 2, 14, 1, 15};
  int shown = 19;
  while (shown > 4 && code.lengths[kOrder[shown - 1]] == 0) --shown;
  bits_.put(std::uint32_t(many - 257), 5);
  bits_.put(std::uint32_t(far - 1), 5);
  bits_.put(std::uint32_t(shown - 4), 4);
  for (int i = 0; i < shown; ++i) bits_.put(code.lengths[kOrder[i]], 3);
  for (const Run& run : runs) {
    bits_.put(code.bits[run.symbol], code.lengths[run.symbol]);
    bits_.put(run.rest, run.bits);
  }
}

// ---- matches

std::uint32_t four(const std::uint8_t* p) {
  std::uint32_t word;
  std::memcpy(&word, p, 4);
  return word;
}

// how many bytes are the same, up to `end` of the second
std::size_t alike(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* end) {
  const std::uint8_t* const from = b;
  while (b + 8 <= end) {
    std::uint64_t x, y;
    std::memcpy(&x, a, 8);
    std::memcpy(&y, b, 8);
    if (x != y) {
      const int same =
          std::endian::native == std::endian::little ? std::countr_zero(x ^ y) : std::countl_zero(x ^ y);
      return std::size_t(b - from) + std::size_t(same / 8);
    }
    a += 8, b += 8;
  }
  while (b < end && *a == *b) ++a, ++b;
  return std::size_t(b - from);
}

struct Match {
  std::size_t length = 0;
  int distance = 0;
  int gain = 0;  // bits
};

class Matcher {
 public:
  Matcher(std::span<const std::uint8_t> bytes, std::size_t row, std::size_t pixel)
      : begin_(bytes.data()),
        end_(begin_ + bytes.size()),
        row_(std::uint32_t(row)),
        pixel_(std::uint32_t(pixel)),
        heads_(std::size_t(1) << kHashBits, -1),
        nearest_(heads_),
        before_(kWindow) {}

  /// The best match at a place, of those that begin before it.
  Match at(const std::uint8_t* p) const {
    Match best;
    const auto here = std::int32_t(p - begin_);
    if (here >= std::int32_t(pixel_)) consider(p, int(pixel_), end_, best);
    if (best.length >= kMostOfMatch) return best;
    const std::uint8_t* const end = end_ - p > kMostOfMatch ? p + kMostOfMatch : end_;
    if (row_ <= kWindow && here >= std::int32_t(row_)) consider(p, int(row_), end, best);
    if (best.length >= kLong || end_ - p < 4 || !begins_pixel(p)) return best;

    if (best.length < 4) {
      const std::int32_t near = nearest_[hash3(p)];
      if (near >= 0 && here - near <= kWindow) consider(p, here - near, end, best);
    }
    const std::uint32_t word = four(p);
    std::int32_t there = heads_[hash4(p)];
    for (int tried = 0; tried < kDepth && there >= 0 && here - there <= kWindow; ++tried) {
      // it is farther: only what is longer is better
      if (best.length >= std::size_t(end - p)) break;
      if (begin_[std::size_t(there) + best.length] == p[best.length] && four(begin_ + there) == word)
        consider(p, here - there, end, best);
      const std::int32_t next = before_[std::size_t(there) % kWindow];
      if (next >= there) break;  // another's by now
      there = next;
    }
    return best;
  }

  /// Remembers the places where pixels begin, from p to before `end`.
  void note(const std::uint8_t* p, const std::uint8_t* end) {
    if (end_ - p < 4) return;
    end = std::min(end, end_ - 3);
    while (p < end && !begins_pixel(p)) ++p;
    while (p < end) {
      remember(p);
      p += pixel_;
      if (p < end && !begins_pixel(p)) ++p;  // a row's first byte
    }
  }

 private:
  bool begins_pixel(const std::uint8_t* p) const {
    return std::uint32_t(p - begin_) % row_ % pixel_ == 1 % pixel_;
  }
  static std::size_t hash4(const std::uint8_t* p) { return (four(p) * 0x9E3779B1u) >> (32 - kHashBits); }
  // of the first three in a row of memory, on a system of either order
  static std::size_t hash3(const std::uint8_t* p) {
    return ((std::uint32_t(p[0]) << 8 | std::uint32_t(p[1]) << 16 | std::uint32_t(p[2]) << 24) *
            0x9E3779B1u) >>
           (32 - kHashBits);
  }
  void remember(const std::uint8_t* p) {
    const auto here = std::int32_t(p - begin_);
    std::int32_t& head = heads_[hash4(p)];
    nearest_[hash3(p)] = here;
    before_[std::size_t(here) % kWindow] = head;
    head = here;
  }
  void consider(const std::uint8_t* p, int distance, const std::uint8_t* end, Match& best) const {
    const std::size_t length = alike(p - distance, p, end);
    if (length < kLeast) return;
    const int bits = kCode + kCodes.distance_bits[std::size_t(kCodes.distance_code(distance))];
    const int gain = int(std::min<std::size_t>(length, kMostOfMatch)) * kLiteral - bits;
    if (gain > best.gain) best = {length, distance, gain};
  }

  const std::uint8_t *begin_, *end_;
  std::uint32_t row_, pixel_;
  std::vector<std::int32_t> heads_, nearest_, before_;  // offsets; -1: none
};

}  // namespace

std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes, std::size_t row, std::size_t pixel) {
  std::vector<std::uint8_t> out = {0x78, 0x5e};  // a window of 32 KiB, a quick method (RFC 1950, 2.2)
  DeflateBlocks blocks(out);
  Matcher matcher(bytes, row, pixel);
  const std::uint8_t *p = bytes.data(), *const end = p + bytes.size();
  while (p < end) {
    Match match = matcher.at(p);
    matcher.note(p, p + 1);
    while (match.gain > 0 && match.length < kLong && p + 1 < end) {
      const Match next = matcher.at(p + 1);
      if (next.gain <= match.gain + kLiteral) break;
      blocks.literal(*p++);
      matcher.note(p, p + 1);
      match = next;
    }
    if (match.gain <= 0) {
      blocks.literal(*p++);
      continue;
    }
    blocks.match(match.length, match.distance);
    // of a long match the last places alone are worth noting
    const std::uint8_t* const after = p + match.length;
    matcher.note(match.length > 2 * kLong ? after - kLong : p + 1, after);
    p = after;
  }
  blocks.finish();
  const std::uint32_t sum = libdeflate_adler32(1, bytes.data(), bytes.size());
  for (int k = 3; k >= 0; --k) out.push_back(std::uint8_t(sum >> (8 * k)));
  return out;
}

}  // namespace obscura::media
