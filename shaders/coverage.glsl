// How much of a pixel (the unit square about its centre) lies on the inner side of a straight edge.
//   s     distance of the pixel's centre to the edge, inside positive, px
//   n     the edge's unit normal, a the larger of |n.x| and |n.y|, b the smaller
//   h, g  (a + b) / 2, (a - b) / 2
// The length of the pixel's cut parallel to the edge is a trapezoid in s: 1/a for |s| < g, falling to 0 at |s| = h.
// Its integral is the area: 1/2 + s/a - sign(s) max(|s| - g, 0)^2 / (2ab) for |s| < h.
struct Pixel {
  float h, g, per_a, per_2ab;
};

Pixel pixel(vec2 n) {
  vec2 m = abs(n);
  float a = max(max(m.x, m.y), 0.70711);
  float b = max(min(m.x, m.y), 0.001);
  float per_a = 1.0 / a;
  return Pixel(0.5 * (a + b), 0.5 * (a - b), per_a, 0.5 * per_a / b);
}

float area(Pixel p, float s) {
  float x = clamp(s, -p.h, p.h);
  float over = max(abs(x) - p.g, 0.0);
  return 0.5 + x * p.per_a - sign(x) * over * over * p.per_2ab;
}
