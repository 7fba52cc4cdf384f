// How much of a pixel (the unit square about its centre) lies on the inner side of a straight edge.
//   s     distance of the pixel's centre to the edge, inside positive, px
//   n     the edge's unit normal, a the larger of |n.x| and |n.y|, b the smaller
//   h, g  (a + b) / 2, (a - b) / 2
// The length of the pixel's cut parallel to the edge is a trapezoid in s: 1/a for |s| < g, falling to 0 at |s| = h.
// Its integral is the area: b/2a u^2 along the slope, u from 0 to 1, then 2g/a below the top, then the slope mirrored.
struct Pixel {
  float h, g, per_b, per_2g;
  float slope, top;                    // areas below a slope and below the top
};

Pixel pixel(vec2 n) {
  vec2 m = abs(n);
  float a = max(max(m.x, m.y), 0.70711);
  float b = max(min(m.x, m.y), 0.001);
  float h = 0.5 * (a + b), g = 0.5 * (a - b);
  return Pixel(h, g, 1.0 / b, 1.0 / max(2.0 * g, 0.001), 0.5 * b / a, 2.0 * g / a);
}

// A clamp to [0, 1] is two instructions, any other a dozen.
float area(Pixel p, float s) {
  float rising = clamp((s + p.h) * p.per_b, 0.0, 1.0);
  float falling = clamp((s - p.g) * p.per_b, 0.0, 1.0);
  float along = clamp(s * p.per_2g + 0.5, 0.0, 1.0);
  return p.slope * (rising * rising + falling * (2.0 - falling)) + p.top * along;
}
