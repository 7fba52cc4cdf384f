// Which bodies are near each other, and what shaders need to darken them there (draw/space/occlusion.cpp): the convex pieces
// of bodies once, and panel by panel which others are near each of them.

import { TEXELS, as_rows } from "./card.js";
import { dot, sub, turned } from "./lens.js";

const DARK_REACH = 1.7,
  DARK_MOST = 0.06; // draw/space/darkness.cpp
const NO_FORM = 0,
  ROUND_FORM = 1,
  BOX_FORM = 2,
  FLAT_FORM = 3; // as shaders.js knows them
const PIECE_TEXELS = 6; // texels of a piece, before the planes of all

/** The middle of a box along its body's axes and half its sides; none of another form. */
function box_of(shape) {
  if (shape.faces.length !== 6 || shape.vertices.length !== 24) return null;
  const low = [0, 1, 2].map((k) => Math.min(...shape.vertices.filter((/** @type {number} */ _, /** @type {number} */ i) => i % 3 === k))),
    high = [0, 1, 2].map((k) => Math.max(...shape.vertices.filter((/** @type {number} */ _, /** @type {number} */ i) => i % 3 === k))),
    close = 1e-5 * Math.max(...sub(high, low));
  const at_end = (/** @type {number} */ x, /** @type {number} */ i) => Math.min(x - low[i % 3], high[i % 3] - x) < close;
  if (!shape.vertices.every(at_end)) return null;
  return { middle: low.map((x, k) => (x + high[k]) / 2), half: low.map((x, k) => (high[k] - x) / 2) };
}

export class Occlusion {
  /** @param {any} space the film's */
  constructor(space) {
    this.space = space;
    const { pieces, shapes } = space,
      least = new Map();
    for (const piece of pieces) least.set(piece.body, Math.min(piece.least, least.get(piece.body) ?? Infinity));
    const texels = new Array(4 * PIECE_TEXELS * pieces.length).fill(0),
      firsts = new Map();
    this.pieces = pieces.map((/** @type {any} */ piece, /** @type {number} */ i) => {
      const at = 4 * PIECE_TEXELS * i,
        material = space.materials?.[piece.body] ?? 0;
      const put = (/** @type {number} */ texel, /** @type {number[]} */ numbers) =>
        numbers.forEach((x, k) => (texels[at + 4 * texel + k] = x));
      (piece.grain ?? []).forEach(
        (/** @type {number} */ x, /** @type {number} */ k) => (texels[at + 12 + 4 * Math.floor(k / 3) + (k % 3)] = x),
      );
      const shape = piece.shape === undefined ? null : shapes[piece.shape];
      if (!shape) {
        const round = piece.radius > 0,
          along = sub(piece.b, piece.a);
        put(0, [...piece.a, piece.radius]);
        put(1, [...piece.b, round ? ROUND_FORM : NO_FORM]);
        put(2, [0, 0, material, piece.least]);
        return {
          body: piece.body,
          center: [0, 1, 2].map((k) => (piece.a[k] + piece.b[k]) / 2),
          around: round ? Math.hypot(...along) / 2 + piece.radius : 0,
          reach: round ? DARK_REACH * least.get(piece.body) : 0,
        };
      }
      if (!firsts.has(piece.shape)) {
        firsts.set(piece.shape, texels.length / 4);
        shape.faces.forEach((/** @type {number[]} */ loop, /** @type {number} */ f) => {
          const n = shape.normals.slice(3 * f, 3 * f + 3);
          texels.push(...n, dot(n, shape.vertices.slice(3 * loop[0], 3 * loop[0] + 3)));
        });
      }
      const box = box_of(shape);
      if (box) put(0, box.middle);
      put(1, box ? [...box.half, BOX_FORM] : [0, 0, 0, FLAT_FORM]);
      put(2, [firsts.get(piece.shape), shape.faces.length, material, piece.least]);
      const center = [0, 0, 0],
        count = shape.vertices.length / 3;
      for (let k = 0; k < 3 * count; ++k) center[k % 3] += shape.vertices[k] / count;
      let around = 0;
      for (let k = 0; k < 3 * count; k += 3) around = Math.max(around, Math.hypot(...sub(shape.vertices.slice(k, k + 3), center)));
      return { body: piece.body, center, around, reach: DARK_REACH * least.get(piece.body) };
    });
    /** All pieces, as texels. */
    this.texels = as_rows(texels);
    const n = pieces.length;
    this.order = Array.from({ length: n }, (_, i) => i);
    this.left = new Float64Array(n);
    this.reaches = new Float64Array(n);
    this.centers = new Float64Array(3 * n);
    /** @type {number[][]} */
    this.near = pieces.map(() => []);
  }

  /**
   * Which pieces are near which, as texels: of each piece its middle and how far it reaches around that; then where its list
   * begins, how long it is, how far others darken it, and its body; then the lists: another, and up to where.
   * @param {Float32Array} poses of bodies
   * @param {import("./lens.js").Lens} lens
   */
  lists(poses, lens) {
    const { pieces, order, left, reaches, centers, near } = this,
      n = pieces.length,
      g = this.space.ground;
    const cap = (DARK_MOST * lens.window[2]) / lens.scale,
      ground = g?.grid ? g : null,
      low = ground ? dot(ground.normal, ground.point) : 0;
    let most = 0;
    for (let i = 0; i < n; ++i) {
      const { body, center, around, reach } = pieces[i];
      const c = turned(poses.subarray(8 * body + 4, 8 * body + 8), center);
      for (let k = 0; k < 3; ++k) centers[3 * i + k] = poses[8 * body + k] + c[k];
      left[i] = centers[3 * i] - around;
      reaches[i] = Math.min(reach, cap);
      most = Math.max(most, reaches[i]);
      near[i].length = 0;
    }
    // in the order of their left ends
    order.sort((i, k) => left[i] - left[k]);
    let entries = 0;
    for (let i = 0; i < n; ++i) {
      const a = order[i],
        end = centers[3 * a] + pieces[a].around + most;
      for (let k = i + 1; k < n && left[order[k]] < end; ++k) {
        const b = order[k],
          apart = pieces[a].around + pieces[b].around + Math.min(reaches[a], reaches[b]);
        const dx = centers[3 * a] - centers[3 * b],
          dy = centers[3 * a + 1] - centers[3 * b + 1],
          dz = centers[3 * a + 2] - centers[3 * b + 2];
        if (dx * dx + dy * dy + dz * dz > apart * apart || !(Math.min(reaches[a], reaches[b]) > 0)) continue;
        near[a].push(b);
        near[b].push(a);
        entries += 2;
      }
      if (ground && reaches[a] > 0) {
        const high = dot(ground.normal, [centers[3 * a], centers[3 * a + 1], centers[3 * a + 2]]) - low;
        if (high < pieces[a].around + reaches[a]) {
          near[a].push(-1);
          ++entries;
        }
      }
    }
    const texels = new Float32Array(Math.ceil((2 * n + entries) / TEXELS) * 4 * TEXELS);
    let next = 2 * n;
    for (let i = 0; i < n; ++i) {
      texels.set(
        [centers[3 * i], centers[3 * i + 1], centers[3 * i + 2], pieces[i].around, next, near[i].length, reaches[i], pieces[i].body],
        8 * i,
      );
      for (const other of near[i]) {
        texels[4 * next] = other;
        texels[4 * next + 1] = other < 0 ? reaches[i] : Math.min(reaches[i], reaches[other]);
        ++next;
      }
    }
    return texels;
  }
}
