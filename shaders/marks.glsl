// Lines that show how a round body turns: two great circles of a ball; of a capsule one along it and one around its middle.
// `grain` is the place in radii, its first axis along the longest side; on what is small they fade.

float marks(vec3 p) {
  vec2 far = abs(p.xz), w = max(fwidth(p.xz), 1e-4);
  vec2 on = clamp((0.045 - far) / w + 0.5, 0.0, 1.0);
  float large = clamp(1.8 - 16.0 * max(w.x, w.y), 0.0, 1.0);
  return 1.0 - 0.34 * large * max(on.x, on.y);
}
