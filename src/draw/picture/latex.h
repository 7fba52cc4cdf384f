#pragma once

#include <string>
#include <string_view>

#include "draw/picture/list.h"

namespace obscura::draw {

/// A formula (formula.h) as LaTeX for text: "$v_{\mathrm{center}}$". Beside LaTeX's own commands it uses two
/// that `page::latex_page` defines: \obscuratext{words} in mathematics, and \obscurabold{v}, a bold italic
/// letter.
std::string latex(std::string_view formula);

/// Plain words as LaTeX for text.
std::string latex_text(std::string_view words);

/// A line of type as LaTeX, held at its `align`.
Words latex_words(const Text& text);

/// The same with another decimal mark in its numbers.
std::string latex_with_mark(std::string_view latex, std::string_view mark);

}  // namespace obscura::draw
