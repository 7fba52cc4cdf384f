// A run in space: where its bodies are, what stands there besides them, how it is seen. It is drawn in light and shadow
// (lit.js), or sketched where that takes too long (sketch.js).

import { Ground } from "./ground.js";
import { Lens, clamp, cross, dot, plus, sub, turned, unit } from "./lens.js";
import { Lit } from "./lit.js";
import { Hanging } from "./pen.js";
import { meets_ball, meets_flat } from "./pick.js";
import { Sketch } from "./sketch.js";

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
const FAINTEST = 0.22; // of a path's oldest end: draw/compose/annotations.cpp
const END_ON = 7,
  NARROW = 0.3; // of coils: draw/space/links.cpp

/**
 * Who draws what stands in space besides the bodies; colours up to 255, inks up to 1, widths in page units.
 * @typedef {{
 *   tube(way: number[][], radius: number, color: number[]): void,
 *   coil(a: number[], b: number[], turns: number, radius: number, by: number, color: number[]): void,
 *   ball(at: number[], radius: number, color: number[]): void,
 *   flat(shape: {vertices: number[], faces: number[][], normals: number[]}, color: number[]): void,
 *   line(a: number[], b: number[], width: number, ink: number[]): void,
 *   trail(nodes: {at: number[], width: number, ink: number[]}[], front: boolean): void,
 * }} Besides
 */

/** One run in space. */
export class Space {
  /**
   * @param {any} film
   * @param {number} run which of the film's
   * @param {import("./reel.js").Reel} reel
   * @param {() => import("./card.js").Card | null} card none: this browser has no WebGL
   * @param {import("./lens.js").Orbit} view
   */
  constructor(film, run, reel, card, view) {
    this.film = film;
    this.run = run;
    this.space = film.spaces[run];
    this.reel = reel;
    this.dark = film.theme === "screen";
    this.view = view;
    this.ground = new Ground(this.space, this.dark, film.ground);
    this.things = reel.things.filter((each) => each.space > 0 && each.part === run);
    this.bodies = this.space.colors.length;
    /** Of each body its place and, from the fifth number on, how it is turned. */
    this.poses = new Float32Array(8 * this.bodies);
    this.card = card;
    /** @type {Lit | null | undefined} */
    this.light = undefined;
  }

  /** Who draws it in light, if this browser can. */
  get lit() {
    if (this.light === undefined) {
      const card = this.card();
      this.light = card && new Lit(this, card);
    }
    return this.light;
  }

  /** Where bodies are in a frame. */
  pose(frame) {
    const { reel, space, poses } = this,
      at = (/** @type {number} */ i) => reel.numbers[i].at(frame);
    for (let i = 0; i < this.bodies; ++i) {
      const q = [0, 1, 2, 3].map((k) => at(space.turns + 4 * i + k)),
        l = Math.hypot(...q);
      for (let k = 0; k < 3; ++k) poses[8 * i + k] = at(space.places + 3 * i + k);
      for (let k = 0; k < 4; ++k) poses[8 * i + 4 + k] = q[k] / l;
    }
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

  /** The panel at a place of the page, or the first. */
  panel_at(x, y) {
    const { panels } = this.space;
    return panels.find((/** @type {any} */ each) => within(each.window, [x, y])) ?? panels[0];
  }

  /** Whether a place of the page is in one of its panels. */
  holds(x, y) {
    return this.space.panels.some((/** @type {any} */ each) => within(each.window, [x, y]));
  }

  /** Where the film sees what the panel at a place of the page looks at. */
  middle_at(x, y, frame) {
    return Lens.of(this.panel_at(x, y), this.reel.numbers, frame).middle;
  }

  /** The film's lens in the panel of a thing of the page. */
  lens_of(thing, frame) {
    // a panel's things are clipped to it
    const [x, y, width, height] = this.reel.clips[thing.clip] ?? [0, 0, 0, 0];
    return Lens.of(this.panel_at(x + width / 2, y + height / 2), this.reel.numbers, frame);
  }

  /** The nodes of a line or a polygon that hangs by them, on the page; none where one is behind the eye. */
  through(thing, frame) {
    const lens = this.view.see(this.lens_of(thing, frame)),
      places = thing.places(thing.numbers(frame, []));
    if (places.some((/** @type {number[]} */ p) => lens.depth(p) < 1e-2)) return null;
    return places.flatMap((/** @type {number[]} */ p) => lens.page(p));
  }

  /** How a thing of the page that hangs in space is moved by the view; none where it does not, or is behind the eye. */
  hanging(thing, frame) {
    if (!thing.hang) return null;
    const film = this.lens_of(thing, frame),
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
   * @param {boolean} sketched without light and shadow, for a picture that does not stay
   */
  draw(context, frame, sketched) {
    const scale = context.canvas.height / 1080,
      { space } = this,
      lit = sketched ? null : this.lit;
    this.pose(frame);
    const lenses = this.lenses(frame);
    lit?.begin(context.canvas);
    lenses.forEach((lens, i) => {
      const { fitted } = space.panels[i];
      if (!lit) {
        this.ground.sketch(context, lens, i, scale, fitted);
        new Sketch(this, context, lens).draw(frame, scale, i);
      } else {
        this.ground.draw(context, lens, i, scale, fitted, (/** @type {number} */ body) => this.body(body));
        lit.panel(lens, frame, scale, i);
      }
    });
    lit?.end(context);
    for (const lens of lenses) this.ground.room(context, lens, scale, false);
  }

  /**
   * Springs, rods, ropes, knobs, plates, lines, drop-lines and trails of a panel.
   * @param {Lens} lens
   * @param {number} frame
   * @param {number} panel
   * @param {Besides} to
   */
  besides(lens, frame, panel, to) {
    const whole = Math.floor(frame),
      { colors } = this.reel,
      n = [];
    for (const thing of this.things) {
      if (!thing.lives_at(whole)) continue;
      thing.numbers(frame, n);
      const color = thing.space !== PLATE && thing.space !== WAY ? colors[thing.step(0, frame)] : [];
      if (thing.space === TUBE) {
        const way = [];
        for (let i = 0; i < thing.nodes; ++i) way.push(n.slice(3 * i, 3 * i + 3));
        const radius = n[3 * thing.nodes];
        if (thing.turns > 0) {
          const [a, b] = way,
            pa = lens.page(a),
            pb = lens.page(b),
            wide = n[3 * thing.nodes + 1];
          const seen = Math.hypot(pb[0] - pa[0], pb[1] - pa[1]);
          const by = ((wide * clamp(seen / (END_ON * wide), NARROW, 1)) / lens.scale) * this.view.zoom;
          to.coil(a, b, thing.turns, radius, by, color);
        } else {
          to.tube(way, radius, color);
        }
      } else if (thing.space === BALL) {
        to.ball(n.slice(0, 3), n[3], color);
      } else if (thing.space === PLATE) {
        this.plate(n, to);
      } else if (thing.space === WAY) {
        this.trail(thing, n, lens, to);
      } else if (thing.space === LINE && thing.index === panel) {
        const width = 2 * n[3 * thing.nodes],
          ink = color.map((/** @type {number} */ c) => c / 255);
        for (let i = 0; i + 1 < thing.nodes; ++i) to.line(n.slice(3 * i, 3 * i + 3), n.slice(3 * i + 3, 3 * i + 6), width, ink);
      }
    }
    if (this.space.drops && this.space.ground) this.drops(lens, to);
  }

  /** Dashes from each body that flies to the ground under it, and a cross there (draw/space/lines.cpp). */
  drops(lens, to) {
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
      // dashes are counted from the ground, so that they do not run along it; their ends are round here
      const p = lens.page(foot),
        q = lens.page(at),
        length = Math.hypot(q[0] - p[0], q[1] - p[1]),
        width = DROP * weight;
      const along = (/** @type {number} */ l) => unproject(lens, foot, at, l / length);
      for (let l = 0; l < length; l += (DROP_DASH + DROP_GAP) * weight) {
        const end = Math.min(l + DROP_DASH * weight, length);
        if (end - l > width) to.line(along(l + width / 2), along(end - width / 2), width, color);
      }
      const arm = (DROP_FOOT * weight * lens.depth(foot)) / lens.scale;
      for (const way of [side, ahead]) to.line(plus(foot, way, -arm), plus(foot, way, arm), 1.3 * width, color);
    }
  }

  plate(numbers, to) {
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
    to.flat({ vertices: corners.flat(), faces, normals }, own);
    const ink = edge.map((/** @type {number} */ c) => c / 255),
      width = 1.3 * EDGE * this.space.weight;
    for (let a = 0; a < 8; ++a) for (const k of [1, 2, 4]) if (!(a & k)) to.line(corners[a], corners[a | k], width, ink);
  }

  trail(thing, numbers, lens, to) {
    const [hx, hy, hz, now, widest] = numbers;
    const [lasting, strong, faint] = thing.trail,
      { places, times } = thing.way,
      { colors } = this.reel;
    const node = (/** @type {number[]} */ at, /** @type {number} */ time) => {
      const s = lasting > 0 ? clamp(1 - (now - time) / lasting, 0, 1) : 1,
        k = thing.path ? FAINTEST + (1 - FAINTEST) * s : s ** 1.3;
      const width = widest * clamp(1 / Math.max(lens.depth(at), 1e-3), 0.3, 1.6) * (thing.path ? 0.4 + 0.6 * k : 0.25 + 0.75 * s);
      return { at, width, ink: [0, 1, 2].map((i) => (colors[faint][i] + k * (colors[strong][i] - colors[faint][i])) / 255).concat(1) };
    };
    const nodes = [];
    for (let i = 0; i < times.length && times[i] < now - 1e-9; ++i) {
      const at = places.slice(3 * i, 3 * i + 3);
      if (!(lasting > 0) || times[i] > now - lasting) nodes.push(node(at, times[i]));
    }
    nodes.push(node([hx, hy, hz], now));
    to.trail(nodes, thing.front);
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
