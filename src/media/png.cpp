// PNG through libpng, except that the pixels are deflated by libdeflate, without a filter.
//
// libpng's own choice (zlib's level 6, a filter tried five ways on every row) suits photographs. Our pictures
// are flat colours, thin antialiased lines and hatching: rows repeat themselves, and filters only hide that
// from deflate. Measured on 1080p frames against libpng's default: a quarter of its time, and 77 to 93 % of
// its bytes. zlib's level 3 is as quick, but takes up to 154 % of the bytes where few things are in the
// picture; its level 6 takes half the time of the default.

#include "media/png.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>

#include "media/error.h"
#include "media/file.h"

namespace obscura::media {

namespace {

// Shared with libpng's callbacks. They keep a failure here and jump; nothing is thrown across libpng's
// frames.
struct Call {
  char failure[200] = "";
  std::vector<std::uint8_t>* out = nullptr;
  std::FILE* in = nullptr;
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  Call& call = *static_cast<Call*>(png_get_error_ptr(png));
  std::snprintf(call.failure, sizeof call.failure, "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep bytes, std::size_t size) {
  bool written = true;
  try {
    Call& call = *static_cast<Call*>(png_get_io_ptr(png));
    call.out->insert(call.out->end(), bytes, bytes + size);
  } catch (const std::bad_alloc&) {
    written = false;
  }
  if (!written) png_error(png, "out of memory");
}

void on_flush(png_structp) {}

void on_read(png_structp png, png_bytep bytes, std::size_t size) {
  const Call& call = *static_cast<Call*>(png_get_io_ptr(png));
  if (std::fread(bytes, 1, size, call.in) != size) png_error(png, "the file ends too early");
}

struct Writing {
  png_structp png = nullptr;
  png_infop facts = nullptr;
  ~Writing() { png_destroy_write_struct(&png, &facts); }
};

struct Reading {
  png_structp png = nullptr;
  png_infop facts = nullptr;
  ~Reading() { png_destroy_read_struct(&png, &facts, nullptr); }
};

constexpr int kLevel = 5;

// The rows as PNG lays them, each after a byte 0 that says "no filter", in one zlib stream.
std::vector<std::uint8_t> deflated(const Image& image, bool alpha) {
  const std::size_t row_bytes = 1 + std::size_t(alpha ? 4 : 3) * image.width;
  const std::size_t size = row_bytes * image.height;
  const auto rows = std::make_unique_for_overwrite<std::uint8_t[]>(size + 1);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.row(y);
    std::uint8_t* to = rows.get() + row_bytes * y;
    *to++ = 0;
    if (alpha) {
      std::memcpy(to, from, row_bytes - 1);
    } else {
      // four bytes at a time, each pixel overwriting the last one's alpha; the last of all has a byte to
      // spare
      for (int x = 0; x < image.width; ++x, from += 4, to += 3) std::memcpy(to, from, 4);
    }
  }

  struct Free {
    void operator()(libdeflate_compressor* c) const { libdeflate_free_compressor(c); }
  };
  const std::unique_ptr<libdeflate_compressor, Free> compressor(libdeflate_alloc_compressor(kLevel));
  if (!compressor) throw std::bad_alloc();
  const std::size_t bound = libdeflate_zlib_compress_bound(compressor.get(), size);
  const auto out = std::make_unique_for_overwrite<std::uint8_t[]>(bound);
  const std::size_t used = libdeflate_zlib_compress(compressor.get(), rows.get(), size, out.get(), bound);
  return {out.get(), out.get() + used};
}

// No object with a destructor may live in here: an error jumps out of it. False: `call.failure` says why.
bool write_chunks(Writing& file, Call& call, const Image& image, bool alpha, png_uint_32 per_metre,
                  png_text* texts, int text_count, const std::vector<std::uint8_t>& pixels) {
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_set_write_fn(file.png, &call, on_write, on_flush);
  png_set_IHDR(file.png, file.facts, png_uint_32(image.width), png_uint_32(image.height), 8,
               alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(file.png, file.facts, PNG_sRGB_INTENT_PERCEPTUAL);
  if (per_metre > 0) png_set_pHYs(file.png, file.facts, per_metre, per_metre, PNG_RESOLUTION_METER);
  if (text_count > 0) png_set_text(file.png, file.facts, texts, text_count);
  png_write_info(file.png, file.facts);
  // chunks of a moderate length, for readers that buffer whole chunks
  constexpr std::size_t kChunk = 1 << 16;
  for (std::size_t at = 0; at < pixels.size(); at += kChunk) {
    const std::size_t size = pixels.size() - at < kChunk ? pixels.size() - at : kChunk;
    png_write_chunk(file.png, reinterpret_cast<png_const_bytep>("IDAT"), pixels.data() + at, size);
  }
  png_write_chunk(file.png, reinterpret_cast<png_const_bytep>("IEND"), nullptr, 0);
  return true;
}

// The header, and what is to be done so that rows come as RGBA8.
bool read_header(Reading& file, Call& call) {
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_set_read_fn(file.png, &call, on_read);
  png_set_user_limits(file.png, 1 << 16, 1 << 16);
  png_read_info(file.png, file.facts);
  return true;
}

bool read_rows(Reading& file, Call&, Image* image, png_bytepp rows) {
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_set_expand(file.png);
  png_set_scale_16(file.png);
  png_set_gray_to_rgb(file.png);
  png_set_add_alpha(file.png, 255, PNG_FILLER_AFTER);
  png_set_interlace_handling(file.png);
  png_read_update_info(file.png, file.facts);
  if (png_get_rowbytes(file.png, file.facts) != std::size_t(4) * image->width) {
    png_error(file.png, "rows are not of RGBA");
  }
  png_read_image(file.png, rows);
  png_read_end(file.png, file.facts);
  return true;
}

// the file that git keeps in place of a picture where git-LFS has not fetched it
bool is_lfs_pointer(std::FILE* file) {
  constexpr std::string_view kBegins = "version https://git-lfs";
  char begins[kBegins.size()];
  const bool is = std::fread(begins, 1, sizeof begins, file) == sizeof begins &&
                  std::string_view(begins, sizeof begins) == kBegins;
  std::rewind(file);
  return is;
}

std::vector<std::uint8_t> encode(const Image& image, const PngOptions& options, const std::string& path) {
  if (image.width <= 0 || image.height <= 0) throw Error(path + ": a picture without pixels");
  // tags, in the order of their keywords
  std::vector<png_text> texts;
  for (const auto& [key, text] : options.tags) {
    if (key.empty() || key.size() > 79)
      throw Error(path + ": PNG keyword '" + key + "' is not of 1 to 79 bytes");
    png_text entry{};
    entry.compression = PNG_ITXT_COMPRESSION_NONE;
    entry.key = const_cast<char*>(key.c_str());
    entry.text = const_cast<char*>(text.c_str());
    entry.itxt_length = text.size();
    entry.lang = const_cast<char*>("");
    entry.lang_key = const_cast<char*>("");
    texts.push_back(entry);
  }

  const std::vector<std::uint8_t> pixels = deflated(image, options.alpha);
  std::vector<std::uint8_t> out;
  out.reserve(pixels.size() + 4096);
  Call call{.out = &out};
  Writing file;
  file.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &call, on_error, on_warning);
  if (file.png) file.facts = png_create_info_struct(file.png);
  if (!file.facts) throw std::bad_alloc();
  if (!write_chunks(file, call, image, options.alpha, png_uint_32(std::lround(options.per_metre)),
                    texts.data(), int(texts.size()), pixels)) {
    throw Error(path + ": " + call.failure);
  }
  return out;
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Image& image, const PngOptions& options) {
  return encode(image, options, "PNG");
}

void write_png(const std::string& path, const Image& image, const PngOptions& options) {
  const std::vector<std::uint8_t> bytes = encode(image, options, path);
  File file(path);
  file.write(bytes);
  file.place(false);
}

Png read_png(const std::string& path) {
  Call call;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> input(std::fopen(path.c_str(), "rb"));
  if (!input) throw Error(path + ": cannot read: " + std::strerror(errno));
  call.in = input.get();
  std::fseek(call.in, 0, SEEK_END);
  const long bytes = std::ftell(call.in);
  std::rewind(call.in);
  if (is_lfs_pointer(call.in))
    throw Error(path +
                ": not a readable PNG: it is a pointer of git-LFS; `git lfs pull` fetches the picture");

  Reading file;
  file.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &call, on_error, on_warning);
  if (file.png) file.facts = png_create_info_struct(file.png);
  if (!file.facts) throw std::bad_alloc();
  if (!read_header(file, call)) throw Error(path + ": not a readable PNG: " + call.failure);

  Png png;
  png.image.width = int(png_get_image_width(file.png, file.facts));
  png.image.height = int(png_get_image_height(file.png, file.facts));
  // deflate shrinks at most 1032 to 1: a short file that promises more is damaged, and needs no memory
  const double promised = double(png_get_rowbytes(file.png, file.facts)) * png.image.height;
  if (bytes >= 0 && promised > 1032.0 * double(bytes)) {
    throw Error(path + ": not a readable PNG: the file is too short for its size");
  }
  const std::size_t needed = std::size_t(4) * png.image.width * png.image.height;
  try {
    png.image.pixels.resize(needed);
  } catch (const std::bad_alloc&) {
    throw Error(fmt::format(
        "{}: its {} x {} pixels need {:.{}f} {} of memory, which are not to be had (--memory-limit)", path,
        png.image.width, png.image.height, double(needed) / (needed < 1e9 ? 1e6 : 1e9), needed < 1e9 ? 1 : 2,
        needed < 1e9 ? "MB" : "GB"));
  }
  std::vector<png_bytep> rows(std::size_t(png.image.height));
  for (int y = 0; y < png.image.height; ++y) rows[std::size_t(y)] = png.image.row(y);
  if (!read_rows(file, call, &png.image, rows.data())) {
    throw Error(path + ": not a readable PNG: " + call.failure);
  }

  png_textp texts = nullptr;
  int count = 0;
  png_get_text(file.png, file.facts, &texts, &count);
  for (int i = 0; i < count; ++i) {
    const bool international = texts[i].compression >= PNG_ITXT_COMPRESSION_NONE;
    const std::size_t length = international ? texts[i].itxt_length : texts[i].text_length;
    png.tags[texts[i].key] = std::string(texts[i].text ? texts[i].text : "", texts[i].text ? length : 0);
  }
  return png;
}

}  // namespace obscura::media
