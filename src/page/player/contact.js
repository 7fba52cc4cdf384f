// How much darker the ground is where bodies are near it (draw/space/light.cpp, GroundShadow::touch): level by level, all
// that is nearer than a distance.

import { cross, dot, plus, sub, turned, unit } from "./lens.js";

const LEVELS = 16,
  MANY = 64,
  RIM = 12;
const FALL = 1.6,
  FOOT = 0.35,
  REACH_OF = 1.4,
  MOST = 0.06; // as there, and draw/space/shadows.cpp

/** The hull of points of a plane, in order. */
export function hull(points) {
  const all = points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]),
    out = [];
  const chain = (each) => {
    const first = out.length;
    for (const p of each) {
      while (out.length >= first + 2) {
        const a = out[out.length - 2],
          b = out[out.length - 1];
        if ((b[0] - a[0]) * (p[1] - b[1]) - (b[1] - a[1]) * (p[0] - b[0]) > 1e-12) break;
        out.pop();
      }
      out.push(p);
    }
    out.pop();
  };
  chain(all);
  chain(all.reverse());
  return out.length > 0 ? out : points.slice(0, 1);
}

/**
 * Darkens the ground under a panel's bodies.
 * @param {CanvasRenderingContext2D} c in page units
 * @param {any} space
 * @param {import("./lens.js").Lens} lens
 * @param {(body: number) => {at: number[], turn: number[]}} body_of
 * @param {boolean} dark
 */
export function draw_contacts(c, space, lens, body_of, dark) {
  const { normal, point } = space.ground;
  let u = plus([1, 0, 0], normal, -normal[0]);
  if (Math.hypot(...u) < 0.1) u = plus([0, 0, 1], normal, -normal[2]);
  u = unit(u);
  const v = cross(u, normal),
    feet = [];
  for (const piece of space.pieces) {
    const { at, turn } = body_of(piece.body);
    const reach = Math.min(REACH_OF * piece.least, (MOST * lens.window[2]) / lens.scale);
    const ball = piece.shape === undefined,
      radius = ball ? Math.max(piece.radius, (piece.dot ?? 0) / lens.scale) : 0;
    const shape = ball ? piece.a.concat(piece.b) : space.shapes[piece.shape].vertices,
      corners = [];
    for (let i = 0; i < shape.length; i += 3) {
      const p = sub(plus(at, turned(turn, shape.slice(i, i + 3))), point),
        high = dot(p, normal);
      if (high - radius < reach && high > -reach) corners.push({ p: [dot(p, u), dot(p, v)], high });
    }
    if (corners.length > 0) feet.push({ corners, reach, radius });
  }
  const share = feet.length > MANY ? 4 : 1,
    alpha = (((dark ? 150 : 90) / 255) * share) / LEVELS;
  // of one grey: channels of their own would be rounded apart, level upon level
  c.fillStyle = dark ? `rgba(0,0,0,${alpha})` : `rgba(24,24,24,${alpha})`;
  for (let i = 0; i < LEVELS; i += share) {
    c.beginPath();
    for (const { corners, reach, radius } of feet) {
      // the hull of the discs under its corners, each as much smaller as it is higher
      const near = reach * ((i + share) / LEVELS) ** FALL,
        rims = [];
      for (const { p, high } of corners) {
        const wide = near - Math.max(high - radius, 0) + FOOT * radius;
        if (wide <= FOOT * radius) continue;
        for (let k = 0; k < RIM; ++k) {
          const a = (2 * Math.PI * k) / RIM;
          rims.push([p[0] + wide * Math.cos(a), p[1] + wide * Math.sin(a)]);
        }
      }
      if (rims.length === 0) continue;
      let first = true;
      for (const [x, y] of hull(rims)) {
        const at = plus(plus(point, u, x), v, y);
        if (lens.depth(at) < 0.02) {
          first = true;
          continue;
        }
        const [px, py] = lens.page(at);
        if (first) c.moveTo(px, py);
        else c.lineTo(px, py);
        first = false;
      }
      c.closePath();
    }
    c.fill();
  }
}
