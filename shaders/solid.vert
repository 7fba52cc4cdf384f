#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 at;       // (x w, y w, z w, w), px
layout(location = 1) in vec4 lit_color;
layout(location = 2) in vec4 shaded_color;
layout(location = 3) in vec3 light_at;
layout(location = 4) in vec2 slope_at;
layout(location = 5) in vec4 grain_at;

out vec3 lit;
out vec3 shaded;
out vec3 light;
flat out vec2 slope;
out vec4 grain;

void main() {
  gl_Position = vec4(at.xy * per_half_size - at.w, at.z, at.w);
  lit = lit_color.rgb;
  shaded = shaded_color.rgb;
  light = light_at;
  slope = slope_at;
  grain = grain_at;
}
