// Which body one points at in space: the first that a ray meets.

import { dot, plus, sub } from "./lens.js";

/**
 * Between which lengths a ray is inside of planes {x: n x = d}; the first is not less than the second where it misses.
 * @param {{n: number[], d: number}[]} planes
 * @returns {[number, number]}
 */
export function inside_planes(planes, from, way) {
  let enters = -Infinity,
    leaves = Infinity;
  for (const { n, d } of planes) {
    const high = dot(n, from) - d,
      rise = dot(n, way);
    if (Math.abs(rise) < 1e-12) {
      if (high > 0) return [Infinity, -Infinity];
    } else if (rise < 0) {
      enters = Math.max(enters, -high / rise);
    } else {
      leaves = Math.min(leaves, -high / rise);
    }
  }
  return [enters, leaves];
}

/** How far along a ray it meets a polyhedron. */
export function meets_flat(shape, from, way) {
  const planes = shape.faces.map((/** @type {number[]} */ face, /** @type {number} */ f) => {
    const n = shape.normals.slice(3 * f, 3 * f + 3);
    return { n, d: dot(n, shape.vertices.slice(3 * face[0], 3 * face[0] + 3)) };
  });
  const [enters, leaves] = inside_planes(planes, from, way);
  return enters < leaves ? enters : Infinity;
}

/** How far along a ray it meets a ball, or a capsule. */
export function meets_ball(piece, from, way, least) {
  const radius = Math.max(piece.radius, piece.dot ? least : 0),
    along = sub(piece.b, piece.a),
    l = dot(along, along);
  let best = Infinity;
  for (let i = 0; i <= (l > 0 ? 16 : 0); ++i) {
    const p = sub(from, plus(piece.a, along, l > 0 ? i / 16 : 0)),
      b = dot(p, way),
      c = dot(p, p) - radius * radius;
    if (b * b >= c) best = Math.min(best, -b - Math.sqrt(b * b - c));
  }
  return best;
}
