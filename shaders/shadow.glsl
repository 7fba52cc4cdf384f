// How much light reaches a surface, of a light that is a disc. A few places of the map within the widest half-shadow tell
// whether the point lies near a shadow's edge, and by how much what darkens it is nearer to the light: so wide is the half-shadow
// there. The mean of more places within that is how much light comes. A shadow is sharp where a body stands and soft where it
// flies, as on the ground (draw/space/light.cpp). Beside the point the surface itself is deeper by its slope, so that it throws
// no shadow on itself. After Fernando, "Percentage-closer soft shadows".

uniform sampler2D map;
uniform vec2 texel;                    // 1 / the map's side, and how much nearer the light a surface counts
uniform vec2 soft;                     // half-shadow a distance from the light, and the widest, all of the map

const int kFew = 4;
const vec2 kDisc[kFew] = vec2[kFew](vec2(0.0, 0.0), vec2(0.658, 0.239), vec2(-0.536, 0.450), vec2(-0.122, -0.689));
const mat2 kTurn = mat2(-0.737369, 0.675490, -0.675490, -0.737369);  // by the golden angle
const float kSharpest = 1.4;           // texels

float light_at(vec3 light, vec2 slope) {
  float nearer = 0.0, gap = 0.0;
  for (int i = 0; i < kFew; i++) {
    vec2 d = kDisc[i] * soft.y;
    float far = light.z + dot(slope, d) - texel.y - texture(map, light.xy + d).r;
    nearer += float(far > 0.0);
    gap += max(far, 0.0);
  }
  float wide = clamp(gap / max(nearer, 1.0) * soft.x, kSharpest * texel.x, soft.y);
  // a loop of no places where all of them are lit or none is: pixels are drawn together, so a branch saves nothing
  int places = nearer > 0.0 && nearer < float(kFew) ? clamp(int(2.0 * wide / texel.x), 5, 12) : 0;
  // along a spiral, so that it has no rows; a place counts for the ring that it stands for, the outer ones less
  float reached = 0.0, all = 0.0, step_out = 1.0 / float(places), r = 0.5 * step_out;
  vec2 way = vec2(wide, 0.0);
  for (int i = 0; i < places; i++) {
    vec2 d = r * way;
    float weight = r * (1.0 - 0.6 * r * r);
    reached += weight * step(light.z + dot(slope, d) - texel.y, texture(map, light.xy + d).r);
    all += weight;
    way = kTurn * way;
    r += step_out;
  }
  return places > 0 ? reached / all : 1.0 - nearer / float(kFew);
}
