// The picture of an instant on a canvas, under a view that one may move.

import { Charts } from "./charts.js";
import { Pen } from "./pen.js";
import { Card } from "./card.js";
import { Orbit } from "./lens.js";
import { Space } from "./space.js";
import { BODY, BOX, CHART, DISC, LOOSE, PAGE, POLYGON, RIGID } from "./reel.js";

const RING = 26; // page units: the ring around a body that is named
const REACH = 12; // page units around a body within which it is pointed at

/** How the world lies on the page beyond what the film says. */
export class View {
  constructor() {
    this.zoom = 1;
    this.dx = this.dy = 0; // page units
  }

  get moved() {
    return this.zoom !== 1 || this.dx !== 0 || this.dy !== 0;
  }

  home() {
    this.zoom = 1;
    this.dx = this.dy = 0;
  }

  /** Nearer by a factor, with a place of the page where it is. */
  nearer(by, x, y) {
    const zoom = Math.min(Math.max(this.zoom * by, 0.2), 60),
      k = zoom / this.zoom;
    this.dx = x - k * (x - this.dx);
    this.dy = y - k * (y - this.dy);
    this.zoom = zoom;
  }

  move(x, y) {
    this.dx += x;
    this.dy += y;
  }

  shift(x, y) {
    this.move(x, y);
  }
}

export class Picture {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {any} film
   * @param {import("./reel.js").Reel} reel
   */
  constructor(canvas, film, reel) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
    this.film = film;
    this.reel = reel;
    this.pen = new Pen(this.context, reel, film.ground);
    this.charts = new Charts(film, reel);
    /** @type {Space[]} one a run */
    this.spaces = [];
    /** @type {View | Orbit} */
    this.view = new View();
    if (film.spaces) {
      // one for all runs, made when a whole picture is first drawn: programs take their time
      /** @type {Card | null | undefined} */
      let made;
      const card = () => (made === undefined ? (made = Card.made()) : made),
        { ground } = film.spaces[0],
        view = (this.view = new Orbit(ground ? ground.normal : [0, 1, 0], Boolean(ground)));
      this.spaces = film.spaces.map((/** @type {any} */ _, /** @type {number} */ run) => new Space(film, run, reel, card, view));
    }
    this.frame = 0;
    /** @type {[number, number] | null} a body around which there is a ring, as part and index */
    this.named = null;
  }

  /** Page units: how wide and high the page is. */
  get width() {
    return 1080 * this.film.aspect;
  }

  /** Sets its size, px of the device. */
  size(width, height) {
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }

  /** Nearer by a factor, with what is seen at a place of the page where it is. */
  nearer(by, x, y) {
    const space = this.spaces.find((each) => each.holds(x, y)) ?? this.spaces[0],
      [left, top] = space ? space.middle_at(x, y, this.frame) : [0, 0];
    this.view.nearer(by, x - left, y - top);
  }

  /** Whether a thing moves with the view. */
  world(thing) {
    return thing.what !== PAGE && thing.what !== CHART;
  }

  /**
   * @param {number} frame not necessarily whole: between two, what moves is between
   * @param {boolean} [sketched] space without light and shadow
   */
  draw(frame, sketched = false) {
    this.frame = frame;
    const { context: c, pen, reel, view, canvas } = this,
      scale = canvas.height / 1080,
      whole = Math.floor(frame);
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.globalCompositeOperation = "source-over";
    c.fillStyle = `rgb(${this.film.ground.join(",")})`;
    c.fillRect(0, 0, canvas.width, canvas.height);
    for (const space of this.spaces) space.draw(c, frame, sketched);
    let clip = -2,
      world = false;
    c.save();
    for (const thing of reel.things) {
      if (thing.space > 0 || !thing.lives_at(whole)) continue;
      const now = !this.spaces.length && this.world(thing);
      // what is said of space goes with the places that it is said of
      const space = this.spaces[Math.min(thing.part, this.spaces.length - 1)];
      pen.hanging = pen.nodes = null;
      if (space && thing.through) {
        pen.nodes = space.through(thing, frame);
        if (!pen.nodes) continue;
      } else if (space && view.moved && this.world(thing)) {
        pen.hanging = space.hanging(thing, frame);
        if (!pen.hanging) continue;
      }
      const window = now && view.moved ? this.film.windows[thing.part] : null;
      const clipped = window ? -100 - thing.part : thing.clip;
      if (clipped !== clip) {
        c.restore();
        c.save();
        clip = clipped;
        const rect = window ?? (clip >= 0 ? reel.clips[clip] : null);
        if (rect) this.clip(rect, scale);
        world = !now;
      }
      if (now !== world) {
        world = now;
        if (now) pen.place(scale, view.zoom, view.dx, view.dy);
        else pen.place(scale);
      }
      pen.draw(thing, frame);
    }
    pen.hanging = pen.nodes = null;
    c.restore();
    pen.place(scale);
    const at = this.named && this.place_of(...this.named);
    if (at) this.ring(at);
    this.charts.draw(c, this.film.theme === "screen" ? "#9aa5b1" : "#5b6570");
  }

  /**
   * Where a body is on the page, under the view.
   * @param {number} part
   * @param {number} index
   */
  place_of(part, index) {
    if (this.spaces.length) return this.spaces[part].place_of(index, this.frame);
    const { view } = this,
      whole = Math.floor(this.frame);
    const thing = this.reel.things.find(
      (each) => each.what === BODY && each.part === part && each.index === index && each.form !== LOOSE && each.lives_at(whole),
    );
    if (!thing) return null;
    const [x, y] = thing.numbers(this.frame, []);
    return [view.zoom * x + view.dx, view.zoom * y + view.dy];
  }

  /** A ring around a place, in ink with a halo of the ground's. */
  ring([x, y]) {
    const c = this.context,
      dark = this.film.theme === "screen";
    for (const [width, color] of [
      [9, `rgb(${this.film.ground.join(",")})`],
      [4, dark ? "#e8edf2" : "#1f2328"],
    ]) {
      c.beginPath();
      c.arc(x, y, RING, 0, 2 * Math.PI);
      c.lineWidth = Number(width);
      c.strokeStyle = String(color);
      c.stroke();
    }
  }

  /** To a rectangle of the page, widened to whole pixels. */
  clip([x, y, width, height], scale) {
    const c = this.context;
    c.setTransform(1, 0, 0, 1, 0, 0);
    const left = Math.floor(x * scale + 1e-6),
      top = Math.floor(y * scale + 1e-6);
    c.beginPath();
    c.rect(left, top, Math.ceil((x + width) * scale - 1e-6) - left, Math.ceil((y + height) * scale - 1e-6) - top);
    c.clip();
  }

  /** The body at a place of the page, as [part, index]. */
  body_at(x, y) {
    if (this.spaces.length)
      return this.spaces.reduce((/** @type {number[] | null} */ found, space) => found ?? space.body_at(x, y, this.frame), null);
    const { view, reel } = this,
      px = (x - view.dx) / view.zoom,
      py = (y - view.dy) / view.zoom;
    const whole = Math.floor(this.frame),
      numbers = [];
    let best = null,
      least = REACH / view.zoom;
    for (let i = reel.things.length - 1; i >= 0; --i) {
      const thing = reel.things[i];
      if (thing.what !== BODY || thing.form === LOOSE || !thing.lives_at(whole)) continue;
      const n = thing.numbers(this.frame, numbers);
      let off = Infinity;
      if (thing.kind === DISC) {
        off = Math.hypot(px - n[0], py - n[1]) - n[2];
      } else if (thing.kind === BOX) {
        const cos = Math.cos(n[2]),
          sin = Math.sin(n[2]),
          u = px - n[0],
          v = py - n[1];
        off = Math.max(Math.abs(cos * u + sin * v) - n[3], Math.abs(cos * v - sin * u) - n[4]);
      } else if (thing.kind === POLYGON && thing.form === RIGID) {
        off = inside(this.pen.turned(thing.outline.points, n), px, py) ? 0 : Infinity;
      }
      if (off <= 0) return [thing.part, thing.index];
      if (off < least) {
        least = off;
        best = [thing.part, thing.index];
      }
    }
    return best;
  }
}

/** Whether a place is within a polygon. */
function inside(points, x, y) {
  let within = false;
  for (let i = 0, j = points.length - 2; i < points.length; j = i, i += 2) {
    const ay = points[i + 1],
      by = points[j + 1];
    if (ay > y !== by > y && x < ((points[j] - points[i]) * (y - ay)) / (by - ay) + points[i]) within = !within;
  }
  return within;
}
