#version 330 core
#include "marks.glsl"

// Surfaces, some with marks, that nothing throws a shadow on.

in vec3 lit;
in vec4 grain;
out vec4 color;

void main() {
  float m = marks(grain.xyz);
  color = vec4(lit * (grain.w > 2.5 ? m : 1.0), 1.0);
}
