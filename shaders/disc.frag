#version 330 core
#include "coverage.glsl"

// A rim of radius r crosses a pixel as its tangent does, but bends away by x^2 / 2r at x along it: 1 / 24r on average.

flat in vec4 disc;                     // centre, outer radius, inner radius
flat in vec4 fill;
flat in vec4 outline;
out vec4 color;

void main() {
  vec2 d = gl_FragCoord.xy - disc.xy;
  float rho = length(d);
  Pixel p = pixel(d / max(rho, 0.001));
  vec2 rim = disc.zw - 1.0 / (24.0 * max(disc.zw, 0.25));
  float outer = area(p, rim.x - rho);
  float inner = min(area(p, rim.y - rho), outer);
  color = outline * (outer - inner) + fill * inner;
}
