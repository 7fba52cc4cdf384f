#version 330 core
#include "coverage.glsl"

// A box (box.frag) without an outline.

flat in vec4 box;                      // centre, half extents
flat in vec4 turned;                   // x axis
flat in vec4 fill;
out vec4 color;

void main() {
  vec2 d = gl_FragCoord.xy - box.xy;
  vec2 depth = box.zw - abs(vec2(dot(d, turned.xy), dot(d, vec2(-turned.y, turned.x))));
  Pixel p = pixel(turned.xy);
  color = fill * (area(p, depth.x) * area(p, depth.y));
}
