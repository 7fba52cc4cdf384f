// The page that documents the language: a few words on each part, and under them its rows of the table of
// keys.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "scene/keys.h"
#include "scene/table.h"

namespace obscura::scene {

namespace {

constexpr const char* kOpening = R"page(# The scene language

A scene is a [TOML](https://toml.io) file that says what is in a room, what it looks like and how it is filmed. Most keys have a
default; this is a complete scene:

```toml
title    = "A bouncing box"
duration = 20
[room]
size = [4, 3]
[[box]]
size       = [0.6, 0.4]
position   = [1, 2]
velocity   = [1.5, 0]
angle      = 20
elasticity = 0.8
[look]
trails = 1.0
```

`obscura new NAME` writes a commented scene to start from; `obscura check SCENE` lists a scene's errors. With the first line
`#:schema ../docs/scene.schema.json` editors complete keys and check values.

Units are metres, kilograms and seconds; angles are in degrees, counter-clockwise. x points right, y up, and the origin is the left end of
the floor, unless `room.corner` moves it. Numbers may be written `2` or `2.0`. Times are exact: `duration = 0.1` is one tenth.

## The plane and space

A scene is in space if `room.size`, or without it the first position in the file, has three numbers; otherwise it is in the plane. Where
the tables below say [x, y], a scene in space has [x, y, z]: x right, y up, z towards the viewer; the origin is the middle of the floor.

```toml
[room]
size  = [6, 3, 4]                                                # six walls
walls = "ground"                                                 # only the floor of them

[[box]]
size        = [0.6, 0.4, 0.3]
position    = [0, 1, 0]
orientation = [0, 30, 0]                                         # degrees about x, then y, then z of the room
# orientation = { axis = [1, 1, 0], angle = 30 }                 # or about an axis
spin        = [0, 0, 90]                                         # degrees per second, about axes of the room

[[capsule]]                                                      # along its own y
length   = 0.8
radius   = 0.1
position = [1, 1, 0]

[[hull]]                                                         # a wedge: the convex hull of its points
points   = [[0, 0, 0], [1, 0, 0], [1, 0.5, 0], [0, 0, 1], [1, 0, 1], [1, 0.5, 1]]
position = [-2, 0, 0]
fixed    = true
```

`rotation = false` keeps a body from turning; in `[physics]` it applies to all bodies.

Without a `[camera]` the picture shows the room from the right and above. Several cameras show the same run side by side:

```toml
[[camera]]
view = "side"

[[camera]]
name      = "around"
azimuth   = 30                                                   # degrees: 0 is from the front, 90 from the right
elevation = 20
orbit     = 12                                                   # degrees per second
follow    = "box[0]"
```

`obscura render SCENE --camera side` films one of them; `-o '{camera}.mp4'` makes a movie for each.

The program writes this page from the table that it checks scenes with.

## Names and references

Springs, trails and `--set` refer to a body by its `name`. A body without a name is numbered in the order of the file: `box[0]`,
`particle[2]`. Copies are numbered from 0: `ball[0]`, `ball[1]`, ... Where several bodies are allowed, `ball[*]` means all of them,
`ball[0..4]` the first five, `ball[0,5]` two.

`--set` uses the same names in paths to any key:

    --set crate.elasticity=0.5      --set film.fps=30              --set ball[3].position.y=2
    --set room.gravity=[0,-1.62]    --set mouse[0].stiffness=20    --set look.theme=screen

## Copies

`copies` makes a row, a grid or a ring of a body of any kind:

```toml
[[particle]]
name       = "ball"
position   = [1, 4]
elasticity = { from = 0, to = 1 }                           # evenly from the first copy to the last
color      = ["blue", "orange"]                             # in turn
copies     = { count = 6, offset = [0.5, 0] }               # a row
# copies   = { count = [6, 2], offset = [[0.5, 0], [0, 0.5]] }   # a grid
# copies   = { count = 12, turn = 30, around = [4, 2] }     # a ring
```

Where the table below says *varies*, a number may also be a list with one value for each copy, or `{ from, to }`; a position may be
`{ from, to }`, a velocity also a list of velocities. In a grid the copies are counted along the first direction, then row by row. `jitter` moves each copy a little; it
depends only on `seed` and on the copy, so it stays the same when other parts of the scene change.

## Springs and nets

An end of a spring is a body (its centre of mass), a point of a body that turns, or a place in the room:

```toml
between = ["ball", "crate"]
between = ["ball", { body = "crate", at = "top right" }]         # of a box: a corner, a side, the center; of a ball: a side
between = [[4, 4.5], { body = "crate", local = [0.2, 0] }]       # metres in the body's own frame, from its origin
between = ["peg[*]", "ball[*]"]                                  # a spring for each pair of copies
```

If `between` makes many springs, their numbers may vary as those of copies do. A `[[net]]` joins the copies of one body to their
neighbours; `fixed` holds some of them:

```toml
[[particle]]
name     = "knot"
position = [2, 4.5]
mass     = 0.05
fixed    = "0..4"                                                # the first row
copies   = { count = [5, 4], offset = [[0.3, 0], [0, -0.3]] }

[[net]]
of        = "knot"
stiffness = 60
```

## Bodies of other shapes

A box and a ball have their origin at their centre. The `points` of a polygon, and the `shapes` of a body with several, are given in the
body's own frame. `position` is where the origin of this frame lies, `angle` turns about it, and `local` of a spring or joint is measured
from it. The centre of mass follows from the shape; `velocity`, trails and `states` are those of the centre of mass.

```toml
[[polygon]]                                                      # a stone of an arch, and ten more
points = [[0.8, 0], [1.2, 0], [1.15, 0.34], [0.767, 0.226]]
copies = { count = 11, turn = 16.4, around = [4, 0] }
position = [4, 0]
group  = "stones"

[[body]]                                                         # a dumb-bell
shapes = [
  { size = [0.6, 0.08] },
  { radius = 0.15, position = [-0.3, 0] },
  { radius = 0.15, position = [0.3, 0] },
]

[contact]
ignore = [["stones", "stones"]]                                  # these do not touch each other; names of bodies will do
```

## Joints

A joint connects two bodies, or a body and the `"room"`. A pin, weld or slider is at one place, given as `at` or as a point of either end. A
rod or rope goes from one point to another, as a spring does:

```toml
[[joint]]
type    = "pin"
between = ["door", "room"]
at      = [2, 1.5]
limits  = [-30, 90]                                              # degrees from its angle at the start

[[joint]]                                                        # nine: each plank to the next
type    = "pin"
between = [{ body = "plank[0..8]", at = "right" }, { body = "plank[1..9]", at = "left" }]

[[joint]]
type    = "slider"
between = ["piston", "room"]
axis    = [0, 1]
motor   = { speed = 0.5, most = 20 }

[[joint]]
type    = "rope"
between = [[4, 4], { body = "crate", at = "top" }]
breaks  = 50
```

Two bodies with a joint between them do not touch each other, unless the joint has `touching = true`.

A pin, in space a hinge, and a slider may have a spring against their angle or way, and a motor that has a speed, or follows an angle or a
position, which may be expressions of the time `t`. A motor gives at most its `most`; where that was not enough it comes back as fast as it can.
In space a screw slides and turns at once.

```toml
[[joint]]                                                        # a torsion pendulum
type    = "pin"
between = ["bar", "room"]
spring  = { stiffness = 4, damping = 0.1, rest_angle = 30 }      # N m/rad, N m s/rad, degrees

[[joint]]
type    = "slider"
between = ["piston", "room"]
motor   = { position = "0.2*sin(3*t)", most = 50 }
```

A pulley is a rope without mass, which runs from the first end `over` points of the room and of bodies to the second: it slides over them
without friction, pulls alone, and several turns make a block and tackle. In the plane the name of a ball that turns is a wheel: the rope runs
around it, on the side of the shorter way, without slipping, and the wheel's inertia counts; the tensions on both sides of it differ, and each
piece of the rope is a joint of its own, `rope[0]`, `rope[1]`, ..., that reports its own. A rope whose end is the wheel that it last runs over is
wound on it, as on a yo-yo or a winch: it leaves the wheel on the side on which its other end lies. A gear makes the angle of a pin, in space of a hinge,
a ratio times that of another: wheels with teeth outside have a negative ratio, that of their radii. With the way of a slider, in metres, it is a
rack: its ratio is the pinion's radius. What it reports is the force of its teeth.

```toml
[[joint]]                                                        # Atwood's machine: the wheel is a ball on a pin
name    = "rope"
type    = "pulley"
between = ["left", "right"]
over    = ["wheel"]

[[joint]]                                                        # a winch: the rope is wound on its drum
type    = "pulley"
between = ["load", "drum"]
over    = ["drum"]

[[joint]]                                                        # a block and tackle of two turns
type    = "pulley"
between = [[3, 4], "counterweight"]
over    = [{ body = "hook", at = "top" }, [3.1, 4], { body = "hook", at = "top" }, [3.2, 4]]

[[joint]]                                                        # the axles are joints of type "pin"
type    = "gear"
joints  = ["small_axle", "large_axle"]
ratio   = -3
```

## Articulated bodies

`[[chain]]` makes the joints of a figure, a crane or a pendulum hold exactly, by Featherstone's algorithm: they cannot drift, and the energy
is conserved for long. The links are ordinary bodies with ordinary joints, limits, motors and friction included; they touch other bodies,
and springs and the mouse can pull them. A chain without a joint to the room moves freely:

```toml
[[chain]]
of = ["trunk", "head", "arm[*]", "leg[*]"]
```

If the joints do not allow the velocities at the start, impulses between the links correct them. The joints of a chain do not break.
All this is done by the direct solver, for up to 100 links (30 in space) beside its other bodies. With more links or bodies, or `solver =
"iterative"`, the links are held by their joints as other bodies are, in the plane and in space: a figure may fall into a pile of hundreds.
The joints do not drift there either (1e-13 of the room). The free motion has the order of `physics.integrator`; what contacts and
limits change is of second order in the step.

## Pieces

`[[bond]]` joins several bodies into one, until it breaks:

```toml
[[box]]
name   = "piece"
size   = [0.2, 0.2, 0.2]
copies = { count = [3, 3, 3], offset = [[0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]] }

[[bond]]
of     = ["piece[*]"]                                            # each piece with those it touches
breaks = 300                                                     # newtons
```

## Explosions

For a given time an explosion pushes every point of every body away from its centre: the corners of a box, the ends of a capsule, a
particle, the middle of a ball. The force acts on each point: a box with eight corners feels eight times the force on a particle there.

```toml
[[explosion]]
center   = [0, 0, 0]
strength = 20                                                    # newtons on a point a metre away
start    = 0.5
duration = 1
scheme   = "paper"                                               # the force is held constant for 10 ms at a time

[room]
ground_drag = 0.5                                                # the paper's friction on the ground

[physics]
rotation = false                                                 # as in the paper: forces do not turn bodies
```

## Forces

Gravity and drag are keys of the room. So are the forces of air, charges, masses and a fluid:

```toml
[room]
gravitation    = 1                                               # every two bodies attract each other: G m1 m2 / r^2
coulomb        = 1                                               # charges repel or attract each other: k q1 q2 / r^2
softening      = 0.05                                            # r^2 + s^2 instead of r^2 in their potentials
electric       = [0, -2]                                         # f = q E
magnetic       = 2                                               # f = q v x B, in the plane positive towards the viewer
quadratic_drag = 0.02                                            # f = -c |v| v
wind           = [3, 0]                                          # drag acts on the velocity relative to it
fluid          = { level = 1, density = 2 }                      # buoyancy of what lies below the level

[[particle]]
charge = -1

[[attractor]]                                                    # a sun that stays where it is
strength = 5                                                     # G times its mass
center   = [4, 2]                                                # or the name of a body, which feels the opposite
```

Any other force is written as an expression: a `potential`, whose negative gradient is the force, or `components`. It acts at the centre of
mass, within every stage of the integrator, so the scheme keeps its order, in every mode and with both solvers:

```toml
[constants]                                                      # for expressions, and for --set constants.k=9
k = 4

[[force]]                                                        # an oscillator, stiffer along y
of        = "ball"                                               # left out: on every body
potential = "k*(x^2 + 2*y^2)/2"                                  # joules

[[force]]                                                        # lift: across the velocity
of         = "ball"
components = ["-0.1*spin*vy", "0.1*spin*vx"]                     # newtons, one for each axis

[[force]]                                                        # r, dx and dy are measured from the centre
potential = "-5*m/r"
center    = [4, 2]

[[force]]                                                        # every two of them, equal and opposite
among     = ["atom[*]"]
potential = "4*((0.3/r)^12 - (0.3/r)^6)"
```

## Motion

A body can be moved as functions of time say. It then has infinite mass: nothing stops it, and what touches it or hangs on it by joints and
springs feels its velocity and acceleration in every stage of the integrator. What it gives is booked as work. A body that is fixed or
moved can be let go; a fixed or moving body can carry a belt.

```toml
[[box]]
name     = "table"
position = [4, 1]
size     = [2, 0.2]
motion   = { x = "0.3*sin(2*pi*t)", angle = "10*sin(t)" }        # metres from its position; degrees
release  = 2.5                                                   # from then on it is free, with its velocity

[[particle]]
name   = "hand"
motion = { path = [[0, 1, 3], [1, 2, 3], [2, 2, 4]] }            # time, x, y: smooth, at rest at both ends

[[box]]
name          = "belt"
position      = [4, 2]
size          = [3, 0.2]
fixed         = true
surface_speed = 0.5                                              # its upper side goes to +x
```

A motion should be smooth: where its velocity jumps, what touches it is struck.

## Events

A `[[when]]` has one condition, and does something when that becomes true:

```toml
[[when]]
touches = ["ball", "pin[*]"]                                     # two bodies; or a wall: "floor", "left", "wall[*]"
do      = [{ mark = "hit" }]                                     # gives the instant a name

[[when]]
crosses = { body = "ball", from = [2, 0], to = [2, 1] }          # its centre of mass, either way; in space a rectangle
again   = true                                                   # each time; left out: the first time
do      = [{ set = "flipper.motor.speed", to = 900 }]

[[when]]
value = "ball.y < 1"                                             # (ball.y < 1)*(ball.vy > 0): both
do    = [{ release = "gate" }, { mark = "open" }]

[[when]]
breaks = "rope"
do     = [{ stop = true }]                                       # everything stands still, and the film ends
```

`leaves` is the end of a touch, `time` an instant. A condition that is true at the start must become false before it fires. A
value compares quantities of bodies: `ball.x`, `y`, `vx`, `vy`, `speed`, `angle`, `spin`, in space also `z` and `vz`, in metres, seconds
and radians, the time `t` and constants. It may also read forces: `ball.contact`, `normal_force`, `friction`, `spring_force` and
`joint_force`, as long as the sum of all that the body has, and `rope.force` of a joint. They are compared at the end of each
step; under `event` the time is then sought within the step. What is zero up to rounding is now true, now not: write `ball.vy < -1e-6`.

`release` lets go what is `fixed` or has a `motion`, with its velocity, or takes away a joint. `set` writes a key as `--set`
does: those of motors, forces (`push.components`, `room.wind`), `room.gravity`, and `fixed` of a body; others stay as they are. What the
hand that does so gives of energy is `energy.work`. Actions are done in their order; conditions that become true together are
served in the order of the file.

With `collision = "event"` a condition fires at its exact time, to a billionth of a second; in other modes at the end of the step in which it
becomes true, also where it has become false again. A `time` is exact in all modes. A joint breaks so, too: under `event` when its load is
more than it bears, else at the end of the step. Marks alone
change nothing of a run. The list of events is one for every frame rate, and for shards and runs that go on from a
checkpoint: `obscura states SCENE --events`.

A mark is a time: `--measure ball.velocity.y@hit` in sweeps (`hit[2]`: the second time), `figure.mark`, `start` and `end` of what a film or figure
shows, `time` of `film.speed` (a freeze), of cards and ghosts. Such a film is run once before it is drawn; marks stand in it to the
microsecond.

## Tracks

A track is a smooth curve on which bodies slide and roll, without seams: straight pieces, arcs and splines, of which each goes on as
the one before, or formulas of a parameter s.

```toml
[[track]]                                                        # a slope, a bend and the floor
points = [[0, 2], [1, 1], { to = [2, 0.6] }, [4, 0.6]]           # { to }: an arc that goes on as the piece before

[[track]]                                                        # a loop: of what crosses itself a body feels the part that it is on
points = [[0, 2], [2, 0], [4, 0], { through = [5, 1], to = [4, 2] }, { through = [3, 1], to = [4, 0] }, [7, 0]]
round  = 0.5                                                     # m: corners of straight pieces become arcs

[[track]]
points   = [[0, 3], { spline = [[1, 2], [2, 2.4], [3, 2]] }]
side     = "both"                                                # rolled on from both sides; left out, from its left
friction = 0

[[track]]                                                        # a wire, and beads on it
x      = "2*cos(s)"                                              # s in radians; also [constants]
y      = "1.5 + sin(s)"
from   = 0
to     = "2*pi"
thread = ["bead"]                                                # begins where the wire is nearest to its position
```

Seen along the track from its first place, `side` is where bodies roll; what comes from the other side passes. A ball may leave the
track, where nothing presses, and land on it again. The ends of a track let go what rolls off; beads stop there, or leave with
`ends = "free"`. With `on = "cart"` a track is part of a body and in that body's own frame: of a cart, of a hoop with a `motion`. In space, balls
and bodies made of balls roll on a track as on a rail, from any side of it; other bodies do not touch it there. Friction and elasticity are
as a wall's. Tracks are for the direct solver, in `contact` and `event`.

## Expressions

Expressions are in metres, kilograms, seconds and radians (`sin(30*deg)`); axes are the room's. An expression is a string, or a number.

| of a force on each body | |
|---|---|
| `x` `y` `z`, `vx` `vy` `vz`, `speed` | its place, velocity and speed; `z` in space |
| `m`, `charge`, `i` | its mass, its charge, the number of the copy (0, 1, ...) |
| `angle`, `spin` | in the plane; rounds are counted |
| `r`, `dx` `dy` `dz`, `dvx` `dvy` `dvz` | distance, place and velocity as seen from `center` |
| `t` | the time |

| of a force between two | |
|---|---|
| `r`, `dx` `dy` `dz`, `dvx` `dvy` `dvz` | from the first to the second; components are the force on the second |
| `m1` `m2`, `charge1` `charge2`, `t` | their masses and charges; the time |

There are `+ - * / ^`, where `^` binds to the right and before a sign (`-2^2` is -4); `< <= > >= == !=`, which are 1 or 0; `sin cos tan asin
acos atan atan2 sinh cosh tanh exp log sqrt abs sign floor min max`; `if(condition, then, else)`; `pi` and `deg`. A product needs its sign:
`2*x`. All functions have the same bits on every machine. An error names the line and column:

    pendulum.toml:12:25: 'components', column 9: nothing is called 'sped' here; did you mean 'speed'?

A potential depends on places and the time, and is differentiated exactly; it counts as potential energy (`fields` in plots and
`energy.fields` in tables). What components, wind and quadratic drag do (not motors of joints, nor the room's linear `drag`) is booked as `work` (`energy.work`) in scenes that have such forces: the total
energy minus the work stays constant where nothing collides. The spring of a mouse's hand is not of the room: what it holds is `hand`
(`energy.hand`), beside the total, which changes by what the hand gives. A force that comes to no finite number ends the run, with the body, the place
and the time.

## Films

Without `speed` a second of the film shows a second of the run. `speed` is one number for the whole film, or a list of keys at times of the
run, and changes from key to key as `ease` says. Before the first key the first speed holds, after the last key the last.

```toml
[film]
speed = 0.5                                                      # ten seconds become twenty
# speed = [                                                      # from 2 s to 3 s at a tenth
#   { time = 1.8 },                                              # speed 1, the default
#   { time = 2, speed = 0.1 },
#   { time = 3, speed = 0.1 },
#   { time = 3.2 },
# ]
```

All other times are times of the run: those of cameras, mice and `[golden]`, the clock on the picture, `--at`, `--from` and `--to`;
`--frames` counts the film's frames. The frame at f seconds of the film shows the run at the integral of the speed up to f: exactly, if that
is a fraction of whole numbers up to a million, otherwise to the nearest microsecond.

A `[[film.plot]]` below the picture, or at its right, plots quantities over time in step with the film: the axes span the whole run, and
each line ends at the current instant with a dot. The quantities are those of `[[figure.plot]]`. An axis has one unit. `of`
may be several bodies: each has a line in its colour and in dashes of its own. Names go with the heads of their lines.

```toml
[[film.plot]]
quantity = ["energy", "kinetic", "potential"]                    # joules

[[film.plot]]
quantity = ["height"]
of       = "ball"
place    = "right"
size     = 40                                                    # percent of the picture's width
```

`range` sets the ends of the values' axis; a line that leaves it is cut off, and its name waits there.

`vary` films several runs together, for each value of a key as `obscura sweep` takes them. They have one clock, one camera and one scale, and
each plot has a line of each run:

```toml
[physics]
diverge = "show"                                                 # a run that blows up is shown, not an error

[film]
vary       = "physics.integrator=euler,rk4"
vary_names = "Euler; Runge-Kutta"
# vary_place = "over"                                            # over each other, each run in a colour
```

The runs are in panels beside each other, at most sixteen; in the plane they may also be over each other, where marks are those of the first
run. If one body moves, it has the colour of its run, as the names and lines have. Stills, shards, `--resume`, `verify` and goldens work as for
one run; the state that a frame's origin holds is that of all runs. With `diverge = "show"` a run goes on while its numbers are finite. The
picture says that it diverges as soon as its energy cannot be explained any more. From the last finite state on it stands still, with the
time at which it came there.

To find the range of the axes the scene is simulated once before the film, so simulating takes twice as long. Marks need this run too.

A film names, measures and points as a figure does: `[[film.vector]]`, `point`, `length`, `angle`, `label`, `cone`, `path` and `ghost` have the
keys of `[[figure.vector]]` and so on; `film.figure = true` shows in the film what `[figure]` has. Values are live, in digits of equal width.
`start` and `end` say when a mark is shown:

```toml
[film]
speed = [{ time = 1, freeze = 2 }]                               # stands still for two seconds, clock and all
badge = true                                                     # shows how fast it goes, where that is not as it happens

[[film.vector]]
quantity = "friction"
of       = "block"
label    = "f = {:.2} N"                                         # two decimals; {}: three digits, with the unit

[[film.label]]
at       = [0.5, 3]
text     = "E_{kin} = {:.1} J"
quantity = "kinetic"

[[film.label]]
at    = "block"
text  = "here it begins to slide"
start = 1                                                        # s of the run
end   = { time = 1, after = 1.5 }                                # and seconds of the film: while it stands still

[[film.path]]
at = { body = "wheel", local = [0.3, 0] }                        # the path of a point, at any length

[[film.caption]]
text  = "Friction is at its limit."
start = 1

[[film.card]]
title = "Part two"
time  = 4
```

Captions have a strip below the picture; in a movie they are a text track as well, and `film.vtt` lies beside `film.mp4`. Cards are its chapters. `film.fade` lets the film
come from the page's colour and go to it. `look.type_scale` makes all type larger, `look.decimal = ","` sets the decimal mark.

A label keeps clear of bodies, walls, arrows and other labels; so do the words of a body (`label = "m_1"` in its table). It goes to another place only where it would be in the way for long, and slowly: at most
two pixels a frame at 1080p. Where it stands when follows from the whole run, so a still, a shard and a resumed film have the same frames.

Quantities are the same everywhere: in plots, as arrows, in labels and after `--measure` (`block.friction@2`, `block.friction.x@2`). A body's
`normal_force`, `friction`, `spring_force` and `joint_force` have one arrow for each thing that it touches or that holds it; the number in a plot is the length of
their sum. `field` is the force of formulas: `[[force]]`, attractors, the fields of the room, wind and quadratic drag. `net_force` is the sum of all forces, `acceleration` that over the mass. Forces of joints are those at the end of a step, forces of contacts those at the start of it, impacts apart; at the
start those of the first step.

`shutter` adds motion blur: a frame is the mean, in linear light, of the pictures from its instant on while the shutter is open. 360 degrees
is the whole time of a frame, 180 half of it.

```toml
[film]
shutter = 180
```

A frame is drawn once for each pixel that the fastest motion crosses while the shutter is open (by the velocities of things and camera when
it opens), 4 to 64 times. If nothing moves it is drawn once, the same as without a shutter. With many bodies it is drawn fewer times: the
states of one frame take at most 2 MB, about 14 states of a thousand bodies. Clock and plots show the frame's instant.

## Figures

`obscura figure` makes a figure for print of one instant or several. `[figure]` says what the figure shows, names and measures; every
value comes from the run:

```toml
[figure]
impact = "crate"                                                 # the step of its first impact
at     = [-0.1, 0, 0.1]                                          # seconds from there, one panel each
width  = 174                                                     # mm

[[figure.vector]]
quantity = "velocity"
of       = "crate"
label    = "v_center = {}"                                       # {}: its value, with its unit

[[figure.point]]
at    = { body = "crate", at = "bottom left" }
label = "P"

[[figure.length]]
between = [[0, 0], [0, 1.2]]
label   = "h"

[[figure.plot]]
quantity = ["energy", "kinetic", "potential"]
```

In space each camera has a panel for each instant: lit surfaces are pixels; lines, arrows and text are vectors over them. Points, vectors,
lengths and angles between places are drawn there too. `axes = true` draws rulers beside a picture of the plane, and three axes in space.

A plot shows quantities over time, `against` another quantity, or `over` the values of a key, with one run for each value. With `reference`
it shows how far each run ends from a reference run; on logarithmic axes the slope is the power:

```toml
[figure]
vary = "physics.integrator=euler,midpoint,rk4"                   # one line each
room = false                                                     # only the plot

[[figure.plot]]
quantity  = ["x"]
of        = "ball"
to        = 2
over      = "physics.rate=20,40,80,160,320"
reference = "physics.rate=10000; physics.integrator=rk4"
scale     = "log"
```

Labels are set as mathematics: letters are italic; digits and words of three or more letters are upright. `_` and `^` make sub- and
superscripts (`v_center`, `a_{ij}`, `x^2`), `'` a prime, `*r*` a vector, `"in quotes"` plain words. There are `\omega` and the other Greek
letters, `\Delta`, `\times`, `\cdot`, `\perp`, `\le`, `\to`; `\dot{q}`, `\ddot{q}`, `\bar{v}`, `\vec{r}`, `\hat{n}`, `\tilde{x}`; `\frac{1}{2}`, `\sqrt{2gh}`, `\sqrt[3]{V}`, `\sum_{i=1}^n`,
`\int_a^b`, `\text{at rest}`, `\mathbf{v}` and functions such as `\sin`. Between dollars it is as in LaTeX: `'energy $\frac{1}{2} m v^2$'`. An unknown command is an error with its column. In
TOML write a backslash twice, or use single quotes.

)page";

const char* const kNotes[][2] = {
    {"room",
     "Without `size` and `walls` the room is 8 m by 4.5 m. With `walls` alone it has only those walls, and "
     "may be open. Without a size, the reference pixel of the mouse is 1/480 of the height that the camera "
     "fits."},
    {"physics",
     "In the plane, balls, polygons and bodies of several shapes need `collision = \"contact\"` or "
     "`\"event\"`. In space `handout` takes bodies of every shape; they collide only with walls. Joints, "
     "friction and collisions between bodies need `contact` or `event`, in the plane and in space.\n\n"
     "In `contact` and `event` a body comes to rest, to the bit, where contacts and joints hold it. Motion "
     "that they leave free continues: a puck on ice, a rolling ball, a pendulum. Let g be gravity and L the "
     "room's height. A body is put to rest when three things are true of it and all that it touches. It has "
     "been slower than 0.002 s g for a quarter of a second. Forces within the laws of contact leave it less "
     "acceleration than g / 1,000,000. The part of its velocity that contacts and joints leave free, or that "
     "their spare friction would not stop within 0.01 s, is less than 1e-8 sqrt(g L). The direct solver "
     "asks only for a velocity below 1e-8 sqrt(g L) and an acceleration below 1e-10 g. All this scales with "
     "the scene; without gravity a body rests only if it does not move at all."},
    {"mouse",
     "The reference pixel is 1/480 of the room's height, so that a larger picture shows the same motion."},
    {"camera",
     "`center` and `width` give a fixed view; with `keys` the camera moves from key to key, and stands still "
     "before the first and after the last. In space it looks at `center` from `azimuth` and `elevation`, or "
     "from `eye`."},
};

std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
  return text;
}

// the type of value, in a word or two
std::string type(const Key& key) {
  switch (key.form) {
    case Form::table:
      return "table";
    case Form::tables:
      return "tables";
    case Form::cameras:
      return "table, or tables";
    case Form::number:
      return "number";
    case Form::integer:
      return "whole number";
    case Form::boolean:
      return "true, false";
    case Form::text:
      return "string";
    case Form::name:
    case Form::label:
    case Form::thing:
      return "name";
    case Form::things:
      return "list of names";
    case Form::rational:
      return "number or fraction";
    case Form::speeds:
      return "number or fraction, or tables";
    case Form::choice:
      return fmt::format("`{}`", fmt::join(key.choices, "`, `"));
    case Form::choices:
      return fmt::format("list of `{}`", fmt::join(key.choices, "`, `"));
    case Form::color:
      return "colour";
    case Form::vector:
      return key.dimension == 3 ? "[x, y, z]" : "[x, y]";
    case Form::spin:
      return "number; in space [x, y, z]";
    case Form::turn:
      return "[x, y, z], deg, or { axis, angle }";
    case Form::walls:
      return "`ground`, `none`, or tables";
    case Form::pixels:
      return "[width, height]";
    case Form::count:
      return "whole number, or one per direction";
    case Form::offset:
      return "[x, y], or a list of them";
    case Form::which:
      return "true, false, or which copies";
    case Form::points:
      return key.dimension == 3 ? "[[x, y, z], ...]" : "[[x, y], ...]";
    case Form::pairs:
      return "pairs of names";
    case Form::limits:
      return "[lowest, highest]";
    case Form::ends:
      return "two ends";
    case Form::places:
      return "places, or points of bodies";
    case Form::couple:
      return "two names";
    case Form::path:
      return "[[t, x, y], ...]";
    case Form::curve:
      return "places, arcs, splines";
    case Form::place:
      return "a place, or a point of a body";
    case Form::times:
      return "number, or a list of them";
    case Form::cue:
      return "number, a mark, or { time, after }";
    case Form::trails:
      return "number, or table of them";
    case Form::states:
      return "true, false, or a file";
    case Form::bodies:
      return "name, or list of names";
    case Form::expression:
      return "expression";
    case Form::expressions:
      return "one expression a dimension";
    case Form::numbers:
      return "numbers with names";
    case Form::any:
      return "value";
    case Form::moment:
      return "number or fraction, or a mark";
  }
  return "";
}

std::string range_text(const Key& key) {
  const bool worth = key.form != Form::integer || key.path != "version";
  if (!worth || (!std::isfinite(key.range.low) && !std::isfinite(key.range.high))) return "";
  if (key.range.low == 0 && (!std::isfinite(key.range.high) || key.range.high >= 1e6))
    return key.range.above ? "> 0" : ">= 0";
  return fmt::format(
      "{} {}",
      key.range.above ? fmt::format("more than {} to", key.range.low) : fmt::format("{} to", key.range.low),
      key.range.high);
}

std::string row(const Key& key, const std::string& section) {
  std::string name = key.path;
  if (!section.empty()) name = name.substr(section.size() + 1);
  std::string kind = type(key);
  if (!key.unit.empty()) kind += ", " + key.unit;
  if (const std::string r = range_text(key); !r.empty()) kind += ", " + r;
  if (key.varies) kind += key.form == Form::color || key.form == Form::text ? "; or a list" : "; *varies*";
  const std::string absent = key.required           ? "needed"
                             : !key.absent.empty()  ? key.absent
                             : key.fallback.empty() ? ""
                                                    : "`" + key.fallback + "`";
  const std::string example =
      key.example.empty() ? "" : "`" + std::string(key.last()) + " = " + key.example + "`";
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", name, cell(kind), cell(absent), cell(key.doc),
                     cell(example));
}

constexpr const char* kHead = "| key | takes | left out | what it is | example |\n|---|---|---|---|---|\n";

bool section(const Key& key) {
  return key.form == Form::table || key.form == Form::tables || key.form == Form::cameras ||
         key.form == Form::numbers;
}

void rows_under(std::string& page, const std::string& owner, const std::string& section) {
  for (const Key* each : keys_of(owner)) {
    // the marks of a film are those of a figure
    if (owner == "film" && each->form == Form::tables && each->path != "film.plot" &&
        key("figure." + std::string(each->last()))) {
      Key same = *each;
      same.doc += fmt::format(" Keys as in `[[figure.{}]]`.", each->last());
      page += row(same, section);
      continue;
    }
    page += row(*each, section);
    if (each->form == Form::table || each->form == Form::tables || each->form == Form::walls ||
        each->form == Form::speeds)
      rows_under(page, each->path, section);
  }
}

}  // namespace

std::string keys_page() {
  std::string page = std::string(kOpening) + "## The keys\n\n### At the top\n\n" + kHead;
  for (const Key* each : keys_of(""))
    if (!section(*each)) page += row(*each, "");
  for (const Key* each : keys_of("")) {
    if (!section(*each)) continue;
    page += fmt::format("\n### {}\n\n{}\n\n",
                        each->form != Form::tables ? "[" + each->path + "]" : "[[" + each->path + "]]",
                        each->doc);
    for (const auto& note : kNotes)
      if (each->path == note[0]) page += std::string(note[1]) + "\n\n";
    if (each->form == Form::numbers) {
      page += "    " + each->example + "\n";
      continue;
    }
    page += kHead;
    rows_under(page, each->path, each->path);
  }
  return page;
}

}  // namespace obscura::scene
