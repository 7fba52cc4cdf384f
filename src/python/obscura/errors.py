"""What goes wrong, as exceptions with the place."""

from __future__ import annotations


class Error(Exception):
    """What all errors of obscura are."""


class Fault:
    """One thing wrong with a scene: its place in the text, or the key of a scene of keys."""

    def __init__(self, file: str, line: int, column: int, key: str, message: str):
        self.file, self.line, self.column, self.key, self.message = file, line, column, key, message

    def __str__(self) -> str:
        if self.key:
            return f"{self.file}: {self.key}: {self.message}"
        if not self.line:
            return f"{self.file}: {self.message}"
        return f"{self.file}:{self.line}:{self.column}: {self.message}"

    def __repr__(self) -> str:
        return f"<Fault {self}>"


class SceneError(Error, ValueError):
    """A scene that is wrong: `faults` has all that is, in the order of its text."""

    def __init__(self, faults: list[Fault]):
        super().__init__(faults)
        self.faults = faults

    def __str__(self) -> str:
        return "\n".join(str(fault) for fault in self.faults)

    @property
    def file(self) -> str:
        return self.faults[0].file

    @property
    def line(self) -> int:
        """Of the first fault, from 1; 0: the scene as a whole."""
        return self.faults[0].line

    @property
    def column(self) -> int:
        return self.faults[0].column

    @property
    def key(self) -> str:
        """Of the first fault of a scene of keys: "ball[0].radius"."""
        return self.faults[0].key


class RunError(Error):
    """A run that cannot go on: which body, what of it, when (s), and the likely cause."""

    def __init__(self, message: str, time: float, body: str, quantity: str, fault: str, likely: str):
        super().__init__(message, time, body, quantity, fault, likely)
        self.time, self.body, self.quantity, self.fault, self.likely = time, body, quantity, fault, likely

    def __str__(self) -> str:
        return self.args[0]


class UsageError(Error, ValueError):
    """A state, column, name or option that does not fit."""


class FileError(Error, OSError):
    """A picture or file that cannot be made or read: OpenGL, fonts, codecs, the disk."""
