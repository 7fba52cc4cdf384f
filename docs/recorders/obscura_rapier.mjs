// Records a simulation by Rapier, of the plane or of space, for obscura: a table of its states, and a scene that shows them.
//
//     import { Recorder } from "./obscura_rapier.mjs";
//     const film = new Recorder(RAPIER, world, "run", 60);   // writes run.csv, and run.toml where there is none
//     film.frame();                                          // before each world.step(), 60 of them a second
//
// RAPIER is the imported package. Each collider is a body of the scene, called by its body's userData where that is a string.

import fs from "node:fs";
import path from "node:path";

const number = (x) => String(Number(x.toPrecision(9))); // as much as Rapier's own 32 bits hold
const list = (v) => `[${v.map(number).join(", ")}]`;
const lists = (all) => `[${all.map(list).join(", ")}]`;
const array = (v) => ("z" in v ? [v.x, v.y, v.z] : [v.x, v.y]);
const thin = 0.01; // half the thickness of what has none

// the middle of a polygon, by the shoelace formula
function centroid(points) {
  let area = 0, x = 0, y = 0;
  points.forEach(([ax, ay], i) => {
    const [bx, by] = points[(i + 1) % points.length], twice = ax * by - bx * ay;
    area += twice / 2, x += ((ax + bx) * twice) / 6, y += ((ay + by) * twice) / 6;
  });
  return [x / area, y / area];
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// a vector of a collider's frame as the world has it; q: an angle, or a quaternion
function turned(v, q) {
  if (v.length === 2) return [Math.cos(q) * v[0] - Math.sin(q) * v[1], Math.sin(q) * v[0] + Math.cos(q) * v[1]];
  const u = [q.x, q.y, q.z], t = cross(u, v).map((c, k) => c + q.w * v[k]), s = cross(u, t);
  return v.map((c, k) => c + 2 * s[k]); // v + 2 u x (u x v + w v)
}

// What a collider looks like: its kind and keys in the scene, and where the middle of that is in its frame.
function look(type, collider, plane) {
  const s = collider.shape, middle = plane ? [0, 0] : [0, 0, 0], n = middle.length;
  const polygon = (points) => {
    const c = centroid(points), own = points.map((p) => [p[0] - c[0], p[1] - c[1]]);
    return { kind: "polygon", keys: `points = ${lists(own)}`, middle: c, reach: Math.max(...own.map((p) => Math.hypot(...p))) };
  };
  const box = (sides, c) => ({ kind: "box", keys: `size = ${list(sides)}`, middle: c, reach: Math.hypot(...sides) / 2 });
  if (type === "Ball") return { kind: "ball", keys: `radius = ${number(s.radius)}`, middle, reach: s.radius };
  if (/Cuboid/.test(type)) return box(array(s.halfExtents).map((x) => 2 * x), middle);
  if (type === "Capsule") {
    const r = s.radius, h = s.halfHeight, reach = r + h;
    if (!plane) return { kind: "capsule", keys: `radius = ${number(r)}\nlength = ${number(2 * reach)}`, middle, reach };
    const ends = [h, -h].map((y) => `{ radius = ${number(r)}, position = ${list([0, y])} }`);
    return { kind: "body", keys: `shapes = [{ size = ${list([2 * r, 2 * h])} }, ${ends.join(", ")}]`, middle, reach };
  }
  if (/Cylinder/.test(type)) {
    const ring = (y) => Array.from({ length: 24 }, (_, i) => (i * Math.PI) / 12).map((a) => [s.radius * Math.cos(a), y, s.radius * Math.sin(a)]);
    const keys = `points = ${lists([...ring(s.halfHeight), ...ring(-s.halfHeight)])}`;
    return { kind: "hull", keys, middle, reach: Math.hypot(s.radius, s.halfHeight) };
  }
  if (type === "Segment" && plane) {
    const [a, b] = [array(s.a), array(s.b)], d = [b[0] - a[0], b[1] - a[1]], k = thin / Math.hypot(...d), m = [-k * d[1], k * d[0]];
    return polygon([[a, 1], [a, -1], [b, -1], [b, 1]].map(([p, side]) => [p[0] + side * m[0], p[1] + side * m[1]]));
  }
  const flat = s.a ? [s.a, s.b, s.c].filter(Boolean).flatMap(array) : [...(s.vertices ?? [])];
  const points = Array.from({ length: flat.length / n }, (_, i) => flat.slice(i * n, (i + 1) * n));
  if (!points.length) return null; // half-spaces, height fields, voxels
  if (plane && /Convex|Triangle/.test(type)) return polygon(points);
  // what else there is: the box around it
  const axes = middle.map((_, k) => points.map((p) => p[k])), low = axes.map((a) => Math.min(...a)), high = axes.map((a) => Math.max(...a));
  return box(low.map((l, k) => Math.max(high[k] - l, 2 * thin)), low.map((l, k) => (l + high[k]) / 2));
}

export class Recorder {
  constructor(RAPIER, world, name, rate = 60) {
    Object.assign(this, { types: RAPIER.ShapeType, world, name, rate, rows: 0, scene: "", moving: null });
    this.plane = !("z" in world.gravity);
    this.low = Array(this.plane ? 2 : 3).fill(Infinity), this.high = this.low.map((x) => -x);
    this.table = fs.openSync(`${name}.csv`, "w");
    process.on("exit", () => this.close());
  }

  // the colliders of the first frame are those of the table
  begin() {
    const taken = new Set(), axes = this.plane ? ["x", "y"] : ["x", "y", "z"];
    const of = (name, parts) => parts.map((part) => `${name}.${part}`);
    const columns = [...of("position", axes), ...(this.plane ? ["angle"] : of("orientation", ["x", "y", "z", "w"])),
                     ...of("velocity", axes), ...(this.plane ? ["spin"] : of("spin", axes))];
    this.moving = [];
    this.world.forEachCollider((collider) => {
      const body = collider.parent(), it = look(this.types[collider.shapeType()], collider, this.plane);
      if (!it) return;
      let name = typeof body?.userData === "string" ? body.userData.replace(/[^A-Za-z0-9_-]/g, "_").replace(/^(?![A-Za-z_])/, "_") : "body";
      if (name === "body" || taken.has(name)) name += `_${taken.size}`;
      taken.add(name);
      Object.assign(it, { name, body, collider, fixed: !body || body.isFixed(), angle: 0 });
      const [position, q] = this.pose(it), sine = this.plane ? 0 : Math.hypot(q.x, q.y, q.z);
      this.scene += `\n[[${it.kind}]]\nname = "${name}"\n${it.keys}\nposition = ${list(position)}\n`;
      if (this.plane) this.scene += `angle = ${number((it.angle * 180) / Math.PI)}\n`;
      else if (sine > 1e-9) this.scene += `orientation = { axis = ${list([q.x, q.y, q.z])}, angle = ${number((Math.atan2(sine, q.w) * 360) / Math.PI)} }\n`;
      if (it.fixed) this.scene += 'fixed = true\ncolor = "grey"\n';
      else this.moving.push(it);
    });
    fs.writeSync(this.table, ["time", ...this.moving.flatMap((it) => of(it.name, columns))].join(",") + "\n");
  }

  // where the middle of a collider is, and its rotation
  pose(it) {
    const q = it.collider.rotation(), away = turned(it.middle, q), whole = 2 * Math.PI;
    if (this.plane) it.angle += q - it.angle - whole * Math.round((q - it.angle) / whole); // counted on, not wrapped
    return [array(it.collider.translation()).map((x, k) => x + away[k]), q];
  }

  frame() {
    if (!this.moving) this.begin();
    const cells = [];
    for (const it of this.moving) {
      if (it.collider.isValid()) { // else it was removed, and stays where it was
        const [p, q] = this.pose(it), [x, y, z] = p, w = it.body.angvel();
        const turn = this.plane ? [it.angle] : [q.x, q.y, q.z, q.w];
        it.cells = [...p, ...turn, ...array(it.body.velocityAtPoint(this.plane ? { x, y } : { x, y, z })), ...(this.plane ? [w] : array(w))];
        p.forEach((c, k) => (this.low[k] = Math.min(this.low[k], c - it.reach), this.high[k] = Math.max(this.high[k], c + it.reach)));
      }
      cells.push(...it.cells);
    }
    fs.writeSync(this.table, [String(this.rows++ / this.rate), ...cells.map(number)].join(",") + "\n");
  }

  close() {
    if (fs.existsSync(`${this.name}.toml`) || !this.rows) return; // a scene that is there is yours
    const margin = 0.1 * Math.max(...this.low.map((l, k) => this.high[k] - l)), last = this.rows - 1;
    const size = this.low.map((l, k) => this.high[k] - l + 2 * margin), corner = this.low.map((l) => l - margin);
    fs.writeFileSync(`${this.name}.toml`, `duration = 3600  # or the table's end\n[film]\nfps = ${this.rate}\n[physics]\noverlap = "separate"\n
[room]\nsize = ${list(size)}\ncorner = ${list(corner)}\nwalls = "none"\n
[golden]\nstates = "${path.basename(this.name)}.csv"\nat = ["${last >> 1}/${this.rate}", "${last}/${this.rate}"]\n${this.scene}`);
  }
}
