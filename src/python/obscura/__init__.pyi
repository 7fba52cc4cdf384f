import os
from typing import Any, Callable, Iterable, Iterator, Mapping, Sequence

import numpy
from numpy.typing import ArrayLike, NDArray

from ._keys import Keys

__version__: str

class Error(Exception): ...

class Fault:
    file: str
    line: int
    column: int
    key: str
    message: str

class SceneError(Error, ValueError):
    faults: list[Fault]
    file: str
    line: int
    column: int
    key: str

class RunError(Error):
    time: float
    body: str
    quantity: str
    fault: str
    likely: str

class UsageError(Error, ValueError): ...

class FileError(Error, OSError):
    characters_written: int
    errno: int
    filename: Any
    filename2: Any
    strerror: str

class Body:
    name: str
    kind: str
    mass: float
    fixed: bool
    turns: bool

class Stage:
    time: float
    positions: NDArray[numpy.float64]
    velocities: NDArray[numpy.float64]
    spins: NDArray[numpy.float64]
    orientations: NDArray[numpy.float64]
    forces: NDArray[numpy.float64]
    torques: NDArray[numpy.float64]

class Pair:
    body: int
    other: int
    wall: int

class Contact:
    body: int
    other: int
    wall: int
    gap: float
    point: NDArray[numpy.float64]
    normal: NDArray[numpy.float64]
    force: NDArray[numpy.float64]
    impulse: NDArray[numpy.float64]
    mode: str

class Event:
    time: float
    name: str
    what: str
    of: list[str]
    marks: list[str]
    stop: bool

class Energies:
    kinetic: float
    gravity: float
    springs: float
    fields: float
    work: float
    total: float

class State:
    def __bytes__(self) -> bytes: ...

class Frame:
    array: NDArray[numpy.uint8]
    number: int
    time: float
    state: str
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    def save(self, path: str | os.PathLike) -> None: ...
    def _repr_png_(self) -> bytes: ...

class Figure:
    svg: str
    def __init__(self, svg: str) -> None: ...
    def save(self, path: str | os.PathLike) -> None: ...
    def _repr_svg_(self) -> str: ...

Force = Callable[[Stage], ArrayLike | tuple[ArrayLike, ArrayLike] | None]

class Scene(Keys):
    name: str
    text: str
    hash: str
    dimension: int
    bodies: list[Body]
    warnings: list[str]
    def __init__(self, source: str | os.PathLike | Mapping | None = None, /, *, sets: Sequence[str] = (),
                 name: str | None = None, **keys: Any) -> None: ...
    @classmethod
    def parse(cls, text: str, name: str = "scene.toml", sets: Sequence[str] = ()) -> Scene: ...
    def copy(self) -> Scene: ...
    def add_force(self, force: Force, name: str | None = None) -> None: ...
    def remove_force(self, name: str) -> None: ...
    def world(self) -> World: ...
    def frames(self, **options: Any) -> Renderer: ...
    def frame(self, t: float = 0, **options: Any) -> Frame: ...
    def render(self, out: str | os.PathLike, **options: Any) -> str: ...
    def still(self, t: float, out: str | os.PathLike, **options: Any) -> str: ...
    def page(self, **options: Any) -> str: ...
    def picture(self, at: float | Iterable[float] = (), **options: Any) -> Figure: ...
    def sweep(self, vary: Mapping[str, Iterable] | Sequence[str], measure: str | Sequence[str],
              jobs: int = 0) -> dict[str, NDArray]: ...
    def _repr_html_(self) -> str: ...

class World:
    scene: Scene
    time: float
    steps: int
    step_length: float
    positions: NDArray[numpy.float64]
    velocities: NDArray[numpy.float64]
    turns: NDArray[numpy.float64]
    spins: NDArray[numpy.float64]
    first_turning: int
    quantities: list[str]
    energies: Energies
    contacts: list[Contact]
    events: list[Event]
    hash: str
    def __init__(self, scene: Scene, threads: int = 1) -> None: ...
    def step(self, count: int = 1) -> None: ...
    def step_to(self, t: float) -> None: ...
    def body(self, name: str) -> int: ...
    def read(self, quantity: str) -> float: ...
    def contact_changes(self) -> tuple[list[Pair], list[Pair]]: ...
    def save(self) -> State: ...
    def restore(self, state: State) -> None: ...

class Renderer:
    width: int
    height: int
    fps: float
    def __init__(self, scene: Scene, **options: Any) -> None: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Frame]: ...
    def __next__(self) -> Frame: ...
    def at(self, t: float) -> Frame: ...
    def draw(self, world: World) -> Frame: ...

class Movie:
    def __init__(self, path: str | os.PathLike, renderer: Renderer | None = None, **options: Any) -> None: ...
    def add(self, frame: Frame | NDArray[numpy.uint8]) -> None: ...
    def __len__(self) -> int: ...
    def close(self) -> None: ...
    def __enter__(self) -> Movie: ...
    def __exit__(self, *error: Any) -> None: ...

def schema() -> dict: ...
