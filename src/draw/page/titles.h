#pragma once

#include <string>
#include <vector>

#include "draw/page/layout.h"
#include "draw/page/marks.h"
#include "draw/picture/list.h"
#include "draw/picture/theme.h"

namespace obscura::draw {

/// A page of words that the film shows while its run stands still.
struct Card {
  std::string title, text;
  double begin = 0, end = 0;         // s of the film
  double fade = 0;                   // s: from the picture to the card, and back
  bool first = false, last = false;  // nothing is shown before it, after it
};

/// Words below the picture.
struct Caption {
  std::string text;
  Interval shown{};
};

/// What a film says beside its marks.
struct Titles {
  std::vector<Card> cards;
  std::vector<Caption> captions;
  bool badge = false;  // how fast it goes, where that is not as it happens

  bool empty() const { return cards.empty() && captions.empty() && !badge; }
};

/// Draws them over a page. `time`: of the run, s; `film`: of the film; `speed`: of the run against the film.
void draw_titles(const Titles& titles, const Layout& layout, double aspect, const Palette& colours,
                 double time, double film, double speed, List& list);

}  // namespace obscura::draw
