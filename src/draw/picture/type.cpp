#include "draw/picture/type.h"

#include <hb-ot.h>
#include <hb.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string_view>

#include "draw/picture/error.h"

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

std::string find(Face face) {
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
      if (!path.empty()) return path;
    }
  }
  if (files[0] != source.files[0])
    throw Error("cannot find the font " + files[0] + ": name a folder that has it in OBSCURA_FONTS");
  throw Error(std::string("cannot find the font ") + source.what + " (" + std::string(source.files[0]) +
              "): install " + source.package + ", or name a folder that has it in OBSCURA_FONTS");
}

template <Face face>
const std::string& file() {
  static const std::string path = find(face);
  return path;
}

/// A font that shapes in its own units. Once made it is never changed, so that threads may share it.
class Font {
 public:
  explicit Font(const std::string& path) {
    hb_blob_t* blob = hb_blob_create_from_file_or_fail(path.c_str());
    if (!blob) throw Error("cannot read the font " + path);
    hb_face_t* face = hb_face_create(blob, 0);
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

struct Buffer {
  hb_buffer_t* it = hb_buffer_create();
  ~Buffer() { hb_buffer_destroy(it); }
};

}  // namespace

const std::string& font_file(Face face) {
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

Line shape(const Text& text) {
  thread_local Buffer buffer;
  // named, not guessed: the locale must not choose glyphs
  static const hb_language_t language = hb_language_from_string("en", -1);

  Line line;
  line.spans.reserve(text.spans.size());
  for (const Span& span : text.spans) {
    const Font& face = font(span.face);
    hb_buffer_reset(buffer.it);
    hb_buffer_add_utf8(buffer.it, span.text.data(), int(span.text.size()), 0, int(span.text.size()));
    hb_buffer_set_language(buffer.it, language);
    hb_buffer_guess_segment_properties(buffer.it);
    const hb_feature_t tabular{HB_TAG('t', 'n', 'u', 'm'), 1, HB_FEATURE_GLOBAL_START, HB_FEATURE_GLOBAL_END};
    hb_shape(face.get(), buffer.it, &tabular, span.tabular ? 1 : 0);

    unsigned count = 0;
    const hb_glyph_info_t* infos = hb_buffer_get_glyph_infos(buffer.it, &count);
    const hb_glyph_position_t* places = hb_buffer_get_glyph_positions(buffer.it, &count);
    const double em = span.size / face.units();
    line.width += span.lead;
    Shaped shaped{span.face, span.size, span.color, {}};
    shaped.glyphs.reserve(count);
    double pen = 0;
    for (unsigned i = 0; i < count; ++i) {
      shaped.glyphs.push_back(
          {infos[i].codepoint,
           {line.width + em * (pen + places[i].x_offset), -span.rise - em * places[i].y_offset}});
      pen += places[i].x_advance;
    }
    line.width += em * pen;
    line.spans.push_back(std::move(shaped));
  }
  return line;
}

void set_decimal_mark(List& list, const std::string& mark) {
  if (mark == ".") return;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  for (Text& text : list.texts)
    for (Span& span : text.spans) {
      if (!span.tabular && span.face != Face::math) continue;
      std::string& words = span.text;
      for (std::size_t i = 1; i + 1 < words.size(); ++i)
        if (words[i] == '.' && digit(words[i - 1]) && digit(words[i + 1])) words.replace(i, 1, mark);
    }
}

}  // namespace obscura::draw
