// Space, drawn by WebGL: bodies in light and shadow, their edges where they are seen, what ties them, trails. The light and
// the widths of lines are those of draw/space; what lies in front is found pixel by pixel, not line by line.

import { Corners, Instances, MAP, Table, texture } from "./card.js";
import { Mesh, forms_of, helix, rgb } from "./forms.js";
import { Ground, above_ground, window_of } from "./ground.js";
import { Lens, clamp, cross, dot, plus, sub, turned, unit } from "./lens.js";
import { Occlusion } from "./occlusion.js";
import { Hanging } from "./pen.js";
import { meets_ball, meets_flat } from "./pick.js";

const RAYS = 32;
const EDGE = 2.3,
  TUBE = 1,
  BALL = 2,
  PLATE = 3,
  WAY = 4,
  LINE = 5;
const DROP = 1.6,
  DROP_DASH = 7,
  DROP_GAP = 5,
  DROP_FOOT = 9; // draw/space/lines.cpp
const END_ON = 7,
  NARROW = 0.3; // of coils: draw/space/links.cpp

/** One run in space. */
export class Space {
  /**
   * @param {any} film
   * @param {number} run which of the film's
   * @param {import("./reel.js").Reel} reel
   * @param {import("./card.js").Card} card
   * @param {import("./lens.js").Orbit} view
   */
  constructor(film, run, reel, card, view) {
    this.film = film;
    this.run = run;
    this.space = film.spaces[run];
    this.reel = reel;
    this.dark = film.theme === "screen";
    this.card = card;
    this.gl = card.gl;
    this.view = view;
    this.ground = new Ground(this.space, this.dark, film.ground);
    this.things = reel.things.filter((each) => each.space > 0 && each.part === run);
    this.bodies = this.space.colors.length;
    this.poses = new Float32Array(8 * this.bodies);
    const { gl, space } = this,
      { mesh, edges, rounds, sides, reaches } = forms_of(space);
    this.reaches = reaches;
    this.solid = new Corners(gl, mesh);
    this.linked = new Corners(gl);
    this.edges = new Instances(gl, [3, 3, 3, 3, 2, 3], edges);
    this.rounds = new Instances(gl, [4, 1, 3, 3], rounds);
    this.sides = new Instances(gl, [3, 3, 3, 3], sides);
    this.lines = new Instances(gl, [3, 3, 2, 4, 4]);
    /** @type {Instances[]} */
    this.trails = space.panels.map(() => new Instances(gl, [3, 3, 2, 4, 4]));
    this.pose_texture = texture(gl, gl.RGBA32F, 2, Math.max(this.bodies, 1), gl.RGBA, gl.FLOAT, gl.NEAREST);
    this.occlusion = new Occlusion(space);
    this.pieces = new Table(gl, this.occlusion.texels);
    this.near = new Table(gl);
    this.empty = gl.createVertexArray();
    /** @type {number[][]} what stands in space besides the bodies */
    this.seen = [];
    /** @type {((program: import("./shaders.js").Program) => void)[]} */
    this.setters = [];
  }

  /** Where bodies are in a frame. */
  pose(frame) {
    const { gl, reel, space, poses } = this,
      at = (/** @type {number} */ i) => reel.numbers[i].at(frame);
    for (let i = 0; i < this.bodies; ++i) {
      const q = [0, 1, 2, 3].map((k) => at(space.turns + 4 * i + k)),
        l = Math.hypot(...q);
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

  /** Where a body is on the page. */
  place_of(index, frame) {
    return this.lenses(frame)[0].page(this.body(index).at);
  }

  /** The panels' lenses in a frame, under the view. */
  lenses(frame) {
    return this.space.panels.map((/** @type {any} */ panel) => this.view.see(Lens.of(panel, this.reel.numbers, frame)));
  }

  /** How a thing of the page that hangs in space is moved by the view; none where it does not, or is behind the eye. */
  hanging(thing, frame) {
    if (!thing.hang) return null;
    // a panel's things are clipped to it
    const [x, y, width, height] = this.reel.clips[thing.clip] ?? [0, 0, 0, 0],
      middle = [x + width / 2, y + height / 2];
    const panel = this.space.panels.find((/** @type {any} */ each) => within(each.window, middle)) ?? this.space.panels[0];
    const film = Lens.of(panel, this.reel.numbers, frame),
      now = this.view.see(film);
    const places = thing.places(thing.numbers(frame, []));
    if (places.some((/** @type {number[]} */ p) => now.depth(p) < 1e-2 || film.depth(p) < 1e-2)) return null;
    return new Hanging(
      places.map((/** @type {number[]} */ p) => film.page(p)),
      places.map((/** @type {number[]} */ p) => now.page(p)),
      36 * this.space.weight,
    );
  }

  /**
   * Draws all panels.
   * @param {CanvasRenderingContext2D} context
   * @param {number} frame
   */
  draw(context, frame) {
    const target = context.canvas,
      scale = target.height / 1080;
    this.card.size(target.width, target.height);
    this.pose(frame);
    const lenses = this.lenses(frame);
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
    this.gl.disable(this.gl.SCISSOR_TEST);
    this.gl.clearColor(0, 0, 0, 0);
    this.gl.clear(this.gl.COLOR_BUFFER_BIT);
    lenses.forEach((lens, i) => {
      const fitted = Lens.of(this.space.panels[i], this.reel.numbers, 0).scale;
      this.ground.draw(context, lens, i, scale, fitted, (/** @type {number} */ body) => this.body(body));
      this.panel(lens, frame, scale, i);
    });
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.card.canvas, 0, 0);
    if (this.trails.some((/** @type {Instances} */ each) => each.count > 0)) this.draw_trails(context, lenses, scale);
    for (const lens of lenses) this.ground.room(context, lens, scale, false);
  }

  panel(lens, frame, scale, number) {
    const { gl, space } = this,
      { canvas, programs } = this.card,
      panel = space.panels[number];
    const [x, y, width, height] = window_of(lens, scale);
    const zoom = lens.scale / panel.fitted,
      links = new Mesh(),
      lines = [],
      trails = [];
    this.links(lens, frame, number, links, lines, trails);
    if (space.drops && space.ground) this.drops(lens, lines);
    this.linked.fill(links);
    this.lines.fill(lines);
    this.trails[number].fill(trails);
    const [near, far] = this.depths(lens);
    const light = this.light();
    const set = (this.setters[number] = (/** @type {import("./shaders.js").Program} */ program) => {
      program.use();
      program.vec("right", lens.right).vec("up", lens.up).vec("back", lens.back).vec("target", lens.target);
      program.vec("camera", [lens.per_distance, lens.scale, lens.middle[0], lens.middle[1]]);
      program.vec("page", [1080 * this.film.aspect, 1080, canvas.height / 1080, space.weight]);
      program.vec("depths", [near, far]).number("zoom", zoom);
      program.vec("toward", space.toward).vec("across", space.across).whole("poses", 0).whole("map", 1);
      program.whole("pieces", 3).whole("near", 4);
      program.number("dark", this.dark ? 1 : 0).vec("eye", lens.eye);
      const g = space.ground;
      program.vec("ground", g ? [...g.normal, dot(g.normal, g.point)] : [0, 0, 0, -1e9]);
      program.vec("light_u", [...light.u, light.origin[0]]).vec("light_v", [...light.v, light.origin[1]]);
      program.vec("light_w", [...light.away, light.origin[2]]).vec("light_size", [light.side, light.depth]);
    });
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.pose_texture);
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, this.pieces.texture);
    this.near.fill(gl.TEXTURE4, this.occlusion.lists(this.poses, lens));
    // what the light sees
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.card.map_frame);
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
    const dark = above_ground(space.ground, lens) ? this.shadow(set) : null;
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
      programs.cover
        .use()
        .whole("shade", 1)
        .vec("ink", this.dark ? [0, 0, 0, 115 / 255] : [0x14 / 255, 0x1a / 255, 0x24 / 255, 62 / 255]);
      gl.bindVertexArray(this.empty);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.bindTexture(gl.TEXTURE_2D, this.card.map);
    gl.colorMask(false, false, false, false);
    set(programs.depth);
    this.solid.draw();
    this.linked.draw();
    gl.colorMask(true, true, true, true);
    gl.depthMask(false);
    gl.depthFunc(gl.LEQUAL);
    set(programs.solid);
    this.solid.draw();
    this.linked.draw();
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
    const { gl } = this,
      { canvas, programs } = this.card,
      neither = this.dark ? 0 : 1;
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(neither, neither, neither, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(false);
    gl.blendEquation(this.dark ? gl.MAX : gl.MIN);
    lenses.forEach((/** @type {Lens} */ lens, /** @type {number} */ i) => {
      const [x, y, width, height] = window_of(lens, scale);
      gl.scissor(x, canvas.height - y - height, width, height);
      this.setters[i](programs.trail);
      programs.trail.vec(
        "page_color",
        this.film.ground.map((/** @type {number} */ c) => c / 255),
      );
      this.trails[i].draw(4);
    });
    gl.blendEquation(gl.FUNC_ADD);
    gl.depthMask(true);
    context.globalCompositeOperation = this.dark ? "lighten" : "darken";
    context.drawImage(canvas, 0, 0);
    context.globalCompositeOperation = "source-over";
  }

  /** How dark the ground is: the light's rays that do not reach it, one after another. */
  shadow(set) {
    const { gl, card } = this,
      { color, frame, width, height } = card.shade(),
      program = card.programs.shadow;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clearDepth(0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.clearDepth(1);
    // the first of a ray's shadows at a place is the nearest yet: the others of that ray do not count
    gl.depthFunc(gl.GREATER);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    set(program);
    const share = this.space.pieces.length > 64 ? 4 : 1,
      { toward } = this.space;
    const side = unit(cross(Math.abs(toward[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], toward)),
      up = cross(toward, side);
    for (let i = 0; i < RAYS; i += share) {
      const r = 0.1 * Math.sqrt((i + 0.5) / RAYS),
        a = i * Math.PI * (3 - Math.sqrt(5));
      program.vec("ray", plus(plus(toward, side, r * Math.cos(a)), up, r * Math.sin(a)));
      program.vec("part", [
        share / RAYS,
        (2 * (i + 1)) / (RAYS + 2) - 1,
        (((i * 5) % 32) / 16 - 1) / width,
        (((i * 13) % 32) / 16 - 1) / height,
      ]);
      this.solid.draw();
      this.linked.draw();
    }
    return color;
  }

  /** The nearest and the farthest that is drawn, as depths over the target's, or metres towards an orthographic eye. */
  depths(lens) {
    let near = Infinity,
      far = -Infinity;
    const see = (/** @type {number[]} */ at, /** @type {number} */ reach) => {
      const z = dot(sub(at, lens.target), lens.back);
      near = Math.min(near, -z - reach);
      far = Math.max(far, -z + reach);
    };
    for (let i = 0; i < this.bodies; ++i) see(Array.from(this.poses.subarray(8 * i, 8 * i + 3)), this.reaches[i] + 0.02 / lens.scale);
    for (const at of this.seen) see(at, 0);
    if (!(near < far)) return [0.1, 10];
    const margin = 0.05 * (far - near) + 20 / lens.scale;
    if (lens.per_distance <= 1e-9) return [near - margin, far + margin];
    return [Math.max(0.01, 1 + lens.per_distance * (near - margin)), Math.max(0.02, 1 + lens.per_distance * (far + margin))];
  }

  /** The box in which the light sees the bodies. */
  light() {
    const { toward } = this.space,
      away = plus([0, 0, 0], toward, -1);
    const u = unit(cross(Math.abs(away[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], away)),
      v = cross(away, u);
    const low = [Infinity, Infinity, Infinity],
      high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < this.bodies; ++i) {
      const p = Array.from(this.poses.subarray(8 * i, 8 * i + 3)),
        at = [dot(p, u), dot(p, v), dot(p, away)];
      for (let k = 0; k < 3; ++k) {
        low[k] = Math.min(low[k], at[k] - this.reaches[i]);
        high[k] = Math.max(high[k], at[k] + this.reaches[i]);
      }
    }
    const any = this.bodies > 0,
      side = any ? 1.02 * Math.max(high[0] - low[0], high[1] - low[1]) : 1;
    const depth = any ? 1.05 * (high[2] - low[2]) : 1;
    const middle = any ? [0, 1, 2].map((k) => (low[k] + high[k]) / 2) : [0, 0, 0];
    return { u, v, away, side, depth, origin: [middle[0] - side / 2, middle[1] - side / 2, middle[2] - depth / 2] };
  }

  /** Springs, rods, ropes, knobs and plates as triangles; trails and the plates' edges as lines. */
  links(lens, frame, panel, mesh, lines, trails) {
    const whole = Math.floor(frame),
      { colors } = this.reel,
      n = [];
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
          const [a, b] = way,
            pa = lens.page(a),
            pb = lens.page(b),
            wide = n[3 * thing.nodes + 1];
          const seen = Math.hypot(pb[0] - pa[0], pb[1] - pa[1]);
          const by = ((wide * clamp(seen / (END_ON * wide), NARROW, 1)) / lens.scale) * this.view.zoom;
          mesh.tube(helix(a, b, thing.turns, radius, by), radius, -1, 0, color);
        } else {
          mesh.tube(way, radius, -1, 0, color);
        }
      } else if (thing.space === BALL) {
        this.seen.push(n.slice(0, 3));
        mesh.ball(n.slice(0, 3), n[3], -1, 0, color, 16);
      } else if (thing.space === PLATE) {
        this.plate(n, mesh, lines);
      } else if (thing.space === WAY) {
        this.trail(thing, n, lens, trails);
      } else if (thing.space === LINE && thing.index === panel) {
        const width = 2 * n[3 * thing.nodes],
          ink = colors[thing.step(0, frame)].map((/** @type {number} */ c) => c / 255);
        for (let i = 0; i + 1 < thing.nodes; ++i) {
          lines.push(...n.slice(3 * i, 3 * i + 6), width, width, ...ink, ...ink);
          this.seen.push(n.slice(3 * i, 3 * i + 3));
        }
      }
    }
  }

  /** Dashes from each body that flies to the ground under it, and a cross there (draw/space/lines.cpp). */
  drops(lens, lines) {
    const { space } = this,
      { normal, point } = space.ground,
      side = orthogonal(normal),
      ahead = cross(normal, side);
    const lowest = new Array(this.bodies).fill(Infinity),
      size = new Array(this.bodies).fill(0);
    for (const piece of space.pieces) {
      const { at, turn } = this.body(piece.body),
        ends = piece.shape === undefined ? [...piece.a, ...piece.b] : space.shapes[piece.shape].vertices;
      for (let i = 0; i < ends.length; i += 3) {
        const local = ends.slice(i, i + 3),
          high = dot(sub(plus(at, turned(turn, local)), point), normal);
        lowest[piece.body] = Math.min(lowest[piece.body], high - (piece.radius ?? 0));
        size[piece.body] = Math.max(size[piece.body], Math.hypot(...local) + (piece.radius ?? 0));
      }
    }
    for (let i = 0; i < this.bodies; ++i) {
      const ink = space.drops[i],
        strength = clamp(lowest[i] / Math.max(size[i], 1e-9) - 0.1, 0, 1);
      if (!ink || !(strength > 0) || lowest[i] === Infinity) continue;
      const { at } = this.body(i),
        foot = plus(at, normal, -dot(sub(at, point), normal));
      if (lens.depth(at) < 1e-2 || lens.depth(foot) < 1e-2) continue;
      const color = [ink[0] / 255, ink[1] / 255, ink[2] / 255, Math.round(190 * strength) / 255],
        weight = space.weight;
      const line = (/** @type {number[]} */ a, /** @type {number[]} */ b, /** @type {number} */ width) =>
        lines.push(...a, ...b, width, width, ...color, ...color);
      // dashes are counted from the ground, so that they do not run along it; their ends are round here
      const p = lens.page(foot),
        q = lens.page(at),
        length = Math.hypot(q[0] - p[0], q[1] - p[1]),
        width = DROP * weight;
      const along = (/** @type {number} */ l) => unproject(lens, foot, at, l / length);
      for (let l = 0; l < length; l += (DROP_DASH + DROP_GAP) * weight) {
        const end = Math.min(l + DROP_DASH * weight, length);
        if (end - l > width) line(along(l + width / 2), along(end - width / 2), width);
      }
      const arm = (DROP_FOOT * weight * lens.depth(foot)) / lens.scale;
      for (const way of [side, ahead]) line(plus(foot, way, -arm), plus(foot, way, arm), 1.3 * width);
    }
  }

  plate(numbers, mesh, lines) {
    const [x, y, z, half, thick] = numbers;
    const [own, edge] = this.space.plate,
      corners = [],
      size = [half, thick, half];
    for (let i = 0; i < 8; ++i) corners.push([0, 1, 2].map((k) => [x, y, z][k] + ((i >> k) & 1 ? size[k] : -size[k])));
    const faces = [
      [0, 4, 6, 2],
      [1, 3, 7, 5],
      [0, 1, 5, 4],
      [2, 6, 7, 3],
      [0, 2, 3, 1],
      [4, 5, 7, 6],
    ];
    const normals = [-1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1];
    mesh.flat({ vertices: corners.flat(), faces, normals }, -1, 0, rgb(own));
    const ink = edge.map((/** @type {number} */ c) => c / 255),
      width = 1.3 * EDGE * this.space.weight;
    for (let a = 0; a < 8; ++a)
      for (const k of [1, 2, 4]) if (!(a & k)) lines.push(...corners[a], ...corners[a | k], width, width, ...ink, ...ink);
    this.seen.push([x, y, z]);
  }

  trail(thing, numbers, lens, lines) {
    const [hx, hy, hz, now, widest] = numbers;
    const [lasting, strong, faint] = thing.trail,
      { places, times } = thing.way,
      { colors } = this.reel;
    const node = (/** @type {number[]} */ at, /** @type {number} */ time) => {
      const s = clamp(1 - (now - time) / lasting, 0, 1),
        k = s ** 1.3;
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
      const a = nodes[i],
        b = nodes[i + 1];
      lines.push(...a.at, ...b.at, a.width, b.width, ...a.ink, ...b.ink);
      this.seen.push(a.at);
    }
  }

  /** The body at a place of the page. */
  body_at(x, y, frame) {
    for (const lens of this.lenses(frame)) {
      if (!within(lens.window, [x, y])) continue;
      const ray = lens.ray(x, y);
      let best = null,
        least = Infinity;
      for (const piece of this.space.pieces) {
        const { at, turn } = this.body(piece.body),
          back = [turn[0], -turn[1], -turn[2], -turn[3]];
        const from = turned(back, sub(ray.from, at)),
          way = turned(back, ray.way);
        const t =
          piece.shape !== undefined
            ? meets_flat(this.space.shapes[piece.shape], from, way)
            : meets_ball(piece, from, way, (piece.dot ?? 6) / lens.scale);
        if (t < least) {
          least = t;
          best = [this.run, piece.body];
        }
      }
      if (best) return best;
    }
    return null;
  }
}

/** Whether a place is in a rectangle. */
const within = (/** @type {number[]} */ r, /** @type {number[]} */ p) =>
  p[0] >= r[0] && p[0] <= r[0] + r[2] && p[1] >= r[1] && p[1] <= r[1] + r[3];

/** A unit vector across another (Eigen's unitOrthogonal). */
function orthogonal(v) {
  const [x, y, z] = v;
  if (Math.abs(x) > 1e-12 * Math.abs(z) || Math.abs(y) > 1e-12 * Math.abs(z)) return unit([-y, x, 0]);
  return unit([0, -z, y]);
}

/** The place of a segment that is seen at a part of its way on the page. */
function unproject(lens, a, b, part) {
  const da = lens.depth(a),
    db = lens.depth(b),
    t = (part * da) / (db + part * (da - db));
  return plus(a, sub(b, a), t);
}
