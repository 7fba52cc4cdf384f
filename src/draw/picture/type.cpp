#include "draw/picture/type.h"

#include <hb-ot.h>
#include <hb.h>
#ifdef OBSCURA_FONTCONFIG
#include <fontconfig/fontconfig.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "draw/picture/error.h"
#include "draw/picture/latex.h"

namespace obscura::draw {
namespace {

namespace fs = std::filesystem;

/// A face, the files that may hold it, best first, and the package that brings it.
struct Source {
  const char* what;
  std::array<std::string_view, 3> files;
  const char* package;
};

// STIX in Debian is version 1: the Word set has whole alphabets in each style and the operators in the
// upright one. STIX Two is what other systems have.
constexpr std::array<Source, 6> kSources{{
    {"Inter Regular", {"Inter-Regular.otf", "Inter-Regular.ttf", ""}, "fonts-inter"},
    {"Inter Medium", {"Inter-Medium.otf", "Inter-Medium.ttf", ""}, "fonts-inter"},
    {"Inter Bold", {"Inter-Bold.otf", "Inter-Bold.ttf", ""}, "fonts-inter"},
    {"STIX Regular",
     {"STIX-Regular.otf", "STIXGeneral-Regular.otf", "STIXTwoText-Regular.otf"},
     "fonts-stix"},
    {"STIX Italic", {"STIX-Italic.otf", "STIXGeneral-Italic.otf", "STIXTwoText-Italic.otf"}, "fonts-stix"},
    {"STIX Bold Italic",
     {"STIX-BoldItalic.otf", "STIXGeneral-BoldItalic.otf", "STIXTwoText-BoldItalic.otf"},
     "fonts-stix"},
}};

std::vector<fs::path> folders() {
  std::vector<fs::path> found;
  if (const char* own = std::getenv("OBSCURA_FONTS")) {
    std::string_view rest = own;
    while (!rest.empty()) {
      const auto colon = rest.find(':');
      if (colon != 0) found.emplace_back(rest.substr(0, colon));
      rest.remove_prefix(colon == rest.npos ? rest.size() : colon + 1);
    }
  }
  if (const char* home = std::getenv("HOME")) found.push_back(fs::path(home) / ".local/share/fonts");
  found.emplace_back("/usr/local/share/fonts");
  // Debian's folders first, then the whole tree
  found.emplace_back("/usr/share/fonts/opentype/inter");
  found.emplace_back("/usr/share/fonts/opentype/stix-word");
  found.emplace_back("/usr/share/fonts");
  return found;
}

/// The files of a typeface; for words those of the family in $OBSCURA_FONT, as its files are usually called.
std::vector<std::string> files_of(Face face) {
  const Source& source = kSources[std::size_t(face)];
  const char* family = std::getenv("OBSCURA_FONT");
  if (!family || !*family || face > Face::bold) return {source.files.begin(), source.files.end()};
  std::string stem;
  for (const char* c = family; *c; ++c)
    if (*c != ' ') stem += *c;
  const std::string style = face == Face::bold ? "Bold" : face == Face::medium ? "Medium" : "Regular";
  std::vector<std::string> files;
  for (const std::string& each : {style, std::string(face == Face::bold ? "Bold" : "Regular")})
    for (const char* end : {".otf", ".ttf"}) files.push_back(stem + "-" + each + end);
  for (const char* end : {".otf", ".ttf"}) files.push_back(stem + (face == Face::bold ? "Bd" : "") + end);
  return files;
}

const char* own_family() {
  const char* family = std::getenv("OBSCURA_FONT");
  return family && *family ? family : nullptr;
}

#ifdef OBSCURA_FONTCONFIG
template <class T>
using Config = std::unique_ptr<T, void (*)(T*)>;

/// The upright font of a family whose weight is nearest, as fontconfig knows them; none where there is no
/// such family. Of the same weight the first by its file's name. Variable fonts are left out.
std::optional<FontFile> of_family(const char* family, int weight) {
  static const Config<FcConfig> config = [] {
    Config<FcConfig> made(FcInitLoadConfigAndFonts(), FcConfigDestroy);
    if (const char* own = std::getenv("OBSCURA_FONTS"); own && made) {
      std::string_view rest = own;
      while (!rest.empty()) {
        const auto colon = rest.find(':');
        const std::string folder(rest.substr(0, colon));
        FcConfigAppFontAddDir(made.get(), reinterpret_cast<const FcChar8*>(folder.c_str()));
        rest.remove_prefix(colon == rest.npos ? rest.size() : colon + 1);
      }
    }
    return made;
  }();
  if (!config) return {};
  const Config<FcPattern> wanted(FcPatternCreate(), FcPatternDestroy);
  FcPatternAddString(wanted.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>(family));
  FcPatternAddInteger(wanted.get(), FC_SLANT, FC_SLANT_ROMAN);
  FcPatternAddBool(wanted.get(), FC_VARIABLE, FcFalse);
  const Config<FcObjectSet> asked(FcObjectSetBuild(FC_FILE, FC_INDEX, FC_WEIGHT, FC_WIDTH, nullptr),
                                  FcObjectSetDestroy);
  const Config<FcFontSet> all(FcFontList(config.get(), wanted.get(), asked.get()), FcFontSetDestroy);
  std::optional<FontFile> best;
  std::pair<double, std::string> least;
  for (int i = 0; all && i < all->nfont; ++i) {
    FcPattern* each = all->fonts[i];
    FcChar8* file = nullptr;
    int index = 0, width = FC_WIDTH_NORMAL;
    double heavy = FC_WEIGHT_REGULAR;
    if (FcPatternGetString(each, FC_FILE, 0, &file) != FcResultMatch) continue;
    FcPatternGetInteger(each, FC_INDEX, 0, &index);
    FcPatternGetInteger(each, FC_WIDTH, 0, &width);
    FcPatternGetDouble(each, FC_WEIGHT, 0, &heavy);
    if (index > 0xffff) continue;  // an instance of a variable font
    const std::string path(reinterpret_cast<const char*>(file));
    std::pair<double, std::string> off{std::abs(heavy - weight) + 10.0 * std::abs(width - FC_WIDTH_NORMAL),
                                       path};
    if (best && least <= off) continue;
    least = std::move(off), best = FontFile{path, index};
  }
  return best;
}

int weight_of(Face face) {
  return face == Face::bold ? FC_WEIGHT_BOLD : face == Face::medium ? FC_WEIGHT_MEDIUM : FC_WEIGHT_REGULAR;
}
#else
std::optional<FontFile> of_family(const char*, int) { return {}; }
int weight_of(Face) { return 0; }
#endif

// a MATH table, and the letters to go with it
bool has_mathematics(const FontFile& file) {
  hb_blob_t* blob = hb_blob_create_from_file_or_fail(file.path.c_str());
  if (!blob) return false;
  hb_face_t* face = hb_face_create(blob, unsigned(file.index));
  bool has = hb_ot_math_has_data(face) != 0;
  hb_font_t* font = hb_font_create(face);
  hb_ot_font_set_funcs(font);
  for (const hb_codepoint_t letter : {0x1D463u, 0x1D497u, 0x1D714u}) {
    hb_codepoint_t glyph = 0;
    has = has && hb_font_get_nominal_glyph(font, letter, &glyph) != 0;
  }
  hb_font_destroy(font), hb_face_destroy(face), hb_blob_destroy(blob);
  return has;
}

FontFile find(Face face) {
  if (const char* family = own_family()) {
    if (face <= Face::bold) {
      if (const auto found = of_family(family, weight_of(face))) return *found;
    } else {
      // the family's own mathematics
      FontFile words = font_file(Face::regular);
      words.alphabets = true;
      if (has_mathematics(words)) return words;
    }
  }
  const Source& source = kSources[std::size_t(face)];
  const std::vector<std::string> files = files_of(face);
  for (const fs::path& folder : folders()) {
    std::error_code ignored;
    std::vector<std::string> here(files.size());
    const auto skip =
        fs::directory_options::skip_permission_denied | fs::directory_options::follow_directory_symlink;
    // the best file of this folder; on a tie the first by name
    for (fs::recursive_directory_iterator it(folder, skip, ignored), end; !ignored && it != end;
         it.increment(ignored)) {
      if (it.depth() > 8) it.disable_recursion_pending();
      const std::string name = it->path().filename().string();
      for (std::size_t i = 0; i < here.size(); ++i) {
        if (name != files[i]) continue;
        const std::string path = it->path().string();
        if (here[i].empty() || path < here[i]) here[i] = path;
      }
    }
    for (const std::string& path : here) {
      if (!path.empty()) return {path};
    }
  }
  if (files[0] != source.files[0])
    throw Error(std::string("cannot find the font family '") + own_family() +
                "': fc-list names those that are installed; a folder that has it goes into OBSCURA_FONTS");
  throw Error(std::string("cannot find the font ") + source.what + " (" + std::string(source.files[0]) +
              "): install " + source.package + ", or name a folder that has it in OBSCURA_FONTS");
}

template <Face face>
const FontFile& file() {
  static const FontFile found = find(face);
  return found;
}

/// A font that shapes in its own units. Once made it is never changed, so that threads may share it.
class Font {
 public:
  explicit Font(const FontFile& file) {
    const std::string& path = file.path;
    hb_blob_t* blob = hb_blob_create_from_file_or_fail(path.c_str());
    if (!blob) throw Error("cannot read the font " + path);
    hb_face_t* face = hb_face_create(blob, unsigned(file.index));
    hb_blob_destroy(blob);
    if (hb_face_get_glyph_count(face) == 0) {
      hb_face_destroy(face);
      throw Error("not a font: " + path);
    }
    units_ = hb_face_get_upem(face);
    font_ = hb_font_create(face);
    hb_face_destroy(face);
    hb_ot_font_set_funcs(font_);
    hb_font_set_scale(font_, int(units_), int(units_));
    hb_font_make_immutable(font_);
  }
  ~Font() { hb_font_destroy(font_); }
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  hb_font_t* get() const { return font_; }
  double units() const { return units_; }

 private:
  hb_font_t* font_ = nullptr;
  unsigned units_ = 1000;
};

template <Face face>
const Font& font() {
  static const Font it(file<face>());
  return it;
}

const Font& font(Face face) {
  switch (face) {
    case Face::regular:
      return font<Face::regular>();
    case Face::medium:
      return font<Face::medium>();
    case Face::bold:
      return font<Face::bold>();
    case Face::math:
      return font<Face::math>();
    case Face::math_italic:
      return font<Face::math_italic>();
    case Face::math_bold_italic:
      return font<Face::math_bold_italic>();
  }
  throw Error("no such face");
}

/// A character of UTF-8, and how many bytes it has.
struct Sign {
  std::uint32_t code = 0;
  std::size_t length = 1;
};
Sign sign_at(const std::string& text, std::size_t i) {
  const auto first = static_cast<unsigned char>(text[i]);
  Sign sign{first, first < 0x80u ? 1u : first < 0xE0u ? 2u : first < 0xF0u ? 3u : 4u};
  if (sign.length > 1) sign.code &= 0xFFu >> (sign.length + 1);
  for (std::size_t k = 1; k < sign.length && i + k < text.size(); ++k)
    sign.code = sign.code << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3Fu);
  return sign;
}

struct Buffer {
  hb_buffer_t* it = hb_buffer_create();
  ~Buffer() { hb_buffer_destroy(it); }
};

}  // namespace

const FontFile& font_file(Face face) {
  switch (face) {
    case Face::regular:
      return file<Face::regular>();
    case Face::medium:
      return file<Face::medium>();
    case Face::bold:
      return file<Face::bold>();
    case Face::math:
      return file<Face::math>();
    case Face::math_italic:
      return file<Face::math_italic>();
    case Face::math_bold_italic:
      return file<Face::math_bold_italic>();
  }
  throw Error("no such face");
}

Text with_all_signs(const Text& text) {
  const auto plain = [](const Span& span) {
    return std::all_of(span.text.begin(), span.text.end(),
                       [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  };
  if (std::all_of(text.spans.begin(), text.spans.end(), plain)) return text;
  const auto has = [](Face face, const Span& span, std::size_t begin, std::size_t length) {
    Span sign = span;
    sign.face = face, sign.text = span.text.substr(begin, length);
    const std::string letters = characters_of(sign);
    hb_codepoint_t glyph = 0;
    return hb_font_get_nominal_glyph(font(face).get(), sign_at(letters, 0).code, &glyph) != 0;
  };
  Text out = text;
  out.spans.clear();
  for (const Span& span : text.spans) {
    Span piece = span;
    piece.text.clear();
    const auto put = [&](Face face, const std::string& sign) {
      if (piece.face != face && !piece.text.empty()) {
        out.spans.push_back(piece);
        piece.text.clear(), piece.lead = 0;
      }
      piece.face = face, piece.text += sign;
    };
    for (std::size_t i = 0; i < span.text.size();) {
      const std::size_t length = sign_at(span.text, i).length;
      const Face other = span.face < Face::math ? Face::math : Face::regular;
      const bool lacks = length > 1 && !has(span.face, span, i, length) && has(other, span, i, length);
      put(lacks ? other : span.face, span.text.substr(i, length));
      i += length;
    }
    out.spans.push_back(piece);
  }
  return out;
}

namespace {

/// Letters that no face has.
class Letters {
 public:
  void add(const std::string& letter) {
    const std::scoped_lock lock(mutex_);
    if (std::find(all_.begin(), all_.end(), letter) == all_.end()) all_.push_back(letter);
  }
  std::vector<std::string> all() const {
    const std::scoped_lock lock(mutex_);
    return all_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> all_;
};
Letters& without_glyph() {
  static Letters letters;
  return letters;
}

/// A glyph of shaped letters, in the font's units.
struct Placed {
  std::uint32_t index;
  int x_offset, y_offset, x_advance;
};

/// Letters, shaped: their glyphs, and the bytes at which there are some that the font lacks, for which it has
/// a box if it can.
struct ShapedLetters {
  std::vector<Placed> glyphs;
  std::vector<std::size_t> lacking{};
};
constexpr hb_codepoint_t kBox = 0x25A1;
constexpr const char* kBoxLetter = "\u25A1";

// The letters of a face, shaped. Films say the same words in frame after frame: what a thread has shaped it
// keeps.
const ShapedLetters& glyphs_of(Face face, const std::string& letters, bool tabular) {
  constexpr std::size_t kKept = 4096;
  thread_local Buffer buffer;
  thread_local std::unordered_map<std::string, ShapedLetters> kept;
  // named, not guessed: the locale must not choose glyphs
  static const hb_language_t language = hb_language_from_string("en", -1);

  const std::string key = letters + char(2 * int(face) + (tabular ? 1 : 0));
  if (const auto found = kept.find(key); found != kept.end()) return found->second;
  if (kept.size() >= kKept) kept.clear();
  hb_buffer_reset(buffer.it);
  hb_buffer_add_utf8(buffer.it, letters.data(), int(letters.size()), 0, int(letters.size()));
  hb_buffer_set_language(buffer.it, language);
  hb_buffer_guess_segment_properties(buffer.it);
  const hb_feature_t figures{HB_TAG('t', 'n', 'u', 'm'), 1, HB_FEATURE_GLOBAL_START, HB_FEATURE_GLOBAL_END};
  hb_shape(font(face).get(), buffer.it, &figures, tabular ? 1 : 0);
  unsigned count = 0;
  const hb_glyph_info_t* infos = hb_buffer_get_glyph_infos(buffer.it, &count);
  const hb_glyph_position_t* places = hb_buffer_get_glyph_positions(buffer.it, &count);
  ShapedLetters& shaped = kept[key];
  hb_codepoint_t box = 0;
  for (unsigned i = 0; i < count; ++i) {
    Placed glyph{infos[i].codepoint, places[i].x_offset, places[i].y_offset, places[i].x_advance};
    if (glyph.index == 0 && infos[i].cluster < letters.size()) {
      without_glyph().add(letters.substr(infos[i].cluster, sign_at(letters, infos[i].cluster).length));
      shaped.lacking.push_back(infos[i].cluster);
      hb_font_t* const its = font(face).get();
      if (hb_font_get_nominal_glyph(its, kBox, &box))
        glyph = {box, 0, 0, hb_font_get_glyph_h_advance(its, box)};
    }
    shaped.glyphs.push_back(glyph);
  }
  return shaped;
}

}  // namespace

std::vector<std::string> letters_without_glyph() { return without_glyph().all(); }

Line shape(const Text& text) {
  Line line;
  line.spans.reserve(text.spans.size());
  for (const Span& span : text.spans) {
    // most are as they were written
    const bool own = span.face >= Face::math_italic && font_file(span.face).alphabets;
    const std::string letters = own ? characters_of(span) : span.text;
    const auto& [placed, lacking] = glyphs_of(span.face, letters, span.tabular);
    const double em = span.size / font(span.face).units();
    line.width += span.lead;
    Shaped shaped{span.face, span.size, span.color, {}};
    if (!lacking.empty()) shaped.drawn = letters;
    for (auto at = lacking.rbegin(); at != lacking.rend(); ++at)
      shaped.drawn.replace(*at, sign_at(letters, *at).length, kBoxLetter);
    shaped.glyphs.reserve(placed.size());
    double pen = 0;
    for (const Placed& glyph : placed) {
      shaped.glyphs.push_back(
          {glyph.index, {line.width + em * (pen + glyph.x_offset), -span.rise - em * glyph.y_offset}});
      pen += glyph.x_advance;
    }
    line.width += em * pen;
    line.spans.push_back(std::move(shaped));
  }
  return line;
}

std::pair<double, double> ink_of(const Text& text) {
  double above = -1e9, below = -1e9;
  for (const Shaped& span : shape(with_all_signs(text)).spans) {
    const Font& face = font(span.face);
    const double em = span.size / face.units();
    for (const Glyph& glyph : span.glyphs) {
      hb_glyph_extents_t ink;
      if (!hb_font_get_glyph_extents(face.get(), glyph.index, &ink) || ink.height == 0) continue;
      above = std::max(above, em * ink.y_bearing - glyph.at.y());
      below = std::max(below, glyph.at.y() - em * (ink.y_bearing + ink.height));
    }
  }
  return above > -1e9 ? std::pair(above, below) : std::pair(0.0, 0.0);
}

// Mathematical Alphanumeric Symbols, Unicode 1D400 to 1D7FF
std::string characters_of(const Span& span) {
  if (span.face < Face::math_italic || !font_file(span.face).alphabets) return span.text;
  const bool bold = span.face == Face::math_bold_italic;
  std::string out;
  for (std::size_t i = 0; i < span.text.size();) {
    const auto [c, length] = sign_at(span.text, i);
    std::uint32_t to = 0;
    if (c >= 'A' && c <= 'Z') to = (bold ? 0x1D468u : 0x1D434u) + (c - 'A');
    if (c >= 'a' && c <= 'z') to = (bold ? 0x1D482u : 0x1D44Eu) + (c - 'a');
    if (c == 'h' && !bold) to = 0x210E;
    if (c >= 0x3B1 && c <= 0x3C9) to = (bold ? 0x1D736u : 0x1D6FCu) + (c - 0x3B1);
    // those that stand after omega there
    constexpr std::uint32_t kMore[] = {0x2202, 0x3F5, 0x3D1, 0x3F0, 0x3D5, 0x3F1, 0x3D6};
    for (std::uint32_t k = 0; k < 7; ++k)
      if (c == kMore[k]) to = (bold ? 0x1D74Fu : 0x1D715u) + k;
    if (to == 0) {
      out.append(span.text, i, length);
    } else if (to < 0x10000) {
      out += {char(0xE0 | to >> 12), char(0x80 | (to >> 6 & 0x3F)), char(0x80 | (to & 0x3F))};
    } else {
      out += {char(0xF0 | to >> 18), char(0x80 | (to >> 12 & 0x3F)), char(0x80 | (to >> 6 & 0x3F)),
              char(0x80 | (to & 0x3F))};
    }
    i += length;
  }
  return out;
}

std::string with_decimal_mark(std::string words, const std::string& mark) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t i = 1; i + 1 < words.size(); ++i)
    if (words[i] == '.' && digit(words[i - 1]) && digit(words[i + 1])) words.replace(i, 1, mark);
  return words;
}

void set_decimal_mark(List& list, const std::string& mark) {
  if (mark == ".") return;
  for (Words& each : list.words) each.latex = latex_with_mark(each.latex, mark);
  for (Text& text : list.texts)
    for (Span& span : text.spans) {
      if (!span.tabular && span.face != Face::math) continue;
      span.text = with_decimal_mark(std::move(span.text), mark);
    }
}

}  // namespace obscura::draw
