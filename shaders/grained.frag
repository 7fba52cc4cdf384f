#version 330 core
#include "marks.glsl"
#include "material.glsl"

// A surface of wood or checks that nothing throws a shadow on.

in vec3 lit;
in vec4 grain;
out vec4 color;

void main() { color = vec4(lit * tone(grain), 1.0); }
