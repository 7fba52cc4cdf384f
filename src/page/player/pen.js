// Draws things on a canvas as GL draws the list (shaders, gl/painter.cpp), by the forms of page/put.cpp.
// Lengths in page units: 1/1080 of the picture's height.

import { BOX, DISC, GROWN, LOOSE, POLYGON, STROKE, TEXT, ink } from "./reel.js";

const OVER = 0,
  DARKEN = 1;
const CREST = 0.22,
  RISE = 0.62,
  NODES = 22; // of coils, as in draw/plane/springs.cpp
const NEAR = 0.5; // nearer points of a trail are one

const smooth = (/** @type {number} */ u) => {
  const s = Math.min(Math.max(u, 0), 1);
  return s * s * (3 - 2 * s);
};

/** @typedef {import("./reel.js").Thing} Thing */

export class Pen {
  /**
   * @param {CanvasRenderingContext2D} context
   * @param {import("./reel.js").Reel} reel
   * @param {number[]} ground the page's colour
   */
  constructor(context, reel, ground) {
    this.context = context;
    this.reel = reel;
    this.ground = ground;
    /** @type {Map<number, Path2D>} */
    this.paths = new Map();
    /** @type {number[]} */
    this.numbers = [];
    this.scale = 1;
    this.zoom = 1;
    this.dx = this.dy = 0;
    /** @type {Hanging | null} where what hangs in space has gone */
    this.hanging = null;
    /** @type {number[] | null} those of a line or a polygon that hangs by them */
    this.nodes = null;
  }

  /**
   * Where page units lie: scaled, and for the world moved.
   * @param {number} scale device pixels a page unit
   * @param {number} zoom
   * @param {number} dx
   * @param {number} dy
   */
  place(scale, zoom = 1, dx = 0, dy = 0) {
    this.scale = scale;
    this.zoom = zoom;
    this.dx = dx;
    this.dy = dy;
    const k = scale * zoom;
    this.context.setTransform(k, 0, 0, k, scale * dx, scale * dy);
  }

  /** @param {Thing} thing @param {number} frame */
  draw(thing, frame) {
    const inks = this.reel.inks;
    if (thing.form === LOOSE) return this.loose(thing, frame);
    const n = thing.numbers(frame, this.numbers);
    switch (thing.kind) {
      case DISC:
        this.move(n);
        return this.disc(n[0], n[1], n[2], n[3], inks[thing.step(0, frame)], inks[thing.step(1, frame)]);
      case BOX:
        this.move(n);
        return this.box(n, thing.step(0, frame), thing.step(1, frame), thing.step(2, frame));
      case TEXT:
        this.move(n);
        return this.text(n[0], n[1], this.reel.lines[thing.step(0, frame)], thing.whole);
      case POLYGON:
        return this.polygon(this.nodes ?? this.turned(thing.outline.points, n), inks[thing.step(0, frame)]);
      case STROKE:
        return this.stroke(thing, frame, n);
    }
  }

  /** Moves a thing's middle with the place that it hangs at. */
  move(n) {
    if (this.hanging) [n[0], n[1]] = this.hanging.middle(n[0], n[1]);
  }

  disc(x, y, radius, line, fill, outline) {
    const c = this.context,
      w = Math.min(line, radius);
    c.beginPath();
    c.arc(x, y, radius - w / 2, 0, 2 * Math.PI);
    c.fillStyle = fill;
    c.fill();
    if (w <= 0) return;
    c.lineWidth = w;
    c.strokeStyle = outline;
    c.stroke();
  }

  box(n, fill, outline, own) {
    const [x, y, angle, wide, high, outlined, axis, thin] = n,
      c = this.context,
      k = this.scale * this.zoom,
      { colors, inks } = this.reel;
    const cos = Math.cos(angle) * k,
      sin = Math.sin(angle) * k;
    c.setTransform(cos, sin, -sin, cos, this.scale * (this.zoom * x + this.dx), this.scale * (this.zoom * y + this.dy));
    const w = Math.min(outlined, wide, high);
    if (colors[fill][3] === 255 && colors[outline][3] === 255) {
      if (w > 0) {
        c.fillStyle = inks[outline];
        c.fillRect(-wide, -high, 2 * wide, 2 * high);
      }
      c.fillStyle = inks[fill];
      c.fillRect(w - wide, w - high, 2 * (wide - w), 2 * (high - w));
    } else {
      c.fillStyle = inks[fill];
      c.fillRect(w / 2 - wide, w / 2 - high, 2 * wide - w, 2 * high - w);
      c.lineWidth = w;
      c.lineJoin = "miter";
      c.strokeStyle = inks[outline];
      if (w > 0) c.strokeRect(w / 2 - wide, w / 2 - high, 2 * wide - w, 2 * high - w);
    }
    if (axis > 0 && thin > 0) {
      // the body's y is up
      c.fillStyle = inks[own];
      c.fillRect(0, -thin / 2, axis, thin);
      c.fillRect(-thin / 2, -axis, thin, axis);
      c.beginPath();
      c.arc(0, 0, 1.5 * thin, 0, 2 * Math.PI);
      c.fill();
    }
    this.place(this.scale, this.zoom, this.dx, this.dy);
  }

  /** A form where it has moved to. */
  turned(points, n) {
    const [x, y, angle, scale] = n,
      cos = scale * Math.cos(angle),
      sin = scale * Math.sin(angle),
      moved = new Float32Array(points.length);
    for (let i = 0; i < points.length; i += 2) {
      moved[i] = x + cos * points[i] - sin * points[i + 1];
      moved[i + 1] = y + sin * points[i] + cos * points[i + 1];
      if (this.hanging) [moved[i], moved[i + 1]] = this.hanging.point(moved[i], moved[i + 1]);
    }
    return moved;
  }

  polygon(points, fill) {
    const c = this.context;
    c.beginPath();
    for (let i = 0; i < points.length; i += 2) c.lineTo(points[i], points[i + 1]);
    c.fillStyle = fill;
    c.fill();
  }

  stroke(thing, frame, n) {
    if (thing.trail) return this.trail(thing, n);
    const color = thing.step(0, frame);
    if (this.nodes) return this.line(thing, this.nodes, n[0], color);
    if (thing.turns > 0) return this.line(thing, coil(thing.turns, n), n[6], color);
    if (thing.form === GROWN) {
      const count = thing.step(1, frame),
        points = new Float32Array(2 * count + 2);
      points.set(thing.outline.points.subarray(0, 2 * count));
      points[2 * count] = n[0];
      points[2 * count + 1] = n[1];
      return this.line(thing, points, n[2], color);
    }
    const points = this.turned(thing.outline.points, n);
    if (!thing.outline.widths) return this.line(thing, points, n[4], color);
    this.taper(thing, points, thing.outline.widths, thing.outline.colors ?? []);
  }

  loose(thing, frame) {
    const { widths, colors, points } = thing.loose(frame);
    if (thing.kind === POLYGON) return this.polygon(points, this.reel.inks[colors[0]]);
    if (widths.length === 1) return this.line(thing, points, widths[0], colors[0]);
    this.taper(thing, points, widths, colors);
  }

  /** The colour with which a stroke that darkens or lightens is drawn: alpha is how far it is from the ground. */
  mixed(thing, color) {
    if (thing.blend === OVER) return color;
    const s = color[3] / 255,
      g = this.ground;
    return [0, 1, 2].map((i) => Math.round(g[i] + s * (color[i] - g[i]))).concat(255);
  }

  blend(thing) {
    this.context.globalCompositeOperation = thing.blend === OVER ? "source-over" : thing.blend === DARKEN ? "darken" : "lighten";
  }

  line(thing, points, width, color) {
    const c = this.context;
    this.blend(thing);
    c.beginPath();
    c.moveTo(points[0], points[1]);
    for (let i = 2; i < points.length; i += 2) c.lineTo(points[i], points[i + 1]);
    if (thing.closed) c.closePath();
    c.lineWidth = width;
    c.lineCap = thing.round && !thing.closed ? "round" : "butt";
    // a coil that is pressed bends sharply, and has no spikes there
    c.lineJoin = thing.turns > 0 ? "round" : "miter";
    c.miterLimit = 4;
    c.strokeStyle = thing.blend === OVER ? this.reel.inks[color] : ink(this.mixed(thing, this.reel.colors[color]));
    c.stroke();
    c.globalCompositeOperation = "source-over";
  }

  /** A line whose width and colour change: pieces that lie under each other's ends. */
  taper(thing, points, widths, colors) {
    const found = { points: [points[0], points[1]], widths: [widths[0]], colors: [this.reel.colors[colors[0]]] };
    for (let i = 1; i < widths.length; ++i) {
      const k = found.points.length;
      if (Math.hypot(points[2 * i] - found.points[k - 2], points[2 * i + 1] - found.points[k - 1]) < 1e-4) continue;
      found.points.push(points[2 * i], points[2 * i + 1]);
      found.widths.push(widths[i]);
      found.colors.push(this.reel.colors[colors[i]]);
    }
    this.pieces(thing, found.points, found.widths, found.colors);
  }

  pieces(thing, points, widths, colors) {
    const c = this.context,
      n = widths.length,
      mixed = colors.map((each) => this.mixed(thing, each));
    this.blend(thing);
    const dot = (i, color) => {
      c.beginPath();
      c.arc(points[2 * i], points[2 * i + 1], widths[i] / 2, 0, 2 * Math.PI);
      c.fillStyle = ink(color);
      c.fill();
    };
    if (thing.round) dot(0, mixed[0]);
    const along = [];
    for (let i = 0; i + 1 < n; ++i) {
      const x = points[2 * i + 2] - points[2 * i],
        y = points[2 * i + 3] - points[2 * i + 1],
        l = Math.hypot(x, y);
      along.push([x / l, y / l]);
    }
    for (let i = 0; i + 1 < n; ++i) {
      const [tx, ty] = along[i];
      const color = mixed[i].map((v, k) => Math.round((v + mixed[i + 1][k]) / 2));
      // mitred where the line bends gently, a disc where it breaks
      const side = (node, other) => {
        const half = widths[node] / 2;
        if (node === 0 || node + 1 === n) return [-half * ty, half * tx];
        const [ux, uy] = along[other];
        if (tx * ux + ty * uy < 0.5) return [-half * ty, half * tx];
        const mx = -ty - uy,
          my = tx + ux,
          l = Math.hypot(mx, my),
          by = (half * l) / (-mx * ty + my * tx);
        return [(by * mx) / l, (by * my) / l];
      };
      const a = side(i, i === 0 ? 0 : i - 1),
        b = side(i + 1, i + 2 < n ? i + 1 : i);
      const under = i + 2 < n ? Math.min(0.5, widths[i + 1] / 2) : 0;
      const px = points[2 * i],
        py = points[2 * i + 1],
        qx = points[2 * i + 2],
        qy = points[2 * i + 3];
      c.beginPath();
      c.moveTo(px + a[0], py + a[1]);
      c.lineTo(qx + b[0], qy + b[1]);
      c.lineTo(qx + b[0] + under * tx, qy + b[1] + under * ty);
      c.lineTo(qx - b[0] + under * tx, qy - b[1] + under * ty);
      c.lineTo(qx - b[0], qy - b[1]);
      c.lineTo(px - a[0], py - a[1]);
      c.fillStyle = ink(color);
      c.fill();
      const breaks = i + 2 < n && tx * along[i + 1][0] + ty * along[i + 1][1] < 0.5;
      if (breaks || (i + 2 === n && thing.round)) dot(i + 1, breaks ? color : mixed[i + 1]);
    }
    c.globalCompositeOperation = "source-over";
  }

  /** The way of the last seconds, as draw/plane/trails.cpp tapers it; it breaks at cusps. */
  trail(thing, [hx, hy, ox, oy, scale, now, widest]) {
    const [lasting, strong, faint] = thing.trail,
      { points, times, cusps } = thing.outline;
    const head = this.reel.colors[strong],
      end = this.reel.colors[faint];
    const from = now - lasting;
    let first = 0,
      high = times.length;
    while (first < high) {
      const middle = (first + high) >> 1;
      if (times[middle] > from) high = middle;
      else first = middle + 1;
    }
    /** @type {{x: number[], w: number[], c: number[][]}} */
    let line = { x: [], w: [], c: [] };
    const flush = () => {
      if (line.w.length > 1) this.pieces(thing, line.x, line.w, line.c);
      line = { x: [], w: [], c: [] };
    };
    const add = (x, y, time, last) => {
      const n = line.w.length;
      if (n > 0 && Math.hypot(x - line.x[2 * n - 2], y - line.x[2 * n - 1]) < (last ? 1e-3 : NEAR)) return false;
      const s = Math.min(Math.max(1 - (now - time) / lasting, 0), 1),
        strength = s ** 1.3;
      line.x.push(x, y);
      line.w.push(widest * (0.25 + 0.75 * s));
      line.c.push([0, 1, 2].map((i) => Math.round(end[i] + strength * (head[i] - end[i]))).concat(255));
      return true;
    };
    const at = (i) => [ox + scale * points[2 * i], oy + scale * points[2 * i + 1]];
    if (first > 0 && first < times.length) {
      // its end lies between two points
      const part = (from - times[first - 1]) / (times[first] - times[first - 1]);
      const [ax, ay] = at(first - 1),
        [bx, by] = at(first);
      add(ax + part * (bx - ax), ay + part * (by - ay), from, false);
    }
    for (let i = first; i < times.length && times[i] < now - 1e-9; ++i) {
      const [x, y] = at(i);
      if (!add(x, y, times[i], false) || !cusps[i]) continue;
      flush();
      add(x, y, times[i], false);
    }
    add(hx, hy, now, true);
    flush();
  }

  /** A line of type: glyphs to a quarter of a pixel across, whole pixels down; or its place to a whole pixel first. */
  text(x, y, spans, whole = false) {
    const c = this.context,
      k = this.scale * this.zoom;
    if (whole) {
      x = (Math.round(k * x + this.scale * this.dx) - this.scale * this.dx) / k;
      y = (Math.round(k * y + this.scale * this.dy) - this.scale * this.dy) / k;
    }
    for (const span of spans) {
      const size = (span[0] * k) / 1000;
      c.fillStyle = this.reel.inks[span[1]];
      for (let i = 2; i < span.length; i += 3) {
        let path = this.paths.get(span[i]);
        if (!path) this.paths.set(span[i], (path = new Path2D(this.reel.glyphs[span[i]])));
        const left = Math.floor((k * (x + span[i + 1]) + this.scale * this.dx) * 4 + 0.5) / 4;
        const baseline = Math.floor(k * (y + span[i + 2]) + this.scale * this.dy + 0.5);
        c.setTransform(size, 0, 0, size, left, baseline);
        c.fill(path);
      }
    }
    this.place(this.scale, this.zoom, this.dx, this.dy);
  }
}

/** How what hangs at one place of the page, or between two, goes with them: from where the film has them to where they are seen. */
export class Hanging {
  /**
   * @param {number[][]} from one or two
   * @param {number[][]} to as many
   * @param {number} whole page units: a shorter arrow has a smaller head
   */
  constructor(from, to, whole) {
    this.from = from;
    this.to = to;
    const [length, angle] = along(from),
      [now, turned] = along(to);
    this.length = length;
    this.size = length > 0 ? Math.min(now / whole, 1) / Math.min(length / whole, 1) : 1;
    this.cos = Math.cos(turned - angle) * this.size;
    this.sin = Math.sin(turned - angle) * this.size;
    this.way = [Math.cos(angle), Math.sin(angle)];
  }

  /** Of words and dots, which stay upright. */
  middle(x, y) {
    const n = this.from.length;
    for (let i = 0; i < n; ++i) {
      x += (this.to[i][0] - this.from[i][0]) / n;
      y += (this.to[i][1] - this.from[i][1]) / n;
    }
    return [x, y];
  }

  /** Of an arrow or a line: with the end that is nearer. */
  point(x, y) {
    if (!(this.length > 0)) return this.middle(x, y);
    const [a] = this.from,
      far = (x - a[0]) * this.way[0] + (y - a[1]) * this.way[1] > this.length / 2 ? 1 : 0;
    const dx = x - this.from[far][0],
      dy = y - this.from[far][1];
    return [this.to[far][0] + this.cos * dx - this.sin * dy, this.to[far][1] + this.sin * dx + this.cos * dy];
  }
}

/** How long the way from the first of two places to the second is, and where it goes. */
function along(places) {
  if (places.length < 2) return [0, 0];
  const x = places[1][0] - places[0][0],
    y = places[1][1] - places[0][1];
  return [Math.hypot(x, y), Math.atan2(y, x)];
}

/** The line of a coil between its ends: draw/plane/springs.cpp. */
function coil(turns, [ax, ay, bx, by, lead, amplitude]) {
  const length = Math.max(Math.hypot(bx - ax, by - ay), 1e-6),
    ux = (bx - ax) / length,
    uy = (by - ay) / length;
  const last = turns * NODES,
    points = new Float32Array(2 * last + 6);
  points[0] = ax;
  points[1] = ay;
  for (let i = 0; i <= last; ++i) {
    const s = (turns * i) / last,
      phase = 2 * Math.PI * s;
    const part = (s - (CREST * Math.sin(2 * phase)) / (4 * Math.PI)) / turns;
    const along = lead + (length - 2 * lead) * part;
    const across = amplitude * smooth(s / RISE) * smooth((turns - s) / RISE) * Math.sin(phase);
    points[2 * i + 2] = ax + ux * along - uy * across;
    points[2 * i + 3] = ay + uy * along + ux * across;
  }
  points[2 * last + 4] = bx;
  points[2 * last + 5] = by;
  return points;
}
