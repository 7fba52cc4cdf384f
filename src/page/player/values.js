// What the run's bodies are doing, in words: names, places, velocities.

export const NOTHING = 1e-6; // of a frame: what counts as none
const ROWS = 200; // rows of a table

const SMALL = -4; // the power of ten below which a number is told with it
const UP = "⁰¹²³⁴⁵⁶⁷⁸⁹";

const minus = (/** @type {string} */ text) => text.replace("-", "−");
const signless = (/** @type {string} */ text) => (Number(text) === 0 ? text.replace("-", "") : text);
const raised = (/** @type {number} */ power) =>
  minus(String(power)).replace("−", "⁻").replace(/[0-9]/g, (digit) => UP[Number(digit)]);

// in a room of many kilometres the last digit that is known is one before the point
const known = (/** @type {number} */ x, /** @type {number} */ within) => (within > 1 ? Math.round(x / within) * within : x);

/**
 * A number with so many digits that count, and none finer than it is known; one that is nearer to zero than that is 0.
 * @param {number} x
 * @param {number} [within] the last digit that is known: a power of ten
 * @param {number} [digits]
 */
export function numeral(x, within = 0, digits = 3) {
  x = known(x, within);
  if (!(Math.abs(x) > within / 2)) return "0";
  if (Math.abs(x) < within) x = Math.sign(x) * within;
  const power = Math.floor(Math.log10(Math.abs(x)) + 1e-12),
    last = within > 0 ? -Math.round(Math.log10(within)) : Infinity;
  const decimals = Math.max(Math.min(digits - 1 - power, last), 0);
  if (power >= SMALL) return minus(signless(x.toFixed(decimals)));
  const short = (/** @type {number} */ up) => (x / 10 ** up).toFixed(Math.min(digits - 1, Math.max(last + up, 0)));
  // 9.999 is told as 10.0
  const up = Math.abs(Number(short(power))) < 10 ? power : power + 1;
  return minus(`${short(up)} × 10${raised(up)}`);
}

/**
 * A number with as many decimals as are known; in a tiny room with a power of ten.
 * @param {number} x
 * @param {number} within the last digit that is known: a power of ten
 */
export function fixed(x, within) {
  return within < 5e-7 ? numeral(x, within, 4) : minus(signless(known(x, within).toFixed(Math.max(0, -Math.round(Math.log10(within))))));
}

/**
 * Seconds, with as many decimals more as a short run needs.
 * @param {number} seconds
 * @param {number} decimals
 * @param {number} duration of the run, s
 */
export function clock(seconds, decimals, duration) {
  return `${seconds.toFixed(decimals + Math.max(0, Math.ceil(Math.log10(0.2 / duration))))} s`;
}

/** The values of a run's bodies at an instant. */
export class Values {
  /**
   * @param {any} film
   * @param {import("./reel.js").Reel} reel
   */
  constructor(film, reel) {
    this.film = film;
    this.reel = reel;
    this.space = film.dimension === 3;
    /** @type {number[]} the frames of events, ascending */
    this.events = film.events
      .map((/** @type {any} */ each) => each.film * film.fps)
      .sort((/** @type {number} */ a, /** @type {number} */ b) => a - b);
    /** @type {Map<string, any>} */
    this.bodies = new Map(film.bodies.map((/** @type {any} */ each) => [`${each.part}:${each.index}`, each]));
  }

  /** @param {number} part @param {number} index */
  body(part, index) {
    return this.bodies.get(`${part}:${index}`);
  }

  /** Seconds of the run, in words. */
  clock(/** @type {number} */ seconds, decimals = 2) {
    return clock(seconds, decimals, this.film.duration);
  }

  /** Seconds of the run in a frame. */
  time(frame) {
    return this.reel.numbers[this.film.time].at(frame);
  }

  /**
   * The instant whose values are told in a frame. Between two frames, up to an event, the velocities go on as in the
   * frames before it; where another event lies so near that they do not, it is the frame before.
   */
  instant(frame) {
    const whole = Math.floor(frame + NOTHING);
    if (frame - whole <= NOTHING) return { frame: whole, time: this.time(whole), before: false };
    const goes_on = whole > 0 && !this.events.some((each) => whole - 1 + NOTHING < each && each < frame - NOTHING);
    if (!goes_on) return { frame: whole, time: this.time(whole), before: false };
    return { frame, time: this.time(frame), before: this.events.some((each) => Math.abs(each - frame) <= NOTHING) };
  }

  /** The place, velocity and turning of a body. */
  state(body, frame) {
    const whole = Math.floor(frame + NOTHING),
      told = this.instant(frame).frame,
      beyond = told - whole,
      seconds = this.time(told) - this.time(whole),
      { place, velocity, angle, spin } = body;
    const at = (/** @type {number} */ i) => {
      const now = this.reel.numbers[i].at(whole);
      return beyond > 0 ? now + beyond * (now - this.reel.numbers[i].at(whole - 1)) : now;
    };
    const v = velocity.map(at);
    return {
      place: place.map((/** @type {number} */ i, /** @type {number} */ k) => {
        return this.reel.numbers[i].at(whole) + (seconds / 2) * (this.reel.numbers[velocity[k]].at(whole) + v[k]);
      }),
      velocity: v,
      speed: Math.hypot(...v),
      angle: angle === undefined ? undefined : (at(angle) * 180) / Math.PI,
      spin: spin === undefined ? undefined : at(spin),
    };
  }

  /** Rows of words on a body: what, and its value. */
  rows(body, frame) {
    const now = this.state(body, frame),
      [length, speed, angle, spin] = body.within;
    const list = (/** @type {string[]} */ words) => `(${words.join(", ")})`;
    const rows = [["position", `${list(now.place.map((/** @type {number} */ x) => fixed(x, length)))} m`]];
    if (!body.fixed) {
      const velocity = now.velocity.map((/** @type {number} */ v) => numeral(v, speed));
      rows.push(["speed", `${numeral(now.speed, speed)} m/s`], ["velocity", `${list(velocity)} m/s`]);
      if (now.angle !== undefined) rows.push(["angle", `${numeral(now.angle, angle)}°`]);
      if (now.spin !== undefined) rows.push(["spin", `${numeral(now.spin, spin)} rad/s`]);
      rows.push(["mass", `${numeral(body.mass)} kg`]);
    }
    return rows;
  }

  /**
   * Columns of a table of the bodies that may move, and its rows, of one body each.
   * @param {number} frame
   * @param {number} by the column that they are sorted by, the largest first; -1: as in the scene
   */
  table(frame, by) {
    const axes = this.space ? ["x", "y", "z"] : ["x", "y"];
    const several = this.film.bodies.some((/** @type {any} */ body) => body.run !== undefined);
    const head = [
      "body",
      ...(several ? ["run"] : []),
      ...axes.map((a) => `${a} / m`),
      ...axes.map((a) => `v${a} / (m/s)`),
      "speed / (m/s)",
    ];
    const rows = this.film.bodies
      .filter((/** @type {any} */ body) => !body.fixed)
      .map((/** @type {any} */ body) => {
        const now = this.state(body, frame);
        const [length, speed] = body.within,
          values = [...now.place, ...now.velocity, now.speed];
        const words = values.map((x, i) => fixed(x, i < now.place.length ? length : speed));
        // of a column that is no number the place in the scene, the first of which comes first
        return several ? { body, values: [-body.part, ...values], words: [body.run ?? "", ...words] } : { body, values, words };
      });
    if (by === 0)
      rows.sort((/** @type {any} */ p, /** @type {any} */ q) => p.body.name.localeCompare(q.body.name, undefined, { numeric: true }));
    if (by > 0) rows.sort((/** @type {any} */ p, /** @type {any} */ q) => q.values[by - 1] - p.values[by - 1]);
    return { head, rows: rows.slice(0, ROWS) };
  }
}
