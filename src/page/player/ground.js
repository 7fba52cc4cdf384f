// The ground and the room in space (draw/space/ground.cpp): a pool of light, a grid, what darkens the ground under bodies, and
// the hairlines of the room.

import { draw_contacts } from "./contact.js";
import { clamp, cross, dot, plus, sub, unit } from "./lens.js";

const POOL = 0.62,
  POOL_ROW = 4,
  POOL_COLUMNS = 48,
  POOL_INK = [0x6a, 0x7c, 0x8e, 0x80];
const TILE = 105,
  FROM = 0.35,
  TO = 1.25,
  PIECES = 28,
  FEW = 7,
  GRID = 1.5,
  FRAME = 1.8;

/** The part of the picture that a panel fills, in whole px. */
/** @returns {[number, number, number, number]} */
export function window_of(lens, scale) {
  const [x, y, width, height] = lens.window,
    left = Math.floor(x * scale + 1e-6),
    top = Math.floor(y * scale + 1e-6);
  return [left, top, Math.ceil((x + width) * scale - 1e-6) - left, Math.ceil((y + height) * scale - 1e-6) - top];
}

/** From here on in page units, within a panel; until restore(). */
export function clip_to_panel(c, lens, scale) {
  c.save();
  c.setTransform(1, 0, 0, 1, 0, 0);
  c.beginPath();
  c.rect(...window_of(lens, scale));
  c.clip();
  c.setTransform(scale, 0, 0, scale, 0, 0);
}

/** Whether one sees the ground from above. */
export function above_ground(ground, lens) {
  if (!ground) return false;
  return dot(ground.normal, lens.per_distance > 1e-9 ? sub(lens.eye, ground.point) : lens.back) > 0;
}

export class Ground {
  /** @param {any} space @param {boolean} dark @param {number[]} color the page's */
  constructor(space, dark, color) {
    this.color = color;
    this.space = space;
    this.dark = dark;
    /** @type {Map<number, {key: string, picture: HTMLCanvasElement}>} */
    this.grids = new Map();
  }

  /** The ground's grid, the room's hairlines behind all, and what darkens the ground under bodies. */
  draw(context, lens, i, scale, fitted, body_of) {
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.kept(context.canvas, lens, i, scale, fitted), 0, 0);
    if (!above_ground(this.space.ground, lens)) return;
    clip_to_panel(context, lens, scale);
    draw_contacts(context, this.space, lens, body_of, this.dark);
    context.restore();
  }

  /** The same without contacts; where one looks from elsewhere than before, in few pieces. */
  sketch(context, lens, i, scale, fitted) {
    if (this.grids.get(i)?.key === `${lens.key} ${scale}`) {
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.drawImage(this.kept(context.canvas, lens, i, scale, fitted), 0, 0);
      return;
    }
    if (above_ground(this.space.ground, lens) && this.space.ground.grid) {
      this.grid(context, lens, scale, fitted, FEW);
      if (this.dark) this.pool(context, lens, scale);
    }
    this.room(context, lens, scale, true);
  }

  /** What is behind all, kept as long as one looks from one place. */
  kept(like, lens, i, scale, fitted) {
    const key = `${lens.key} ${scale}`,
      known = this.grids.get(i);
    if (known?.key === key) return known.picture;
    const picture = known?.picture ?? document.createElement("canvas"),
      c = this.clear(picture, like, lens, scale);
    if (above_ground(this.space.ground, lens) && this.space.ground.grid) {
      this.grid(c, lens, scale, fitted, PIECES);
      if (this.dark) this.pool(c, lens, scale);
    }
    this.room(c, lens, scale, true);
    this.grids.set(i, { key, picture });
    return picture;
  }

  /** A panel's part of a canvas in the page's colour. */
  clear(picture, like, lens, scale) {
    picture.width = like.width;
    picture.height = like.height;
    const c = /** @type {CanvasRenderingContext2D} */ (picture.getContext("2d"));
    c.fillStyle = `rgb(${this.color.join(",")})`;
    c.fillRect(...window_of(lens, scale));
    return c;
  }

  /** A pool of light around what is looked at, on the dark theme, over the grid. */
  pool(c, lens, scale) {
    const { normal, point } = this.space.ground,
      [left, top, width, height] = lens.window;
    const foot = plus(lens.target, normal, -dot(sub(lens.target, point), normal)),
      radius = (POOL * width) / lens.scale;
    const rows = Math.ceil(height / POOL_ROW),
      step = width / POOL_COLUMNS,
      columns = POOL_COLUMNS + 1;
    const image = new ImageData(columns, rows);
    for (let k = 0; k < columns * rows; ++k) {
      const { from, way } = lens.ray(left + (k % columns) * step, top + (Math.floor(k / columns) + 0.5) * POOL_ROW);
      const fall = dot(way, normal);
      if (!(fall < -1e-6)) continue;
      const at = plus(from, way, -dot(sub(from, point), normal) / fall),
        strength = 1 - smooth_step(Math.hypot(...sub(at, foot)) / radius);
      image.data.set([POOL_INK[0], POOL_INK[1], POOL_INK[2], Math.round(POOL_INK[3] * strength)], 4 * k);
    }
    const small = document.createElement("canvas");
    small.width = columns;
    small.height = rows;
    /** @type {CanvasRenderingContext2D} */ (small.getContext("2d")).putImageData(image, 0, 0);
    clip_to_panel(c, lens, scale);
    c.drawImage(small, left - step / 2, top, columns * step, rows * POOL_ROW);
    c.restore();
  }

  /** The colour of a line that stands off the pool of light over it as it does off the ground elsewhere. */
  under_pool(ink, strength) {
    const k = 1 / (1 - (strength * POOL_INK[3]) / 255);
    return this.color.map((g, i) => Math.round(clamp(g + k * (ink[i] - g), 0, 255)));
  }

  /** Lines on the ground, each in so many pieces of one strength. */
  grid(c, lens, scale, fitted, pieces) {
    const { ground, weight } = this.space,
      n = ground.normal,
      shown = lens.window[2] / lens.scale;
    const tile = ground.tile > 0 ? ground.tile : nice((TILE * weight) / fitted);
    let u = plus([1, 0, 0], n, -n[0]);
    if (Math.hypot(...u) < 0.1) u = plus([0, 0, 1], n, -n[2]);
    u = unit(u);
    const v = cross(u, n),
      origin = plus([0, 0, 0], n, dot(n, ground.point));
    const foot = plus(lens.target, n, -dot(sub(lens.target, ground.point), n));
    const x = dot(sub(foot, origin), u),
      y = dot(sub(foot, origin), v);
    /** @type {number[][]} */
    const loop = [];
    for (let i = 0; ground.loop && i < ground.loop.length; i += 3) loop.push(ground.loop.slice(i, i + 3));
    const radius = loop.length ? Math.max(...loop.map((p) => Math.hypot(...sub(p, foot)))) : TO * shown;
    const last = Math.min(Math.ceil(radius / tile), 400),
      ink = this.dark ? [0x50, 0x5d, 0x6a] : [0xc6, 0xcb, 0xd1];
    clip_to_panel(c, lens, scale);
    c.lineWidth = GRID * weight;
    c.lineCap = "butt";
    for (const [along, across, here, there] of /** @type {[number[], number[], number, number][]} */ ([
      [u, v, y, x],
      [v, u, x, y],
    ])) {
      const middle = Math.round(here / tile);
      for (let k = middle - last; k <= middle + last; ++k) {
        const off = k * tile - here;
        if (Math.abs(off) > radius) continue;
        const start = plus(plus(origin, across, k * tile), along, there),
          half = Math.sqrt(Math.max(radius * radius - off * off, 0));
        const part = loop.length ? clip(loop, plus([0, 0, 0], n, -1), start, along, -half, half) : [-half, half];
        if (!part) continue;
        /** @type {{p: number[], s: number} | null} */
        let before = null;
        for (let i = 0; i <= pieces; ++i) {
          const t = part[0] + ((part[1] - part[0]) * i) / pieces,
            at = plus(start, along, t);
          if (lens.depth(at) < 0.05) {
            before = null;
            continue;
          }
          const r = Math.hypot(off, t) / shown;
          const now = {
            p: lens.page(at),
            s: loop.length ? 1 : 1 - smooth_step((r - FROM) / (TO - FROM)),
            pool: this.dark ? 1 - smooth_step(r / POOL) : 0,
          };
          if (before && before.s + now.s > 0.01) {
            const own = this.under_pool(ink, (before.pool + now.pool) / 2);
            c.strokeStyle = `rgba(${own.join(",")},${(before.s + now.s) / 2})`;
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
    clip_to_panel(c, lens, scale);
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
      let p = at(a),
        q = at(b);
      const dp = lens.depth(p),
        dq = lens.depth(q),
        near = 0.02;
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
}

/** From 0 to 1 with level ends. */
function smooth_step(u) {
  const q = clamp(u, 0, 1);
  return q * q * (3 - 2 * q);
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
    const side = sub(loop[(i + 1) % loop.length], loop[i]),
      inwards = cross(normal, side);
    const height = dot(inwards, sub(a, loop[i])),
      rise = dot(inwards, d);
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
