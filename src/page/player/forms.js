// Triangles of bodies in space, each corner as a centre, a normal, and how far along it the corner lies.

import { cross, dot, plus, sub, unit } from "./lens.js";

export const CORNER = 9; // numbers: centre, normal, radius (negative: page units), body, piece from 1 on

export const rgb = (/** @type {number[]} */ c) => (c[0] << 16) | (c[1] << 8) | c[2];

const SIDES = 8; // of a tube
const COIL_NODES = 14; // of a coil's turn, as in draw/space/links.cpp
const LEAVES = 0.5; // turns over which it leaves its axis

/** Corners that come to be triangles. */
export class Mesh {
  constructor() {
    /** @type {number[]} */
    this.corners = [];
    /** @type {number[]} */
    this.colors = []; // one a corner, 0xRRGGBB
    /** @type {boolean[]} */
    this.round = []; // one a corner: of a surface that is
  }

  add(center, normal, radius, body, piece, color, round = true) {
    this.corners.push(center[0], center[1], center[2], normal[0], normal[1], normal[2], radius, body, piece);
    this.colors.push(color);
    this.round.push(round);
  }

  get count() {
    return this.colors.length;
  }

  /** A polyhedron's faces. */
  flat(shape, body, piece, color) {
    const at = (/** @type {number} */ i) => shape.vertices.slice(3 * i, 3 * i + 3);
    let first = 0; // corner of this face
    shape.faces.forEach((/** @type {number[]} */ loop, /** @type {number} */ f) => {
      const own = shape.normals.slice(3 * f, 3 * f + 3),
        normals = loop.map((_, i) => shape.round?.slice(3 * (first + i), 3 * (first + i) + 3) ?? own),
        round = normals.some((n) => dot(n, own) < 1 - 1e-6); // of a round surface
      for (let i = 2; i < loop.length; ++i)
        for (const k of [0, i - 1, i]) this.add(at(loop[k]), normals[k], 0, body, piece, color, round);
      first += loop.length;
    });
  }

  /** A ball, or the half of one that looks along `axis` from `from` (cosine). */
  ball(center, radius, body, piece, color, around) {
    const rings = around / 2;
    const normal = (/** @type {number} */ r, /** @type {number} */ k) => {
      const polar = (Math.PI * r) / rings,
        turn = (2 * Math.PI * k) / around;
      return [Math.sin(polar) * Math.cos(turn), Math.cos(polar), Math.sin(polar) * Math.sin(turn)];
    };
    for (let r = 0; r < rings; ++r)
      for (let k = 0; k < around; ++k)
        for (const [dr, dk] of [
          [0, 0],
          [0, 1],
          [1, 1],
          [0, 0],
          [1, 1],
          [1, 0],
        ])
          this.add(center, normal(r + dr, k + dk), radius, body, piece, color);
  }

  /** A tube without ends along places. */
  tube(way, radius, body, piece, color, sides = SIDES) {
    /** @type {number[] | null} */
    let side = null;
    /** @type {number[][] | null} */
    let before = null;
    for (let i = 0; i < way.length; ++i) {
      const along = unit(
        plus(i > 0 ? unit(sub(way[i], way[i - 1])) : [0, 0, 0], i + 1 < way.length ? unit(sub(way[i + 1], way[i])) : [0, 0, 0]),
      );
      if (!side) side = unit(cross(along, Math.abs(along[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0]));
      side = unit(plus(side, along, -dot(side, along)));
      const up = cross(along, side),
        ring = [];
      for (let k = 0; k < sides; ++k) {
        const a = (2 * Math.PI * k) / sides;
        ring.push(plus(plus([0, 0, 0], side, Math.cos(a)), up, Math.sin(a)));
      }
      for (let k = 0; before && k < sides; ++k) {
        const l = (k + 1) % sides;
        for (const [j, n] of /** @type {[number, number[]][]} */ ([
          [i - 1, before[k]],
          [i, ring[k]],
          [i, ring[l]],
          [i - 1, before[k]],
          [i, ring[l]],
          [i - 1, before[l]],
        ]))
          this.add(way[j], n, radius, body, piece, color);
      }
      before = ring;
    }
  }
}

const smooth_end = (/** @type {number} */ u) => {
  const s = Math.min(Math.max(u, 0), 1);
  return s * s * (3 - 2 * s);
};

/** The wire of a coil from a to b. */
export function helix(a, b, turns, wire, radius) {
  const length = Math.hypot(...sub(b, a));
  if (turns === 0 || length < 1e-9) return [a, b];
  const d = unit(sub(b, a)),
    level = cross([0, 1, 0], d);
  const u = Math.hypot(...level) > 0.05 ? unit(level) : unit(plus([1, 0, 0], d, -d[0])),
    v = cross(d, u);
  const lead = Math.min(Math.min(Math.max(0.085 * length, 2 * wire), 14 * wire), 0.2 * length),
    way = [a];
  for (let i = 0; i <= turns * COIL_NODES; ++i) {
    const s = i / COIL_NODES,
      turn = 2 * Math.PI * s,
      high = radius * smooth_end(s / LEAVES) * smooth_end((turns - s) / LEAVES);
    way.push(plus(plus(plus(a, d, lead + ((length - 2 * lead) * s) / turns), u, high * Math.cos(turn)), v, high * Math.sin(turn)));
  }
  way.push(b);
  return way;
}

/** The bodies' forms: triangles; edges, rounds' outlines and capsules' sides as the programs take them; how far each reaches. */
export function forms_of(space) {
  const mesh = new Mesh(),
    edges = [],
    rounds = [],
    sides = [];
  const balls = space.pieces.filter((/** @type {any} */ p) => p.shape === undefined).length;
  const around = balls > 200 ? 16 : balls > 40 ? 24 : 48;
  /** @type {number[]} */
  const reaches = new Array(space.colors.length).fill(0);
  space.pieces.forEach((/** @type {any} */ piece, /** @type {number} */ i) => {
    const own = rgb(space.colors[piece.body]),
      of_one = (/** @type {number} */ c) => c / 255,
      ink = space.edges[piece.body].map(of_one),
      crease = space.creases[piece.body].slice(0, 3).map(of_one);
    const number = i + 1;
    let reach = 0;
    if (piece.shape !== undefined) {
      const shape = space.shapes[piece.shape];
      mesh.flat(shape, piece.body, number, own);
      const at = (/** @type {number} */ i) => shape.vertices.slice(3 * i, 3 * i + 3);
      const normal = (/** @type {number} */ f) => shape.normals.slice(3 * f, 3 * f + 3);
      for (let i = 0; i < shape.edges.length; i += 4) {
        const [a, b, left, right] = shape.edges.slice(i, i + 4);
        const n = normal(left),
          m = right >= 0 ? normal(right) : [-n[0], -n[1], -n[2]];
        edges.push(...at(a), ...at(b), ...n, ...m, piece.body, piece.least, ink[0], ink[1], ink[2], ...crease);
      }
      for (let i = 0; i < shape.vertices.length; i += 3) reach = Math.max(reach, Math.hypot(...at(i / 3)));
    } else {
      const radius = piece.dot ? -piece.dot : piece.radius;
      mesh.ball(piece.a, radius, piece.body, number, own, around);
      const axis = sub(piece.b, piece.a);
      rounds.push(...piece.a, radius, piece.body, ink[0], ink[1], ink[2], ...axis);
      if (Math.hypot(...axis) > 0) {
        mesh.ball(piece.b, radius, piece.body, number, own, around);
        mesh.tube([piece.a, piece.b], piece.radius, piece.body, number, own, around);
        rounds.push(...piece.b, radius, piece.body, ink[0], ink[1], ink[2], -axis[0], -axis[1], -axis[2]);
        for (const side of [-1, 1]) sides.push(...piece.a, ...piece.b, piece.radius, side, piece.body, ink[0], ink[1], ink[2]);
      }
      reach = Math.max(Math.hypot(...piece.a), Math.hypot(...piece.b)) + piece.radius;
    }
    reaches[piece.body] = Math.max(reaches[piece.body], reach);
  });
  return { mesh, edges, rounds, sides, reaches };
}
