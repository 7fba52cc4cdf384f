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

namespace {

std::unique_ptr<Pen> pen_for(Form form, const Sheet& sheet, double aspect) {
  const double height = sheet.width / aspect;
  std::unique_ptr<Pen> pen =
      form == Form::svg ? svg_pen(sheet.width, height, sheet) : pdf_pen(sheet.width, height, sheet);
  if (!pen) throw Error("this build has no Cairo and writes no PDF");
  return pen;
}

void put_page(const draw::Picture& picture, const Sheet& sheet, const std::optional<Raster>& raster,
              Pen& pen) {
  const double scale = sheet.width / (1080 * picture.aspect), height = 1080 * scale;
  if (raster) {
    pen.image({0, 0, raster->width * raster->pixel, raster->height * raster->pixel}, *raster);
    pen.begin_figure();
  } else {
    if (!picture.transparent)
      pen.fill({{0, 0}, {sheet.width, 0}, {sheet.width, height}, {0, height}}, picture.ground);
    pen.begin_figure();
    if (picture.still) put(*picture.still, scale, picture.ground, pen);
  }
  put(picture.moving, scale, picture.ground, pen);
}

}  // namespace

std::vector<std::uint8_t> page(const draw::Picture& picture, Form form, const Sheet& sheet,
                               const std::optional<Raster>& raster) {
  const std::unique_ptr<Pen> pen = pen_for(form, sheet, picture.aspect);
  put_page(picture, sheet, raster, *pen);
  return pen->finish();
}

Pages::Pages(const Sheet& sheet, double aspect) : sheet_(sheet), pen_(pen_for(Form::pdf, sheet, aspect)) {}
Pages::~Pages() = default;

void Pages::add(const draw::Picture& picture, const std::optional<Raster>& raster) {
  if (begun_) pen_->next_page();
  begun_ = true;
  put_page(picture, sheet_, raster, *pen_);
}

std::vector<std::uint8_t> Pages::finish() { return pen_->finish(); }

}  // namespace obscura::page
