#include "draw/list.h"

namespace obscura::draw {

void List::mark(Kind kind, int end) {
  if (!batches.empty() && batches.back().kind == kind && batches.back().clip == clip_) {
    batches.back().end = end;
  } else {
    batches.push_back({kind, end - 1, end, clip_});
  }
}

void List::add(const Disc& disc) {
  discs.push_back(disc);
  mark(Kind::disc, int(discs.size()));
}

void List::add(const Box& box) {
  boxes.push_back(box);
  mark(Kind::box, int(boxes.size()));
}

void List::add(const Text& text) {
  texts.push_back(text);
  mark(Kind::text, int(texts.size()));
}

void List::add(const std::vector<Node>& line, Cap cap, Blend blend, bool closed) {
  if (line.size() < 2) return;
  const int begin = int(nodes.size());
  nodes.insert(nodes.end(), line.begin(), line.end());
  strokes.push_back({begin, int(nodes.size()), closed, cap, blend});
  mark(Kind::stroke, int(strokes.size()));
}

void List::add(const std::vector<Point>& outline, Color fill) {
  if (outline.size() < 3) return;
  const int begin = int(points.size());
  points.insert(points.end(), outline.begin(), outline.end());
  polygons.push_back({begin, int(points.size()), fill});
  mark(Kind::polygon, int(polygons.size()));
}

void List::clip(const Rect& rect) {
  clips.push_back(rect);
  clip_ = int(clips.size()) - 1;
}

void List::unclip() { clip_ = -1; }

}  // namespace obscura::draw
