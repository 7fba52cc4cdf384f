#version 330 core

// How many of the light's 32 rays do not reach a pixel.

uniform sampler2D rays;
out float dark;

void main() {
  uvec4 bits = uvec4(texelFetch(rays, ivec2(gl_FragCoord.xy), 0) * 255.0 + 0.5);
  uint x = bits.r | bits.g << 8 | bits.b << 16 | bits.a << 24;
  x -= (x >> 1) & 0x55555555u;
  x = (x & 0x33333333u) + ((x >> 2) & 0x33333333u);
  x = (x + (x >> 4)) & 0x0F0F0F0Fu;
  x = (x * 0x01010101u) >> 24;
  dark = float(x) / 32.0;
}
