// A page in two files, as LaTeX likes them: lines in a PDF, words by LaTeX over it. Nothing but graphicx and
// color is asked for, so what mathematics needs besides is defined here.

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "page/page.h"

namespace obscura::page {
namespace {

// \obscuratext: words, \obscurabold: a bold letter, each in the size of a script where it is one. amsmath's
// \text and \boldsymbol do the same.
constexpr std::string_view kOpening = R"(\begingroup%
\def\obscurachoice#1#2{\mathchoice%
  {\hbox{#1{\textstyle}{\csname f@size\endcsname}{#2}}}{\hbox{#1{\textstyle}{\csname f@size\endcsname}{#2}}}%
  {\hbox{#1{\scriptstyle}{\csname sf@size\endcsname}{#2}}}{\hbox{#1{\scriptscriptstyle}{\csname ssf@size\endcsname}{#2}}}}%
\def\obscurawords#1#2#3{\fontsize{#2}{0pt}\selectfont#3}%
\def\obscuraheavy#1#2#3{\boldmath$#1#3$}%
\def\obscuratext#1{\obscurachoice\obscurawords{#1}}%
\def\obscurabold#1{\obscurachoice\obscuraheavy{#1}}%
\def\obscurafolder{}%
\ifx\CurrentFilePath\undefined\else\ifx\CurrentFilePath\empty\else\edef\obscurafolder{\CurrentFilePath/}\fi\fi%
)";

std::string decimal(double x) {
  std::string text = fmt::format("{:.3f}", std::abs(x) < 5e-4 ? 0.0 : x);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

// the nearest size that LaTeX's own fonts have
double nearest_size(double size) {
  constexpr std::array<double, 12> sizes{5, 6, 7, 8, 9, 10, 10.95, 12, 14.4, 17.28, 20.74, 24.88};
  double best = size, least = 2;
  for (const double each : sizes)
    if (const double off = std::abs(each - size - 0.01); off < least) best = each, least = off;
  return best;
}

}  // namespace

std::string latex_page(const draw::Picture& picture, const Sheet& sheet, const std::string& pdf) {
  const double k = sheet.width / (1080 * picture.aspect), height = 1080 * k;
  const std::string width = decimal(sheet.width);
  std::string out = fmt::format(
      "% The words of {}. In the document: \\usepackage{{graphicx,color}}, and \\input this file.\n"
      "% \\newcommand\\obscurawidth{{\\textwidth}} before it makes it so wide; the words keep their size.\n",
      pdf);
  out += kOpening;
  out += fmt::format(
      "\\ifx\\obscurawidth\\undefined\\unitlength=1bp\\else"
      "\\unitlength=\\dimexpr\\obscurawidth*1000/{:.0f}\\relax\\fi%\n"
      "\\begin{{picture}}({},{})%\n"
      "\\put(0,0){{\\includegraphics[width={}\\unitlength]{{\\obscurafolder {}}}}}%\n",
      1000 * sheet.width, width, decimal(height), width, pdf);
  for (const draw::Words& words : picture.moving.words) {
    if (words.latex.empty() || words.color.a == 0) continue;
    // what is faint is mixed with the ground
    const draw::Color ink =
        draw::mix(picture.ground, {words.color.r, words.color.g, words.color.b}, words.color.a / 255.0);
    const char across = words.align == draw::Align::left    ? 'l'
                        : words.align == draw::Align::right ? 'r'
                                                            : 'c';
    const std::string box =
        words.level == draw::Level::baseline
            ? fmt::format("\\makebox[0pt][{}]", across)
            : fmt::format("\\makebox(0,0)[{}{}]", across == 'c' ? "" : std::string(1, across),
                          words.level == draw::Level::top      ? "t"
                          : words.level == draw::Level::bottom ? "b"
                                                               : "");
    const double size = nearest_size(k * words.size);
    out += fmt::format(
        "\\put({},{}){{{}{{\\color[rgb]{{{},{},{}}}\\fontsize{{{:g}}}{{{:g}}}\\selectfont {}}}}}%\n",
        decimal(k * words.at.x()), decimal(height - k * words.at.y()), box, decimal(ink.r / 255.0),
        decimal(ink.g / 255.0), decimal(ink.b / 255.0), size, 1.2 * size, words.latex);
  }
  return out + "\\end{picture}%\n\\endgroup%\n";
}

}  // namespace obscura::page
