#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "draw/picture/list.h"

namespace obscura::page {

/// A file of vectors.
enum class Form { svg, pdf };

/// "svg", "pdf".
std::optional<Form> form(std::string_view name);

/// "Cairo 1.16.0", or that there is none.
std::string libraries();

/// Whether this build writes it: PDF needs Cairo.
bool writes(Form form);

/// Properties of a page besides its picture.
struct Sheet {
  double width = 238.11;  // pt; its height follows from the picture's aspect
  std::string title;      // of the file's properties
  std::string text{};     // instead of the picture, for screen readers
};

/// Colours of a picture's solids, which no vector says: put under its moving list, from the page's upper left
/// corner on. RGBA8, row 0 at the top, alpha not multiplied in.
struct Raster {
  int width = 0, height = 0;
  double pixel = 0;  // pt
  const std::uint8_t* pixels = nullptr;
  std::vector<std::uint8_t> png{};  // the same as a file, for SVG
};

/// A picture put down as one page exactly as large as it: type as type with its fonts in the file, lines as
/// lines. The same bytes for the same picture. Throws page::Error, draw::Error where a font is missing.
std::vector<std::uint8_t> page(const draw::Picture& picture, Form form, const Sheet& sheet,
                               const std::optional<Raster>& raster = {});

class Pen;

/// A PDF of several pages of one size, a picture each.
class Pages {
 public:
  Pages(const Sheet& sheet, double aspect);
  ~Pages();

  void add(const draw::Picture& picture, const std::optional<Raster>& raster = {});
  /// The file; requires a page.
  std::vector<std::uint8_t> finish();

 private:
  Sheet sheet_;
  std::unique_ptr<Pen> pen_;
  bool begun_ = false;
};

/// The words of a picture that are apart as LaTeX over `pdf`, the file of its page without words. Needs
/// graphicx and color; the document's own fonts, sizes in points; as wide as \obscurawidth where that is
/// defined.
std::string latex_page(const draw::Picture& picture, const Sheet& sheet, const std::string& pdf);

}  // namespace obscura::page
