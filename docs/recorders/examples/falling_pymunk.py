"""Three lines of obscura's in a pymunk program: a ball and a leaning crate fall onto a slope."""

import pymunk
from obscura_pymunk import Recorder

space = pymunk.Space()
space.gravity = 0, -9.81
slope = pymunk.Segment(space.static_body, (-2, 0.4), (3, 0), 0.05)
slope.elasticity, slope.friction = 0.5, 0.6
space.add(slope)

ball = pymunk.Body(1, pymunk.moment_for_circle(1, 0, 0.2))
ball.position = 0, 2
round_shape = pymunk.Circle(ball, 0.2)
crate = pymunk.Body(2, pymunk.moment_for_box(2, (0.6, 0.4)))
crate.position, crate.angle = (0.9, 1.4), 0.3
square = pymunk.Poly.create_box(crate, (0.6, 0.4))
for body, shape in (ball, round_shape), (crate, square):
    shape.elasticity, shape.friction = 0.5, 0.6
    space.add(body, shape)

film = Recorder(space, "run", rate=60, names={ball: "ball", crate: "crate"})
for step in range(91):
    film.frame()
    space.step(1 / 60)
