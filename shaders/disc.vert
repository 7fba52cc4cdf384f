#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 place;    // centre, outer radius, inner radius; px
layout(location = 1) in vec4 fill_color;
layout(location = 2) in vec4 outline_color;

flat out vec4 disc;
flat out vec4 fill;
flat out vec4 outline;

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  gl_Position = on_page(place.xy + corner * (place.z + 0.75));
  disc = place;
  fill = premultiplied(fill_color);
  outline = premultiplied(outline_color);
}
