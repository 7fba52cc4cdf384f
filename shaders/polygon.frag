#version 330 core
#include "green.glsl"

flat in ivec2 edges;                   // first, number
flat in vec4 fill;
uniform samplerBuffer lines;           // p, q of each edge, px
out vec4 color;

void main() {
  vec2 low = gl_FragCoord.xy - 0.5;
  float sum = 0.0;
  for (int i = 0; i < edges.y; ++i) sum += beside(texelFetch(lines, edges.x + i) - low.xyxy);
  color = fill * min(abs(sum), 1.0);
}
