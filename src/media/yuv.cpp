// RGB to limited-range Y'CbCr 4:2:0, ITU-R BT.709-6 items 3.2 to 3.5, exactly rounded.
//
//   Y  =  16 + 219/255 (Kr R + Kg G + Kb B)              Kr = 0.2126, Kg = 0.7152, Kb = 0.0722
//   Cb = 128 + 224/255 (B - E) / (2 (1 - Kb))            E = Kr R + Kg G + Kb B
//   Cr = 128 + 224/255 (R - E) / (2 (1 - Kr))            R, G, B = 0..255
//
// In integers, with sums over the four pixels of a chroma sample (index 4) and the common factors cancelled:
//
//   S = 1063 R + 3576 G + 361 B                          Y  = 16 + 73 S / 425000
//   U = -1063 R4 - 3576 G4 + 4639 B4                     Cb = 128 + 28 U / 1182945
//   V = 3937 R4 - 3576 G4 - 361 B4                       Cr = 128 + 28 V / 1003935
//
// The scalar loop divides these integers. The lanes multiply by a reciprocal in floating point, each step of
// which is one correctly rounded IEEE operation; that the truncated product is the quotient was tried for
// every S, U and V there is (the test tries them again).
//   luma: (73 S + 16.5 * 425000) / 425000 = t / 53125, t the numerator / 8 without remainder: t < 2^24 is
//   exact in a float, and the product's error, 1.5e-5 at most, stays below the step 1 / 53125. chroma: a
//   double's error, 1e-13, is far below the step 1 / 2365890, and no value lies on a half.

#include "media/yuv.h"

#include <cassert>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace obscura::media {

namespace {

std::uint8_t luma(const std::uint8_t* p) {
  const int s = 1063 * p[0] + 3576 * p[1] + 361 * p[2];
  return std::uint8_t((73 * s + 7012500) / 425000);
}

void scalar_rows(const std::uint8_t* top, const std::uint8_t* bottom, int from, int width, std::uint8_t* y0,
                 std::uint8_t* y1, std::uint8_t* u, std::uint8_t* v) {
  for (int x = from; x < width; x += 2) {
    const std::uint8_t *a = top + 4 * x, *b = bottom + 4 * x;
    y0[x] = luma(a);
    y0[x + 1] = luma(a + 4);
    y1[x] = luma(b);
    y1[x + 1] = luma(b + 4);
    const int red = a[0] + a[4] + b[0] + b[4];
    const int green = a[1] + a[5] + b[1] + b[5];
    const int blue = a[2] + a[6] + b[2] + b[6];
    const int cb = -1063 * red - 3576 * green + 4639 * blue;
    const int cr = 3937 * red - 3576 * green - 361 * blue;
    u[x / 2] = std::uint8_t((56 * cb + 257 * 1182945) / (2 * 1182945));
    v[x / 2] = std::uint8_t((56 * cr + 257 * 1003935) / (2 * 1003935));
  }
}

#if defined(__x86_64__)

constexpr float kLuma = 1.0f / 53125;
constexpr double kBlue = 28.0 / 1182945, kRed = 28.0 / 1003935;

// two 16-bit factors for each 32-bit lane: the low one for red or green, the high one for blue or alpha
constexpr int factors(int low, int high) { return (high << 16) | (low & 0xffff); }

// ---- SSE2: 8 columns of two rows at a time

__m128i luma4(__m128i rb, __m128i ga) {
  const __m128i s = _mm_add_epi32(_mm_madd_epi16(rb, _mm_set1_epi32(factors(1063, 361))),
                                  _mm_madd_epi16(ga, _mm_set1_epi32(factors(3576, 0))));
  // 73 s = 64 s + 8 s + s
  const __m128i s73 = _mm_add_epi32(_mm_add_epi32(_mm_slli_epi32(s, 6), _mm_slli_epi32(s, 3)), s);
  const __m128i t = _mm_srli_epi32(_mm_add_epi32(s73, _mm_set1_epi32(7012500)), 3);
  return _mm_cvttps_epi32(_mm_mul_ps(_mm_cvtepi32_ps(t), _mm_set1_ps(kLuma)));
}

// the sum of each two neighbours of a and b
__m128i pairs(__m128i a, __m128i b) {
  const __m128 x = _mm_castsi128_ps(a), y = _mm_castsi128_ps(b);
  return _mm_add_epi32(_mm_castps_si128(_mm_shuffle_ps(x, y, _MM_SHUFFLE(2, 0, 2, 0))),
                       _mm_castps_si128(_mm_shuffle_ps(x, y, _MM_SHUFFLE(3, 1, 3, 1))));
}

__m128i chroma4(__m128i c, double scale) {
  const __m128d k = _mm_set1_pd(scale), middle = _mm_set1_pd(128.5);
  const __m128d low = _mm_cvtepi32_pd(c);
  const __m128d high = _mm_cvtepi32_pd(_mm_shuffle_epi32(c, _MM_SHUFFLE(3, 2, 3, 2)));
  return _mm_unpacklo_epi64(_mm_cvttpd_epi32(_mm_add_pd(_mm_mul_pd(low, k), middle)),
                            _mm_cvttpd_epi32(_mm_add_pd(_mm_mul_pd(high, k), middle)));
}

void store4(std::uint8_t* to, __m128i c) {
  const __m128i bytes = _mm_packus_epi16(_mm_packs_epi32(c, c), _mm_setzero_si128());
  _mm_storeu_si32(to, bytes);
}

int sse2_rows(const std::uint8_t* top, const std::uint8_t* bottom, int width, std::uint8_t* y0,
              std::uint8_t* y1, std::uint8_t* u, std::uint8_t* v) {
  const __m128i low = _mm_set1_epi32(0x00ff00ff);
  int x = 0;
  for (; x + 8 <= width; x += 8) {
    __m128i luma_top[2], luma_bottom[2], cb[2], cr[2];
    for (int k = 0; k < 2; ++k) {
      const __m128i a = _mm_loadu_si128(reinterpret_cast<const __m128i*>(top + 4 * x) + k);
      const __m128i b = _mm_loadu_si128(reinterpret_cast<const __m128i*>(bottom + 4 * x) + k);
      const __m128i a_rb = _mm_and_si128(a, low), a_ga = _mm_srli_epi16(a, 8);
      const __m128i b_rb = _mm_and_si128(b, low), b_ga = _mm_srli_epi16(b, 8);
      luma_top[k] = luma4(a_rb, a_ga);
      luma_bottom[k] = luma4(b_rb, b_ga);
      const __m128i rb = _mm_add_epi16(a_rb, b_rb), ga = _mm_add_epi16(a_ga, b_ga);
      const __m128i green = _mm_madd_epi16(ga, _mm_set1_epi32(factors(-3576, 0)));
      cb[k] = _mm_add_epi32(_mm_madd_epi16(rb, _mm_set1_epi32(factors(-1063, 4639))), green);
      cr[k] = _mm_add_epi32(_mm_madd_epi16(rb, _mm_set1_epi32(factors(3937, -361))), green);
    }
    const __m128i rows = _mm_packus_epi16(_mm_packs_epi32(luma_top[0], luma_top[1]),
                                          _mm_packs_epi32(luma_bottom[0], luma_bottom[1]));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(y0 + x), rows);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(y1 + x), _mm_unpackhi_epi64(rows, rows));
    store4(u + x / 2, chroma4(pairs(cb[0], cb[1]), kBlue));
    store4(v + x / 2, chroma4(pairs(cr[0], cr[1]), kRed));
  }
  return x;
}

// ---- AVX2: 16 columns of two rows at a time

#define OBSCURA_AVX2 __attribute__((target("avx2"), always_inline)) inline

OBSCURA_AVX2 __m256i luma8(__m256i rb, __m256i ga) {
  const __m256i s = _mm256_add_epi32(_mm256_madd_epi16(rb, _mm256_set1_epi32(factors(1063, 361))),
                                     _mm256_madd_epi16(ga, _mm256_set1_epi32(factors(3576, 0))));
  const __m256i s73 = _mm256_add_epi32(_mm256_add_epi32(_mm256_slli_epi32(s, 6), _mm256_slli_epi32(s, 3)), s);
  const __m256i t = _mm256_srli_epi32(_mm256_add_epi32(s73, _mm256_set1_epi32(7012500)), 3);
  return _mm256_cvttps_epi32(_mm256_mul_ps(_mm256_cvtepi32_ps(t), _mm256_set1_ps(kLuma)));
}

// the sum of each two neighbours of a and b, in order
OBSCURA_AVX2 __m256i pairs(__m256i a, __m256i b) {
  return _mm256_permute4x64_epi64(_mm256_hadd_epi32(a, b), _MM_SHUFFLE(3, 1, 2, 0));
}

OBSCURA_AVX2 __m128i chroma4(__m128i c, __m256d scale) {
  const __m256d middle = _mm256_set1_pd(128.5);
  return _mm256_cvttpd_epi32(_mm256_add_pd(_mm256_mul_pd(_mm256_cvtepi32_pd(c), scale), middle));
}

OBSCURA_AVX2 void store8(std::uint8_t* to, __m256i c, double scale) {
  const __m256d k = _mm256_set1_pd(scale);
  const __m128i words =
      _mm_packs_epi32(chroma4(_mm256_castsi256_si128(c), k), chroma4(_mm256_extracti128_si256(c, 1), k));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(to), _mm_packus_epi16(words, words));
}

__attribute__((target("avx2"))) int avx2_rows(const std::uint8_t* top, const std::uint8_t* bottom, int width,
                                              std::uint8_t* y0, std::uint8_t* y1, std::uint8_t* u,
                                              std::uint8_t* v) {
  const __m256i low = _mm256_set1_epi32(0x00ff00ff);
  // the packs below work within halves; this puts their groups of four bytes in order
  const __m256i order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
  int x = 0;
  for (; x + 16 <= width; x += 16) {
    __m256i luma_top[2], luma_bottom[2], cb[2], cr[2];
    for (int k = 0; k < 2; ++k) {
      const __m256i a = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(top + 4 * x) + k);
      const __m256i b = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bottom + 4 * x) + k);
      const __m256i a_rb = _mm256_and_si256(a, low), a_ga = _mm256_srli_epi16(a, 8);
      const __m256i b_rb = _mm256_and_si256(b, low), b_ga = _mm256_srli_epi16(b, 8);
      luma_top[k] = luma8(a_rb, a_ga);
      luma_bottom[k] = luma8(b_rb, b_ga);
      const __m256i rb = _mm256_add_epi16(a_rb, b_rb), ga = _mm256_add_epi16(a_ga, b_ga);
      const __m256i green = _mm256_madd_epi16(ga, _mm256_set1_epi32(factors(-3576, 0)));
      cb[k] = _mm256_add_epi32(_mm256_madd_epi16(rb, _mm256_set1_epi32(factors(-1063, 4639))), green);
      cr[k] = _mm256_add_epi32(_mm256_madd_epi16(rb, _mm256_set1_epi32(factors(3937, -361))), green);
    }
    const __m256i packed = _mm256_packus_epi16(_mm256_packs_epi32(luma_top[0], luma_top[1]),
                                               _mm256_packs_epi32(luma_bottom[0], luma_bottom[1]));
    const __m256i rows = _mm256_permutevar8x32_epi32(packed, order);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(y0 + x), _mm256_castsi256_si128(rows));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(y1 + x), _mm256_extracti128_si256(rows, 1));
    store8(u + x / 2, pairs(cb[0], cb[1]), kBlue);
    store8(v + x / 2, pairs(cr[0], cr[1]), kRed);
  }
  return x;
}

#endif

void convert(const Image& image, const Yuv420& out, const Rect& part, [[maybe_unused]] Lanes lanes) {
  assert(image.width % 2 == 0 && image.height % 2 == 0 && available(lanes));
  assert(part.x % 2 == 0 && part.y % 2 == 0 && part.width % 2 == 0 && part.height % 2 == 0);
  for (int row = part.y; row < part.y + part.height; row += 2) {
    const std::uint8_t *top = image.row(row) + 4 * part.x, *bottom = image.row(row + 1) + 4 * part.x;
    std::uint8_t* y0 = out.y + std::ptrdiff_t(out.y_stride) * row + part.x;
    std::uint8_t* y1 = y0 + out.y_stride;
    std::uint8_t* u = out.u + std::ptrdiff_t(out.u_stride) * (row / 2) + part.x / 2;
    std::uint8_t* v = out.v + std::ptrdiff_t(out.v_stride) * (row / 2) + part.x / 2;
    int done = 0;
#if defined(__x86_64__)
    if (lanes == Lanes::avx2) done = avx2_rows(top, bottom, part.width, y0, y1, u, v);
    if (lanes == Lanes::sse2) done = sse2_rows(top, bottom, part.width, y0, y1, u, v);
#endif
    scalar_rows(top, bottom, done, part.width, y0, y1, u, v);
  }
}

Lanes widest() {
  static const Lanes lanes = available(Lanes::avx2)   ? Lanes::avx2
                             : available(Lanes::sse2) ? Lanes::sse2
                                                      : Lanes::scalar;
  return lanes;
}

}  // namespace

bool available(Lanes lanes) {
#if defined(__x86_64__)
  return lanes != Lanes::avx2 || __builtin_cpu_supports("avx2");
#else
  return lanes == Lanes::scalar;
#endif
}

void convert(const Image& image, const Yuv420& out) { convert(image, out, widest()); }

void convert(const Image& image, const Yuv420& out, Lanes lanes) {
  convert(image, out, {0, 0, image.width, image.height}, lanes);
}

void convert(const Image& image, const Yuv420& out, const Rect& part) { convert(image, out, part, widest()); }

}  // namespace obscura::media
