#version 330 core

// One shadow: the rays that it is of are added to those of the pixel, by a logical or.

flat in vec4 rays;
out vec4 color;

void main() { color = rays; }
