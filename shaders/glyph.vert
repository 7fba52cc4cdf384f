#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 place;    // left, top, width, height; whole px
layout(location = 1) in vec2 in_atlas; // texels
layout(location = 2) in vec4 ink_color;

flat out vec2 shift;
flat out vec4 ink;

void main() {
  gl_Position = on_page(place.xy + place.zw * vec2(gl_VertexID & 1, gl_VertexID >> 1));
  shift = in_atlas - place.xy;
  ink = premultiplied(ink_color);
}
