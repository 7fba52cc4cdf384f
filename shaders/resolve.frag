#version 330 core

// The mean of a pixel's four samples, over the picture.

uniform sampler2DMS samples;
out vec4 color;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  color = 0.25 * (texelFetch(samples, at, 0) + texelFetch(samples, at, 1) + texelFetch(samples, at, 2) +
                  texelFetch(samples, at, 3));
}
