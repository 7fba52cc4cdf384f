#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 bounds;   // low corner, high corner; px
layout(location = 1) in vec4 corners;  // the first two; px
layout(location = 2) in vec4 more_corners;
layout(location = 3) in vec4 fill_color;

flat out vec4 first, second;
flat out vec4 fill;

void main() {
  gl_Position = on_page(mix(bounds.xy, bounds.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1)));
  first = corners;
  second = more_corners;
  fill = premultiplied(fill_color);
}
