#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "draw/picture/formula.h"

namespace obscura::draw {

/// A part of words: plain, or mathematics, which stood between dollars.
struct Phrase {
  std::string_view text;
  bool mathematics = false;
  std::size_t begin = 0;  // of `text` within the words
};

/// Words and the mathematics between dollars in them. As in Pandoc a dollar opens mathematics before what is
/// no space, and closes it behind what is none and before no digit: "from $5 to $10" has none.
std::vector<Phrase> phrases(std::string_view words);

/// Whether something in the words is mathematics.
bool contains_mathematics(std::string_view words);

/// What the mathematics in words says wrongly, at its column of the words.
std::optional<FormulaMistake> prose_mistake(std::string_view words);

/// A line of words in `face`, and of the mathematics in them, as high as they are.
Formula prose(std::string_view words, Face face, double size, Color color);

/// Adds words to a list, and the mathematics in them, at the left end of their baseline, or at its middle.
void add_prose(const std::string& words, Face face, double size, Color color, const Point& at, Align align,
               List& list);

/// The same in letters alone, for where nothing is set: "the slope's μ = f/N".
std::string in_letters(std::string_view words);

/// A formula (formula.h) in letters alone: "E_kin = ½ m v²".
std::string formula_in_letters(std::string_view text);

}  // namespace obscura::draw
