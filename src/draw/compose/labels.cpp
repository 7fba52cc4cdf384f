// Labels: the words of a body stand over the highest of its places on the page, upright however it or the
// camera turns; if there is no room above, under the lowest. A plate of the room's colour keeps them readable
// over other things.

#include <algorithm>
#include <cmath>

#include "draw/plane/stage.h"
#include "draw/space/space.h"

namespace obscura::draw {
namespace {

constexpr double kLabel = 23;                  // em
constexpr double kAscent = 0.74;               // of the em: figures and capitals
constexpr double kDescent = 0.22;              // and what hangs below the baseline
constexpr double kBodyGap = 7, kAround = 3.5;  // page units: to the body, and of the plate around the words

/// From where to where on the page a body reaches.
struct Height {
  double top = 1e300, bottom = -1e300;
  void add(double y, double radius) {
    top = std::min(top, y - radius), bottom = std::max(bottom, y + radius);
  }
};

struct Label {
  const std::string& words;
  Point center;
  Height body;
  std::optional<Hang> hang = {};  // in space
};

void add(const std::vector<Label>& labels, const Rect& window, double weight, const Palette& colours,
         List& list) {
  const double size = kLabel * weight, around = kAround * weight;
  std::vector<std::pair<Text, std::optional<Hang>>> texts;
  for (const Label& label : labels) {
    if (outside(window, label.center, 0)) continue;
    const std::string words = fitted(label.words, Face::medium, size, window.width - 2 * around);
    const double half = width_of(words, Face::medium, size) / 2 + around;
    const double high = kAscent * size + around, low = kDescent * size + around;
    double baseline = label.body.top - kBodyGap * weight - low;
    if (baseline - high < window.y) baseline = label.body.bottom + kBodyGap * weight + high;
    const double last = window.y + window.height - low;
    baseline = std::min(baseline, last);
    const double x = 2 * half < window.width
                         ? std::clamp(label.center.x(), window.x + half, window.x + window.width - half)
                         : window.x + window.width / 2;
    Color plate = colours.room;
    plate.a = 190;
    if (label.hang) list.hang(label.hang);
    list.add({{x - half, baseline - high},
              {x + half, baseline - high},
              {x + half, baseline + low},
              {x - half, baseline + low}},
             plate);
    texts.push_back({{{x, baseline},
                      Align::center,
                      {{.text = words, .face = Face::medium, .size = size, .color = colours.ink}}},
                     label.hang});
  }
  for (const auto& [text, hang] : texts) {
    if (hang) list.hang(hang);
    list.add(text);
  }
  if (!texts.empty() && texts.back().second) list.hang({});
}

/// A form of the plane: a body's own, or a part's at its place.
template <class Form>
void add_form(const Form& form, const sim::Vec3& center, const sim::Snapshot::Body& body, const View& view,
              Height& span) {
  const double s = std::sin(body.angle), c = std::cos(body.angle);
  const auto add = [&](const sim::Vec3& own, double radius) {
    const sim::Vec3 turned(c * own.x() - s * own.y(), s * own.x() + c * own.y(), 0);
    span.add(view.page(body.position + turned).y(), view.scale * radius);
  };
  if (form.kind == sim::ShapeKind::box) {
    for (int i = 0; i < 4; ++i)
      add(center + form.half.cwiseProduct(sim::Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, 0)), 0);
  } else if (form.vertices.empty()) {
    add(center, form.radius);
  }
  for (const sim::Vec3& vertex : form.vertices) add(vertex, 0);
}

}  // namespace

void draw_labels(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  std::vector<Label> labels;
  for (std::size_t i = 0; i < stage.look.bodies.size() && i < now.bodies.size(); ++i) {
    const std::string& words = stage.look.bodies[i].label;
    if (words.empty()) continue;
    const sim::SceneInfo::Body& body = stage.cast.bodies[i];
    Label label{words, view.page(now.bodies[i].position), {}};
    if (body.parts.empty()) add_form(body, sim::Vec3::Zero(), now.bodies[i], view, label.body);
    for (const sim::SceneInfo::Part& part : body.parts)
      add_form(part, part.center, now.bodies[i], view, label.body);
    label.body.add(label.center.y(), stage.dots[i]);
    labels.push_back(label);
  }
  add(labels, view.window, stage.layout.weight, stage.colours, list);
}

void draw_space_labels(SpaceFrame& s) {
  const auto& bodies = s.stage.look.bodies;
  if (std::all_of(bodies.begin(), bodies.end(), [](const BodyLook& body) { return body.label.empty(); }))
    return;
  std::vector<Height> spans(s.now.bodies.size());
  for (std::size_t i = 0; i < s.stage.pieces.size(); ++i) {
    const Piece& piece = s.stage.pieces[i];
    const sim::Snapshot::Body& body = s.now.bodies[std::size_t(piece.body)];
    const auto add = [&](const sim::Vec3& place, double radius) {
      if (s.lens.depth(place) > 1e-2)
        spans[std::size_t(piece.body)].add(s.lens.page(place).y(), radius * s.lens.scale_at(place));
    };
    for (const sim::Vec3& v : s.placed[i].vertices) add(v, 0);
    if (piece.form == Piece::Form::polyhedron) continue;
    const double dot = s.stage.dots[std::size_t(piece.body)];
    for (const sim::Vec3& end : {piece.a, piece.b})
      add(body.position + body.orientation * end, dot > 0 ? dot / s.lens.scale : piece.radius);
  }
  std::vector<Label> labels;
  for (std::size_t i = 0; i < bodies.size() && i < spans.size(); ++i) {
    const sim::Vec3& place = s.now.bodies[i].position;
    if (bodies[i].label.empty() || s.lens.depth(place) < 1e-2) continue;
    labels.push_back({bodies[i].label, s.lens.page(place), spans[i], Hang{place, place}});
  }
  add(labels, s.lens.window, s.stage.layout.weight, s.stage.colours, s.list);
}

}  // namespace obscura::draw
