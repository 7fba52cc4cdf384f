// Space in light and shadow, by WebGL: bodies, their edges where they are seen, what ties them, trails. The light and the
// widths of lines are those of draw/space; what lies in front is found pixel by pixel, not line by line.

import { Corners, Instances, MAP, Table, texture } from "./card.js";
import { Mesh, forms_of, helix, rgb } from "./forms.js";
import { above_ground, window_of } from "./ground.js";
import { cross, dot, plus, sub, unit } from "./lens.js";
import { Occlusion } from "./occlusion.js";

const RAYS = 32;

/** What of a panel the card has to draw besides the bodies. */
class Besides {
  constructor() {
    this.mesh = new Mesh();
    /** @type {number[]} */
    this.lines = [];
    /** @type {number[]} */
    this.trails = [];
    /** @type {number[]} over the bodies */
    this.fronts = [];
    /** @type {number[][]} places of it */
    this.seen = [];
  }

  tube(way, radius, color) {
    this.seen.push(...way);
    this.mesh.tube(way, radius, -1, 0, rgb(color));
  }

  coil(a, b, turns, radius, by, color) {
    this.seen.push(a, b);
    this.mesh.tube(helix(a, b, turns, radius, by), radius, -1, 0, rgb(color));
  }

  ball(at, radius, color) {
    this.seen.push(at);
    this.mesh.ball(at, radius, -1, 0, rgb(color), 16);
  }

  flat(shape, color) {
    this.seen.push(shape.vertices.slice(0, 3));
    this.mesh.flat(shape, -1, 0, rgb(color));
  }

  line(a, b, width, ink) {
    this.seen.push(a);
    this.lines.push(...a, ...b, width, width, ...ink, ...ink);
  }

  trail(nodes, front) {
    const lines = front ? this.fronts : this.trails;
    for (let i = 0; i + 1 < nodes.length; ++i) {
      const a = nodes[i],
        b = nodes[i + 1];
      lines.push(...a.at, ...b.at, a.width, b.width, ...a.ink, ...b.ink);
      this.seen.push(a.at);
    }
  }
}

/** One run in light. */
export class Lit {
  /**
   * @param {import("./space.js").Space} run
   * @param {import("./card.js").Card} card
   */
  constructor(run, card) {
    const { gl } = card,
      { space } = run,
      { mesh, edges, rounds, sides, reaches } = forms_of(space);
    this.run = run;
    this.card = card;
    this.gl = gl;
    this.space = space;
    this.dark = run.dark;
    this.bodies = run.bodies;
    this.reaches = reaches;
    this.solid = new Corners(gl, mesh);
    this.linked = new Corners(gl);
    this.edges = new Instances(gl, [3, 3, 3, 3, 2, 3, 3], edges);
    this.rounds = new Instances(gl, [4, 1, 3, 3], rounds);
    this.sides = new Instances(gl, [3, 3, 3, 3], sides);
    this.lines = new Instances(gl, [3, 3, 2, 4, 4]);
    this.trails = new Instances(gl, [3, 3, 2, 4, 4]);
    /** paths over the bodies */
    this.fronts = new Instances(gl, [3, 3, 2, 4, 4]);
    this.pose_texture = texture(gl, gl.RGBA32F, 2, Math.max(this.bodies, 1), gl.RGBA, gl.FLOAT, gl.NEAREST);
    this.occlusion = new Occlusion(space);
    this.pieces = new Table(gl, this.occlusion.texels);
    this.near = new Table(gl);
    this.empty = gl.createVertexArray();
    /** @type {number[][]} what stands in space besides the bodies */
    this.seen = [];
  }

  /** Makes ready to draw panels into a picture so large. */
  begin(target) {
    const { gl } = this;
    this.card.size(target.width, target.height);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.pose_texture);
    if (this.bodies > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 2, this.bodies, gl.RGBA, gl.FLOAT, this.run.poses);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
  }

  /** Puts the panels on the canvas. */
  end(context) {
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.card.canvas, 0, 0);
  }

  /**
   * Draws a panel's bodies, and what ties them.
   * @param {import("./lens.js").Lens} lens
   * @param {number} frame
   * @param {number} scale px a page unit
   * @param {number} number the panel's
   */
  panel(lens, frame, scale, number) {
    const { gl, space } = this,
      { canvas, programs } = this.card,
      panel = space.panels[number];
    const [x, y, width, height] = window_of(lens, scale);
    const zoom = lens.scale / panel.fitted,
      besides = new Besides();
    this.run.besides(lens, frame, number, besides);
    this.seen = besides.seen;
    this.linked.fill(besides.mesh);
    this.lines.fill(besides.lines);
    this.trails.fill(besides.trails);
    this.fronts.fill(besides.fronts);
    const [near, far] = this.depths(lens);
    const light = this.light();
    const set = (/** @type {import("./shaders.js").Program} */ program) => {
      program.use();
      program.vec("right", lens.right).vec("up", lens.up).vec("back", lens.back).vec("target", lens.target);
      program.vec("camera", [lens.per_distance, lens.scale, lens.middle[0], lens.middle[1]]);
      program.vec("page", [1080 * this.run.film.aspect, 1080, canvas.height / 1080, space.weight]);
      program.vec("depths", [near, far]).number("zoom", zoom);
      program.vec("toward", space.toward).vec("across", space.across).whole("poses", 0).whole("map", 1);
      program.whole("pieces", 3).whole("near", 4);
      program.number("dark", this.dark ? 1 : 0).vec("eye", lens.eye);
      const g = space.ground;
      program.vec("ground", g ? [...g.normal, dot(g.normal, g.point)] : [0, 0, 0, -1e9]);
      program.vec("light_u", [...light.u, light.origin[0]]).vec("light_v", [...light.v, light.origin[1]]);
      program.vec("light_w", [...light.away, light.origin[2]]).vec("light_size", [light.side, light.depth]);
    };
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.pose_texture);
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, this.pieces.texture);
    this.near.fill(gl.TEXTURE4, this.occlusion.lists(this.run.poses, lens));
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
        .vec("ink", this.dark ? [0, 0, 0, 132 / 255] : [0x14 / 255, 0x1a / 255, 0x24 / 255, 62 / 255]);
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
    this.trails.draw(4);
    this.lines.draw(4);
    set(programs.edge);
    this.edges.draw(4);
    set(programs.round);
    this.rounds.draw(130);
    set(programs.side);
    this.sides.draw(4);
    gl.disable(gl.DEPTH_TEST);
    set(programs.line);
    this.fronts.draw(4);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
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
    for (let i = 0; i < this.bodies; ++i) see(Array.from(this.run.poses.subarray(8 * i, 8 * i + 3)), this.reaches[i] + 0.02 / lens.scale);
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
      const p = Array.from(this.run.poses.subarray(8 * i, 8 * i + 3)),
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
}
