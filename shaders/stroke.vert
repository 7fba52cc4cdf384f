#version 330 core
#include "page.glsl"

layout(location = 0) in vec2 at;       // px
layout(location = 1) in vec3 place_at;
layout(location = 2) in vec4 color_at;
layout(location = 3) in vec4 piece_at;
layout(location = 4) in vec4 cut_at;

noperspective out vec3 place;
noperspective out vec4 ink;
flat out vec4 piece;
flat out vec4 cut;

void main() {
  gl_Position = on_page(at);
  place = place_at;
  ink = premultiplied(color_at);
  piece = piece_at;
  cut = cut_at;
}
