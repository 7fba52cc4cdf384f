// The values of a number in the frames of a film, as cubic pieces: see page/keys.h.

import { Numbers } from "./bytes.js";

const STEPS = 4;

/**
 * @typedef {{starts: Numbers, gaps: Numbers, ends: Numbers, bends: Numbers}} KeyStreams
 */

export class Course {
  /**
   * Reads the next `count` frames.
   * @param {KeyStreams} streams
   * @param {number} count
   * @param {number} bound
   */
  constructor(streams, count, bound) {
    const step = bound / STEPS,
      times = [0],
      values = [streams.starts.next()],
      bends = [];
    let moves = false;
    for (let frame = 0; frame < count - 1;) {
      const gap = streams.gaps.next();
      frame += gap;
      times.push(frame);
      const by = streams.ends.next();
      values.push(values[values.length - 1] + by);
      const a = gap > 1 ? streams.bends.next() : 0,
        b = gap > 1 ? streams.bends.next() : 0;
      bends.push(3 * step * a, 3 * step * b);
      moves ||= by !== 0 || a !== 0 || b !== 0;
    }
    this.constant = !moves;
    this.first = step * values[0];
    this.piece = 0;
    this.times = Int32Array.from(times);
    this.values = Float64Array.from(values, (v) => v * step);
    this.bends = Float64Array.from(bends);
  }

  /**
   * The piece that holds a frame.
   * @param {number} frame
   */
  find(frame) {
    const times = this.times;
    let k = this.piece;
    if (times[k] <= frame && frame < times[k + 1]) return k;
    let low = 0,
      high = times.length - 2;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= frame) low = middle;
      else high = middle - 1;
    }
    return (this.piece = low);
  }

  /**
   * @param {number} frame from the first, not necessarily whole
   * @returns {number}
   */
  at(frame) {
    if (this.constant) return this.first;
    const k = this.find(frame),
      from = this.times[k],
      to = this.times[k + 1];
    const u = Math.min(1, (frame - from) / (to - from)),
      v = 1 - u;
    const p = this.values[k],
      q = this.values[k + 1];
    return p + u * (q - p) + u * v * (v * this.bends[2 * k] + u * this.bends[2 * k + 1]);
  }
}

/** A whole number that jumps from frame to frame. */
export class Steps {
  /**
   * @param {Numbers} stream
   * @param {number} count
   */
  constructor(stream, count) {
    const values = [],
      ends = [];
    for (let frame = 0; frame < count;) {
      values.push(stream.next());
      frame += stream.next();
      ends.push(frame);
    }
    this.values = values;
    this.ends = ends;
    this.piece = 0;
  }

  /**
   * @param {number} frame a whole one
   * @returns {number}
   */
  at(frame) {
    const ends = this.ends;
    let k = this.piece;
    if (frame >= ends[k] || (k > 0 && frame < ends[k - 1])) {
      let low = 0,
        high = ends.length - 1;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (ends[middle] > frame) high = middle;
        else low = middle + 1;
      }
      k = this.piece = low;
    }
    return this.values[k];
  }
}
