// The things of a film's pictures, as Reel wrote them (page/reel.h), and what each is in a frame.

import { Numbers } from "./bytes.js";
import { Course, Steps } from "./keys.js";

export const PAGE = 0,
  CHART = 1,
  LAYER = 2,
  BODY = 3,
  SPRING = 4,
  JOINT = 5,
  TRAIL = 6;
export const DISC = 0,
  BOX = 1,
  STROKE = 2,
  POLYGON = 3,
  TEXT = 4;
export const NUMBERS = 0,
  RIGID = 1,
  GROWN = 2,
  LOOSE = 3;
const POINT = 64,
  LOOSE_STEPS = 16;

/**
 * @typedef {{from: number, to: number, courses: Course[], steps: Steps[], frames: Loose[]}} Life
 * @typedef {{widths: number[], colors: number[], points: Float32Array}} Loose
 * @typedef {{points: Float32Array, widths?: Float32Array, colors?: number[], times?: Float64Array, cusps?: boolean[]}} Outline
 */

/** A thing of the picture through the film. */
export class Thing {
  /**
   * @param {any} json
   * @param {number} frames of the film
   * @param {any} streams
   */
  constructor(json, frames, streams) {
    const [what, index, part] = json.of;
    this.what = what;
    this.index = index;
    this.part = part;
    this.kind = json.kind;
    this.clip = json.clip ?? -1;
    this.form = json.form ?? NUMBERS;
    this.still = json.still === 1;
    // of so many places of space, at which it hangs: the last of its numbers
    this.hang = json.hang ?? 0;
    // which are its nodes
    this.through = json.through === 1;
    // words that keep to whole pixels
    this.whole = json.whole === 1;
    const style = json.style ?? 0;
    this.closed = (style & 1) !== 0;
    this.round = (style & 2) !== 0;
    this.blend = style >> 2;
    this.turns = json.turns ?? 0;
    this.trail = json.trail;
    // what stands in space: a tube of so many nodes, a ball, a plate, a trail
    this.space = json.space ?? 0;
    this.nodes = json.nodes ?? 0;
    // a path of an annotation, and whether it is over the bodies
    this.path = json.path !== undefined;
    this.front = json.path === 2;
    /** @type {{places: number[], times: number[]}} */
    this.way = { places: [], times: [] };
    // between two frames only that is drawn which is the same thing in both
    this.steady = this.still || this.what >= BODY || this.space > 0;
    /** @type {Outline} */
    this.outline = this.space === 4 ? this.read_way(json, streams.points) : this.read_outline(json, streams.points);
    const lives = json.lives ?? [0, frames];
    /** @type {Life[]} */
    this.lives = [];
    for (let i = 0; i < lives.length; i += 2) this.lives.push({ from: lives[i], to: lives[i + 1], courses: [], steps: [], frames: [] });
    if (this.form === LOOSE) this.read_frames(streams.loose);
    else for (const life of this.lives) this.read_life(life, json.bounds, streams);
    /** @type {Life | null} */
    this.life = null;
  }

  /** @returns {Outline} */
  read_outline(json, stream) {
    const n = json.points ?? 0,
      points = new Float32Array(2 * n);
    const times = json.trail ? new Float64Array(n) : undefined,
      cusps = json.trail ? /** @type {boolean[]} */ ([]) : undefined;
    let x = 0,
      y = 0,
      time = 0;
    for (let i = 0; i < n; ++i) {
      if (times && cusps) {
        const by = stream.next();
        const cusp = by % 2 !== 0;
        time += (cusp ? by - 1 : by) / 2;
        times[i] = time / 1e4;
        cusps.push(cusp);
      }
      x += stream.next();
      y += stream.next();
      points[2 * i] = x / POINT;
      points[2 * i + 1] = y / POINT;
    }
    if (!json.profile) return { points, times, cusps };
    const widths = new Float32Array(n),
      colors = [];
    for (let i = 0; i < n; ++i) {
      widths[i] = stream.next() / POINT;
      colors.push(stream.next());
    }
    return { points, widths, colors };
  }

  /** A trail's way in space. */
  read_way(json, stream) {
    const at = [0, 0, 0],
      unit_of = json.bounds[0];
    let time = 0;
    for (let i = 0; i < json.points; ++i) {
      time += stream.next();
      this.way.times.push(time / 1e4);
      for (let k = 0; k < 3; ++k) this.way.places.push((at[k] += stream.next()) * unit_of);
    }
    return { points: new Float32Array(0) };
  }

  read_life(life, bounds, streams) {
    const count = life.to - life.from;
    for (const bound of bounds) life.courses.push(new Course(streams.keys, count, bound));
    for (let i = 0; i < this.step_count(); ++i) life.steps.push(new Steps(streams.steps, count));
  }

  step_count() {
    if (this.trail || this.space === 3) return 0;
    if (this.space > 0) return 1;
    if (this.kind === DISC) return 2;
    if (this.kind === BOX) return 3;
    return this.form === GROWN ? 2 : 1;
  }

  read_frames(stream) {
    /** @type {number[] | null} */
    let before = null;
    let nodes = 0,
      mixed = 0;
    for (const life of this.lives) {
      for (let frame = life.from; frame < life.to; ++frame) {
        const n = stream.next();
        if (n > 0) {
          nodes = n;
          mixed = stream.next();
        }
        const stroke = this.kind === STROKE;
        const widths = stroke ? (mixed ? nodes : 1) : 0,
          colors = mixed ? nodes : 1;
        const size = widths + colors + 2 * nodes;
        /** @type {number[]} */
        const all = new Array(size);
        for (let i = 0; i < size; ++i) all[i] = stream.next() + (n === 0 && before ? before[i] : i >= 2 ? all[i - 2] : 0);
        before = all;
        life.frames.push({
          widths: all.slice(0, widths).map((w) => w / POINT),
          colors: all.slice(widths, widths + colors),
          points: Float32Array.from(all.slice(widths + colors), (x) => x / LOOSE_STEPS),
        });
      }
    }
  }

  /**
   * Whether it is there in a frame; if so its life is known.
   * @param {number} frame a whole one
   */
  lives_at(frame) {
    if (this.life && this.life.from <= frame && frame < this.life.to) return true;
    this.life = null;
    for (const life of this.lives) if (life.from <= frame && frame < life.to) this.life = life;
    return this.life !== null;
  }

  /**
   * Its numbers in a frame where it lives.
   * @param {number} frame
   * @param {number[]} out
   */
  numbers(frame, out) {
    const life = /** @type {Life} */ (this.life);
    const local = Math.min((this.steady ? frame : Math.floor(frame)) - life.from, life.to - life.from - 1);
    for (let i = 0; i < life.courses.length; ++i) out[i] = life.courses[i].at(local);
    return out;
  }

  /** The places at which it hangs, of its numbers in a frame. */
  places(numbers) {
    const end = /** @type {Life} */ (this.life).courses.length,
      all = [];
    for (let i = end - 3 * this.hang; i < end; i += 3) all.push(numbers.slice(i, i + 3));
    return all;
  }

  /**
   * A colour, a line of type, a count.
   * @param {number} which
   * @param {number} frame
   */
  step(which, frame) {
    const life = /** @type {Life} */ (this.life);
    // the clock between two frames says the nearer
    const whole = this.what === PAGE && this.kind === TEXT ? Math.min(Math.round(frame), life.to - 1) : Math.floor(frame);
    return life.steps[which].at(whole - life.from);
  }

  /** @param {number} frame */
  loose(frame) {
    const life = /** @type {Life} */ (this.life);
    return life.frames[Math.floor(frame) - life.from];
  }
}

/** A film's things and numbers. */
export class Reel {
  /**
   * @param {any} json
   * @param {Uint8Array} bytes
   */
  constructor(json, bytes) {
    const parts = [];
    let at = 0;
    for (const size of json.streams) {
      parts.push(new Numbers(bytes.subarray(at, at + size)));
      at += size;
    }
    const [starts, gaps, ends, bends, points, steps, loose] = parts;
    const keys = { starts, gaps, ends, bends };
    const streams = { keys, points, steps, loose };
    /** @type {number} */
    this.frames = json.frames;
    this.colors = json.colors.map((/** @type {number} */ c) => [c >>> 24, (c >>> 16) & 255, (c >>> 8) & 255, c & 255]);
    /** @type {string[]} */
    this.inks = this.colors.map(ink);
    /** @type {number[][]} */
    this.clips = json.clips;
    /** @type {any[]} */
    this.lines = json.lines;
    /** @type {string[]} */
    this.glyphs = json.glyphs;
    /** @type {Thing[]} */
    this.things = json.things.map((/** @type {any} */ each) => new Thing(each, this.frames, streams));
    /** @type {Course[]} */
    this.numbers = json.numbers.map((/** @type {number} */ bound) => new Course(keys, this.frames, bound));
  }
}

/** @param {number[]} c red, green, blue and alpha up to 255 */
export function ink([r, g, b, a]) {
  return a === 255 ? `rgb(${r},${g},${b})` : `rgba(${r},${g},${b},${a / 255})`;
}
