"""The keys of a scene as attributes, by the language's schema: scene.room.size, scene.ball[0].radius."""

from __future__ import annotations

import copy
import difflib
import functools
import json
from typing import Any, Iterator

from . import _obscura
from .errors import UsageError
from .language import is_list, properties


@functools.lru_cache(maxsize=None)
def schema() -> dict:
    """The scene language's JSON Schema: every key with its type, range, default and description."""
    return json.loads(_obscura.schema())


def plain(value: Any) -> Any:
    """A value of its own: what its giver does with it later changes nothing. Arrays become lists."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(each) for each in value]
    return value


class Told:
    """What a list or a table of a scene has beside Python's: what changes it changes the scene."""

    def _tell(self) -> None:
        self._changed()

    def _within(self, value: Any) -> Any:
        if isinstance(value, Told):
            return value
        if isinstance(value, list):
            return Items(value, self._tell)
        return Entries(value, self._tell) if isinstance(value, dict) else value

    def __reduce__(self):
        return type(self).__mro__[2], (plain(self),)

    def __deepcopy__(self, memo):
        return copy.deepcopy(plain(self), memo)


class Items(Told, list):
    """A list of a scene: what changes it, or what is in it, changes the scene."""

    def __init__(self, values, changed):
        self._changed = changed
        list.__init__(self, (self._within(value) for value in values))

    def _wrap(self) -> None:
        for i, value in enumerate(self):
            list.__setitem__(self, i, self._within(value))


class Entries(Told, dict):
    """A table of a scene with keys of its user's, as constants: what changes it changes the scene."""

    def __init__(self, values, changed):
        self._changed = changed
        dict.__init__(self, {key: self._within(value) for key, value in values.items()})

    def _wrap(self) -> None:
        for key, value in self.items():
            dict.__setitem__(self, key, self._within(value))


def _telling(of: type, name: str):
    change_of = getattr(of, name)

    @functools.wraps(change_of)
    def change(self, *arguments, **options):
        answer = change_of(self, *arguments, **options)
        self._wrap()
        self._tell()
        return answer

    return change


for _name in ("__setitem__", "__delitem__", "__iadd__", "__imul__", "append", "extend", "insert", "pop", "remove",
              "clear", "sort", "reverse"):
    setattr(Items, _name, _telling(list, _name))
for _name in ("__setitem__", "__delitem__", "__ior__", "pop", "popitem", "clear", "update", "setdefault"):
    setattr(Entries, _name, _telling(dict, _name))


class Section:
    """A table of a scene: its keys are attributes, checked by name when they are set."""

    def __init__(self, path: str, data: dict, keys: dict, touch):
        self.__dict__.update(_path=path, _data=data, _keys=keys, _touch=touch)

    def _key(self, name: str) -> dict:
        if name in self._keys:
            return self._keys[name]
        near = difflib.get_close_matches(name, self._keys, 1)
        where = f"[{self._path}]" if self._path else "a scene"
        raise AttributeError(f"{where} has no key '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        node, path = self._key(name), f"{self._path}.{name}" if self._path else name
        if is_list(node):
            return Kind(path, self._data, name, properties(node), self._touch)
        if properties(node) and not isinstance(self._data.get(name, {}), list):
            return Section(path, _Late(self._data, name), properties(node), self._touch)
        value = self._data[name] if name in self._data else node.get("default")
        if not isinstance(value, (list, dict)):
            return value
        kept = self._data.get(name)

        def changed() -> None:
            nonlocal kept
            if self._data.get(name) is not kept:
                raise UsageError(f"this value of {path} has been replaced: ask for it again, as scene.{path}")
            setattr(self, name, told)
            kept = self._data[name]

        told = (Items if isinstance(value, list) else Entries)(value, changed)
        return told

    def __setattr__(self, name: str, value: Any) -> None:
        self._key(name)
        self._data[name] = plain(value)
        self._touch()

    def __delattr__(self, name: str) -> None:
        self._key(name)
        if name in self._data:
            del self._data[name]
            self._touch()

    def __dir__(self) -> list[str]:
        return sorted(self._keys)

    def __repr__(self) -> str:
        return f"<{self._path or 'scene'}: {dict(self._data.items())}>"


class _Late:
    """A table within another, which is made when its first key is set."""

    def __init__(self, owner: Any, name: str):
        self._owner, self._name = owner, name

    def _there(self) -> dict:
        there = self._owner.get(self._name, {})
        return there if isinstance(there, dict) else {}

    def get(self, key, default=None):
        return self._there().get(key, default)

    def items(self):
        return self._there().items()

    def __contains__(self, key) -> bool:
        return key in self._there()

    def __getitem__(self, key):
        return self._there()[key]

    def __setitem__(self, key, value) -> None:
        there = self._owner.get(self._name)
        if there is None:
            there = self._owner[self._name] = {}
        there[key] = value

    def __delitem__(self, key) -> None:
        del self._there()[key]


class Kind:
    """The things of a kind, as [[ball]] lists them: by number, or by name."""

    def __init__(self, path: str, owner: Any, name: str, keys: dict, touch):
        self.__dict__.update(_path=path, _owner=owner, _name=name, _keys=keys, _touch=touch)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._keys:
            raise AttributeError(f"[[{self._path}]] is a list: ask one of them, as scene.{self._path}[0].{name}")
        hint = f"; scene.{self._path}.add(...) adds one" if name in ("append", "insert", "extend") else ""
        raise AttributeError(f"[[{self._path}]] is a list that has no '{name}'{hint}")

    def __setattr__(self, name: str, value: Any) -> None:
        example = f"scene.{self._path}[0].{name}"
        raise AttributeError(f"[[{self._path}]] is a list: set the key of one of them, as {example} = ...")

    def _list(self) -> list:
        return self._owner.get(self._name) or []

    def _number(self, which: int | str) -> int:
        if isinstance(which, str):
            for i, each in enumerate(self._list()):
                if each.get("name") == which:
                    return i
            raise KeyError(f"no [[{self._path}]] is called '{which}'")
        if not hasattr(which, "__index__"):
            raise TypeError(f"one of the [[{self._path}]] is taken by its number or name, not by {which!r}")
        try:
            return range(len(self._list()))[which]
        except IndexError:
            raise IndexError(f"the scene has {len(self._list())} [[{self._path}]]") from None

    def add(self, **keys: Any) -> Section:
        """One more."""
        section = Section(self._path, {}, self._keys, lambda: None)
        for name in keys:
            section._key(name)
        self._owner[self._name] = [*self._list(), plain(keys)]
        self._touch()
        return self[-1]

    def __len__(self) -> int:
        return len(self._list())

    def __contains__(self, which: Any) -> bool:
        return isinstance(which, str) and any(each.get("name") == which for each in self._list())

    def __getitem__(self, which: int | str) -> Section:
        i = self._number(which)
        data = self._list()[i]

        def touch() -> None:
            all_ = self._list()
            if not (i < len(all_) and all_[i] is data) and not any(each is data for each in all_):
                raise UsageError(f"this [[{self._path}]] is no longer in the scene")
            self._touch()

        return Section(f"{self._path}[{i}]", data, self._keys, touch)

    def __delitem__(self, which: int | str) -> None:
        del self._list()[self._number(which)]
        if not self._list():
            del self._owner[self._name]
        self._touch()

    def __iter__(self) -> Iterator[Section]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} [[{self._path}]]>"
