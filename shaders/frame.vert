#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 place;    // origin, length of the axes, half their width; px
layout(location = 1) in vec4 frame;    // x axis, unused, radius of the dot at the origin
layout(location = 2) in vec4 color_of;

flat out vec4 axes;
flat out vec4 turned;
flat out vec4 ink;

void main() {
  // the body's y is up where the page's is down
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec2 local = mix(vec2(-max(frame.w, place.w) - 0.75), vec2(place.z + 0.75), corner);
  gl_Position = on_page(place.xy + local.x * frame.xy - local.y * vec2(-frame.y, frame.x));
  axes = place;
  turned = frame;
  ink = premultiplied(color_of);
}
