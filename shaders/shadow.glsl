// How much light reaches a surface. Where the map's surface is nearer to the light than this one, it is dark. The mean of
// four places, each of four texels, makes a soft edge; beside the point the surface itself is deeper by its slope, so that
// it throws no shadow on itself.

uniform sampler2DShadow map;
uniform vec2 texel;                    // 1 / the map's side, and how much nearer the light a surface counts

float light_at(vec3 light, vec2 slope) {
  float reached = 0.0;
  for (int i = -1; i <= 1; i += 2) {
    for (int j = -1; j <= 1; j += 2) {
      vec2 d = vec2(i, j) * (1.1 * texel.x);
      reached += texture(map, vec3(light.xy + d, light.z + dot(slope, d) - texel.y));
    }
  }
  return reached / 4.0;
}
