#version 330 core

// Discs of few pixels: their area within a pixel is summed over its columns, each of which a disc cuts in a chord.

flat in vec4 disc;                     // centre, outer radius, inner radius
flat in vec4 fill;
flat in vec4 outline;
out vec4 color;

const int kColumns = 8;

float chords(vec2 d, float radius) {
  float sum = 0.0;
  for (int i = 0; i < kColumns; ++i) {
    float x = d.x + (float(i) + 0.5) / float(kColumns) - 0.5;
    float half_chord = sqrt(max(radius * radius - x * x, 0.0));
    sum += max(min(half_chord, d.y + 0.5) - max(-half_chord, d.y - 0.5), 0.0);
  }
  return sum / float(kColumns);
}

void main() {
  vec2 d = gl_FragCoord.xy - disc.xy;
  float outer = chords(d, disc.z);
  float inner = chords(d, disc.w);
  color = outline * (outer - inner) + fill * inner;
}
