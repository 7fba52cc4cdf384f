// Light and shadow.
//   lit     s = s0 + s1 (1 + n_y)/2 + s4 (1 + n . f)/2 + s2 max(0, n . l)     n  normal, l  to the light
//   shaded  s = s0 + s1 (1 + n_y)/2 + s4 (1 + n . f)/2 + s3 max(0, n . l)     s3 < s2: round things stay
//   round; on the dark theme it is below 0: a shadow from which nothing is reflected
// of what is round s is larger by s5 (1 - 0.6 max(0, n . l)) (n . e - 0.4)       e  to the eye
// f is level and across the light: two upright faces at a right angle that both look away from the light
// differ by s4/2 at least, however they are turned.
//   colour  from dark to bright along s, through the body's own, m w: m is its largest part of red, green
//   and blue, w those parts over m; the dark is a share of m w^1.5, so that it is full and not grey
// A shadow on the ground is drawn ray by ray: each casts the body's corners on the plane, their hull is dark
// for that ray, and a place is as dark as the share of rays that do not reach it. So a shadow is sharp where
// a body stands on the ground and soft where it flies.

#include "draw/space/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kFine = 0.08;     // of kSpread: of the disc that lights thin rods
constexpr double kFoot = 0.35;     // of a ball's radius: where it is near the ground
constexpr double kFall = 1.6;      // of the darkness around a contact: how much sooner than straight it falls
constexpr double kBefore = 0.02;   // least depth of what the ground is seen of, over the target's
constexpr double kNear = 1e-3;     // least depth over the target's
constexpr double kSharp = 0.6;     // page units: shadows softer than this take more rays
constexpr double kMiddle = 0.4;    // of round surfaces: the cosine to the eye at which they are as flat ones
constexpr double kInTheSun = 0.4;  // of that, in full light
constexpr double kGloss = 0.4;     // how white the mirrored light is
constexpr double kLevel = 0.05;    // light that comes from lower throws no shadows on the ground

/// From dark to bright, see above.
struct Tones {
  Color ink;            // what the dark tends to
  double share, inked;  // the dark: its share of the own colour's light, how much of it is ink
  double own, white;    // at which s it is the own colour; how much white is in the brightest
  double shaded;        // s3
  double facing;        // s5
};
constexpr Tones kPaper{{0x18, 0x1C, 0x22}, 0.44, 0.08, 0.67, 0.30, 0.06, 0.55};
constexpr Tones kScreen{{0x08, 0x0C, 0x12}, 0.36, 0.10, 0.72, 0.26, -0.12, 0.8};

Color deep(Color own, const Tones& t) {
  const double most = std::max({own.r, own.g, own.b, std::uint8_t(1)});
  const auto part = [&](std::uint8_t c) { return std::uint8_t(t.share * c * std::sqrt(c / most) + 0.5); };
  return mix({part(own.r), part(own.g), part(own.b)}, t.ink, t.inked);
}

double cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The hull of `points`, in order. Andrew's chain.
void hull(std::vector<Point>& points, std::vector<Point>& out) {
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  out.clear();
  const auto chain = [&](auto begin, auto end) {
    const std::size_t first = out.size();
    for (auto p = begin; p != end; ++p) {
      while (out.size() >= first + 2 &&
             cross(out.back() - out[out.size() - 2], *p - out[out.size() - 2]) <= 1e-9)
        out.pop_back();
      out.push_back(*p);
    }
    out.pop_back();
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
}

/// (x w, y w, w) of a place, see CameraProjection::homogeneous.
Vec3 seen_at(const CameraProjection& lens, const Vec3& place) {
  const Eigen::Vector4d h = lens.homogeneous(place);
  return {h.x(), h.y(), h.w()};
}

}  // namespace

Light light(const Vec3& toward) {
  Light l;
  l.toward = toward.normalized();
  const Vec3 side =
      (std::abs(l.toward.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitX()).cross(l.toward).normalized();
  const Vec3 up = l.toward.cross(side);
  l.across = side - side.y() * Vec3::UnitY();
  l.across.normalize();
  for (int i = 0; i < kRays; ++i) {
    // a sunflower: even over the disc, without rows
    const double r = kSpread * std::sqrt((i + 0.5) / kRays), a = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec3 off = r * (std::cos(a) * side + std::sin(a) * up);
    l.rays[i] = l.toward + off, l.fine[i] = l.toward + kFine * off;
  }
  return l;
}

namespace {

// `more`: of s
Shaded toned(Color own, Theme theme, const Light& light, const Vec3& normal, double more) {
  const double sky = (1 + normal.y()) / 2, sun = std::max(0.0, normal.dot(light.toward));
  const Tones& t = theme == Theme::paper ? kPaper : kScreen;
  const Color low = deep(own, t), high = mix(own, {255, 255, 255}, t.white);
  const auto tone = [&](double s) {
    return s < t.own ? mix(low, own, std::max(s, 0.0) / t.own)
                     : mix(own, high, (std::min(s, 1.0) - t.own) / (1 - t.own));
  };
  const double base = 0.15 + 0.13 * sky + 0.26 * (1 + normal.dot(light.across)) / 2 + more;
  return {tone(base + 0.58 * sun), tone(base + t.shaded * sun)};
}

}  // namespace

Shaded shade(Color own, Theme theme, const Light& light, const Vec3& normal) {
  return toned(own, theme, light, normal, 0);
}

Shaded shade_round(Color own, Theme theme, const Light& light, const Vec3& normal, const Vec3& sight) {
  const double sun = std::max(0.0, normal.dot(light.toward)),
               facing = (theme == Theme::paper ? kPaper : kScreen).facing;
  Shaded it =
      toned(own, theme, light, normal, facing * (1 - (1 - kInTheSun) * sun) * (normal.dot(sight) - kMiddle));
  const double mirrored = std::max(0.0, normal.dot((light.toward + sight).normalized()));
  it.lit = mix(it.lit, {255, 255, 255}, kGloss * std::pow(mirrored, 36));
  return it;
}

Shaded shine(Color own, Theme theme, const Light& light, const Vec3& normal, const Vec3& sight) {
  const Vec3 back = 2 * normal.dot(sight) * normal - sight;  // where what one sees comes from
  const auto smooth = [](double from, double to, double x) {
    const double u = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return u * u * (3 - 2 * u);
  };
  // a dark ground, a bright horizon, a sky that darkens upwards
  const double sky = 0.16 + 0.5 * smooth(-0.35, 0.1, back.y()) - 0.26 * smooth(0.1, 0.95, back.y());
  const double spot = std::pow(std::max(back.dot(light.toward), 0.0), 28);
  const double sun = std::max(0.0, normal.dot(light.toward));
  const Color grey{0xA9, 0xB0, 0xB8}, white{255, 255, 255};
  const Color tint = mix(own, grey, 0.25);
  const bool paper = theme == Theme::paper;
  const Color dark = mix(tint, (paper ? kPaper : kScreen).ink, paper ? 0.60 : 0.72);
  const Color pale = mix(tint, white, paper ? 0.48 : 0.3);
  const auto tone = [&](double s, double bright) {
    return mix(mix(dark, pale, std::clamp(s, 0.0, 1.0)), white, std::clamp(bright, 0.0, 1.0));
  };
  return {tone(sky + 0.42 * sun, 0.75 * spot), tone(sky + 0.08 * sun, 0)};
}

Color edge(Color own, Theme theme) {
  return theme == Theme::paper ? mix(own, {0x10, 0x13, 0x18}, 0.58) : mix(own, {0x06, 0x09, 0x0D}, 0.80);
}

Color crease(Color own, Theme theme) {
  return theme == Theme::paper ? edge(own, theme) : mix(own, {255, 255, 255}, 0.5);
}

std::uint32_t stopped(double share) {
  std::uint32_t rays = 0;
  for (int i = 0; i < kRays; ++i)
    if (std::floor((i + 1) * share) > std::floor(i * share)) rays |= 1u << i;
  return share < 1 ? rays : ~0u;
}

GroundShadow::GroundShadow(const Ground& ground, const Light& light, const CameraProjection& lens)
    : ground_(ground), light_(light), lens_(lens), slope_(light.toward.dot(ground.normal)) {
  // what of it lies before the eye
  for (std::size_t i = 0; i < ground.loop.size(); ++i) {
    const Vec3 &a = ground.loop[i], &b = ground.loop[(i + 1) % ground.loop.size()];
    const double at_a = lens.depth(a) - kBefore, at_b = lens.depth(b) - kBefore;
    if (at_a >= 0) bound_.push_back(lens.page(a));
    if ((at_a < 0) != (at_b < 0)) bound_.push_back(lens.page(a + (b - a) * (at_a / (at_a - at_b))));
  }
  plumb_ = ray(ground.normal);
  if (slope_ <= kLevel) return;
  for (int i = 0; i < kRays; ++i) rays_[i] = ray(light.rays[i]), fine_[i] = ray(light.fine[i]);
  rays_[kRays] = ray(light.toward);
}

GroundShadow::Ray GroundShadow::ray(const Vec3& along) const {
  // a ball's shadow is an ellipse: its axis along the light is longer
  const double down = along.dot(ground_.normal);
  const Vec3 flat = along - ground_.normal * down;
  const Vec3 u = flat.norm() > 1e-9 ? Vec3(flat.normalized()) : ground_.normal.unitOrthogonal();
  const Vec3 v = ground_.normal.cross(u);
  const auto seen = [&](const Vec3& way) {
    return Vec3(seen_at(lens_, lens_.target + way) - seen_at(lens_, lens_.target));
  };
  Ray r{seen(-along / down), {}};
  for (int k = 0; k < kRim; ++k) {
    const double a = 2 * std::numbers::pi * k / kRim;
    r.round[k] = seen(along.norm() / down * std::cos(a) * u + std::sin(a) * v);
  }
  return r;
}

// what of outline_ falls on the ground's own part
void GroundShadow::put(std::vector<Solids::Shade>& where, std::uint32_t rays, Solids& solids) {
  const std::size_t sides = bound_.size();
  double area = 0;
  const auto turn = [](const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); };
  for (std::size_t i = 0; i < sides; ++i) area += turn(bound_[i], bound_[(i + 1) % sides]);
  for (std::size_t i = 0; i < sides; ++i) {
    const Point& from = bound_[i];
    const Point along = bound_[(i + 1) % sides] - from;
    const auto inside = [&](const Point& p) { return turn(along, p - from) * (area > 0 ? 1 : -1); };
    cast_.swap(outline_), outline_.clear();
    for (std::size_t k = 0; k < cast_.size(); ++k) {
      const Point &a = cast_[k], &b = cast_[(k + 1) % cast_.size()];
      const double at_a = inside(a), at_b = inside(b);
      if (at_a >= 0) outline_.push_back(a);
      if ((at_a < 0) != (at_b < 0)) outline_.push_back(a + (b - a) * (at_a / (at_a - at_b)));
    }
  }
  if (outline_.size() < 3) return;
  const int begin = int(solids.points.size());
  solids.points.insert(solids.points.end(), outline_.begin(), outline_.end());
  where.push_back({begin, int(solids.points.size()), rays});
}

void GroundShadow::cast(std::span<const Vec3> corners, double radius, bool many, std::uint32_t rays,
                        bool fine, Solids& solids) {
  if (slope_ <= kLevel) return;
  // bodies under the ground cast no shadow on it
  double high = -1e300;
  seen_.clear(), heights_.clear();
  for (const Vec3& c : corners) {
    const double h = (c - ground_.point).dot(ground_.normal);
    high = std::max(high, h + radius);
    heights_.push_back(std::max(h, 0.0));
    seen_.push_back(seen_at(lens_, c));
  }
  if (high <= 0) return;

  // a sharp shadow takes one ray for all, a soft one each
  const double depth = std::max((seen_[0] + heights_[0] * rays_[kRays].down).z(), kNear);
  const double soft = 2 * (fine ? kFine : 1) * kSpread * high / (slope_ * slope_) * lens_.scale / depth;
  const int share = soft < kSharp ? kRays : soft < 4 * kSharp ? 4 : soft < 16 * kSharp || many ? 2 : 1;
  for (int i = 0; i < kRays; i += share) {
    const std::uint32_t own = share == kRays ? ~0u : ((1u << share) - 1) << i;
    if (!(own & rays)) continue;
    const Ray& ray = share == kRays ? rays_[kRays] : fine ? fine_[std::size_t(i)] : rays_[std::size_t(i)];
    cast_.clear();
    bool behind = false;
    const auto add = [&](const Vec3& place) {
      behind = behind || place.z() < kNear;
      cast_.push_back(place.head<2>() / place.z());
    };
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const Vec3 place = seen_[k] + heights_[k] * ray.down;
      if (radius <= 0) {
        add(place);
      } else {
        for (const Vec3& rim : ray.round) add(place + radius * rim);
      }
    }
    // shadows that reach behind the eye are far outside the page or all over it
    if (behind || cast_.size() < 3) continue;
    hull(cast_, outline_);
    put(solids.shades, own & rays, solids);
  }
}

void GroundShadow::touch(std::span<const Vec3> corners, double radius, double reach, bool many,
                         Solids& solids) {
  double least = 1e300;
  for (const Vec3& c : corners)
    least = std::min(least, std::max((c - ground_.point).dot(ground_.normal) - radius, 0.0));
  const int share = many ? 2 : 1;
  for (int i = 0; i < kRays && least < reach; i += share) {
    // the hull of the discs under its corners, each as much smaller as it is higher
    const double near = reach * std::pow(double(i + share) / kRays, kFall);
    cast_.clear();
    bool behind = false;
    for (const Vec3& c : corners) {
      const double high = (c - ground_.point).dot(ground_.normal);
      const double wide = near - std::max(high - radius, 0.0) + kFoot * radius;
      if (!(wide > kFoot * radius) || high < -reach) continue;
      const Vec3 foot = seen_at(lens_, c) + high * plumb_.down;
      for (const Vec3& rim : plumb_.round) {
        const Vec3 place = foot + wide * rim;
        behind = behind || place.z() < kNear;
        cast_.push_back(place.head<2>() / place.z());
      }
    }
    if (behind || cast_.size() < 3) continue;
    hull(cast_, outline_);
    put(solids.touches, ((1u << share) - 1) << i, solids);
  }
}

}  // namespace obscura::draw
