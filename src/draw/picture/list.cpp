#include "draw/picture/list.h"

#include <algorithm>

#include "draw/picture/latex.h"
#include "draw/picture/solids.h"
#include "draw/picture/type.h"

namespace obscura::draw {

void List::mark(Kind kind, int end) {
  if (!batches.empty() && batches.back().kind == kind && batches.back().clip == clip_ &&
      batches.back().halo == halo_) {
    batches.back().end = end;
  } else {
    batches.push_back({kind, end - 1, end, clip_, halo_});
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
  if (apart) {
    words.push_back(latex_words(text));
    return;
  }
  texts.push_back(with_all_signs(text));
  mark(Kind::text, int(texts.size()));
}

void List::add(const std::vector<Node>& line, Cap cap, Blend blend, bool closed, const Winding& winding) {
  if (line.size() < 2) return;
  const int begin = int(nodes.size());
  nodes.insert(nodes.end(), line.begin(), line.end());
  strokes.push_back({begin, int(nodes.size()), closed, cap, blend, winding});
  mark(Kind::stroke, int(strokes.size()));
}

void List::add_row(const std::vector<Node>& line) {
  add(line, Cap::butt);
  if (line.size() > 1) strokes.back().whole = true;
}

void List::add(const std::vector<Point>& outline, Color fill) {
  if (outline.size() < 3) return;
  const int begin = int(points.size());
  points.insert(points.end(), outline.begin(), outline.end());
  polygons.push_back({begin, int(points.size()), fill});
  mark(Kind::polygon, int(polygons.size()));
}

void List::clip(const Rect& rect) {
  // that of the last is its own again, as where a list is added batch by batch
  if (clips.empty() || !(clips.back() == rect)) clips.push_back(rect);
  clip_ = int(clips.size()) - 1;
}

void List::unclip() { clip_ = -1; }

void List::halo(bool is) { halo_ = is; }

void List::of(Subject subject) {
  subject.part = part;
  of(subject, {});
}

void List::hang(const std::optional<Hang>& at) {
  of(abouts.empty() ? Subject{.part = part} : abouts.back().subject, at);
}

void List::of(const Subject& subject, const std::optional<Hang>& hang) {
  const std::array<int, kKinds> first{int(discs.size()), int(boxes.size()), int(strokes.size()),
                                      int(polygons.size()), int(texts.size())};
  if (!abouts.empty() && abouts.back().first == first) abouts.pop_back();
  if (abouts.empty() || abouts.back().subject != subject || abouts.back().hang != hang)
    abouts.push_back({subject, hang, first});
}

std::vector<About> List::about(Kind kind) const {
  const auto n = std::size_t(kind);
  const std::array<std::size_t, kKinds> counts{discs.size(), boxes.size(), strokes.size(), polygons.size(),
                                               texts.size()};
  std::vector<About> all(counts[n]);
  for (std::size_t i = 0; i < abouts.size(); ++i) {
    const auto from = std::size_t(abouts[i].first[n]);
    const std::size_t to = i + 1 < abouts.size() ? std::size_t(abouts[i + 1].first[n]) : counts[n];
    std::fill(all.begin() + std::ptrdiff_t(from), all.begin() + std::ptrdiff_t(to),
              About{abouts[i].subject, abouts[i].hang, {}});
  }
  return all;
}

void List::add(const List& list, double k, const Point& at) {
  const auto moved = [&](const Point& p) { return Point(at + k * p); };
  std::array<std::vector<About>, kKinds> whose;
  for (std::size_t kind = 0; kind < kKinds; ++kind) whose[kind] = list.about(Kind(kind));
  const int strokes_before = int(strokes.size());
  for (const Batch& batch : list.batches) {
    if (batch.clip >= 0) {
      const Rect& r = list.clips[std::size_t(batch.clip)];
      clip({at.x() + k * r.x, at.y() + k * r.y, k * r.width, k * r.height});
    } else {
      unclip();
    }
    halo(batch.halo);
    for (int i = batch.begin; i < batch.end; ++i) {
      const auto n = std::size_t(i);
      const About& about = whose[std::size_t(batch.kind)][n];
      of(about.subject);
      if (about.hang) hang(about.hang);
      switch (batch.kind) {
        case Kind::disc: {
          Disc disc = list.discs[n];
          disc.center = moved(disc.center), disc.radius *= k, disc.line *= k;
          add(disc);
          break;
        }
        case Kind::box: {
          Box box = list.boxes[n];
          box.center = moved(box.center), box.half *= k, box.line *= k, box.axis *= k, box.axis_line *= k;
          add(box);
          break;
        }
        case Kind::stroke: {
          const Stroke& stroke = list.strokes[n];
          std::vector<Node> line(list.nodes.begin() + stroke.begin, list.nodes.begin() + stroke.end);
          for (Node& node : line) node.at = moved(node.at), node.width *= k;
          Winding winding = stroke.winding;
          winding.lead *= k, winding.amplitude *= k;
          add(line, stroke.cap, stroke.blend, stroke.closed, winding);
          strokes.back().whole = stroke.whole;
          break;
        }
        case Kind::polygon: {
          const Polygon& polygon = list.polygons[n];
          std::vector<Point> outline(list.points.begin() + polygon.begin, list.points.begin() + polygon.end);
          for (Point& p : outline) p = moved(p);
          add(outline, polygon.fill);
          break;
        }
        case Kind::text: {
          Text text = list.texts[n];
          text.at = moved(text.at);
          if (text.whole) text.whole = moved(*text.whole);
          for (Span& span : text.spans) span.size *= k, span.rise *= k, span.lead *= k;
          add(text);
          break;
        }
      }
    }
  }
  halo(false);
  for (Trail trail : list.trails) {
    trail.begin += strokes_before, trail.end += strokes_before, trail.widest *= k;
    trail.origin = moved(trail.origin), trail.scale *= k;
    trail.subject.part = part;
    for (Trail::Point& p : trail.way) p.at = moved(p.at);
    trails.push_back(std::move(trail));
  }
  of({});
  for (Words each : list.words) {
    each.at = moved(each.at), each.size *= k;
    words.push_back(std::move(each));
  }
  unclip();
}

Solids placed(Solids solids, double k, const Point& at) {
  const auto moved = [&](const Point& p) { return Point(at + k * p); };
  const Rect& w = solids.window;
  solids.window = {at.x() + k * w.x, at.y() + k * w.y, k * w.width, k * w.height};
  for (Solids::Vertex& v : solids.vertices) {
    v.at[0] = float(k * v.at[0] + at.x() * v.at[3]);
    v.at[1] = float(k * v.at[1] + at.y() * v.at[3]);
  }
  for (Point& p : solids.points) p = moved(p);
  solids.lens.scale *= k, solids.lens.middle = moved(solids.lens.middle), solids.lens.window = solids.window;
  for (Solids::Tube& tube : solids.tubes) tube.winding.lead *= k, tube.winding.amplitude *= k;
  for (Solids::Tube& line : solids.lines) line.radius *= k;
  for (Solids::Way& way : solids.ways) way.widest *= k;
  return solids;
}

}  // namespace obscura::draw
