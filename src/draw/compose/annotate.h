#pragma once

#include <optional>
#include <span>

#include "draw/compose/depict.h"
#include "draw/page/figure.h"
#include "draw/page/layout.h"
#include "draw/picture/theme.h"

namespace obscura::draw {

/// The mapping from places of the world to a sheet (`kPoint` units a point): a view in the plane, a lens in
/// space.
class Projection {
 public:
  explicit Projection(const View& view) : view_(view), window_(view.window) {}
  /// A lens's page, put down `scale` times as large with its corner at `corner`.
  Projection(const CameraProjection& lens, double scale, const Point& corner);

  Point page(const sim::Vec3& place) const;
  /// Page units a metre there.
  double scale_at(const sim::Vec3& place) const;
  /// The way from there to the eye, unit.
  sim::Vec3 sight(const sim::Vec3& place) const;
  const Rect& window() const { return window_; }
  /// The plane's; none of space.
  const View* view() const { return view_ ? &*view_ : nullptr; }

 private:
  std::optional<View> view_;
  CameraProjection lens_;
  double scale_ = 1;
  Point corner_ = {0, 0};
  Rect window_;
};

/// How long arrows are, one scale a kind for all panels of a figure: m a unit. 0: none is drawn.
struct Scales {
  double velocity = 0;  // m/s
  double force = 0;     // N
  double impulse = 0;   // N s
};

/// The scales at which the longest arrow of each kind is a good part of a window of `scale` page units a
/// metre.
Scales scales(const Figure& figure, const sim::SceneInfo& cast, std::span<const sim::Snapshot> moments,
              const Rect& window, double scale);

/// Draws what a figure says of an instant: arrows, angles, lengths, points, and their words where there is
/// room for them.
void annotate(const Figure& figure, const Scales& scales, const sim::SceneInfo& cast, const Palette& colours,
              const Projection& projection, const sim::Snapshot& now, List& list);

/// Rulers in metres along the lower and the left edge of a sheet's window, and how much room they take there.
void draw_rulers(const Layout& layout, const View& view, const Palette& colours, List& list);
inline constexpr double kRulerBelow = 25, kRulerLeft = 27;  // pt

/// Whether a figure has a line of legend, and puts it down from `left` to `right` (page units) on a baseline:
/// the room's scale, and an arrow of each kind.
bool has_legend(const Figure& figure);
void draw_legend(const Figure& figure, const Scales& scales, const Palette& colours, double scale,
                 double left, double right, double baseline, List& list);

/// The largest of 1, 2, 5 times a power of ten that is not above x.
double round_below(double x);

}  // namespace obscura::draw
