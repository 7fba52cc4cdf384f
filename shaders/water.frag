#version 330 core

// The surface of a fluid, through which one sees what lies under it.

in vec4 ink;
out vec4 color;

void main() { color = ink; }
