#version 330 core
#include "shadow.glsl"

// A surface that may lie in the shadow of another.

in vec3 lit;
in vec3 shaded;
in vec3 light;
flat in vec2 slope;
out vec4 color;

void main() { color = vec4(mix(shaded, lit, light_at(light, slope)), 1.0); }
