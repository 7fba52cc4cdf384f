#version 330 core
#include "page.glsl"

layout(location = 0) in vec4 bounds;   // low corner, high corner; px
layout(location = 1) in vec2 edges_at; // first edge, number of edges
layout(location = 2) in vec4 fill_color;

flat out ivec2 edges;
flat out vec4 fill;

void main() {
  gl_Position = on_page(mix(bounds.xy, bounds.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1)));
  edges = ivec2(edges_at);
  fill = premultiplied(fill_color);
}
