#include "page/page.h"

#ifdef OBSCURA_CAIRO
#include <cairo.h>
#endif

#include "page/error.h"
#include "page/pen.h"

namespace obscura::page {

std::optional<Form> form(std::string_view name) {
  if (name == "svg") return Form::svg;
  if (name == "pdf") return Form::pdf;
  return {};
}

std::string libraries() {
#ifdef OBSCURA_CAIRO
  return std::string("Cairo ") + cairo_version_string();
#else
  return "no Cairo: figures are SVG and PNG";
#endif
}

bool writes(Form form) {
#ifdef OBSCURA_CAIRO
  (void)form;
  return true;
#else
  return form != Form::pdf;
#endif
}

#ifndef OBSCURA_CAIRO
std::unique_ptr<Pen> pdf_pen(double, double, const Sheet&) { return nullptr; }
#endif

std::vector<std::uint8_t> page(const draw::Picture& picture, Form form, const Sheet& sheet,
                               const std::optional<Raster>& raster) {
  const double scale = sheet.width / (1080 * picture.aspect), height = 1080 * scale;
  const std::unique_ptr<Pen> pen =
      form == Form::svg ? svg_pen(sheet.width, height, sheet) : pdf_pen(sheet.width, height, sheet);
  if (!pen) throw Error("this build has no Cairo and writes no PDF");
  if (raster) {
    pen->image({0, 0, raster->width * raster->pixel, raster->height * raster->pixel}, *raster);
  } else {
    if (!picture.transparent)
      pen->fill({{0, 0}, {sheet.width, 0}, {sheet.width, height}, {0, height}}, picture.ground);
    if (picture.still) put(*picture.still, scale, picture.ground, *pen);
  }
  put(picture.moving, scale, picture.ground, *pen);
  return pen->finish();
}

}  // namespace obscura::page
