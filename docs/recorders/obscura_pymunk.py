"""Records a pymunk simulation for obscura: a table of its states, and a scene that shows them.

    from obscura_pymunk import Recorder
    film = Recorder(space, "run", rate=60)      # writes run.csv, and run.toml where there is none
    ...
    film.frame()                                # before each step, `rate` of them a second
    space.step(1 / 60)

    obscura render run.toml --states run.csv    # the film
    obscura golden run.toml --update            # the golden
"""

import atexit
import math
import os
import re

import pymunk

THIN = 0.01  # half the thickness of a segment without a radius, of the picture's height


def centroid(points):
    """Area and centroid of a simple polygon, by the shoelace formula."""
    area = x = y = 0.0
    for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1]):
        cross = ax * by - bx * ay
        area, x, y = area + cross / 2, x + (ax + bx) * cross / 6, y + (ay + by) * cross / 6
    return abs(area), (x / area, y / area)


class Recorder:
    """`scale` is metres per unit of the space; where gravity points along +y, y is turned around."""

    def __init__(self, space, name, rate=60, scale=1.0, names=None):
        self.space, self.name, self.rate, self.scale = space, name, rate, scale
        self.up = -1.0 if space.gravity[1] > 0 else 1.0
        self.names = dict(names or {})  # body: "name"; others have the attribute `name`, or a number
        self.bodies, self.rows = None, 0
        self.low, self.high = [math.inf] * 2, [-math.inf] * 2
        atexit.register(self.close)

    def point(self, p):
        return (p[0] * self.scale, p[1] * self.scale * self.up)

    def parts(self, shape, thin):
        """What a shape consists of: (area, centroid, kind, numbers), in the body's frame and in metres."""
        if isinstance(shape, pymunk.Circle):
            r, c = shape.radius * self.scale, self.point(shape.offset)
            return [(math.pi * r * r, c, "circle", r)]
        if isinstance(shape, pymunk.Segment):
            r, a, b = shape.radius * self.scale or thin, self.point(shape.a), self.point(shape.b)
            length, middle = math.dist(a, b), ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
            angle = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
            parts = [(2 * r * length, middle, "box", (length, 2 * r, angle))]
            return parts + ([(math.pi * r * r, end, "circle", r) for end in (a, b)] if shape.radius else [])
        points = [self.point(p) for p in shape.get_vertices()]
        area, middle = centroid(points)
        return [(area, middle, "polygon", points)]

    def begin(self):
        """The bodies of the first frame are those of the table."""
        shapes = {}
        for shape in self.space.shapes:
            shape.cache_bb()
            shapes.setdefault(shape.body, []).append(shape)
        size = max((max(s.bb.right - s.bb.left, s.bb.top - s.bb.bottom) for s in self.space.shapes), default=1)
        self.bodies, taken = [], set()
        for i, (body, all_of_it) in enumerate(shapes.items()):
            parts = [part for s in all_of_it for part in self.parts(s, THIN * size * self.scale / 2)]
            area = sum(p[0] for p in parts)
            middle = [sum(p[0] * p[1][k] for p in parts) / area for k in (0, 1)]
            name = re.sub(r"[^A-Za-z0-9_-]", "_", str(self.names.get(body, getattr(body, "name", f"body{i}"))))
            name = name if re.match(r"[A-Za-z_]", name) else "_" + name
            name = f"{name}_{i}" if name in taken else name
            taken.add(name)
            reach = max(math.hypot(s.bb.right - s.bb.left, s.bb.top - s.bb.bottom) for s in all_of_it) * self.scale
            self.bodies.append((name, body, parts, middle, reach / 2, self.pose(body, middle)))
        self.moving = [b for b in self.bodies if b[1].body_type != pymunk.Body.STATIC]
        self.table = open(self.name + ".csv", "w", encoding="utf-8")
        columns = ["position.x", "position.y", "angle", "velocity.x", "velocity.y", "spin"]
        self.table.write(",".join(["time"] + [f"{b[0]}.{c}" for b in self.moving for c in columns]) + "\n")

    def pose(self, body, middle):
        """Where the middle of its shapes is, and how fast: what obscura calls its position and velocity."""
        angle, spin = body.angle * self.up, body.angular_velocity * self.up
        (x, y), (vx, vy) = self.point(body.position), self.point(body.velocity)
        rx = math.cos(angle) * middle[0] - math.sin(angle) * middle[1]
        ry = math.sin(angle) * middle[0] + math.cos(angle) * middle[1]
        gx, gy = self.point(body.center_of_gravity)  # its velocity is that of its centre of gravity
        dx, dy = rx - (math.cos(angle) * gx - math.sin(angle) * gy), ry - (math.sin(angle) * gx + math.cos(angle) * gy)
        return x + rx, y + ry, angle, vx - spin * dy, vy + spin * dx, spin

    def frame(self):
        if self.bodies is None:
            self.begin()
        cells = [self.rows / self.rate]
        for _, body, _, middle, reach, _ in self.moving:
            pose = self.pose(body, middle)
            cells += pose
            for k in (0, 1):
                self.low[k] = min(self.low[k], pose[k] - reach)
                self.high[k] = max(self.high[k], pose[k] + reach)
        self.table.write(",".join(repr(float(x)) for x in cells) + "\n")
        self.rows += 1

    def close(self):
        atexit.unregister(self.close)
        if not self.rows or self.table.closed:
            return
        self.table.close()
        if not os.path.exists(self.name + ".toml"):  # from then on it is yours
            with open(self.name + ".toml", "w", encoding="utf-8") as scene:
                scene.write(self.scene())

    def scene(self):
        last, low, high = self.rows - 1, self.low, self.high
        margin = 0.1 * max(h - l for l, h in zip(low, high))
        text = f"duration = 3600  # or the table's end\n\n[film]\nfps = {self.rate}\n\n[room]\n"
        text += f"size = [{high[0] - low[0] + 2 * margin!r}, {high[1] - low[1] + 2 * margin!r}]\n"
        text += f'corner = [{low[0] - margin!r}, {low[1] - margin!r}]\nwalls = "none"\n\n[physics]\n'
        moments = sorted({0, last // 2, last})
        text += 'overlap = "separate"\n\n[golden]\nat = [' + ", ".join(f'"{n}/{self.rate}"' for n in moments)
        text += f']\nstates = "{os.path.basename(self.name)}.csv"\n'
        for name, body, parts, middle, _, (x, y, angle, *_) in self.bodies:
            text += f'\n[[body]]\nname = "{name}"\nposition = [{x!r}, {y!r}]\nangle = {math.degrees(angle)!r}\n'
            text += "fixed = true\ncolor = \"grey\"\n" if body.body_type == pymunk.Body.STATIC else ""
            text += "shapes = [\n"
            for _, c, kind, value in parts:
                at = f"position = [{c[0] - middle[0]!r}, {c[1] - middle[1]!r}]"
                if kind == "circle":
                    text += f"  {{ radius = {value!r}, {at} }},\n"
                elif kind == "box":
                    text += f"  {{ size = [{value[0]!r}, {value[1]!r}], {at}, angle = {value[2]!r} }},\n"
                else:
                    points = ", ".join(f"[{p[0] - middle[0]!r}, {p[1] - middle[1]!r}]" for p in value)
                    text += f"  {{ points = [{points}] }},\n"
            text += "]\n"
        return text
