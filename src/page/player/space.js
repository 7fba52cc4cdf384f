// Space, drawn by WebGL: bodies in light and shadow, their edges where they are seen, what ties them, trails. The light and
// the widths of lines are those of draw/space; what lies in front is found pixel by pixel, not line by line.

import { draw_contacts } from "./contact.js";
import { Mesh, CORNER, helix } from "./forms.js";
import { Lens, Orbit, cross, dot, plus, sub, turned, unit } from "./lens.js";
import { make_programs } from "./shaders.js";

const RAYS = 32, MAP = 2048;
const EDGE = 2.3, TUBE = 1, BALL = 2, PLATE = 3, WAY = 4, LINE = 5;
const LEAST = 1.6;                       // page units: radius of what is too small to see
const TILE = 105, FROM = 0.35, TO = 1.25, PIECES = 28, GRID = 1.5, FRAME = 1.8;  // draw/space/ground.cpp
const END_ON = 7, NARROW = 0.3;          // of coils: draw/space/links.cpp

const clamp = (/** @type {number} */ x, /** @type {number} */ low, /** @type {number} */ high) => Math.min(Math.max(x, low), high);
const rgb = (/** @type {number[]} */ c) => c[0] << 16 | c[1] << 8 | c[2];

/** Corners of a mesh as the card has them. */
class Corners {
  constructor(gl) {
    this.gl = gl;
    this.array = gl.createVertexArray();
    this.numbers = gl.createBuffer();
    this.colors = gl.createBuffer();
    this.count = 0;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.numbers);
    [[3, 0], [3, 3], [1, 6], [1, 7], [1, 8]].forEach(([size, from], i) => {
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, size, gl.FLOAT, false, 4 * CORNER, 4 * from);
    });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colors);
    gl.enableVertexAttribArray(5);
    gl.vertexAttribPointer(5, 4, gl.UNSIGNED_BYTE, true, 0, 0);
  }

  /** @param {Mesh} mesh */
  fill(mesh) {
    const gl = this.gl, colors = new Uint8Array(4 * mesh.count);
    mesh.colors.forEach((c, i) => colors.set([c >> 16, (c >> 8) & 255, c & 255, 255], 4 * i));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.numbers);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(mesh.corners), gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colors);
    gl.bufferData(gl.ARRAY_BUFFER, colors, gl.DYNAMIC_DRAW);
    this.count = mesh.count;
  }

  draw() {
    if (this.count === 0) return;
    this.gl.bindVertexArray(this.array);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, this.count);
  }
}

/** Things drawn once each, by `sizes` numbers an attribute. */
class Instances {
  constructor(gl, sizes) {
    this.gl = gl;
    this.array = gl.createVertexArray();
    this.numbers = gl.createBuffer();
    this.stride = sizes.reduce((/** @type {number} */ a, /** @type {number} */ b) => a + b, 0);
    this.count = 0;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.numbers);
    let from = 0;
    sizes.forEach((/** @type {number} */ size, /** @type {number} */ i) => {
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, size, gl.FLOAT, false, 4 * this.stride, 4 * from);
      gl.vertexAttribDivisor(i, 1);
      from += size;
    });
  }

  /** @param {number[]} numbers */
  fill(numbers) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.numbers);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(numbers), this.gl.DYNAMIC_DRAW);
    this.count = numbers.length / this.stride;
  }

  draw(corners) {
    if (this.count === 0) return;
    this.gl.bindVertexArray(this.array);
    this.gl.drawArraysInstanced(this.gl.TRIANGLE_STRIP, 0, corners, this.count);
  }
}

export class Space {
  /**
   * @param {any} film
   * @param {import("./reel.js").Reel} reel
   */
  constructor(film, reel) {
    this.film = film;
    this.space = film.space;
    this.reel = reel;
    this.dark = film.theme === "screen";
    this.view = new Orbit(this.space.ground ? this.space.ground.normal : [0, 1, 0]);
    this.things = reel.things.filter((each) => each.space > 0);
    this.canvas = document.createElement("canvas");
    const gl = this.canvas.getContext("webgl2", { antialias: true, alpha: true, depth: true, stencil: false, premultipliedAlpha: true });
    if (!gl) throw new Error("this browser has no WebGL 2, which space is drawn with");
    this.gl = gl;
    this.programs = make_programs(gl);
    this.bodies = this.space.colors.length;
    this.poses = new Float32Array(8 * this.bodies);
    this.build();
    /** @type {Map<number, {key: string, picture: HTMLCanvasElement}>} */
    this.grids = new Map();
    /** @type {any} */
    this.shade = null;
    /** @type {((program: import("./shaders.js").Program) => void)[]} */
    this.setters = [];
  }

  build() {
    const { gl, space } = this, mesh = new Mesh(), edges = [], rounds = [], sides = [];
    const balls = space.pieces.filter((/** @type {any} */ p) => p.shape === undefined).length;
    const around = balls > 200 ? 16 : balls > 40 ? 24 : 48;
    const alone = new Map();
    for (const piece of space.pieces) alone.set(piece.body, (alone.get(piece.body) ?? 0) + 1);
    /** @type {number[]} */
    this.reaches = new Array(this.bodies).fill(0);
    for (const piece of space.pieces) {
      const own = rgb(space.colors[piece.body]), ink = space.edges[piece.body].map((/** @type {number} */ c) => c / 255);
      const least = alone.get(piece.body) === 1 ? piece.least : 0;
      let reach = 0;
      if (piece.shape !== undefined) {
        const shape = space.shapes[piece.shape];
        mesh.flat(shape, piece.body, least, own);
        const at = (/** @type {number} */ i) => shape.vertices.slice(3 * i, 3 * i + 3);
        const normal = (/** @type {number} */ f) => shape.normals.slice(3 * f, 3 * f + 3);
        for (let i = 0; i < shape.edges.length; i += 4) {
          const [a, b, left, right] = shape.edges.slice(i, i + 4);
          const n = normal(left), m = right >= 0 ? normal(right) : [-n[0], -n[1], -n[2]];
          edges.push(...at(a), ...at(b), ...n, ...m, piece.body, piece.least, ink[0], ink[1], ink[2]);
        }
        for (let i = 0; i < shape.vertices.length; i += 3) reach = Math.max(reach, Math.hypot(...at(i / 3)));
      } else {
        const radius = piece.dot ? -piece.dot : piece.radius;
        mesh.ball(piece.a, radius, piece.body, least, own, around);
        const axis = sub(piece.b, piece.a);
        rounds.push(...piece.a, radius, piece.body, ink[0], ink[1], ink[2], ...axis);
        if (Math.hypot(...axis) > 0) {
          mesh.ball(piece.b, radius, piece.body, least, own, around);
          mesh.tube([piece.a, piece.b], piece.radius, piece.body, least, own, around);
          rounds.push(...piece.b, radius, piece.body, ink[0], ink[1], ink[2], -axis[0], -axis[1], -axis[2]);
          for (const side of [-1, 1]) sides.push(...piece.a, ...piece.b, piece.radius, side, piece.body, ink[0], ink[1], ink[2]);
        }
        reach = Math.max(Math.hypot(...piece.a), Math.hypot(...piece.b)) + piece.radius;
      }
      this.reaches[piece.body] = Math.max(this.reaches[piece.body], reach);
    }
    this.solid = new Corners(gl);
    this.solid.fill(mesh);
    this.linked = new Corners(gl);
    this.edges = new Instances(gl, [3, 3, 3, 3, 2, 3]);
    this.edges.fill(edges);
    this.rounds = new Instances(gl, [4, 1, 3, 3]);
    this.rounds.fill(rounds);
    this.sides = new Instances(gl, [3, 3, 3, 3]);
    this.sides.fill(sides);
    this.lines = new Instances(gl, [3, 3, 2, 4, 4]);
    this.trails = this.space.panels.map(() => new Instances(gl, [3, 3, 2, 4, 4]));
    this.pose_texture = texture(gl, gl.RGBA32F, 2, Math.max(this.bodies, 1), gl.RGBA, gl.FLOAT, gl.NEAREST);
    this.map = texture(gl, gl.DEPTH_COMPONENT24, MAP, MAP, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
    this.map_frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.map_frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.map, 0);
    gl.drawBuffers([gl.NONE]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Where bodies are in a frame. */
  pose(frame) {
    const { gl, reel, space, poses } = this, at = (/** @type {number} */ i) => reel.numbers[i].at(frame);
    for (let i = 0; i < this.bodies; ++i) {
      const q = [0, 1, 2, 3].map((k) => at(space.turns + 4 * i + k)), l = Math.hypot(...q);
      for (let k = 0; k < 3; ++k) poses[8 * i + k] = at(space.places + 3 * i + k);
      for (let k = 0; k < 4; ++k) poses[8 * i + 4 + k] = q[k] / l;
    }
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.pose_texture);
    if (this.bodies > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 2, this.bodies, gl.RGBA, gl.FLOAT, poses);
  }

  /** A body's place, and how it is turned. */
  body(i) {
    return { at: Array.from(this.poses.subarray(8 * i, 8 * i + 3)), turn: Array.from(this.poses.subarray(8 * i + 4, 8 * i + 8)) };
  }

  /** The panels' lenses in a frame, under the view. */
  lenses(frame) {
    return this.space.panels.map((/** @type {any} */ panel) => this.view.see(Lens.of(panel, this.reel.numbers, frame)));
  }

  /**
   * Draws all panels.
   * @param {CanvasRenderingContext2D} context
   * @param {number} frame
   */
  draw(context, frame) {
    const { canvas } = this, target = context.canvas, scale = target.height / 1080;
    if (canvas.width !== target.width || canvas.height !== target.height) {
      canvas.width = target.width;
      canvas.height = target.height;
      this.shade = null;
    }
    this.pose(frame);
    const lenses = this.lenses(frame);
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
    this.gl.disable(this.gl.SCISSOR_TEST);
    this.gl.clearColor(0, 0, 0, 0);
    this.gl.clear(this.gl.COLOR_BUFFER_BIT);
    lenses.forEach((lens, i) => {
      this.ground(context, lens, i, scale);
      this.panel(lens, frame, scale, i);
    });
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(canvas, 0, 0);
    if (this.trails.some((/** @type {Instances} */ each) => each.count > 0)) this.draw_trails(context, lenses, scale);
    for (const lens of lenses) this.room(context, lens, scale, false);
  }

  window(lens, scale) {
    const [x, y, width, height] = lens.window, left = Math.floor(x * scale + 1e-6), top = Math.floor(y * scale + 1e-6);
    return [left, top, Math.ceil((x + width) * scale - 1e-6) - left, Math.ceil((y + height) * scale - 1e-6) - top];
  }

  above(lens) {
    const { ground } = this.space;
    if (!ground) return false;
    return dot(ground.normal, lens.per_distance > 1e-9 ? sub(lens.eye, ground.point) : lens.back) > 0;
  }

  panel(lens, frame, scale, number) {
    const { gl, canvas, programs, space } = this, panel = space.panels[number];
    const [x, y, width, height] = this.window(lens, scale);
    const zoom = lens.scale / panel.fitted, links = new Mesh(), lines = [], trails = [];
    this.links(lens, frame, links, lines, trails);
    this.linked.fill(links);
    this.lines.fill(lines);
    this.trails[number].fill(trails);
    const [near, far] = this.depths(lens);
    const light = this.light(lens);
    const set = this.setters[number] = (/** @type {import("./shaders.js").Program} */ program) => {
      program.use();
      program.vec("right", lens.right).vec("up", lens.up).vec("back", lens.back).vec("target", lens.target);
      program.vec("camera", [lens.per_distance, lens.scale, lens.middle[0], lens.middle[1]]);
      program.vec("page", [1080 * this.film.aspect, 1080, canvas.height / 1080, space.weight]);
      program.vec("depths", [near, far]).number("zoom", zoom);
      program.vec("toward", space.toward).vec("across", space.across).whole("poses", 0).whole("map", 1);
      program.number("dark", this.dark ? 1 : 0).vec("eye", lens.eye);
      const g = space.ground;
      program.vec("ground", g ? [...g.normal, dot(g.normal, g.point)] : [0, 0, 0, -1e9]);
      program.vec("light_u", [...light.u, light.origin[0]]).vec("light_v", [...light.v, light.origin[1]]);
      program.vec("light_w", [...light.away, light.origin[2]]).vec("light_size", [light.side, light.depth]);
    };
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.pose_texture);
    // what the light sees
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.map_frame);
    gl.viewport(0, 0, MAP, MAP);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.depthMask(true);
    gl.clearDepth(1);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    set(programs.caster);
    this.solid.draw();
    const dark = this.above(lens) ? this.shadow(set, scale) : null;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(x, canvas.height - y - height, width, height);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.activeTexture(gl.TEXTURE1);
    if (dark) {
      gl.disable(gl.DEPTH_TEST);
      gl.bindTexture(gl.TEXTURE_2D, dark);
      programs.cover.use().whole("shade", 1).vec("ink", this.dark ? [0, 0, 0, 115 / 255] : [0x14 / 255, 0x1a / 255, 0x24 / 255, 62 / 255]);
      gl.bindVertexArray(this.empty ??= gl.createVertexArray());
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    set(programs.solid);
    this.solid.draw();
    this.linked.draw();
    gl.depthMask(false);
    set(programs.line);
    this.lines.draw(4);
    set(programs.edge);
    this.edges.draw(4);
    set(programs.round);
    this.rounds.draw(130);
    set(programs.side);
    this.sides.draw(4);
    gl.depthMask(true);
  }

  /**
   * Trails over what hides them: the darker of two colours is taken, or on a dark page the lighter, as in the plane. They
   * are drawn on white, or black, alone, under the depths of what is there already.
   */
  draw_trails(context, lenses, scale) {
    const { gl, canvas, programs } = this, neither = this.dark ? 0 : 1;
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(neither, neither, neither, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(false);
    gl.blendEquation(this.dark ? gl.MAX : gl.MIN);
    lenses.forEach((/** @type {Lens} */ lens, /** @type {number} */ i) => {
      const [x, y, width, height] = this.window(lens, scale);
      gl.scissor(x, canvas.height - y - height, width, height);
      this.setters[i](programs.trail);
      programs.trail.vec("page_color", [neither, neither, neither]);
      this.trails[i].draw(4);
    });
    gl.blendEquation(gl.FUNC_ADD);
    gl.depthMask(true);
    context.globalCompositeOperation = this.dark ? "lighten" : "darken";
    context.drawImage(canvas, 0, 0);
    context.globalCompositeOperation = "source-over";
  }

  /** How dark the ground is: the light's rays that do not reach it, one after another. */
  shadow(set, scale) {
    const { gl, canvas } = this, width = (canvas.width + 1) >> 1, height = (canvas.height + 1) >> 1;
    if (!this.shade) {
      const color = texture(gl, gl.RGBA8, width, height, gl.RGBA, gl.UNSIGNED_BYTE, gl.LINEAR), frame = gl.createFramebuffer();
      const depth = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, color, 0);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
      this.shade = { color, frame };
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shade.frame);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clearDepth(0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.clearDepth(1);
    // the first of a ray's shadows at a place is the nearest yet: the others of that ray do not count
    gl.depthFunc(gl.GREATER);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    set(this.programs.shadow);
    const share = this.space.pieces.length > 64 ? 4 : 1, { toward } = this.space;
    const side = unit(cross(Math.abs(toward[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], toward)), up = cross(toward, side);
    for (let i = 0; i < RAYS; i += share) {
      const r = 0.1 * Math.sqrt((i + 0.5) / RAYS), a = i * Math.PI * (3 - Math.sqrt(5));
      this.programs.shadow.vec("ray", plus(plus(toward, side, r * Math.cos(a)), up, r * Math.sin(a)));
      this.programs.shadow.vec("part", [share / RAYS, 2 * (i + 1) / (RAYS + 2) - 1, (i * 5 % 32 / 16 - 1) / width, (i * 13 % 32 / 16 - 1) / height]);
      this.solid.draw();
      this.linked.draw();
    }
    return this.shade.color;
  }

  /** The nearest and the farthest that is drawn, as depths over the target's, or metres towards an orthographic eye. */
  depths(lens) {
    let near = Infinity, far = -Infinity;
    const see = (/** @type {number[]} */ at, /** @type {number} */ reach) => {
      const z = dot(sub(at, lens.target), lens.back);
      near = Math.min(near, -z - reach);
      far = Math.max(far, -z + reach);
    };
    for (let i = 0; i < this.bodies; ++i) see(Array.from(this.poses.subarray(8 * i, 8 * i + 3)), this.reaches[i] + 0.02 / lens.scale);
    for (const at of this.seen ?? []) see(at, 0);
    if (!(near < far)) return [0.1, 10];
    const margin = 0.05 * (far - near) + 20 / lens.scale;
    if (lens.per_distance <= 1e-9) return [near - margin, far + margin];
    return [Math.max(0.01, 1 + lens.per_distance * (near - margin)), Math.max(0.02, 1 + lens.per_distance * (far + margin))];
  }

  /** The box in which the light sees the bodies. */
  light() {
    const { toward } = this.space, away = plus([0, 0, 0], toward, -1);
    const u = unit(cross(Math.abs(away[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], away)), v = cross(away, u);
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < this.bodies; ++i) {
      const p = Array.from(this.poses.subarray(8 * i, 8 * i + 3)), at = [dot(p, u), dot(p, v), dot(p, away)];
      for (let k = 0; k < 3; ++k) {
        low[k] = Math.min(low[k], at[k] - this.reaches[i]);
        high[k] = Math.max(high[k], at[k] + this.reaches[i]);
      }
    }
    const any = this.bodies > 0, side = any ? 1.02 * Math.max(high[0] - low[0], high[1] - low[1]) : 1;
    const depth = any ? 1.05 * (high[2] - low[2]) : 1;
    const middle = any ? [0, 1, 2].map((k) => (low[k] + high[k]) / 2) : [0, 0, 0];
    return { u, v, away, side, depth, origin: [middle[0] - side / 2, middle[1] - side / 2, middle[2] - depth / 2] };
  }

  /** Springs, rods, ropes, knobs and plates as triangles; trails and the plates' edges as lines. */
  links(lens, frame, mesh, lines, trails) {
    const whole = Math.floor(frame), { colors } = this.reel, n = [];
    /** @type {number[][]} */
    this.seen = [];
    for (const thing of this.things) {
      if (!thing.lives_at(whole)) continue;
      thing.numbers(frame, n);
      const color = thing.space !== PLATE && thing.space !== WAY ? rgb(colors[thing.step(0, frame)]) : 0;
      if (thing.space === TUBE) {
        const way = [];
        for (let i = 0; i < thing.nodes; ++i) way.push(n.slice(3 * i, 3 * i + 3));
        const radius = n[3 * thing.nodes];
        this.seen.push(...way);
        if (thing.turns > 0) {
          const [a, b] = way, pa = lens.page(a), pb = lens.page(b), wide = n[3 * thing.nodes + 1];
          const seen = Math.hypot(pb[0] - pa[0], pb[1] - pa[1]);
          const by = wide * clamp(seen / (END_ON * wide), NARROW, 1) / lens.scale * this.view.zoom;
          mesh.tube(helix(a, b, thing.turns, radius, by), radius, -1, 0, color);
        } else {
          mesh.tube(way, radius, -1, 0, color);
        }
      } else if (thing.space === BALL) {
        this.seen.push(n.slice(0, 3));
        mesh.ball(n.slice(0, 3), n[3], -1, 0, color, 16);
      } else if (thing.space === PLATE) {
        this.plate(n, mesh, lines, lens);
      } else if (thing.space === WAY) {
        this.trail(thing, n, lens, trails);
      } else if (thing.space === LINE) {
        const width = 2 * n[3 * thing.nodes], ink = colors[thing.step(0, frame)].map((/** @type {number} */ c) => c / 255);
        for (let i = 0; i + 1 < thing.nodes; ++i) {
          lines.push(...n.slice(3 * i, 3 * i + 6), width, width, ...ink, ...ink);
          this.seen.push(n.slice(3 * i, 3 * i + 3));
        }
      }
    }
  }

  plate([x, y, z, half, thick], mesh, lines, lens) {
    const [own, edge] = this.space.plate, corners = [], size = [half, thick, half];
    for (let i = 0; i < 8; ++i) corners.push([0, 1, 2].map((k) => [x, y, z][k] + (i >> k & 1 ? size[k] : -size[k])));
    const faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    const normals = [-1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1];
    mesh.flat({ vertices: corners.flat(), faces, normals }, -1, 0, rgb(own));
    const ink = edge.map((/** @type {number} */ c) => c / 255), width = 1.3 * EDGE * this.space.weight;
    for (let a = 0; a < 8; ++a)
      for (const k of [1, 2, 4]) if (!(a & k)) lines.push(...corners[a], ...corners[a | k], width, width, ...ink, ...ink);
    this.seen?.push([x, y, z]);
  }

  trail(thing, [hx, hy, hz, now, widest], lens, lines) {
    const [lasting, strong, faint] = thing.trail, { places, times } = thing.way, { colors } = this.reel;
    const node = (/** @type {number[]} */ at, /** @type {number} */ time) => {
      const s = clamp(1 - (now - time) / lasting, 0, 1), k = s ** 1.3;
      const width = widest * clamp(1 / Math.max(lens.depth(at), 1e-3), 0.3, 1.6) * (0.25 + 0.75 * s);
      return { at, width, ink: [0, 1, 2].map((i) => (colors[faint][i] + k * (colors[strong][i] - colors[faint][i])) / 255).concat(1) };
    };
    const nodes = [];
    for (let i = 0; i < times.length && times[i] < now - 1e-9; ++i) {
      const at = places.slice(3 * i, 3 * i + 3);
      if (times[i] > now - lasting) nodes.push(node(at, times[i]));
    }
    nodes.push(node([hx, hy, hz], now));
    for (let i = 0; i + 1 < nodes.length; ++i) {
      const a = nodes[i], b = nodes[i + 1];
      lines.push(...a.at, ...b.at, a.width, b.width, ...a.ink, ...b.ink);
      this.seen?.push(a.at);
    }
  }

  /** The ground's grid and the room's hairlines behind all, kept as long as one looks from one place. */
  ground(context, lens, i, scale) {
    const key = `${lens.key} ${scale}`;
    let known = this.grids.get(i);
    if (!known || known.key !== key) {
      const picture = known?.picture ?? document.createElement("canvas");
      picture.width = context.canvas.width;
      picture.height = context.canvas.height;
      const c = /** @type {CanvasRenderingContext2D} */ (picture.getContext("2d"));
      if (this.above(lens) && this.space.ground.grid) this.grid(c, lens, scale, this.space.panels[i]);
      this.room(c, lens, scale, true);
      this.grids.set(i, known = { key, picture });
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(known.picture, 0, 0);
    if (!this.above(lens)) return;
    this.clipped(context, lens, scale);
    draw_contacts(context, this.space, lens, (body) => this.body(body), this.dark);
    context.restore();
  }

  clipped(c, lens, scale) {
    c.save();
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.beginPath();
    c.rect(...this.window(lens, scale));
    c.clip();
    c.setTransform(scale, 0, 0, scale, 0, 0);
  }

  grid(c, lens, scale, panel) {
    const { ground, weight } = this.space, n = ground.normal, shown = lens.window[2] / lens.scale;
    const own = Lens.of(panel, this.reel.numbers, 0);
    const tile = ground.tile > 0 ? ground.tile : nice(TILE * weight / own.scale);
    let u = plus([1, 0, 0], n, -n[0]);
    if (Math.hypot(...u) < 0.1) u = plus([0, 0, 1], n, -n[2]);
    u = unit(u);
    const v = cross(u, n), origin = plus([0, 0, 0], n, dot(n, ground.point));
    const foot = plus(lens.target, n, -dot(sub(lens.target, ground.point), n));
    const x = dot(sub(foot, origin), u), y = dot(sub(foot, origin), v);
    /** @type {number[][]} */
    const loop = [];
    for (let i = 0; ground.loop && i < ground.loop.length; i += 3) loop.push(ground.loop.slice(i, i + 3));
    const radius = loop.length ? Math.max(...loop.map((p) => Math.hypot(...sub(p, foot)))) : TO * shown;
    const last = Math.min(Math.ceil(radius / tile), 400), ink = this.dark ? [0x43, 0x4f, 0x5b] : [0xc6, 0xcb, 0xd1];
    this.clipped(c, lens, scale);
    c.globalCompositeOperation = this.dark ? "lighten" : "darken";
    c.lineWidth = GRID * weight;
    c.lineCap = "butt";
    for (const [along, across, here, there] of /** @type {[number[], number[], number, number][]} */ ([[u, v, y, x], [v, u, x, y]])) {
      const middle = Math.round(here / tile);
      for (let k = middle - last; k <= middle + last; ++k) {
        const off = k * tile - here;
        if (Math.abs(off) > radius) continue;
        const start = plus(plus(origin, across, k * tile), along, there), half = Math.sqrt(Math.max(radius * radius - off * off, 0));
        const part = loop.length ? clip(loop, plus([0, 0, 0], n, -1), start, along, -half, half) : [-half, half];
        if (!part) continue;
        /** @type {{p: number[], s: number} | null} */
        let before = null;
        for (let i = 0; i <= PIECES; ++i) {
          const t = part[0] + (part[1] - part[0]) * i / PIECES, at = plus(start, along, t);
          if (lens.depth(at) < 0.05) {
            before = null;
            continue;
          }
          const r = (Math.hypot(off, t) / shown - FROM) / (TO - FROM), q = clamp(r, 0, 1);
          const now = { p: lens.page(at), s: loop.length ? 1 : 1 - q * q * (3 - 2 * q) };
          if (before && before.s + now.s > 0.01) {
            c.strokeStyle = `rgba(${ink.join(",")},${(before.s + now.s) / 2})`;
            c.beginPath();
            c.moveTo(before.p[0], before.p[1]);
            c.lineTo(now.p[0], now.p[1]);
            c.stroke();
          }
          before = now;
        }
      }
    }
    c.restore();
  }

  /** The room's edges that lie behind what is in it, or before it. */
  room(c, lens, scale, back) {
    const { room, weight, hatch } = this.space;
    if (!room) return;
    this.clipped(c, lens, scale);
    c.lineCap = "round";
    c.lineWidth = (back ? 1 : 0.8) * FRAME * weight;
    c.strokeStyle = `rgba(${hatch.slice(0, 3).join(",")},${back ? hatch[3] / 255 : 70 / 255})`;
    const at = (/** @type {number} */ i) => room.vertices.slice(3 * i, 3 * i + 3);
    const away = (/** @type {number} */ f) => {
      const n = room.normals.slice(3 * f, 3 * f + 3);
      return dot(n, lens.per_distance > 1e-9 ? sub(lens.eye, at(room.faces[f][0])) : lens.back) < 0;
    };
    for (let i = 0; i < room.edges.length; i += 4) {
      const [a, b, left, right] = room.edges.slice(i, i + 4);
      if ((away(left) || (right >= 0 && away(right))) !== back) continue;
      let p = at(a), q = at(b);
      const dp = lens.depth(p), dq = lens.depth(q), near = 0.02;
      if (dp < near && dq < near) continue;
      if (dp < near) p = plus(q, sub(p, q), (dq - near) / (dq - dp));
      if (dq < near) q = plus(p, sub(q, p), (dp - near) / (dp - dq));
      c.beginPath();
      c.moveTo(...lens.page(p));
      c.lineTo(...lens.page(q));
      c.stroke();
    }
    c.restore();
  }

  /** The body at a place of the page. */
  body_at(x, y, frame) {
    for (const lens of this.lenses(frame)) {
      const [left, top, width, height] = lens.window;
      if (x < left || x > left + width || y < top || y > top + height) continue;
      const ray = lens.ray(x, y);
      let best = null, least = Infinity;
      for (const piece of this.space.pieces) {
        const { at, turn } = this.body(piece.body), back = [turn[0], -turn[1], -turn[2], -turn[3]];
        const from = turned(back, sub(ray.from, at)), way = turned(back, ray.way);
        const t = piece.shape !== undefined ? meets_flat(this.space.shapes[piece.shape], from, way)
          : meets_ball(piece, from, way, (piece.dot ?? 6) / lens.scale);
        if (t < least) {
          least = t;
          best = [0, piece.body];
        }
      }
      if (best) return best;
    }
    return null;
  }
}

function texture(gl, inner, width, height, format, type, filter) {
  const it = gl.createTexture();
  // a unit that no program reads
  gl.activeTexture(gl.TEXTURE2);
  gl.bindTexture(gl.TEXTURE_2D, it);
  gl.texImage2D(gl.TEXTURE_2D, 0, inner, width, height, 0, format, type, null);
  for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, filter);
  for (const which of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, which, gl.CLAMP_TO_EDGE);
  return it;
}

/** 1, 2 or 5 times a power of ten, not smaller. */
function nice(least) {
  const unit_of = 10 ** Math.ceil(Math.log10(least) - 1e-12);
  for (const part of [0.2, 0.5, 1]) if (unit_of * part >= least * (1 - 1e-9)) return unit_of * part;
  return unit_of;
}

/** The part of a line in a convex loop of a plane. */
function clip(loop, normal, a, d, from, to) {
  for (let i = 0; i < loop.length; ++i) {
    const side = sub(loop[(i + 1) % loop.length], loop[i]), inwards = cross(normal, side);
    const height = dot(inwards, sub(a, loop[i])), rise = dot(inwards, d);
    if (Math.abs(rise) < 1e-12 * Math.hypot(...inwards)) {
      if (height < 0) return null;
    } else if (rise > 0) {
      from = Math.max(from, -height / rise);
    } else {
      to = Math.min(to, -height / rise);
    }
  }
  return from < to ? [from, to] : null;
}

/** How far along a ray it meets a polyhedron. */
function meets_flat(shape, from, way) {
  let enters = -Infinity, leaves = Infinity;
  for (let f = 0; f < shape.faces.length; ++f) {
    const n = shape.normals.slice(3 * f, 3 * f + 3), v = shape.faces[f][0], p = shape.vertices.slice(3 * v, 3 * v + 3);
    const high = dot(n, sub(from, p)), rise = dot(n, way);
    if (Math.abs(rise) < 1e-12) {
      if (high > 0) return Infinity;
    } else if (rise < 0) {
      enters = Math.max(enters, -high / rise);
    } else {
      leaves = Math.min(leaves, -high / rise);
    }
  }
  return enters < leaves ? enters : Infinity;
}

/** How far along a ray it meets a ball, or a capsule. */
function meets_ball(piece, from, way, least) {
  const radius = Math.max(piece.radius, piece.dot ? least : 0), along = sub(piece.b, piece.a), l = dot(along, along);
  let best = Infinity;
  for (let i = 0; i <= (l > 0 ? 16 : 0); ++i) {
    const p = sub(from, plus(piece.a, along, l > 0 ? i / 16 : 0)), b = dot(p, way), c = dot(p, p) - radius * radius;
    if (b * b >= c) best = Math.min(best, -b - Math.sqrt(b * b - c));
  }
  return best;
}
