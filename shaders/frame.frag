#version 330 core
#include "coverage.glsl"

// The frame of a box: two axes from its middle, and the dot from which they leave.

flat in vec4 axes;                     // origin, length, half width
flat in vec4 turned;                   // x axis, unused, radius of the dot
flat in vec4 ink;
out vec4 color;

float slab(Pixel p, float low, float high) { return area(p, low) + area(p, high) - 1.0; }

void main() {
  vec2 d = gl_FragCoord.xy - axes.xy;
  vec2 local = vec2(dot(d, turned.xy), dot(d, vec2(turned.y, -turned.x)));
  Pixel p = pixel(turned.xy);
  float spot = clamp(turned.w + 0.5 - length(d), 0.0, 1.0);
  float x = slab(p, local.x, axes.z - local.x) * slab(p, axes.w - local.y, axes.w + local.y);
  float y = slab(p, local.y, axes.z - local.y) * slab(p, axes.w - local.x, axes.w + local.x);
  color = ink * (1.0 - (1.0 - spot) * (1.0 - x) * (1.0 - y));
}
