// How space lies on the page (draw/picture/lens.h), and how one may look at it otherwise than the film does.

/** @typedef {number[]} Vec */

export const dot = (/** @type {Vec} */ a, /** @type {Vec} */ b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const sub = (/** @type {Vec} */ a, /** @type {Vec} */ b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const plus = (/** @type {Vec} */ a, /** @type {Vec} */ b, k = 1) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
export const cross = (/** @type {Vec} */ a, /** @type {Vec} */ b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const unit = (/** @type {Vec} */ a) => plus([0, 0, 0], a, 1 / Math.max(Math.hypot(...a), 1e-300));

export const clamp = (/** @type {number} */ x, /** @type {number} */ low, /** @type {number} */ high) => Math.min(Math.max(x, low), high);

/** A vector turned by a quaternion (w, x, y, z). */
export function turned(q, v) {
  const [w, x, y, z] = q,
    u = [x, y, z],
    t = plus([0, 0, 0], cross(u, v), 2);
  return plus(plus(v, t, w), cross(u, t));
}

/** A vector turned about a unit axis. */
export function about(axis, angle, v) {
  const half = angle / 2,
    s = Math.sin(half);
  return turned([Math.cos(half), s * axis[0], s * axis[1], s * axis[2]], v);
}

const LOWEST = 0.02; // rad over the ground

/** How one looks at space: turned about the vertical, tilted, nearer, moved. */
export class Orbit {
  /**
   * @param {Vec} up the vertical
   * @param {boolean} [ground] whether there is ground, under which nothing is to be seen
   */
  constructor(up, ground = false) {
    this.vertical = up;
    this.ground = ground;
    this.turn = this.tilt = this.dx = this.dy = 0;
    this.zoom = 1;
    this.flat = false; // from above
    this.steep = 0; // rad: how far to tilt to there
  }

  home() {
    this.turn = this.tilt = this.dx = this.dy = 0;
    this.zoom = 1;
    this.flat = false;
  }

  get moved() {
    return this.zoom !== 1 || this.dx !== 0 || this.dy !== 0 || this.turn !== 0 || this.tilt !== 0 || this.flat;
  }

  /** Around what is looked at, by page units of a pointer; from above on, too. */
  move(x, y) {
    if (this.flat) this.tilt = this.steep;
    this.turn -= x * 0.006;
    this.tilt += y * 0.006;
    this.flat = false;
  }

  shift(x, y) {
    this.dx += x;
    this.dy += y;
  }

  /**
   * Nearer by a factor, with what is seen at a place of the page where it is.
   * @param {number} by
   * @param {number} x page units from the middle of the film's picture
   * @param {number} y
   */
  nearer(by, x, y) {
    const zoom = clamp(this.zoom * by, 0.2, 60),
      k = zoom / this.zoom;
    this.dx = x - k * (x - this.dx);
    this.dy = y - k * (y - this.dy);
    this.zoom = zoom;
  }

  /** From above, or back. */
  above() {
    const was = this.flat;
    this.home();
    this.flat = !was;
  }

  /** @param {Lens} lens of the film */
  see(lens) {
    if (!this.moved) return lens;
    const rises = Math.asin(Math.min(Math.max(dot(lens.back, this.vertical), -1), 1));
    const most = Math.PI / 2 - 1e-4,
      least = this.ground ? Math.min(rises, LOWEST) : -most;
    this.steep = most - rises;
    // not lower than that, so that one can turn back at once
    this.tilt = clamp(this.tilt, least - rises, most - rises);
    const tilt = (this.flat ? most : rises + this.tilt) - rises;
    const turn = (/** @type {Vec} */ v) => about(this.vertical, this.turn, about(lens.right, -tilt, v));
    return new Lens(
      lens.target,
      turn(lens.right),
      turn(lens.up),
      turn(lens.back),
      lens.per_distance,
      lens.scale * this.zoom,
      [lens.middle[0] + this.dx, lens.middle[1] + this.dy],
      lens.window,
    );
  }
}

export class Lens {
  constructor(target, right, up, back, per_distance, scale, middle, window) {
    this.target = target;
    this.right = right;
    this.up = up;
    this.back = back;
    this.per_distance = per_distance;
    this.scale = scale;
    this.middle = middle;
    this.window = window;
  }

  /** That of a frame. */
  static of(panel, numbers, frame) {
    const at = (/** @type {number} */ i) => numbers[panel.lens + i].at(frame);
    const three = (/** @type {number} */ i) => [at(i), at(i + 1), at(i + 2)];
    return new Lens(three(0), unit(three(3)), unit(three(6)), unit(three(9)), at(12), at(13), [at(14), at(15)], panel.window);
  }

  get key() {
    return [this.target, this.right, this.up, this.back, this.per_distance, this.scale, this.middle]
      .flat()
      .map((x) => x.toPrecision(7))
      .join();
  }

  /** The eye, or for an orthographic camera a place far towards it. */
  get eye() {
    return plus(this.target, this.back, this.per_distance > 1e-9 ? 1 / this.per_distance : 1e6);
  }

  /** Over the target's; not positive at the eye and behind it. */
  depth(place) {
    return 1 - this.per_distance * dot(sub(place, this.target), this.back);
  }

  /**
   * A place on the page.
   * @param {Vec} place
   * @returns {[number, number]}
   */
  page(place) {
    const p = sub(place, this.target),
      k = this.scale / this.depth(place);
    return [this.middle[0] + k * dot(p, this.right), this.middle[1] - k * dot(p, this.up)];
  }

  /** The ray through a point of the page: a place on it, and where it goes. */
  ray(x, y) {
    const across = plus(plus(this.target, this.right, (x - this.middle[0]) / this.scale), this.up, (this.middle[1] - y) / this.scale);
    if (this.per_distance <= 1e-9) return { from: plus(across, this.back, 1e4), way: plus([0, 0, 0], this.back, -1) };
    return { from: this.eye, way: unit(sub(across, this.eye)) };
  }
}
