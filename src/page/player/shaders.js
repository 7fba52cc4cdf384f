// The programs that draw space: how its corners lie on the page, in light and in shadow (draw/space/light.cpp).

// a place of the world: of a body, or of none; on the page and in depth
const PLACE = `#version 300 es
precision highp float;
uniform highp sampler2D poses;
uniform vec3 target, right, up, back, eye;
uniform vec4 camera, page;  // per distance, scale, middle; width, height, pixels a unit, weight
uniform vec2 depths;
const int METAL = 1, WOOD = 2, CHECKS = 3;
vec3 turned(vec4 q, vec3 v) { vec3 t = 2.0 * cross(q.yzw, v); return v + q.x * t + cross(q.yzw, t); }
vec4 turn_of(float body) { return body < 0.0 ? vec4(1, 0, 0, 0) : texelFetch(poses, ivec2(1, int(body)), 0); }
vec3 at_of(float body) { return body < 0.0 ? vec3(0) : texelFetch(poses, ivec2(0, int(body)), 0).xyz; }
float depth_of(vec3 p) { return 1.0 - camera.x * dot(p - target, back); }
vec3 sight(vec3 p) { return camera.x > 1e-9 ? normalize(eye - p) : back; }
// (x w, y w, w) in page units
vec3 seen(vec3 p) {
  vec3 q = p - target;
  float w = depth_of(p);
  return vec3(camera.z * w + camera.y * dot(q, right), camera.w * w - camera.y * dot(q, up), w);
}
float z_of(vec3 p, float w) {
  if (camera.x > 1e-9) return ((depths.y + depths.x) * w - 2.0 * depths.x * depths.y) / (depths.y - depths.x);
  return -1.0 + 2.0 * (-dot(p - target, back) - depths.x) / (depths.y - depths.x);
}
// a radius in m; negative ones are in page units, and none is too small to see
float radius_at(float radius, float depth) {
  return max(radius < 0.0 ? -radius / camera.y : radius, 1.6 * page.w * depth / camera.y);
}
vec4 clip_of(vec3 p) {
  vec3 s = seen(p);
  return vec4(2.0 * s.x / page.x - s.z, s.z - 2.0 * s.y / page.y, z_of(p, s.z), s.z);
}
`;

const CORNERS = `
layout(location = 0) in vec3 center;
layout(location = 1) in vec3 normal;
layout(location = 2) in float radius;
layout(location = 3) in float body;
layout(location = 4) in float piece;  // from 1 on; 0: none
layout(location = 5) in vec4 own;
uniform vec4 ground;
vec3 corner(out vec3 n) {
  vec4 q = turn_of(body);
  n = turned(q, normal);
  vec3 c = at_of(body) + turned(q, center);
  return c + (radius != 0.0 && body >= 0.0 ? radius_at(radius, depth_of(c)) : radius) * n;
}
`;

// a place as the light sees it: 0 to 1 over what it sees, the third away from it
const LIGHT = `
uniform vec4 light_u, light_v, light_w;
uniform vec2 light_size;
vec3 light_at(vec3 p) {
  vec3 at = vec3(dot(light_u.xyz, p) - light_u.w, dot(light_v.xyz, p) - light_v.w, dot(light_w.xyz, p) - light_w.w);
  return at / vec3(light_size.xx, light_size.y);
}
`;

// pieces of bodies, six texels each, and their planes; what is near them (occlusion.js)
const OF_PIECES = `
uniform highp sampler2D pieces, near;
vec4 of_pieces(int i) { return texelFetch(pieces, ivec2(i & 1023, i >> 10), 0); }
vec4 of_near(int i) { return texelFetch(near, ivec2(i & 1023, i >> 10), 0); }
`;

const SOLID_VERTEX = `${PLACE}${CORNERS}${LIGHT}${OF_PIECES}
out vec3 place, world_normal, color, light;
flat out float rounded;
flat out vec2 slope;
flat out int number, material;
out vec3 grain;
invariant gl_Position;
void main() {
  vec3 n, p = corner(n);
  gl_Position = clip_of(p);
  place = p;
  world_normal = n;
  number = int(piece) - 1;
  material = 0;
  grain = vec3(0);
  if (number >= 0) {
    vec4 its = of_pieces(6 * number + 2);
    material = int(its.z);
    // a little below the surface, so that no face is on the edge of a cell
    vec3 below = center + (radius - 0.02 * its.w) * normal;
    for (int i = 0; i < 3; ++i) grain[i] = dot(of_pieces(6 * number + 3 + i).xyz, below);
    // no two boards are cut from one place of the tree
    if (material == WOOD) grain += fract(0.618034 * body) * vec3(11, 1.5, 2.5);
  }
  color = own.rgb, rounded = own.a;
  light = light_at(p);
  float facing = max(-dot(n, light_w.xyz), 1e-3);
  slope = clamp(vec2(dot(n, light_u.xyz), dot(n, light_v.xyz)) / facing, -12.0, 12.0) * light_size.x / light_size.y;
}`;

// how dark a place is by the bodies near it (draw/space/occlusion.cpp)
const DARKNESS = `
const int BOX = 2;
uniform vec4 ground;
// a piece in its body's frame: what it is, and where
struct Piece { vec4 one, two; int first, count; };
float distance_to(Piece piece, vec3 p) {
  int kind = int(piece.two.w);
  if (kind == BOX) {
    vec3 q = abs(p - piece.one.xyz) - piece.two.xyz;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
  }
  if (kind < BOX) {
    vec3 way = piece.two.xyz - piece.one.xyz, off = p - piece.one.xyz;
    float l = dot(way, way);
    return length(off - (l > 0.0 ? clamp(dot(off, way) / l, 0.0, 1.0) : 0.0) * way) - piece.one.w;
  }
  // the farthest of its planes, and beyond the edge with the one that is farthest across it
  float most = -1e30, across = 0.0;
  vec3 normal;
  for (int i = piece.first; i < piece.first + piece.count; ++i) {
    vec4 plane = of_pieces(i);
    float d = dot(plane.xyz, p) - plane.w;
    if (d > most) { most = d; normal = plane.xyz; }
  }
  if (most <= 0.0) return most;
  for (int i = piece.first; i < piece.first + piece.count; ++i) {
    vec4 plane = of_pieces(i);
    float cosine = dot(plane.xyz, normal), sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    if (sine >= 0.05) across = max(across, (dot(plane.xyz, p) - plane.w - most * cosine) / sine);
  }
  return sqrt(most * most + across * across);
}
float near_part(float high, float reach) {
  float g = clamp(1.0 - high / reach, 0.0, 1.0);
  return g * g;
}
float darkness(int own, vec3 p, vec3 n) {
  if (own < 0) return 0.0;
  vec4 list = of_near(2 * own + 1);
  float light = 1.0;
  for (int i = int(list.x); i < int(list.x + list.y); ++i) {
    vec4 entry = of_near(i);
    int other = int(entry.x);
    float reach = entry.y;
    // what leaves the far height free leaves the near one free
    float g;
    if (other < 0) {
      float high = dot(ground.xyz, p) - ground.w, rise = dot(ground.xyz, n);
      g = near_part(high + reach * rise, reach) + near_part(high + reach / 3.0 * rise, reach / 3.0);
    } else {
      vec4 ball = of_near(2 * other);
      vec3 off = p - ball.xyz;
      float far = ball.w + 2.0 * reach;
      if (dot(off, off) > far * far) continue;
      float body = of_near(2 * other + 1).w;
      vec4 q = turn_of(body), planes = of_pieces(6 * other + 2);
      q.yzw = -q.yzw;
      vec3 local = turned(q, p - at_of(body)), out_to = turned(q, n);
      Piece piece = Piece(of_pieces(6 * other), of_pieces(6 * other + 1), int(planes.x), int(planes.y));
      float high = distance_to(piece, local + reach * out_to);
      if (high >= reach) continue;
      g = near_part(high, reach) + near_part(distance_to(piece, local + reach / 3.0 * out_to), reach / 3.0);
    }
    light *= 1.0 - 0.25 * g;
  }
  return 1.0 - light;
}
`;

// the patterns of materials (shaders/material.glsl), and metal (draw/space/light.cpp)
const MATERIALS = `
float wood(vec3 p) {
  float r = 2.1 * length(p.yz + vec2(0.4, 3.7)) + 0.16 * sin(0.31 * p.x + 0.7 * p.y) + 0.05 * sin(1.1 * p.x + 2.3);
  float t = fract(r), late = smoothstep(0.15, 0.85, t) * (1.0 - smoothstep(0.86, 1.0, t));
  return 1.0 - 0.085 * mix(0.42, late, clamp(2.2 - 8.4 * length(fwidth(p.yz)), 0.0, 1.0));
}
float checks(vec3 p) {
  vec3 w = max(fwidth(p), 1e-4);
  vec3 i = 2.0 * (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * 0.5) - 0.5)) / w;
  return 0.78 + 0.22 * clamp(i.x, -1.0, 1.0) * clamp(i.y, -1.0, 1.0) * clamp(i.z, -1.0, 1.0);
}
vec3 shine(vec3 n, vec3 s, float sun, bool lit) {
  vec3 back = 2.0 * dot(n, s) * n - s;
  float sky = 0.16 + 0.5 * smoothstep(-0.35, 0.1, back.y) - 0.26 * smoothstep(0.1, 0.95, back.y);
  float spot = pow(max(dot(back, toward), 0.0), 28.0);
  vec3 tint = mix(color, vec3(169, 176, 184) / 255.0, 0.25);
  bool screen = dark > 0.5;
  vec3 low = mix(tint, darkest(), screen ? 0.72 : 0.6), high = mix(tint, vec3(1), screen ? 0.3 : 0.48);
  return mix(mix(low, high, clamp(sky + (lit ? 0.42 : 0.08) * sun, 0.0, 1.0)), vec3(1), lit ? 0.75 * spot : 0.0);
}
`;

const SOLID_FRAGMENT = `${PLACE}${OF_PIECES}${DARKNESS}
uniform highp sampler2DShadow map;
uniform vec3 toward, across;
uniform float dark;
in vec3 place, world_normal, color, light, grain;
flat in float rounded;
flat in vec2 slope;
flat in int number, material;
out vec4 ink;
vec3 darkest() { return (dark > 0.5 ? vec3(8, 12, 18) : vec3(24, 28, 34)) / 255.0; }
vec3 tone(float s) {
  bool screen = dark > 0.5;
  float most = max(max(color.r, color.g), max(color.b, 1.0 / 255.0)), own = screen ? 0.72 : 0.67;
  vec3 deep = (screen ? 0.36 : 0.44) * color * sqrt(color / most);
  vec3 low = mix(deep, darkest(), screen ? 0.1 : 0.08);
  return s < own ? mix(low, color, max(s, 0.0) / own)
                 : mix(color, vec3(1), (screen ? 0.26 : 0.3) * (min(s, 1.0) - own) / (1.0 - own));
}
${MATERIALS}
void main() {
  vec3 n = normalize(world_normal);
  float sun = max(0.0, dot(n, toward));
  float base = 0.15 + 0.13 * (1.0 + n.y) / 2.0 + 0.26 * (1.0 + dot(n, across)) / 2.0;
  float reached = 0.0;
  for (int i = -1; i <= 1; i += 2)
    for (int j = -1; j <= 1; j += 2) {
      vec2 d = vec2(i, j) * (1.1 / 2048.0);
      reached += texture(map, vec3(light.xy + d, light.z + dot(slope, d) - 0.0025));
    }
  vec3 shaded, lit;
  if (material == METAL) {
    vec3 s = sight(place);
    shaded = shine(n, s, sun, false), lit = shine(n, s, sun, true);
  } else {
    // what is round (draw/space/light.cpp: shade_round)
    vec3 s = sight(place);
    base += rounded * (dark > 0.5 ? 0.8 : 0.55) * (1.0 - 0.6 * sun) * (dot(n, s) - 0.4);
    shaded = tone(base + (dark > 0.5 ? -0.12 : 0.06) * sun), lit = tone(base + 0.58 * sun);
    lit = mix(lit, vec3(1), rounded * 0.4 * pow(max(dot(n, normalize(toward + s)), 0.0), 36.0));
  }
  vec3 it = mix(mix(shaded, lit, reached / 4.0), vec3(12, 16, 22) / 255.0, darkness(number, place, n));
  // both are worked out for every pixel of a quad, as their widths need
  float w = wood(grain), c = checks(grain);
  ink = vec4(it * (material == WOOD ? w : material == CHECKS ? c : 1.0), 1.0);
}`;

// depths alone, so that only what is seen is lit
const DEPTH_FRAGMENT = `#version 300 es
void main() {}`;

const CASTER_VERTEX = `${PLACE}${CORNERS}${LIGHT}
out vec3 world_normal;
void main() {
  vec3 n, p = corner(n);
  gl_Position = vec4(2.0 * light_at(p) - 1.0, 1.0);
  world_normal = n;
}`;

const CASTER_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 toward;
in vec3 world_normal;
void main() { if (dot(world_normal, toward) > 0.0) discard; }`;

// a shadow of one ray on the ground
const SHADOW_VERTEX = `${PLACE}${CORNERS}
uniform vec3 ray;
uniform vec4 part;  // how dark, how near, and by how much it is shifted
void main() {
  vec3 n, p = corner(n);
  float high = max(dot(ground.xyz, p) - ground.w, 0.0);
  vec4 at = clip_of(p - ray * (high / dot(ray, ground.xyz)));
  gl_Position = vec4(at.xy + part.zw * at.w, part.y * at.w, at.w);
}`;

const SHADOW_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 part;
out vec4 ink;
void main() { ink = vec4(part.x); }`;

const COVER_VERTEX = `#version 300 es
out vec2 place;
void main() {
  place = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
}`;

const COVER_FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D shade;
uniform vec4 ink;
in vec2 place;
out vec4 color;
void main() {
  float a = ink.a * min(texture(shade, place).r, 1.0);
  color = vec4(ink.rgb * a, a);
}`;

// a line between two places, as wide as it is in page units, nearer to the eye by a little than what it lies on
const SEGMENT = `
out vec2 place;  // px, from the first end along the line
flat out float along, wide_a, wide_b;
const vec4 kNowhere = vec4(2, 2, 2, 1);
vec4 segment(vec3 a, vec3 b, float wa, float wb, float near) {
  float da = depth_of(a), db = depth_of(b);
  if (da < 0.02 || db < 0.02) return kNowhere;
  vec3 sa = seen(a), sb = seen(b);
  vec2 p = sa.xy / sa.z * page.z, q = sb.xy / sb.z * page.z;
  float l = length(q - p);
  vec2 u = l > 1e-4 ? (q - p) / l : vec2(1, 0), v = vec2(-u.y, u.x);
  bool end = (gl_VertexID & 2) != 0;
  float half_wide = 0.5 * (end ? wb : wa) * page.z, reach = half_wide + 1.0;
  float side = (gl_VertexID & 1) != 0 ? 1.0 : -1.0;
  vec2 at = (end ? q + u * reach : p - u * reach) + side * reach * v;
  place = vec2(end ? l + reach : -reach, side * reach);
  along = l;
  wide_a = 0.5 * wa * page.z;
  wide_b = 0.5 * wb * page.z;
  vec3 w = end ? b : a;
  w += near * sight(w);
  float depth = depth_of(w);
  float z = camera.x > 1e-9 ? z_of(w, depth) / depth : z_of(w, 1.0);
  return vec4(2.0 * at.x / (page.x * page.z) - 1.0, 1.0 - 2.0 * at.y / (page.y * page.z), z, 1.0);
}
`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
in vec2 place;
flat in float along, wide_a, wide_b;
in vec4 color;
out vec4 ink;
void main() {
  float t = along > 0.0 ? clamp(place.x / along, 0.0, 1.0) : 0.0;
  float off = length(vec2(place.x - clamp(place.x, 0.0, along), place.y)), half_wide = mix(wide_a, wide_b, t);
  // how much of the pixel lies between both sides
  float a = color.a * (clamp(half_wide + 0.5 - off, 0.0, 1.0) + clamp(half_wide + 0.5 + off, 0.0, 1.0) - 1.0);
  if (a <= 0.0) discard;
  ink = vec4(color.rgb * a, a);
}`;

const LINE_VERTEX = `${PLACE}${SEGMENT}
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
layout(location = 2) in vec2 width;
layout(location = 3) in vec4 color_a;
layout(location = 4) in vec4 color_b;
out vec4 color;
void main() {
  color = (gl_VertexID & 2) != 0 ? color_b : color_a;
  gl_Position = segment(a, b, width.x, width.y, 1.0 / camera.y);
}`;

const EDGE_VERTEX = `${PLACE}${SEGMENT}
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
layout(location = 2) in vec3 left;
layout(location = 3) in vec3 other;
layout(location = 4) in vec2 whose;  // body, half its thickness
layout(location = 5) in vec3 outline;
layout(location = 6) in vec3 crease;
out vec4 color;
void main() {
  vec4 q = turn_of(whose.x);
  vec3 c = at_of(whose.x), p = c + turned(q, a), r = c + turned(q, b), m = turned(q, left), n = turned(q, other);
  vec3 s = sight(p);
  bool one = dot(m, s) > 0.0, two = dot(n, s) > 0.0;
  float part = one && two ? min(1.0, min(dot(m, s), dot(n, s)) / 0.1) : 0.0;
  color = vec4(mix(outline, crease, part), 1.0);
  if ((!one && !two) || (one && two && dot(m, n) > 0.92)) { gl_Position = kNowhere; return; }
  float width = clamp(0.22 * whose.y * camera.y / depth_of(c), 0.5 * page.w, 2.3 * page.w) * mix(1.3, 0.75, part);
  // before the faces beside it, up to where the line ends
  float half_wide = 0.5 * width * depth_of(c) / camera.y, steep = 0.0;
  if (one) steep = sqrt(1.0 - pow(dot(m, s), 2.0)) / dot(m, s);
  if (two) steep = max(steep, sqrt(1.0 - pow(dot(n, s), 2.0)) / dot(n, s));
  float near = max(min(0.06 * whose.y, 3.0 / camera.y), min(1.2 * half_wide * steep, 0.4 * whose.y));
  gl_Position = segment(p, r, width, width, near);
}`;

// the outline of a ball: 64 pieces of the circle that the eye sees, as a strip
const ROUND_VERTEX = `${PLACE}
layout(location = 0) in vec4 ball;  // centre, radius
layout(location = 1) in float body;
layout(location = 2) in vec3 own;
layout(location = 3) in vec3 other;  // of a capsule: towards its other end
out vec2 place;
flat out float along, wide_a, wide_b;
out vec4 color;
void main() {
  vec4 q = turn_of(body);
  vec3 c = at_of(body) + turned(q, ball.xyz);
  float depth = depth_of(c), r = radius_at(ball.w, depth), seen_r = r * camera.y / depth;
  color = vec4(own, 1.0);
  along = 0.0;
  float width = 1.3 * clamp(0.22 * seen_r, 0.5 * page.w, 2.3 * page.w), half_wide = 0.5 * width * page.z;
  wide_a = wide_b = half_wide;
  if (seen_r < 2.2 || depth < 0.02) { place = vec2(0); gl_Position = vec4(2, 2, 2, 1); return; }
  // the line lies inside the rim
  float rim = r * (1.0 - 0.25 * width / seen_r);
  vec3 s = sight(c), u = normalize(cross(abs(s.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0), s)), v = cross(s, u);
  float d = camera.x > 1e-9 ? length(eye - c) : 1e9, cosine = min(rim / d, 1.0);
  float turn = 6.283185307 * float(gl_VertexID / 2) / 64.0, side = (gl_VertexID & 1) != 0 ? 1.0 : -1.0;
  vec3 out_to = cos(turn) * u + sin(turn) * v;
  if (dot(out_to, turned(q, other)) > 1e-6) color.a = 0.0;
  vec3 p = c + rim * (cosine * s + sqrt(1.0 - cosine * cosine) * out_to);
  vec3 at = seen(p), middle = seen(c);
  vec2 out_of = normalize(at.xy / at.z - middle.xy / middle.z);
  float reach = half_wide + 1.0;
  vec2 px = at.xy / at.z * page.z + side * reach * out_of;
  place = vec2(0.0, side * reach);
  // the ball bulges before the line's inner half
  vec3 w = p + (sqrt(seen_r * width) + 1.0) * depth / camera.y * s;
  float dw = depth_of(w), z = camera.x > 1e-9 ? z_of(w, dw) / dw : z_of(w, 1.0);
  gl_Position = vec4(2.0 * px.x / (page.x * page.z) - 1.0, 1.0 - 2.0 * px.y / (page.y * page.z), z, 1.0);
}`;

// a side of a capsule's outline
const SIDE_VERTEX = `${PLACE}${SEGMENT}
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
layout(location = 2) in vec3 form;  // radius, side, body
layout(location = 3) in vec3 own;
out vec4 color;
void main() {
  vec4 q = turn_of(form.z);
  vec3 p = at_of(form.z) + turned(q, a), r = at_of(form.z) + turned(q, b), across = cross(r - p, sight(0.5 * (p + r)));
  float depth = depth_of(p), seen_r = form.x * camera.y / depth;
  color = vec4(own, 1.0);
  if (seen_r < 2.2 || dot(across, across) < 1e-16) { gl_Position = kNowhere; return; }
  float width = 1.3 * clamp(0.22 * seen_r, 0.5 * page.w, 2.3 * page.w);
  vec3 by = form.y * form.x * (1.0 - 0.25 * width / seen_r) * normalize(across);
  gl_Position = segment(p + by, r + by, width, width, (sqrt(seen_r * width) + 1.0) * depth / camera.y);
}`;

export class Program {
  /**
   * @param {WebGL2RenderingContext} gl
   * @param {string} vertex
   * @param {string} fragment
   */
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    const program = (this.program = /** @type {WebGLProgram} */ (gl.createProgram()));
    for (const [kind, text] of /** @type {[number, string][]} */ ([
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ])) {
      const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const logs = (gl.getAttachedShaders(program) ?? []).map((each) => gl.getShaderInfoLog(each)).join("\n");
      throw new Error(`a shader does not compile: ${gl.getProgramInfoLog(program)}\n${logs}`);
    }
    /** @type {Map<string, WebGLUniformLocation | null>} */
    this.places = new Map();
  }

  place(name) {
    if (!this.places.has(name)) this.places.set(name, this.gl.getUniformLocation(this.program, name));
    return this.places.get(name) ?? null;
  }

  use() {
    this.gl.useProgram(this.program);
    return this;
  }

  vec(name, v) {
    const at = this.place(name);
    if (v.length === 2) this.gl.uniform2fv(at, v);
    else if (v.length === 3) this.gl.uniform3fv(at, v);
    else this.gl.uniform4fv(at, v);
    return this;
  }

  number(name, x) {
    this.gl.uniform1f(this.place(name), x);
    return this;
  }

  whole(name, i) {
    this.gl.uniform1i(this.place(name), i);
    return this;
  }
}

/** @param {WebGL2RenderingContext} gl */
export function make_programs(gl) {
  return {
    solid: new Program(gl, SOLID_VERTEX, SOLID_FRAGMENT),
    depth: new Program(gl, SOLID_VERTEX, DEPTH_FRAGMENT),
    caster: new Program(gl, CASTER_VERTEX, CASTER_FRAGMENT),
    shadow: new Program(gl, SHADOW_VERTEX, SHADOW_FRAGMENT),
    cover: new Program(gl, COVER_VERTEX, COVER_FRAGMENT),
    line: new Program(gl, LINE_VERTEX, LINE_FRAGMENT),
    edge: new Program(gl, EDGE_VERTEX, LINE_FRAGMENT),
    round: new Program(gl, ROUND_VERTEX, LINE_FRAGMENT),
    side: new Program(gl, SIDE_VERTEX, LINE_FRAGMENT),
  };
}
