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
  double begin = 0, end = 1e300;     // s of the film: when it is shown
  std::vector<std::string> lines{};  // of a page: as long as they may be
  std::vector<Point> room{};         // of each: what it takes above its baseline and below, page units
};

/// What a film says beside its marks.
struct Titles {
  std::vector<Card> cards;
  std::vector<Caption> captions;
  bool badge = false;  // how fast it goes, where that is not as it happens
  double fade = 0;     // s: from the page's colour at the film's start, and to it at its end
  double length = 0;   // s of the film
  bool still = false;  // of one picture: what is shown is there as a whole
  double foot = 0;     // of a page: what the captions take of its height, page units
  double type_scale = 1;

  bool empty() const { return cards.empty() && captions.empty() && !badge && !(fade > 0); }
};

/// The same for a page: captions in lines, and the strip at the page's foot that holds all that are shown at
/// one instant. Nothing else is drawn there.
Titles laid_out(const Titles& titles, double aspect, double type_scale = 1);

/// Draws them over a page. `time`: of the run, s; `film`: of the film; `speed`: of the run against the film.
void draw_titles(const Titles& titles, const Layout& layout, double aspect, const Palette& colours,
                 double time, double film, double speed, List& list);

}  // namespace obscura::draw
