#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 place;    // centre, half extents; px
layout(location = 1) in vec4 frame;    // x axis, outline width
layout(location = 2) in vec4 fill_color;
layout(location = 3) in vec4 outline_color;

flat out vec4 box;
flat out vec4 turned;
flat out vec4 fill;
flat out vec4 outline;

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec2 local = corner * (place.zw + 0.75);
  gl_Position = on_page(place.xy + local.x * frame.xy + local.y * vec2(-frame.y, frame.x));
  box = place;
  turned = frame;
  fill = premultiplied(fill_color);
  outline = premultiplied(outline_color);
}
