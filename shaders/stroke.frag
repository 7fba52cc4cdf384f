#version 330 core
#include "coverage.glsl"

// One piece of a stroke. In its body the distance to the middle line is lateral; past a round end it is radial. A piece
// that is a whole stroke has two ends, and measures from its middle.

noperspective in vec3 place;           // lateral distance, distance past the end, half width; px
noperspective in vec4 ink;             // premultiplied
flat in vec4 piece;                    // unit tangent, 1 where the end is butt, which side of the cut: -1, 1 or 0 for both
flat in vec4 cut;                      // a point of the line that halves a broken joint, and its unit normal; of a piece with
                                       // two ends (no normal) how far they are from its middle
uniform vec4 ground;                   // where darkened or lightened: what the ink is mixed with; else nothing
out vec4 color;

void main() {
  vec2 tangent = piece.xy;
  vec2 normal = vec2(-tangent.y, tangent.x);
  bool whole = piece.w == 0.0 && cut.x > 0.0;
  float end = whole ? abs(place.y) - cut.x : place.y;
  float past = piece.z > 0.5 ? 0.0 : max(end, 0.0);
  past = whole && place.y < 0.0 ? -past : past;
  vec2 away = place.x * normal + past * tangent;
  float r = length(away);
  Pixel p = pixel(r > 0.001 ? away / r : normal);
  float coverage = area(p, place.z - r) + area(p, place.z + r) - 1.0;
  coverage *= piece.z > 0.5 ? area(p, -end) : 1.0;

  // each pixel belongs to one side of a broken joint
  float across = dot(gl_FragCoord.xy - cut.xy, cut.zw);
  bool other_side = piece.w * across < 0.0 || (piece.w < 0.0 && across == 0.0);
  coverage = other_side ? 0.0 : max(coverage, 0.0);

  color = ink * coverage;
  color += ground * (1.0 - color.a);
}
