// Which body one points at in space: the first that a ray meets.

import { dot, plus, sub } from "./lens.js";

/** How far along a ray it meets a polyhedron. */
export function meets_flat(shape, from, way) {
  let enters = -Infinity,
    leaves = Infinity;
  for (let f = 0; f < shape.faces.length; ++f) {
    const n = shape.normals.slice(3 * f, 3 * f + 3),
      v = shape.faces[f][0],
      p = shape.vertices.slice(3 * v, 3 * v + 3);
    const high = dot(n, sub(from, p)),
      rise = dot(n, way);
    if (Math.abs(rise) < 1e-12) {
      if (high > 0) return Infinity;
    } else if (rise < 0) {
      enters = Math.max(enters, -high / rise);
    } else {
      leaves = Math.min(leaves, -high / rise);
    }
  }
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
