#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "page/reel.h"

namespace obscura::page {

/// A film as one HTML file that plays without any other: what it says besides its pictures.
struct FilmPage {
  std::string title;
  bool dark = false;
  bool watched = false;                // it may ask the server that it is from, and no other
  std::string origin;                  // JSON, as pictures carry it
  std::string generator;               // "obscura 0.2.0"
  std::vector<std::string> sentences;  // what happens, for screen readers
  std::string footer;                  // text
  std::vector<std::uint8_t> still;     // an SVG that is shown where no script runs; empty: words alone
  nlohmann::ordered_json film;         // what its player needs besides the reel (page/player/player.js)
};

/// The file. Its script and style are named by their hashes in its content security policy; nothing else
/// runs, and nothing is fetched. All words are escaped.
std::string html(const FilmPage& page, Reel& reel);

/// A page of words where a watched page would be: what is wrong with its scene. It follows as that one does.
std::string words_page(const std::string& title, const std::vector<std::string>& lines, bool dark = false);

/// The origin that such a file carries, as JSON; empty where it carries none.
std::string origin_in_html(const std::string& file);

}  // namespace obscura::page
