#version 330 core

// Pixels that lie wholly in a polygon (quadrangle.vert): their coverage is 1.

flat in vec4 fill;
out vec4 color;

void main() { color = fill; }
