#version 330 core
#include "green.glsl"

// A polygon of four corners, as the heads of arrows are: without its edges in a buffer it takes half the time.

flat in vec4 first, second;            // two corners each, px
flat in vec4 fill;
out vec4 color;

void main() {
  vec4 low = gl_FragCoord.xyxy - 0.5;
  float sum = beside(first - low);
  sum += beside(vec4(first.zw, second.xy) - low);
  sum += beside(second - low);
  sum += beside(vec4(second.zw, first.xy) - low);
  color = fill * min(abs(sum), 1.0);
}
