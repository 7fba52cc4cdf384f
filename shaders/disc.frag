#version 330 core

// A rim of radius r crosses a pixel as its tangent does, but bends away by x^2 / 2r at x along it: 1 / 24r on average.
// The area is that of coverage.glsl, all lengths times rho, so that a and b are the coordinates of the pixel.

flat in vec4 disc;                     // centre, outer radius, inner radius
flat in vec4 fill;
flat in vec4 outline;
out vec4 color;

void main() {
  vec2 d = abs(gl_FragCoord.xy - disc.xy);
  float rho = max(length(d), 0.5);
  float a = max(max(d.x, d.y), 0.5), b = max(min(d.x, d.y), 0.001);
  float h = 0.5 * (a + b), g = 0.5 * (a - b), per_ab = 1.0 / (a * b);
  vec2 rim = disc.zw - 1.0 / (24.0 * disc.zw);
  vec2 x = clamp((rim - rho) * rho, -h, h);
  vec2 m = x - clamp(x, -g, g);
  vec2 area = 0.5 + (x * b - 0.5 * m * abs(m)) * per_ab;
  color = outline * area.x + (fill - outline) * area.y;
}
