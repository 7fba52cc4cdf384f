// obscura figure: one picture for print: vectors as SVG or PDF, pixels as PNG.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/figure/figure_builder.h"
#include "app/figure/figure_raster.h"
#include "app/run/trouble.h"
#include "draw/picture/type.h"
#include "gl/context.h"
#include "media/error.h"
#include "media/file.h"
#include "media/png.h"
#include "page/page.h"

namespace obscura::app {

namespace {

struct FigureFlags {
  std::string scene;
  std::vector<std::string> sets, vary;
  std::optional<std::string> out, at, width, font, theme, every;
  std::optional<int> columns;
  double dpi = 300;
  gl::ContextOptions context;
};

constexpr double kMillimetre = 72 / 25.4;  // pt

// "84mm", "3.3in", "240pt"; a bare number is of millimetres
double points(const std::string& text) {
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string unit(read.ptr, text.data() + text.size());
  const double each = unit.empty() || unit == "mm" ? kMillimetre
                      : unit == "cm"               ? 10 * kMillimetre
                      : unit == "in"               ? 72
                      : unit == "pt"               ? 1
                                                   : 0;
  const double width = value * each;
  if (read.ec != std::errc() || !(width >= 20 * kMillimetre && width <= 1000 * kMillimetre))
    throw UsageError(fmt::format("--width {}: expected 20mm to 1000mm, as in 84mm, 3.3in or 240pt", text));
  return width;
}

std::string ending(const std::string& name) {
  const std::string end = std::filesystem::path(name).extension().string();
  return end.empty() ? "" : end.substr(1);
}

void check_ending(const std::string& out) {
  const std::string end = ending(out);
  if (end == "png") return;
  const auto form = end == "tex" ? page::Form::pdf : page::form(end);
  if (!form)
    throw UsageError(fmt::format("-o {}: expected a name that ends with .svg, .pdf, .png or .tex", out));
  if (!page::writes(*form))
    throw UsageError(fmt::format(
        "-o {}: this obscura was built without Cairo and cannot write PDF; use .svg or .png", out));
}

// the PDF beside LaTeX's words: not the figure's own, which may lie there too
std::string lines_of(const std::string& out) {
  const std::filesystem::path path(out);
  return (path.parent_path() / (path.stem().string() + "-lines.pdf")).string();
}

void write(const std::string& out, const std::vector<std::uint8_t>& bytes) {
  media::File file(out);
  file.write(bytes);
  file.place(false);
}

int run(const FigureFlags& flags) {
  if (flags.out) check_ending(*flags.out);
  const std::string first = flags.scene == "-" ? "scene" : std::filesystem::path(flags.scene).stem().string();
  const std::string out = flags.out.value_or("render_out/" + first + ".svg");

  AlbumOptions options;
  if (flags.at) options.at = instants(*flags.at);
  if (flags.width) options.width = points(*flags.width);
  if (flags.every) {
    options.every = sim::parse_rational(*flags.every);
    if (!options.every || options.every->num <= 0)
      throw UsageError(fmt::format("--every {}: expected seconds above 0", *flags.every));
  }
  options.columns = flags.columns;
  options.vary = flags.vary;
  options.latex = ending(out) == "tex";
  if (flags.theme) options.theme = *flags.theme == "screen" ? draw::Theme::screen : draw::Theme::paper;
  if (flags.font) {
    ::setenv("OBSCURA_FONT", flags.font->c_str(), 1);
    (void)draw::font_file(draw::Face::regular);  // throws where there is none
  }

  const FigureBuilder album(flags.scene, flags.sets, options);
  media::make_folder_of(out);
  const Page made = album.page();
  const double width = album.width(), height = width / made.picture.aspect;
  std::string size = fmt::format("{:.1f} x {:.1f} mm", width / kMillimetre, height / kMillimetre);
  if (ending(out) == "png") {
    const media::Image image = pixels(made, width, flags.dpi, flags.context);
    media::Tags tags{{"Software", "obscura " OBSCURA_VERSION}};
    if (!album.title().empty()) tags["Title"] = album.title();
    tags["Description"] = album.text();
    media::write_png(out, image, {.per_metre = flags.dpi / 0.0254, .tags = tags});
    size += fmt::format(", {} x {} px at {:g} dpi", image.width, image.height, flags.dpi);
  } else {
    const page::Sheet sheet{width, album.title(), album.text()};
    const auto under = lit_surfaces(made, width, flags.dpi, flags.context);
    const std::optional<page::Raster> raster = under ? std::optional(under->raster()) : std::nullopt;
    if (options.latex) {
      const std::string lines = lines_of(out);
      write(lines, page::page(made.picture, page::Form::pdf, sheet, raster));
      const std::string words =
          page::latex_page(made.picture, sheet, std::filesystem::path(lines).filename().string());
      write(out, {words.begin(), words.end()});
      size += fmt::format(", words over {}", lines);
    } else {
      write(out, page::page(made.picture, *page::form(ending(out)), sheet, raster));
    }
  }
  say(stdout, "{}: {}\n", out, size);
  warn_of_letters(album.scene());
  return kDone;
}

}  // namespace

OBSCURA_COMMAND(30, figure) {
  const Command command(program, exit, "figure", "Draw a figure for print: SVG, PDF, PNG or LaTeX");
  auto flags = std::make_shared<FigureFlags>();
  add_scene(command, flags->scene);
  command
      .option(
          "-o,--output", flags->out,
          "The output: .svg or .pdf (vectors, with text as text), .png, or .tex (its words for LaTeX, over "
          "the lines in NAME-lines.pdf) [render_out/SCENE.svg]")
      .type("OUT");
  command
      .option("--at", flags->at,
              "The instant (s), or several, as in 0,0.5,1 or 0:2:0.5, with a panel for each [figure.at, or a "
              "quarter of the duration]")
      .type("SECONDS");
  command
      .option("--width", flags->width,
              "Width of the figure, as in 84mm, 3.3in or 240pt; text and lines keep their size "
              "[figure.width, 84mm]")
      .type("LENGTH");
  command.option("--every", flags->every, "Also draw earlier instants, this far apart, fading [figure.every]")
      .type("SECONDS");
  command
      .option(
          "--vary", flags->vary,
          "A panel, and a line in each plot, for each value of a key, as in --vary crate.elasticity=0,0.5,1 "
          "[figure.vary]")
      .type("PATH=VALUES")
      .repeated();
  command.option("--columns", flags->columns, "Panels in a row").range(1, 20);
  command
      .option(
          "--font", flags->font,
          "Font family of words, as in 'Source Sans 3'; of mathematics too where it has a MATH table [Inter]")
      .type("NAME");
  command.option("--dpi", flags->dpi, "Pixels per inch of a PNG, and of lit surfaces in space [300]")
      .range(10.0, 4800.0);
  command.option("--theme", flags->theme, "paper (white) or screen (dark) [paper]")
      .one_of({"paper", "screen"});
  add_backend(command, flags->context.backend);
  add_sets(command, flags->sets);
  add_memory_limit(command);
  command.footer(
      "The scene's [figure] says what the figure names, measures and draws: see docs/scene.md.\n\n"
      "Examples:\n"
      "  obscura figure scenes/box.toml -o box.svg --at 0.8\n"
      "  obscura figure scenes/bounce.toml -o bounce.pdf --at 1.2 --every 0.1 --width 120mm\n"
      "  obscura figure scenes/box.toml -o box.png --at 0,0.4,0.8 --dpi 600\n"
      "  obscura figure scenes/box.toml -o e.pdf --vary 'box[0].elasticity=0,0.5,1' --width 174mm\n\n"
      "Exit codes: 0 done, 2 usage, 3 scene, 4 files, fonts, 5 OpenGL, 6 the simulation diverged.");
  command.run([flags] { return run(*flags); });
}

}  // namespace obscura::app
