#version 330 core
#include "page.glsl"

layout(location = 0) in vec2 at;       // px
layout(location = 1) in vec4 rays_at;  // a bit a ray

flat out vec4 rays;

void main() {
  gl_Position = on_page(at);
  rays = rays_at;
}
