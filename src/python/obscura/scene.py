"""Scenes of Python: from keys, text or files; simulated, drawn, filmed."""

from __future__ import annotations

import base64
import contextlib
import copy
import difflib
import html
import json
import operator
import os
from typing import Any, Callable, Iterable, Mapping, Sequence

import numpy

from . import _obscura
from .errors import FileError, SceneError, UsageError
from .keys import Section, plain, schema


class _Holder:
    """What holds the function of a force: C++ refers to it weakly, so that Python's collector finds all cycles."""

    __slots__ = ("function", "__weakref__")

    def __init__(self, function: Callable):
        self.function = function


class _Built(_obscura.Scene):
    """A scene of C++ with the holders of its forces, which live as long as it does."""

    def __init__(self, scene: _obscura.Scene, holders: tuple[_Holder, ...] = ()):
        super().__init__(scene)
        self._holders = holders

    def with_function(self, name: str, function: Callable) -> "_Built":
        holder = _Holder(function)
        return _Built(self.with_force(name, holder), (*self._holders, holder))


class Figure:
    """A figure for print, as SVG."""

    def __init__(self, svg: str):
        self.svg = svg

    def save(self, path: str | os.PathLike) -> None:
        if not os.fspath(path).endswith(".svg"):
            raise UsageError(f"{os.fspath(path)}: a figure is an SVG, name.svg")
        # under its name once it is whole
        part = os.fspath(path) + ".part"
        try:
            with open(part, "w", encoding="utf-8") as file:
                file.write(self.svg)
            os.replace(part, path)
        except OSError as error:
            with contextlib.suppress(OSError):
                os.unlink(part)
            raise FileError(f"{os.fspath(path)}: {error.strerror}") from None

    def _repr_html_(self) -> str:
        # as a picture of its own, whose fonts and styles are not the page's
        data = base64.b64encode(self.svg.encode()).decode()
        return f'<img src="data:image/svg+xml;base64,{data}">'

    def _repr_svg_(self) -> str:
        # within a page it has no declaration of its own
        return self.svg.partition("?>")[2] if self.svg.startswith("<?xml") else self.svg


class Scene(Section):
    """What is in a room, what it looks like and how it is filmed.

    Scene("room.toml") reads a file, with values over its keys as --set takes them; Scene({...}) and
    Scene(room={"size": [4, 2.25]}, ...) take keys; Scene.parse(text) takes TOML. Keys are attributes:
    scene.room.gravity = [0, -1.62], scene.ball[0].radius, scene.ball.add(name="b", radius=0.1, position=[1, 1]).
    A name that the language does not have is an AttributeError at once; a value that cannot be is a SceneError when
    the scene is used, with its line and column, or its key.
    """

    def __init__(self, source: str | os.PathLike | Mapping | None = None, /, *, sets: Sequence[str] = (),
                 name: str | None = None, **keys: Any):
        if source is None or isinstance(source, Mapping):
            data = {**(dict(source) if source else {}), **keys}
            for key in data:
                if not isinstance(key, str):
                    raise TypeError(f"the keys of a scene are words, not {key!r}")
            if sets:
                raise TypeError("'sets' go over the keys of a file or a text")
            self._begin(("keys", name or "scene"), plain(data))
        else:
            if keys:
                raise TypeError("a scene is a file or keys, not both: set keys after it is read")
            if not isinstance(source, (str, bytes, os.PathLike)):
                raise TypeError(f"Scene(source) takes a file's name, or keys as a dict, not {_shown(source)}")
            file = _path(source)
            if "\n" in file and not os.path.exists(file):
                raise UsageError("Scene(source) takes a file's name: a text of TOML goes to Scene.parse(text)")
            self._begin(("file", file, _words(sets)), None)
            # what was read stays what it is, wherever it goes
            self.__dict__["_source"] = ("text", self._built().text, file, _words(sets))

    @classmethod
    def parse(cls, text: str, name: str = "scene.toml", sets: Sequence[str] = ()) -> "Scene":
        """A scene of TOML; `name` stands for the file in messages."""
        if not isinstance(text, (str, bytes)):
            raise TypeError(f"Scene.parse(text) takes TOML as text, not {_shown(text)}: Scene(path) reads a file")
        scene = cls.__new__(cls)
        scene._begin(("text", text, name, _words(sets)), None)
        scene._built()
        return scene

    def _begin(self, source: tuple, data: dict | None) -> None:
        self.__dict__.update(_source=source, _own=data, _made=None, _forces=[], _path="",
                             _keys=schema()["properties"])
        if data is not None:
            for key in data:
                self._key(key)

    # keys are read only when somebody asks for them: a file keeps its own lines until one is changed
    @property
    def _data(self) -> dict:
        if self._own is None:
            self.__dict__["_own"] = self._built().keys()
        return self._own

    def _touch(self) -> None:
        self.__dict__["_made"] = None
        if self._source[0] != "keys":
            self.__dict__["_source"] = ("keys", self._source[2])

    def _built(self):
        if self._made is None:
            kind, *source = self._source
            if kind == "file":
                made = _obscura.Scene.read(*source)
            elif kind == "text":
                made = _obscura.Scene.parse(*source)
            else:
                made = _obscura.Scene.build(self._own, source[0])
            made = _Built(made)
            for name, force in self._forces:
                made = made.with_function(name, force)
            self.__dict__["_made"] = made
        return self._made

    def __getstate__(self) -> dict:
        return {"source": self._source, "own": self._own, "forces": self._forces}

    def __setstate__(self, state: dict) -> None:
        self._begin(state["source"], state["own"])
        self.__dict__["_forces"] = state["forces"]

    def copy(self) -> "Scene":
        """Another one, whose keys may be changed."""
        other = Scene.__new__(Scene)
        other._begin(self._source, copy.deepcopy(self._own))
        other.__dict__.update(_forces=list(self._forces), _made=self._made)
        return other

    __copy__ = copy

    def __deepcopy__(self, memo: dict) -> "Scene":
        return self.copy()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self.hash == other.hash and self._forces == other._forces

    __hash__ = None  # it can be changed

    def __dir__(self) -> list[str]:
        return sorted({*self._keys, *(name for name in dir(type(self)) if not name.startswith("_"))})

    def __repr__(self) -> str:
        try:
            scene = self._built()
        except SceneError as error:
            return f"<Scene, not yet whole: {error.faults[0]}>"
        return (f"<Scene {scene.name}: {len(scene.bodies)} bodies in {'the plane' if scene.dimension == 2 else 'space'}, "
                f"{scene.duration:g} s>")

    # --- what it is

    @property
    def text(self) -> str:
        """As TOML, without what `sets` put over it."""
        return self._built().text

    @property
    def hash(self) -> str:
        """Equal for scenes that say the same, however they say it."""
        return self._built().hash

    @property
    def name(self) -> str:
        return self._built().name

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self._built().dimension

    @property
    def bodies(self) -> list:
        """In the order of all columns: those that turn come last."""
        return self._built().bodies

    @property
    def warnings(self) -> list[str]:
        """What is likely to go wrong: steps that are too long for springs."""
        return self._built().warnings

    def add_force(self, force: Callable, name: str | None = None) -> None:
        """A force on all bodies, called in every stage of the integrator.

        force(stage) returns forces (N, a row a body), or forces and torques, or fills stage.forces and stage.torques.
        Its answer follows from the stage alone. A film of such a scene cannot be verified, and says so. One of the
        same name takes the place of that which was added before, as where a cell of a notebook runs again; of
        functions without a name of their own, as lambdas, a second one needs `name`.
        """
        if not callable(force):
            raise TypeError(f"a force is a function of a stage, not {force!r}")
        if not isinstance(name, (str, type(None))):
            raise TypeError(f"the name of a force is a word, not {_shown(name)}")
        if not name:
            name = getattr(force, "__name__", "force")
            old = dict(self._forces).get(name)
            if old is not None and _another(old, force):
                raise UsageError(f"there is a force called '{name}' already: add_force(force, name=...) adds another, "
                                 f"or takes the place of the one of that name")
        self.remove_force(name)
        made = self._built().with_function(name, force)
        self._forces.append((name, force))
        self.__dict__["_made"] = made

    def remove_force(self, name: str) -> None:
        """Takes away the force that add_force() added under this name, if there is one."""
        left = [each for each in self._forces if each[0] != name]
        if len(left) < len(self._forces):
            self.__dict__.update(_forces=left, _made=None)

    # --- what is made of it

    def world(self) -> "World":
        """The scene as it runs."""
        return World(self)

    def frames(self, **options: Any) -> "Renderer":
        """The frames of its film, one by one."""
        return Renderer(self, **options)

    def frame(self, t: float = 0, **options: Any):
        """The picture at t seconds."""
        return Renderer(self, **options).at(t)

    def render(self, out: str | os.PathLike, **options: Any) -> str:
        """Films it as `obscura render` does, on all cores; answers the name of the file."""
        _obscura.render(self._built(), _path(out), **options)
        return _path(out)

    def still(self, t: float, out: str | os.PathLike, **options: Any) -> str:
        """The picture at t seconds as a PNG, as `obscura render --at` writes it."""
        _obscura.still(self._built(), _number(t, "still(t, out) takes a number of seconds"), _path(out), **options)
        return _path(out)

    def page(self, **options: Any) -> str:
        """The page that plays its film, as HTML."""
        return _obscura.film_page(self._built(), **options)

    def picture(self, at: float | Iterable[float] = (), **options: Any) -> Figure:
        """Its figure for print, as `obscura figure` draws it, at one instant or several."""
        for name in options:
            if name not in ("theme", "camera", "transparent"):
                raise TypeError(f"a figure has no option '{name}': its size is figure.width")
        times = [_number(t, "picture(at) takes a number of seconds, or a list of such") for t in (at if numpy.iterable(at) else [at])]
        return Figure(_obscura.figure_svg(self._built(), times, **options))

    def sweep(self, vary: Mapping[str, Iterable] | Sequence[str], measure: str | Sequence[str],
              jobs: int = 0) -> dict[str, numpy.ndarray]:
        """Runs all combinations of the values of keys and measures each: a column a key and a measure.

        sweep({"ball.elasticity": [0, 0.5, 1]}, "energy.total@5") is `obscura sweep --vary ball.elasticity=0,0.5,1
        --measure energy.total@5`. What a run did not come to is nan; "trouble" says why.
        """
        if isinstance(vary, Mapping):
            for key, values in vary.items():
                if isinstance(values, str) or not numpy.iterable(values):
                    raise TypeError(f"{key}: expected a list of values, not {_shown(values)}")
            vary = [f"{key}=" + ",".join(_toml(value, key) for value in values) for key, values in vary.items()]
        vary = _words(vary, "vary", "{'ball.elasticity': [0, 0.5, 1]} or ['ball.elasticity=0,0.5,1']")
        measure = [measure] if isinstance(measure, str) else _words(measure, "measure", "['energy.total@5']")
        jobs = _whole(jobs, "jobs is a whole number, 0 for all cores")
        if jobs < 0:
            raise UsageError(f"jobs {jobs}: expected 0 (all cores) or more")
        heads, rows = _obscura.sweep(self._built(), vary, measure, jobs)
        columns = {head: [row[i] for row in rows] for i, head in enumerate(heads)}
        return {head: numpy.array(cells) if head == "trouble" else _column(cells) for head, cells in columns.items()}

    def _repr_html_(self) -> str:
        # a frame of its own, for a page has its own styles and scripts
        page = html.escape(self.page(), quote=True)
        film = self.film
        width, height = getattr(film, "size", None) or (1920, 1080)
        return (f'<iframe srcdoc="{page}" style="width:100%;aspect-ratio:{width}/{height * 1.08:g};border:0" '
                'sandbox="allow-scripts"></iframe>')


def _words(words: Sequence[str], what: str = "sets", example: str = "['ball.elasticity=0.9']") -> list[str]:
    if isinstance(words, str) or not numpy.iterable(words):
        raise TypeError(f"'{what}' is a list, as in {what}={example}, not {_shown(words)}")
    for each in (words := list(words)):
        if not isinstance(each, str):
            raise TypeError(f"'{what}' is a list of words, as in {what}={example}, not of {_shown(each)}")
    return words


def _another(old: Callable, new: Callable) -> bool:
    """Whether two forces of one name are likely meant both: lambdas, functions that one function has made, methods of
    two objects. What was written again is the old one anew."""
    if old is new or old == new:
        return False
    name = getattr(new, "__name__", "<lambda>")
    if name == "<lambda>":
        return True
    code = [getattr(getattr(each, "__func__", each), "__code__", None) for each in (old, new)]
    return code[0] is code[1]


def _shown(value: Any) -> str:
    """A value in a message: on one line, cut where it is long."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 100 else text[:97] + "..."


def _path(path: str | os.PathLike) -> str:
    """A file's name: what the system would cut at a zero is an error, and so is what no message can say."""
    name = os.fsdecode(path)
    if "\0" in name:
        raise ValueError(f"a path has no zero in it: {name!r}")
    try:
        name.encode()
    except UnicodeEncodeError:
        raise ValueError(f"a path is of UTF-8: {name!r}") from None
    return name


def _whole(value: Any, what: str) -> int:
    """A whole number of 64 bits."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{what}, not {_shown(value)}") from None
    if not -2**63 <= number < 2**63:
        raise UsageError(f"{what}, not {number}")
    return number


def _number(value: Any, what: str) -> float:
    """A number, but not text that says one."""
    try:
        if not isinstance(value, (str, bytes, bytearray)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise TypeError(f"{what}, not {_shown(value)}") from None


def _toml(value: Any, key: str) -> str:
    """A value of a key, as `obscura sweep --vary` takes it."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        if "," in value:
            raise UsageError(f"{key}: values of words are without commas, not {_shown(value)}")
        return value
    if isinstance(value, (list, tuple)):
        return "[" + ",".join(json.dumps(each) if isinstance(each, str) else _toml(each, key) for each in value) + "]"
    return repr(value)


def _column(cells: list[str]) -> numpy.ndarray:
    try:
        return numpy.array([float(cell) if cell else numpy.nan for cell in cells])
    except ValueError:
        return numpy.array(cells)


class World(_obscura.World):
    """A scene that runs, by whole steps of its physics clock.

    positions, velocities, turns and spins are columns of the state itself: arrays that cannot be written, follow the
    world and keep it alive. Setting one takes hold from the next step on. `threads` share the steps of some hundred
    bodies or more (0: one a core); the bits are the same.
    """

    def __init__(self, scene: Scene, threads: int = 1):
        if not isinstance(scene, Scene):
            raise TypeError(f"a world is of a Scene, not of {scene!r}")
        # it holds the functions of forces
        object.__setattr__(self, "_made", scene._built())
        super().__init__(self._made, _whole(threads, "threads is a whole number, 0 for one a core"))
        # as it is now: what is changed of it later is the next world's
        object.__setattr__(self, "_scene", scene.copy())
        object.__setattr__(self, "_threads", threads)

    @property
    def scene(self) -> Scene:
        """What it runs, as that was when the world was made: a copy."""
        return self._scene.copy()

    def step(self, count: int = 1) -> None:
        """Goes on by so many steps of the physics clock."""
        super().step(_whole(count, "step(count) takes a whole number of steps, step_to(t) a time in seconds"))

    def step_to(self, t: float) -> None:
        """Goes on to the step that is nearest to t s; one that is past stays."""
        super().step_to(_number(t, "step_to(t) takes a number of seconds"))

    def body(self, name: str) -> int:
        """The number of a body: its row in all columns."""
        if not isinstance(name, str):
            raise TypeError(f"body(name) takes the name of a body, not {_shown(name)}")
        return super().body(name)

    def read(self, quantity: str) -> float:
        """A number of the state by its name: one of `quantities`."""
        if not isinstance(quantity, str):
            raise TypeError(f"read(quantity) takes a name, as 'energy.total', not {_shown(quantity)}")
        return super().read(quantity)

    def restore(self, state: _obscura.State) -> None:
        """Goes on from a state of this scene, that save() gave."""
        if not isinstance(state, _obscura.State):
            raise TypeError(f"restore(state) takes what save() gave, not {_shown(state)}")
        super().restore(state)

    def __setattr__(self, name: str, value: Any) -> None:
        if not isinstance(getattr(type(self), name, None), property):
            # a class of one's own may have attributes of its own, but for what looks like one that can be set
            own = type(self) is not World
            known = [each for each in dir(World) if not each.startswith("_")]
            if own:
                known = [each for each in known if getattr(getattr(World, each), "fset", None)]
            near = difflib.get_close_matches(name, known, 1)
            if near or not own:
                raise AttributeError(f"a world has no '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
        super().__setattr__(name, value)

    def __reduce__(self):
        return _world, (self._scene, self.save(), self._threads)

    def __repr__(self) -> str:
        return f"<World {self._scene.name} at {self.time:g} s>"


def _world(scene: Scene, state, threads: int = 1) -> World:
    world = World(scene, threads)
    world.restore(state)
    return world


class Renderer(_obscura.Renderer):
    """Draws a scene: `for frame in renderer` its film, renderer.at(t) an instant, renderer.draw(world) a world.

    Options: size=(width, height), fps, theme ("paper", "screen"), camera, transparent, start, end.
    """

    def __init__(self, scene: Scene, **options: Any):
        if not isinstance(scene, Scene):
            raise TypeError(f"a renderer is of a Scene, not of {scene!r}")
        # it holds the functions of forces
        self._made = scene._built()
        super().__init__(self._made, **options)

    def at(self, t: float) -> _obscura.Frame:
        """The picture at t seconds."""
        return super().at(_number(t, "at(t) takes a number of seconds"))

    def draw(self, world: World) -> _obscura.Frame:
        """The picture of a world as it stands."""
        if not isinstance(world, World):
            raise TypeError(f"draw(world) takes a World, not {_shown(world)}: at(t) draws an instant of the scene")
        return super().draw(world)


class Movie(_obscura.Movie):
    """A movie file that takes frames, of a renderer or arrays of height x width x 3 or 4 bytes.

    with Movie("a.mp4", renderer) as movie: movie.add(frame). Without a renderer it needs size and fps. Options: crf,
    preset, codec, transparent. An exception within leaves no file.
    """

    def __init__(self, path: str | os.PathLike, renderer: Renderer | None = None, **options: Any):
        if renderer is not None and not isinstance(renderer, Renderer):
            raise TypeError(f"a movie is of a Renderer, or of size and fps, not of {_shown(renderer)}")
        for name in ("size", "width", "height", "fps"):
            if renderer is not None and name in options:
                raise TypeError(f"a movie of a renderer has the renderer's {name}")
        for name in ("theme", "camera", "start", "end", "jobs"):
            if name in options:
                raise TypeError(f"a movie of frames has no {name}: that is a renderer's option")
        super().__init__(_path(path), renderer, **options)
