#version 330 core

// What the light sees of a body.

layout(location = 0) in vec3 at;       // 0 to 1 over the map, the third away from the light

void main() { gl_Position = vec4(at * 2.0 - 1.0, 1.0); }
