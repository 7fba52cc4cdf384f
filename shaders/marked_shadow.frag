#version 330 core
#include "marks.glsl"
#include "shadow.glsl"

// Surfaces, some with marks, that may lie in the shadow of another.

in vec3 lit;
in vec3 shaded;
in vec3 light;
flat in vec2 slope;
in vec4 grain;
out vec4 color;

void main() {
  float m = marks(grain.xyz);
  color = vec4(mix(shaded, lit, light_at(light, slope)) * (grain.w > 2.5 ? m : 1.0), 1.0);
}
