"""Rooms of bodies, simulated and filmed without a window.

    import obscura

    scene = obscura.Scene("room.toml")
    scene.duration = 5
    scene.render("room.mp4")

"""

import os as _os

# a wheel has the fonts in it
_fonts = _os.path.join(_os.path.dirname(__file__), "fonts")
if _os.path.isdir(_fonts):
    _os.environ.setdefault("OBSCURA_FONTS", _fonts)

from ._obscura import Body, Contact, Energies, Event, Frame, Pair, Stage, State, __version__
from .errors import Error, Fault, FileError, RunError, SceneError, UsageError
from .keys import schema
from .scene import Figure, Movie, Renderer, Scene, World

__all__ = [
    "Body", "Contact", "Energies", "Error", "Event", "Fault", "Figure", "FileError", "Frame", "Movie", "Pair", "Renderer",
    "RunError", "Scene", "SceneError", "Stage", "State", "UsageError", "World", "schema",
]
