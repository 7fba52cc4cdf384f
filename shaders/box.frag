#version 330 core
#include "coverage.glsl"

// A box is where two slabs cross, and its coverage is the product of theirs. Its four edges' normals are equal
// but for quarter turns, so that one Pixel serves all. Here the fill is wider than a pixel's diagonal, so that a pixel
// meets one edge of a slab at most; slab.frag draws the others.

flat in vec4 box;                      // centre, half extents
flat in vec4 turned;                   // x axis, outline width
flat in vec4 fill;
flat in vec4 outline;
out vec4 color;

float within(Pixel p, vec2 depth) { return area(p, depth.x) * area(p, depth.y); }

void main() {
  vec2 d = gl_FragCoord.xy - box.xy;
  vec2 local = abs(vec2(dot(d, turned.xy), dot(d, vec2(-turned.y, turned.x))));
  Pixel p = pixel(turned.xy);
  vec2 depth = box.zw - local;
  float outer = within(p, depth);
  float inner = within(p, depth - turned.z);
  color = outline * outer + (fill - outline) * inner;
}
