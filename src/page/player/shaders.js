// The programs that draw space: how its corners lie on the page, in light and in shadow (draw/space/light.cpp).

// a place of the world: of a body, or of none; on the page and in depth
const PLACE = `#version 300 es
precision highp float;
uniform highp sampler2D poses;
uniform vec3 target, right, up, back, eye;
uniform vec4 camera, page;  // per distance, scale, middle; width, height, pixels a unit, weight
uniform vec2 depths;
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
layout(location = 4) in float least;
layout(location = 5) in vec4 own;
uniform vec4 ground;
vec3 corner(out vec3 n) {
  vec4 q = turn_of(body);
  n = turned(q, normal);
  vec3 c = at_of(body) + turned(q, center);
  float small = 1.6 * page.w * depth_of(c) / camera.y;
  float r = radius < 0.0 ? -radius / camera.y : radius;
  if (r > 0.0 && body >= 0.0) r = max(r, small);
  return c + r * n;
}
`;

const SOLID_VERTEX = `${PLACE}${CORNERS}
uniform vec4 light_u, light_v, light_w;
uniform vec2 light_size;
out vec3 world_normal, color, light;
out float contact;
flat out vec2 slope;
void main() {
  vec3 n, p = corner(n);
  gl_Position = clip_of(p);
  world_normal = n;
  color = own.rgb;
  light = vec3(dot(light_u.xyz, p) - light_u.w, dot(light_v.xyz, p) - light_v.w, dot(light_w.xyz, p) - light_w.w) / vec3(light_size.xx, light_size.y);
  float facing = max(-dot(n, light_w.xyz), 1e-3);
  slope = clamp(vec2(dot(n, light_u.xyz), dot(n, light_v.xyz)) / facing, -12.0, 12.0) * light_size.x / light_size.y;
  float high = dot(ground.xyz, p) - ground.w, reach = 0.8 * least;
  contact = least > 0.0 && high < 4.0 * reach ? 0.26 * exp(-max(high, 0.0) / reach) : 0.0;
}`;

const SOLID_FRAGMENT = `#version 300 es
precision highp float;
uniform highp sampler2DShadow map;
uniform vec3 toward, across;
uniform float dark;
in vec3 world_normal, color, light;
in float contact;
flat in vec2 slope;
out vec4 ink;
vec3 tone(float s) {
  vec3 low = dark > 0.5 ? mix(color, vec3(8, 12, 18) / 255.0, 0.72) : mix(color, vec3(24, 28, 34) / 255.0, 0.52);
  return mix(low, mix(color, vec3(1), dark > 0.5 ? 0.14 : 0.5), clamp(s, 0.0, 1.0));
}
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
  vec3 it = mix(tone(base + 0.12 * sun), tone(base + 0.58 * sun), reached / 4.0);
  ink = vec4(mix(it, vec3(12, 16, 22) / 255.0, contact), 1.0);
}`;

const CASTER_VERTEX = `${PLACE}${CORNERS}
uniform vec4 light_u, light_v, light_w;
uniform vec2 light_size;
out vec3 world_normal;
void main() {
  vec3 n, p = corner(n);
  vec3 l = vec3(dot(light_u.xyz, p) - light_u.w, dot(light_v.xyz, p) - light_v.w, dot(light_w.xyz, p) - light_w.w) / vec3(light_size.xx, light_size.y);
  gl_Position = vec4(2.0 * l - 1.0, 1.0);
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
  float a = color.a * clamp(half_wide + 0.5 - off, 0.0, 1.0) * min(1.0, 2.0 * half_wide);
  if (a <= 0.0) discard;
  ink = vec4(color.rgb * a, a);
}`;

// the same on the page's colour, for the darker or the lighter of two
const TRAIL_FRAGMENT = LINE_FRAGMENT.replace("out vec4 ink;", "uniform vec3 page_color;\nout vec4 ink;")
  .replace("ink = vec4(color.rgb * a, a);", "ink = vec4(mix(page_color, color.rgb, a), 1.0);");

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
layout(location = 5) in vec3 own;
out vec4 color;
void main() {
  vec4 q = turn_of(whose.x);
  vec3 c = at_of(whose.x), p = c + turned(q, a), r = c + turned(q, b), m = turned(q, left), n = turned(q, other);
  vec3 s = sight(p);
  bool one = dot(m, s) > 0.0, two = dot(n, s) > 0.0;
  color = vec4(own, 1.0);
  if ((!one && !two) || (one && two && dot(m, n) > 0.94)) { gl_Position = kNowhere; return; }
  float width = clamp(0.22 * whose.y * camera.y / depth_of(c), 0.5 * page.w, 2.3 * page.w) * (one && two ? 0.75 : 1.3);
  gl_Position = segment(p, r, width, width, min(0.06 * whose.y, 3.0 / camera.y));
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
  float depth = depth_of(c), small = 1.6 * page.w * depth / camera.y;
  float r = max(ball.w < 0.0 ? -ball.w / camera.y : ball.w, small), seen_r = r * camera.y / depth;
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
    const program = this.program = /** @type {WebGLProgram} */ (gl.createProgram());
    for (const [kind, text] of /** @type {[number, string][]} */ ([[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]])) {
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
    caster: new Program(gl, CASTER_VERTEX, CASTER_FRAGMENT),
    shadow: new Program(gl, SHADOW_VERTEX, SHADOW_FRAGMENT),
    cover: new Program(gl, COVER_VERTEX, COVER_FRAGMENT),
    line: new Program(gl, LINE_VERTEX, LINE_FRAGMENT),
    trail: new Program(gl, LINE_VERTEX, TRAIL_FRAGMENT),
    edge: new Program(gl, EDGE_VERTEX, LINE_FRAGMENT),
    round: new Program(gl, ROUND_VERTEX, LINE_FRAGMENT),
    side: new Program(gl, SIDE_VERTEX, LINE_FRAGMENT),
  };
}
