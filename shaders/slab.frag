#version 330 core
#include "coverage.glsl"

// A box (box.frag) of any extents.

flat in vec4 box;                      // centre, half extents
flat in vec4 turned;                   // x axis, outline width
flat in vec4 fill;
flat in vec4 outline;
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
}
