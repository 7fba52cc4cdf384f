// Space sketched on the canvas alone, body by body from the farthest on: what a page shows while the picture moves where the
// whole one takes too long, and where a browser has no WebGL. Bodies and lines are where they are in light; the shadows
// of bodies on each other are one tone a face, and the ground's are hard.

import { hull } from "./contact.js";
import { helix } from "./forms.js";
import { above_ground, clip_to_panel } from "./ground.js";
import { clamp, dot, plus, sub, turned } from "./lens.js";
import { inside_planes } from "./pick.js";

const WIDEST = 2.3,
  THINNEST = 0.5,
  PART = 0.22, // widths of edges: draw/space/edges.cpp
  ALIKE = 0.92; // cosine: faces so much alike have none between them
const ITEMS = 300; // items: more are put in order by their middles alone
const TOUCH = 1e-3; // of a body's size: so far two that touch may be within each other
const SHADES = 12; // of a trail
const SHADOWS = 60; // bodies' pieces: of more, none shades another
const MEANS = [1, 1, 0.96, 0.78]; // of the patterns of wood and checks: shaders.js

/**
 * What is drawn in one go: a convex body's piece, or a line.
 * @typedef {{
 *   middle: number[], size: number, near: number, box: number[],
 *   corners: number[][], radius: number, planes: {n: number[], d: number, front: boolean}[],
 *   draw: () => void,
 * }} Item
 */

/** A panel of one run in an instant. */
export class Sketch {
  /**
   * @param {import("./space.js").Space} run
   * @param {CanvasRenderingContext2D} c
   * @param {import("./lens.js").Lens} lens
   */
  constructor(run, c, lens) {
    this.run = run;
    this.space = run.space;
    this.dark = run.dark;
    this.c = c;
    this.lens = lens;
    /** @type {Item[]} */
    this.items = [];
    /** @type {Item[]} those of bodies */
    this.solids = [];
    /** @type {{at: number[], width: number, ink: number[]}[][]} trails over the bodies */
    this.fronts = [];
  }

  /**
   * Draws it over its ground.
   * @param {number} frame
   * @param {number} scale px a page unit
   * @param {number} number the panel's
   */
  draw(frame, scale, number) {
    const { run, space, c, lens } = this;
    clip_to_panel(c, lens, scale);
    c.lineJoin = "round";
    c.lineCap = "round";
    for (const piece of space.pieces) this.piece(piece);
    this.solids = this.items.slice();
    if (above_ground(space.ground, lens)) this.shadow();
    run.besides(lens, frame, number, this);
    for (const item of ordered(this.items, lens)) item.draw();
    for (const nodes of this.fronts) this.way(nodes);
    c.restore();
  }

  /** Towards the eye. */
  sight(at) {
    const { lens } = this;
    return lens.per_distance > 1e-9 ? sub(lens.eye, at) : lens.back;
  }

  /** How wide a body's edges are. */
  edge(least, depth) {
    const { weight } = this.space;
    return clamp((PART * least * this.lens.scale) / depth, THINNEST * weight, WIDEST * weight);
  }

  /**
   * A colour in light, by the way its surface looks (shaders.js: tone), of which a part is in the sun, in the mean of its
   * material's pattern.
   */
  tone(color, n, reached = 1, material = 0) {
    const { toward, across } = this.space,
      darkest = this.dark ? [8, 12, 18] : [24, 28, 34];
    const sun = Math.max(0, dot(n, toward)),
      base = 0.15 + (0.13 * (1 + n[1])) / 2 + (0.26 * (1 + dot(n, across))) / 2,
      s = clamp(base + (0.06 + 0.52 * reached) * sun, 0, 1),
      mean = MEANS[material] ?? 1;
    const [part, inked, own, white] = this.dark ? [0.36, 0.1, 0.72, 0.26] : [0.44, 0.08, 0.67, 0.3],
      most = Math.max(color[0], color[1], color[2], 1);
    return `rgb(${color.slice(0, 3).map((/** @type {number} */ x, /** @type {number} */ k) => {
      const deep = part * x * Math.sqrt(x / most),
        low = deep + inked * (darkest[k] - deep);
      return Math.round(
        mean * (s < own ? low + (s / own) * (x - low) : x + ((white * (s - own)) / (1 - own)) * (255 - x)),
      );
    })})`;
  }

  /** How much of a face the sun reaches: from its middle and towards its corners. */
  reached(loop, own) {
    if (this.solids.length > SHADOWS) return 1;
    const middle = [0, 0, 0];
    for (const p of loop) for (let k = 0; k < 3; ++k) middle[k] += p[k] / loop.length;
    const from = loop.map((/** @type {number[]} */ p) => plus(middle, sub(p, middle), 0.6)).concat([middle]);
    const free = from.filter(
      (/** @type {number[]} */ p) => !this.solids.some((each) => each !== own && shades(each, p, this.space.toward)),
    );
    return free.length / from.length;
  }

  /**
   * @param {number[][]} places in space
   * @param {number} radius m around them
   * @param {Item["planes"]} planes
   * @param {() => void} draw
   * @returns {Item | undefined} none where it is behind the eye
   */
  item(places, radius, planes, draw) {
    const { lens } = this,
      middle = [0, 0, 0],
      box = [Infinity, Infinity, -Infinity, -Infinity];
    for (const p of places) {
      const depth = lens.depth(p);
      if (depth < 0.02) return undefined;
      const [x, y] = lens.page(p),
        r = (radius * lens.scale) / depth;
      box[0] = Math.min(box[0], x - r);
      box[1] = Math.min(box[1], y - r);
      box[2] = Math.max(box[2], x + r);
      box[3] = Math.max(box[3], y + r);
      for (let k = 0; k < 3; ++k) middle[k] += p[k] / places.length;
    }
    const size = radius + Math.max(...places.map((p) => Math.hypot(...sub(p, middle))));
    const item = { middle, size, near: dot(sub(middle, lens.target), lens.back), box, corners: places, radius, planes, draw };
    this.items.push(item);
    return item;
  }

  piece(piece) {
    const { space } = this,
      { at, turn } = this.run.body(piece.body),
      own = space.colors[piece.body],
      [ink, crease] = [space.edges, space.creases].map((of) => `rgb(${of[piece.body].slice(0, 3).join(",")})`);
    const place = (/** @type {number[]} */ p) => plus(at, turned(turn, p));
    if (piece.shape === undefined) return this.round(place(piece.a), place(piece.b), piece, own, ink);
    const shape = space.shapes[piece.shape],
      corners = [];
    for (let i = 0; i < shape.vertices.length; i += 3) corners.push(place(shape.vertices.slice(i, i + 3)));
    this.faces(corners, shape, (f) => turned(turn, shape.normals.slice(3 * f, 3 * f + 3)), own, {
      ink,
      crease,
      least: piece.least,
      material: space.materials?.[piece.body] ?? 0,
    });
  }

  /**
   * A polyhedron: its faces that look at the eye, and its edges there.
   * @param {number[][]} corners
   * @param {{faces: number[][], edges?: number[]}} shape
   * @param {(face: number) => number[]} normal_of
   * @param {number[]} own
   * @param {{ink: string, crease: string, least: number, material: number} | null} body none: a thing without edges and shadows
   */
  faces(corners, { faces, edges = [] }, normal_of, own, body) {
    const planes = faces.map((loop, f) => {
      const n = normal_of(f),
        p = corners[loop[0]];
      return { n, d: dot(n, p), front: dot(n, this.sight(p)) > 0 };
    });
    const item = this.item(corners, 0, planes, () => {
      const { c, lens } = this,
        at = corners.map((p) => lens.page(p));
      faces.forEach((loop, f) => {
        if (!planes[f].front) return;
        const sunny = body && dot(planes[f].n, this.space.toward) > 0,
          places = loop.map((i) => corners[i]);
        c.beginPath();
        for (const i of loop) c.lineTo(...at[i]);
        c.closePath();
        c.strokeStyle = c.fillStyle = this.tone(own, planes[f].n, sunny ? this.reached(places, item) : 1, body?.material);
        c.fill();
        // no seam between two
        c.lineWidth = 0.5;
        c.stroke();
      });
      if (!body) return;
      c.lineWidth = this.edge(body.least, lens.depth(corners[0]));
      // outlines lie over the ends of creases
      for (const crease of [true, false]) {
        c.beginPath();
        for (let i = 0; i < edges.length; i += 4) {
          const [a, b, left, right] = edges.slice(i, i + 4),
            one = planes[left].front,
            two = right >= 0 && planes[right].front;
          if (crease ? !one || !two || dot(planes[left].n, planes[right].n) > ALIKE : one === two) continue;
          c.moveTo(...at[a]);
          c.lineTo(...at[b]);
        }
        c.strokeStyle = crease ? body.crease : body.ink;
        c.stroke();
      }
    });
  }

  /** A ball, or a capsule. */
  round(a, b, piece, own, ink) {
    const { lens } = this,
      radius = piece.dot
        ? (piece.dot * lens.depth(a)) / lens.scale
        : Math.max(piece.radius, (1.6 * this.space.weight * lens.depth(a)) / lens.scale);
    this.item([a, b], radius, [], () => this.disc(a, radius, own, ink, b));
  }

  /** A ball, or with another end a capsule; `ink`: of its rim. */
  disc(a, radius, own, ink, b = a) {
    const { c, lens } = this,
      depth = lens.depth(a),
      r = (radius * lens.scale) / depth,
      [x, y] = lens.page(a);
    // on a ball: where light falls, and beside it
    const { toward } = this.space,
      way = [dot(toward, lens.right), -dot(toward, lens.up)];
    const back = this.sight(a),
      l = Math.hypot(...back),
      to_eye = back.map((v) => v / l);
    const rim = (/** @type {number} */ side) => {
      const n = plus(plus([0, 0, 0], lens.right, side * way[0]), lens.up, -side * way[1]);
      return this.tone(own, plus([0, 0, 0], n, 1 / Math.max(Math.hypot(...n), 1e-9)));
    };
    const width = ink && r >= 2.2 ? 1.3 * clamp(PART * r, THINNEST * this.space.weight, WIDEST * this.space.weight) : 0;
    const [p, q] = [x + way[0] * r, y + way[1] * r],
      light = c.createLinearGradient(2 * x - p, 2 * y - q, p, q);
    light.addColorStop(0, rim(-1));
    light.addColorStop(0.5, this.tone(own, to_eye));
    light.addColorStop(1, rim(1));
    if (Math.hypot(...sub(b, a)) > 0) {
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(...lens.page(b));
      if (width > 0) {
        c.lineWidth = 2 * r;
        c.strokeStyle = String(ink);
        c.stroke();
      }
      c.lineWidth = 2 * (r - width);
      c.strokeStyle = this.tone(own, to_eye);
      c.stroke();
      return;
    }
    c.beginPath();
    c.arc(x, y, Math.max(r - width / 2, 0.1), 0, 2 * Math.PI);
    c.fillStyle = light;
    c.fill();
    if (!(width > 0)) return;
    c.lineWidth = width;
    c.strokeStyle = String(ink);
    c.stroke();
  }

  /** The ground's shadow: of each body, where the middle of the light does not reach. */
  shadow() {
    const { c, lens, space } = this,
      { normal, point } = space.ground,
      rise = dot(space.toward, normal);
    if (!(rise > 0.05)) return;
    c.beginPath();
    for (const { corners, radius } of this.items) {
      const rims = [];
      for (const p of corners) {
        const high = Math.max(dot(sub(p, point), normal), 0),
          foot = plus(p, space.toward, -high / rise);
        if (lens.depth(foot) < 0.05) continue;
        const [x, y] = lens.page(foot);
        if (radius > 0) {
          const r = (radius * lens.scale) / lens.depth(foot),
            flat = clamp(dot(lens.back, normal), 0.2, 1);
          for (let k = 0; k < 12; ++k) rims.push([x + r * Math.cos((k * Math.PI) / 6), y + r * flat * Math.sin((k * Math.PI) / 6)]);
        } else {
          rims.push([x, y]);
        }
      }
      if (rims.length < 3) continue;
      hull(rims).forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
      c.closePath();
    }
    c.fillStyle = this.dark ? `rgba(0,0,0,${148 / 255})` : `rgba(20,26,36,${62 / 255})`;
    c.fill();
  }

  // what stands in space besides the bodies: see Besides in space.js

  tube(way, radius, color) {
    // piece by piece, so that each is before or behind what it passes
    for (let i = 0; i + 1 < way.length; ++i) {
      const [a, b] = [way[i], way[i + 1]];
      this.item([a, b], radius, [], () => this.wire([a, b], radius, color));
    }
  }

  coil(a, b, turns, radius, by, color) {
    const way = helix(a, b, turns, radius, by),
      each = Math.max(2, Math.ceil(way.length / 12));
    for (let i = 0; i + 1 < way.length; i += each - 1) {
      const part = way.slice(i, i + each);
      this.item(part, radius, [], () => this.wire(part, radius, color));
    }
  }

  wire(way, radius, color) {
    const { c, lens } = this,
      [a, b] = [way[0], way[way.length - 1]],
      along = sub(b, a),
      back = this.sight(a);
    // the side of it that the eye sees
    const out = plus(back, along, -dot(back, along) / Math.max(dot(along, along), 1e-12)),
      l = Math.hypot(...out);
    c.beginPath();
    for (const p of way) c.lineTo(...lens.page(p));
    c.lineWidth = Math.max((2 * radius * lens.scale) / lens.depth(a), 1);
    c.strokeStyle = this.tone(color, l > 0 ? out.map((x) => x / l) : lens.back);
    c.stroke();
  }

  ball(at, radius, color) {
    this.item([at], radius, [], () => this.disc(at, radius, color, ""));
  }

  flat(shape, color) {
    const corners = [];
    for (let i = 0; i < shape.vertices.length; i += 3) corners.push(shape.vertices.slice(i, i + 3));
    this.faces(corners, shape, (f) => shape.normals.slice(3 * f, 3 * f + 3), color, null);
  }

  line(a, b, width, ink) {
    this.item([a, b], 0, [], () => {
      const { c, lens } = this;
      c.beginPath();
      c.moveTo(...lens.page(a));
      c.lineTo(...lens.page(b));
      c.lineWidth = width;
      c.strokeStyle = rgba(ink);
      c.stroke();
    });
  }

  /** Before all bodies, or behind them. */
  trail(nodes, front) {
    if (front) this.fronts.push(nodes);
    else this.way(nodes);
  }

  way(nodes) {
    const { c, lens } = this,
      each = Math.max(1, Math.ceil(nodes.length / SHADES));
    for (let i = 0; i + 1 < nodes.length; i += each) {
      const part = nodes.slice(i, i + each + 1).filter((/** @type {any} */ node) => lens.depth(node.at) > 0.02);
      if (part.length < 2) continue;
      const { width, ink } = part[part.length >> 1];
      c.beginPath();
      for (const node of part) c.lineTo(...lens.page(node.at));
      c.lineWidth = width;
      c.strokeStyle = rgba(ink);
      c.stroke();
    }
    c.globalCompositeOperation = "source-over";
  }
}

const rgba = ([r, g, b, a = 1]) => `rgba(${Math.round(255 * r)},${Math.round(255 * g)},${Math.round(255 * b)},${a})`;

/**
 * Items from the farthest on. Where two cover each other on the page and a face of one parts them, that tells which is
 * behind; else the middle that is farther.
 * @param {Item[]} items
 * @param {import("./lens.js").Lens} lens
 */
function ordered(items, lens) {
  const far = items.slice().sort((a, b) => a.near - b.near);
  if (far.length > ITEMS) return far;
  const left = new Set(far),
    out = [];
  const put = (/** @type {Item} */ item, /** @type {Set<Item>} */ above) => {
    if (!left.has(item) || above.has(item)) return;
    above.add(item);
    for (const other of far)
      if (left.has(other) && other !== item && meet(item.box, other.box) && hidden(other, item, lens)) put(other, above);
    above.delete(item);
    if (left.delete(item)) out.push(item);
  };
  for (const item of far) put(item, new Set());
  return out;
}

/** Whether an item lies on the way from a place to the sun. */
function shades(item, from, toward) {
  const far = sub(item.middle, from),
    along = dot(far, toward);
  if (along < -item.size || dot(far, far) - along * along > item.size * item.size) return false;
  if (item.planes.length === 0) {
    const off = Math.min(
      ...item.corners.map((/** @type {number[]} */ p) => {
        const way = sub(p, from),
          l = dot(way, toward);
        return l > 0 ? Math.sqrt(Math.max(dot(way, way) - l * l, 0)) : Infinity;
      }),
    );
    return off < item.radius;
  }
  const [enters, leaves] = inside_planes(item.planes, from, toward);
  return Math.max(enters, 1e-3 * item.size) < leaves;
}

const meet = (/** @type {number[]} */ a, /** @type {number[]} */ b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];

/** Whether the first of two items is behind the second. Parted both ways, neither hides the other. */
const hidden = (/** @type {Item} */ first, /** @type {Item} */ second, lens) => behind(first, second, lens) && !behind(second, first, lens);

/** Whether a face parts two items so that the first is behind the second. */
function behind(first, second, lens) {
  const near = TOUCH * Math.min(first.size, second.size);
  const beyond = (/** @type {Item} */ item, /** @type {{n: number[], d: number}} */ plane) =>
    item.corners.every((p) => dot(plane.n, p) - plane.d >= item.radius - near);
  return (
    second.planes.some((plane) => !plane.front && beyond(first, plane)) ||
    first.planes.some((plane) => plane.front && beyond(second, plane)) ||
    (first.planes.length + second.planes.length === 0 && first.radius * second.radius > 0 && ahead(first, second, lens))
  );
}

/** Whether the second of two rounds is nearer to the eye. */
function ahead(first, second, lens) {
  return (
    Math.max(...second.corners.map((p) => dot(sub(p, lens.target), lens.back))) >
    Math.max(...first.corners.map((p) => dot(sub(p, lens.target), lens.back)))
  );
}
