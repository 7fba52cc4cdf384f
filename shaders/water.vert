#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 at;       // (x w, y w, z w, w), px
layout(location = 1) in vec4 color_at;

out vec4 ink;

void main() {
  gl_Position = vec4(at.xy * per_half_size - at.w, at.z, at.w);
  ink = premultiplied(color_at);
}
