#include "app/compare/comparison.h"
#include "app/console/say.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "app/compare/format.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/run/frames.h"
#include "media/error.h"

namespace obscura::app {

namespace {

constexpr std::size_t kMostRows = 12;  // of the table
constexpr const char* kByOrder =
    "  the folders have no name of a file in common: the first was compared with the first, and so on\n";

using Frame = Comparison::Frame;

std::string size(const media::Image& image) { return fmt::format("{}x{}", image.width, image.height); }

// whether frame a differs more than b: visible differences count first
bool worse(const Frame& a, const Frame& b) {
  if (a.sizes != b.sizes) return a.sizes;
  const auto key = [](const media::Difference& d) { return std::tuple(d.solid, d.pixels, d.largest); };
  return key(a.difference) > key(b.difference);
}

std::string pair_of(const std::string& a, const std::string& b) { return fmt::format("{} and {}", a, b); }

// frames of two folders belong together by name, where they have names in common, and else by order
void match(Frames& a, Frames& b, Comparison& found) {
  const std::set<std::string> left(a.names().begin(), a.names().end()),
      right(b.names().begin(), b.names().end());
  std::vector<std::string> both, only_a, only_b;
  for (const std::string& name : a.names()) (right.contains(name) ? both : only_a).push_back(name);
  for (const std::string& name : b.names())
    if (!left.contains(name)) only_b.push_back(name);
  if (both.empty()) {
    found.by_order = true;
    return;
  }
  if (!only_a.empty()) found.plain.push_back(fmt::format("only {} has {}", found.a, some_of(only_a)));
  if (!only_b.empty()) found.plain.push_back(fmt::format("only {} has {}", found.b, some_of(only_b)));
  a.only(both), b.only(both);
}

void keep_if_telling(Comparison& found, Frame frame, const media::Image& a, const media::Image& b) {
  frame.a = a, frame.b = b;
  found.differing.push_back(std::move(frame));
  const int last = int(found.differing.size()) - 1;
  if (found.first < 0) found.first = last;
  const int before = found.worst;
  if (before < 0 || worse(found.differing[std::size_t(last)], found.differing[std::size_t(before)]))
    found.worst = last;
  // pictures of the first and the worst alone are kept
  for (const int i : {before, last})
    if (i >= 0 && i != found.first && i != found.worst)
      found.differing[std::size_t(i)].a = found.differing[std::size_t(i)].b = {};
}

// When frames of two movies are shown, since the first. The first that differs by more than the files round
// times to is told: the same pixels at another speed are another film.
class FrameTimes {
 public:
  void compare(const Frames& a, const Frames& b, Comparison& found) {
    if (told_ || a.kind() != Frames::Kind::movie || b.kind() != Frames::Kind::movie) return;
    const double left = *a.time(), right = *b.time();
    if (found.compared == 0) first_a_ = left, first_b_ = right;
    const double at_a = left - first_a_, at_b = right - first_b_;
    if (std::abs(at_a - at_b) <= a.tick() + b.tick()) return;
    told_ = true;
    found.plain.push_back(
        fmt::format("{} is at {:.4g} s in {} and at {:.4g} s in {}", a.name(), at_a, found.a, at_b, found.b));
  }

 private:
  double first_a_ = 0, first_b_ = 0;  // s
  bool told_ = false;
};

void compare_frames(Frames& a, Frames& b, Comparison& found) {
  media::Image left, right;
  FrameTimes times;
  std::optional<Origin> first_a, first_b;
  for (;;) {
    if (interrupted()) return;
    const bool more_a = a.next(left), more_b = b.next(right);
    if (!more_a || !more_b) {
      std::int64_t rest = more_a || more_b;
      while (more_a && a.next(left)) ++rest;
      while (more_b && b.next(right)) ++rest;
      if (rest > 0)
        found.plain.push_back(fmt::format("{} has {} frames and {} has {}", found.a,
                                          found.compared + (more_a ? rest : 0), found.b,
                                          found.compared + (more_b ? rest : 0)));
      break;
    }
    if (found.compared == 0) first_a = a.origin(), first_b = b.origin();
    times.compare(a, b, found);
    Frame frame;
    frame.number = found.compared++;
    frame.name = found.by_order ? pair_of(a.name(), b.name()) : a.name(), frame.time = a.time();
    frame.origin_a = a.origin(), frame.origin_b = b.origin();
    if (left.width != right.width || left.height != right.height) {
      frame.sizes = true, frame.size_a = size(left), frame.size_b = size(right);
    } else {
      frame.difference = media::difference(left, right);
      if (frame.difference.same()) continue;
    }
    keep_if_telling(found, std::move(frame), left, right);
  }
  if (found.differing.empty()) {
    // differences of their origins, though they look the same
    const Cause told = first_a && first_b && found.plain.empty() ? cause(first_a, first_b, false) : Cause{};
    if (told.kind != Cause::Kind::pixels) found.others = told.lines;
    return;
  }
  const Frame& first = found.differing[std::size_t(found.first)];
  found.cause = cause(first.origin_a, first.origin_b);
}

std::string row(const Frame& frame, const std::string& mark) {
  const media::Difference& d = frame.difference;
  const std::string when = frame.time ? fmt::format("{:.4g} s", *frame.time) : "";
  if (frame.sizes)
    return fmt::format("  {:<14} {:>9}  {} and {}  {}\n", frame.name, when, frame.size_a, frame.size_b, mark);
  return fmt::format(
      "  {:<14} {:>9} {:>9} {:>8} {:>8}   {:<22} {}\n", frame.name, when, d.pixels, d.solid, d.largest,
      fmt::format("{}x{} at ({}, {})", d.right - d.left + 1, d.bottom - d.top + 1, d.left, d.top), mark);
}

std::string table(const Comparison& comparison) {
  std::string text = fmt::format("  {:<14} {:>9} {:>9} {:>8} {:>8}   {}\n", "frame", "time", "pixels",
                                 "solid", "largest", "within");
  std::size_t shown = 0;
  for (std::size_t i = 0; i < comparison.differing.size(); ++i) {
    const bool first = int(i) == comparison.first, worst = int(i) == comparison.worst;
    if (shown >= kMostRows && !worst) continue;
    ++shown;
    text += row(comparison.differing[i], first && worst ? " first and worst"
                                         : first        ? " first"
                                         : worst        ? " worst"
                                                        : "");
  }
  if (shown < comparison.differing.size())
    text += fmt::format("  and {} more\n", comparison.differing.size() - shown);
  return text;
}

}  // namespace

Comparison compare(const std::string& a, const std::string& b) {
  Comparison found;
  found.a = a, found.b = b;
  Frames left(a), right(b);
  const bool still_a = left.kind() == Frames::Kind::still, still_b = right.kind() == Frames::Kind::still;
  if (still_a != still_b)
    throw UsageError(
        fmt::format("{} is one picture and {} is a sequence of them", still_a ? a : b, still_a ? b : a));
  found.still = still_a;
  // the same bytes are the same pictures, if they are pictures at all
  if (left.kind() != Frames::Kind::folder && right.kind() != Frames::Kind::folder)
    found.same_bytes = file_hash(a) == file_hash(b);
  if (found.same_bytes) {
    media::Image image;
    if (!left.next(image)) throw media::Error(a + ": has no picture in it");
    found.compared = 1;
    return found;
  }
  if (left.kind() == Frames::Kind::folder && right.kind() == Frames::Kind::folder) match(left, right, found);
  compare_frames(left, right, found);
  return found;
}

std::string sentence(const media::Difference& d) {
  if (d.same()) return "the same pixels";
  std::string text =
      d.pixels == 1 ? fmt::format("one pixel differs, at ({}, {}), by {} of 255 levels", d.x, d.y, d.largest)
                    : fmt::format("{} pixels differ by up to {} of 255 levels", d.pixels, d.largest);
  if (d.alpha_only) text += ", in alpha alone";
  if (d.pixels > 1)
    text +=
        fmt::format(", within {}x{} at ({}, {})", d.right - d.left + 1, d.bottom - d.top + 1, d.left, d.top);
  if (d.solid == 0)
    text += "; all of it is as of edges that moved by less than a pixel";
  else if (d.solid < d.pixels)
    text += fmt::format("; {} of them more than an edge moved by less than a pixel", d.solid);
  return text;
}

std::string sentence(const Frame& frame) {
  if (frame.sizes) return fmt::format("other sizes: {} and {} pixels", frame.size_a, frame.size_b);
  return sentence(frame.difference);
}

std::string text(const Comparison& comparison) {
  const Comparison& c = comparison;
  std::string all;
  if (c.same_bytes) return fmt::format("{} and {} are the same, byte by byte\n", c.a, c.b);
  if (c.same()) {
    all = c.still ? fmt::format("{} and {} show the same pixels", c.a, c.b)
                  : fmt::format("{} and {} show the same pixels in all {}", c.a, c.b,
                                counted(std::size_t(c.compared), "frame"));
    all += c.others.empty() ? "\n" : "; what they say of themselves differs:\n";
    for (const std::string& line : c.others) all += "  " + line + "\n";
    if (c.by_order) all += kByOrder;
    return all;
  }
  all = fmt::format("{} and {} differ", c.a, c.b);
  if (c.still) {
    all += fmt::format(": {}\n", sentence(c.differing.front()));
  } else if (c.differing.empty()) {
    all += fmt::format("; the pixels of {} are the same\n", counted(std::size_t(c.compared), "frame"));
  } else {
    all += fmt::format(" in {} of {}\n", c.differing.size(), counted(std::size_t(c.compared), "frame")) +
           table(c);
  }
  if (c.by_order) all += kByOrder;
  for (const std::string& line : c.plain) all += "  " + line + "\n";
  if (c.cause) {
    all += fmt::format("cause: {}\n", c.cause->lines.empty() ? "not known" : c.cause->lines.front());
    for (std::size_t i = 1; i < c.cause->lines.size(); ++i) all += "  " + c.cause->lines[i] + "\n";
  }
  return all;
}

std::string json(const Comparison& comparison) {
  const Comparison& c = comparison;
  nlohmann::ordered_json top = json_head("compare", c.same() ? kDone : kDiffers);
  top["a"] = c.a, top["b"] = c.b;
  top["same"] = c.same(), top["same_bytes"] = c.same_bytes;
  top["frames"] = c.compared;
  if (c.by_order) top["by_order"] = true;
  top["differing"] = nlohmann::ordered_json::array();
  for (const Frame& frame : c.differing) {
    nlohmann::ordered_json it;
    it["frame"] = frame.number, it["name"] = frame.name;
    if (frame.time) it["time"] = *frame.time;
    if (frame.sizes) {
      it["sizes"] = {frame.size_a, frame.size_b};
    } else {
      it.update(json_of(frame.difference));
    }
    top["differing"].push_back(std::move(it));
  }
  if (c.first >= 0) {
    top["first"] = c.differing[std::size_t(c.first)].number;
    top["worst"] = c.differing[std::size_t(c.worst)].number;
  }
  top["plain"] = c.plain, top["others"] = c.others;
  if (c.cause) top["cause"] = json_of(*c.cause);
  return text_of(top);
}

}  // namespace obscura::app
