// What the run's bodies are doing, in words: names, places, velocities.

/**
 * A number with so many digits that count.
 * @param {number} x
 * @param {number} [digits]
 */
export function numeral(x, digits = 3) {
  if (!(Math.abs(x) >= 5e-7)) return "0";
  const decimals = Math.min(Math.max(digits - 1 - Math.floor(Math.log10(Math.abs(x))), 0), 4);
  const text = x.toFixed(decimals);
  return (Number(text) === 0 ? "0" : text).replace("-", "−");
}

/** @param {number} seconds */
export function clock(seconds) {
  return `${seconds.toFixed(2)} s`;
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
    /** @type {Map<string, any>} */
    this.bodies = new Map(film.bodies.map((/** @type {any} */ each) => [`${each.part}:${each.index}`, each]));
  }

  /** @param {number} part @param {number} index */
  body(part, index) {
    return this.bodies.get(`${part}:${index}`);
  }

  /** Seconds of the run in a frame. */
  time(frame) {
    return this.reel.numbers[this.film.time].at(frame);
  }

  /** The place, velocity and turning of a body; between two frames those of the first, for an impact may lie between. */
  state(body, frame) {
    const whole = Math.floor(frame + 1e-6),
      at = (/** @type {number} */ i) => this.reel.numbers[i].at(whole),
      { place, velocity, angle, spin } = body;
    const v = velocity.map(at);
    return {
      place: place.map(at),
      velocity: v,
      speed: Math.hypot(...v),
      angle: angle === undefined ? undefined : (at(angle) * 180) / Math.PI,
      spin: spin === undefined ? undefined : at(spin),
    };
  }

  /** Rows of words on a body: what, and its value. */
  rows(body, frame) {
    const now = this.state(body, frame),
      list = (/** @type {number[]} */ v) => v.map((x) => numeral(x)).join(", ");
    const rows = [["position", `(${now.place.map((x) => (Math.round(x * 1000) / 1000).toFixed(3).replace("-", "−")).join(", ")}) m`]];
    if (!body.fixed) {
      rows.push(["speed", `${numeral(now.speed)} m/s`], ["velocity", `(${list(now.velocity)}) m/s`]);
      if (now.angle !== undefined) rows.push(["angle", `${numeral(now.angle)}°`]);
      if (now.spin !== undefined) rows.push(["spin", `${numeral(now.spin)} rad/s`]);
      rows.push(["mass", `${numeral(body.mass)} kg`]);
    }
    return rows;
  }

  /** Columns and rows of a table of all bodies that may move. */
  table(frame) {
    const axes = this.space ? ["x", "y", "z"] : ["x", "y"];
    const head = ["body", ...axes.map((a) => `${a} / m`), ...axes.map((a) => `v${a} / (m/s)`), "speed / (m/s)"];
    const rows = [];
    for (const body of this.film.bodies) {
      if (body.fixed) continue;
      const now = this.state(body, frame);
      rows.push([body.name, ...now.place.map((x) => x.toFixed(3)), ...now.velocity.map((x) => x.toFixed(3)), now.speed.toFixed(3)]);
      if (rows.length === 200) break;
    }
    return { head, rows };
  }
}
