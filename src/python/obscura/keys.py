"""The keys of a scene as attributes, by the language's schema: scene.room.size, scene.ball[0].radius."""

from __future__ import annotations

import copy
import difflib
import functools
import json
from typing import Any, Iterator

from . import _obscura
from .language import is_list, properties


@functools.lru_cache(maxsize=None)
def schema() -> dict:
    """The scene language's JSON Schema: every key with its type, range, default and description."""
    return json.loads(_obscura.schema())


class Items(list):
    """A list of a scene: what changes it, or a list within it, changes the scene."""

    def __init__(self, values, changed):
        super().__init__(Items(value, self._tell) if isinstance(value, list) else value for value in values)
        self._changed = changed

    def _tell(self) -> None:
        self._changed()

    def plain(self) -> list:
        return [value.plain() if isinstance(value, Items) else value for value in self]

    def __reduce__(self):
        return list, (self.plain(),)

    def __deepcopy__(self, memo) -> list:
        return copy.deepcopy(self.plain(), memo)


def _telling(name: str):
    of_list = getattr(list, name)

    @functools.wraps(of_list)
    def change(self, *arguments, **options):
        answer = of_list(self, *arguments, **options)
        for i, value in enumerate(self):
            if isinstance(value, list) and not isinstance(value, Items):
                list.__setitem__(self, i, Items(value, self._tell))
        self._tell()
        return answer

    return change


for _name in ("__setitem__", "__delitem__", "__iadd__", "__imul__", "append", "extend", "insert", "pop", "remove",
              "clear", "sort", "reverse"):
    setattr(Items, _name, _telling(_name))


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
        if not isinstance(value, list):
            return value
        items = Items(value, lambda: setattr(self, name, items.plain()))
        return items

    def __setattr__(self, name: str, value: Any) -> None:
        self._key(name)
        self._data[name] = value.plain() if isinstance(value, Items) else value
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
        return self._owner.get(self._name, {})

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
        try:
            return range(len(self._list()))[which]
        except IndexError:
            raise IndexError(f"the scene has {len(self._list())} [[{self._path}]]") from None

    def add(self, **keys: Any) -> Section:
        """One more."""
        section = Section(self._path, {}, self._keys, lambda: None)
        for name in keys:
            section._key(name)
        self._owner[self._name] = [*self._list(), keys]
        self._touch()
        return self[-1]

    def __len__(self) -> int:
        return len(self._list())

    def __getitem__(self, which: int | str) -> Section:
        i = self._number(which)
        return Section(f"{self._path}[{i}]", self._list()[i], self._keys, self._touch)

    def __delitem__(self, which: int | str) -> None:
        del self._list()[self._number(which)]
        if not self._list():
            del self._owner[self._name]
        self._touch()

    def __iter__(self) -> Iterator[Section]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} [[{self._path}]]>"
