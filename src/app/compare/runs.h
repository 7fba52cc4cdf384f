#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/run/table.h"

namespace obscura::app {

/// How far apart two values may be.
struct Tolerance {
  double relative = 0, absolute = 0;  // of the first; in the quantity's unit
  /// Whether `b` may stand for `a`: |b - a| <= absolute + relative |a|. An infinite one, or one that is no
  /// number, is as itself alone.
  bool holds(double a, double b) const;
};

/// How two runs, as tables, agree.
struct RunComparison {
  /// A quantity of both: "ball.position", its components together.
  struct Quantity {
    std::string body, name;  // "ball", "position"; of all bodies: "energy", "total"
    bool parts = false;
    double first = 0;    // s: where it parts; if it does
    double largest = 0;  // |b - a| of a component
    double at = 0;       // s: there
  };
  /// The first place where anything parts.
  struct Place {
    double time = 0;
    int line_a = 0, line_b = 0;  // of the files
    std::string body, quantity;  // "ball", "position.y"
    double a = 0, b = 0;
  };

  std::string a, b;
  std::size_t times = 0;  // compared
  std::vector<Quantity> quantities;
  std::optional<Place> place;
  bool turned = false;              // angles differ by whole turns, which are let pass
  std::vector<std::string> plain;   // what b has not: that counts as another run
  std::vector<std::string> others;  // what was not compared, and is no difference

  bool same() const { return !place && plain.empty(); }
};

/// Compares run b with run a, the reference, at a's times and in a's columns. b must have the positions of
/// a's bodies, and each component of a quantity of which it has one; with `interpolate` between b's rows by
/// straight lines. Angles that differ by whole turns are one angle, and so are q and -q.
RunComparison compare(const Table& a, const Table& b, const Tolerance& tolerance, bool interpolate);

/// The whole as lines for a person, as a JSON object for a program.
std::string text(const RunComparison& comparison, const Tolerance& tolerance);
std::string json(const RunComparison& comparison);

}  // namespace obscura::app
