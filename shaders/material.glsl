// The pattern of a material: how much of its colour a place has. `grain` is the place in units of half the body's
// thickness (of wood: the mean of its two lesser ones), its first axis along the longest side; the fourth says which material.
//   1 wood: rings around a line beside the body, a little wavy; their late wood is a little darker
//   2 checks: cells of one unit, by turns dark; each axis a square wave averaged over the pixel (Quilez, filtered checks)
//   3 marks, see there

float wood(vec3 p) {
  float r = 2.1 * length(p.yz + vec2(0.4, 3.7)) + 0.16 * sin(0.31 * p.x + 0.7 * p.y) + 0.05 * sin(1.1 * p.x + 2.3);
  float t = fract(r);
  float late = smoothstep(0.15, 0.85, t) * (1.0 - smoothstep(0.86, 1.0, t));
  // rings that are too fine for the picture fade, also where a face only touches one of them
  float fine = clamp(2.2 - 8.4 * length(fwidth(p.yz)), 0.0, 1.0);
  return 1.0 - 0.085 * mix(0.42, late, fine);
}

float checks(vec3 p) {
  vec3 w = max(fwidth(p), 1e-4);
  vec3 i = 2.0 * (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * 0.5) - 0.5)) / w;
  return 0.78 + 0.22 * clamp(i.x, -1.0, 1.0) * clamp(i.y, -1.0, 1.0) * clamp(i.z, -1.0, 1.0);
}

// all are worked out for every pixel of a quad, as their widths need
float tone(vec4 grain) {
  float w = wood(grain.xyz), c = checks(grain.xyz), m = marks(grain.xyz);
  return grain.w > 2.5 ? m : grain.w > 1.5 ? c : grain.w > 0.5 ? w : 1.0;
}
