#version 330 core

// A surface that may lie in the shadow of another. Where the map's surface is nearer to the light than this one, it
// is dark. The mean of four places, each of four texels, makes a soft edge; beside the point the surface itself is deeper
// by its slope, so that it throws no shadow on itself.

in vec3 lit;
in vec3 shaded;
in vec3 light;
flat in vec2 slope;
uniform sampler2DShadow map;
uniform vec2 texel;                    // 1 / the map's side, and how much nearer the light a surface counts
out vec4 color;

void main() {
  float reached = 0.0;
  for (int i = -1; i <= 1; i += 2) {
    for (int j = -1; j <= 1; j += 2) {
      vec2 d = vec2(i, j) * (1.1 * texel.x);
      reached += texture(map, vec3(light.xy + d, light.z + dot(slope, d) - texel.y));
    }
  }
  color = vec4(mix(shaded, lit, reached / 4.0), 1.0);
}
