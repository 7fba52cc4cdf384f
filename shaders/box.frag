#version 330 core
#include "coverage.glsl"

// A box is where two slabs cross, and its coverage is the product of theirs. Its four edges' normals are equal
// but for quarter turns, so that one Pixel serves all.

flat in vec4 box;                      // centre, half extents
flat in vec4 turned;                   // x axis, outline width, radius of the dot in the middle
flat in vec4 fill;
flat in vec4 outline;
flat in vec4 middle;
out vec4 color;

float slabs(Pixel p, vec2 local, vec2 extent) {
  return (area(p, extent.x - local.x) + area(p, extent.x + local.x) - 1.0) *
         (area(p, extent.y - local.y) + area(p, extent.y + local.y) - 1.0);
}

void main() {
  vec2 d = gl_FragCoord.xy - box.xy;
  vec2 local = abs(vec2(dot(d, turned.xy), dot(d, vec2(-turned.y, turned.x))));
  Pixel p = pixel(turned.xy);
  float outer = slabs(p, local, box.zw);
  float inner = slabs(p, local, max(box.zw - turned.z, 0.0));
  color = outline * (outer - inner) + fill * inner;
  float spot = clamp(turned.w + 0.5 - length(d), 0.0, 1.0) * inner;
  color = middle * spot + color * (1.0 - middle.a * spot);
}
