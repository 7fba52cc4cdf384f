#version 330 core
#include "marks.glsl"
#include "material.glsl"
#include "shadow.glsl"

// A surface of wood or checks that may lie in the shadow of another.

in vec3 lit;
in vec3 shaded;
in vec3 light;
flat in vec2 slope;
in vec4 grain;
out vec4 color;

void main() { color = vec4(mix(shaded, lit, light_at(light, slope)) * tone(grain), 1.0); }
