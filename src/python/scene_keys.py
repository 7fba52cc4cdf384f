"""scene_keys.py SCHEMA STUB: the keys of scenes as classes for editors and type checkers, of the language's JSON Schema."""

import json
import keyword
import re
import runpy
import sys
from pathlib import Path

# the package itself needs its compiled part
language = runpy.run_path(str(Path(__file__).parent / "obscura/language.py"))
properties, is_list = language["properties"], language["is_list"]

HEAD = '''\
# Made of the scene language's schema.
from typing import Any, Generic, Iterator, Literal, Sequence, TypeVar

_T = TypeVar("_T")

class Kind(Generic[_T]):
    """The things of a kind, by number or by name."""
    def __len__(self) -> int: ...
    def __contains__(self, which: Any) -> bool: ...
    def __getitem__(self, which: int | str) -> _T: ...
    def __delitem__(self, which: int | str) -> None: ...
    def __iter__(self) -> Iterator[_T]: ...
    def add(self, **keys: Any) -> _T: ...
'''


def type_of(node):
    """How Python writes the values of a key."""
    if "enum" in node:
        return f"Literal[{', '.join(repr(value) for value in node['enum'])}]"
    if "anyOf" in node:
        return " | ".join(dict.fromkeys(type_of(way) for way in node["anyOf"]))
    kind = node.get("type")
    if isinstance(kind, list):
        return " | ".join(dict.fromkeys(type_of({**node, "type": each}) for each in kind))
    if kind == "array":
        return f"Sequence[{type_of(node.get('items', {}))}]"
    return {"number": "float", "integer": "int", "string": "str", "boolean": "bool", "object": "dict[str, Any]"}.get(kind, "Any")


def told(node):
    text = re.sub(r"\s+", " ", node.get("description", "")).replace("\\", "\\\\").replace('"""', "'''")
    return text + " " if text.endswith('"') else text


def section(path, node, done):
    """The classes of a table and of those in it; the name of its own."""
    name = "".join(part.title() for part in re.split(r"[._]", path)) or "Keys"
    lines = [f"class {name}:"]
    if told(node):
        lines.append(f'    """{told(node)}"""')
    for key, its in properties(node).items():
        if keyword.iskeyword(key):
            continue  # getattr(caption, "from")
        within = properties(its)
        of = section(f"{path}.{key}" if path else key, its, done) if within else ""
        kind = f"Kind[{of}]" if is_list(its) else of if within and "anyOf" not in its else ""
        lines.append(f"    {key}: {kind or ' | '.join(filter(None, (of, type_of(its))))}")
        if told(its):
            lines.append(f'    """{told(its)}"""')
    done.append("\n".join(lines) + "\n")
    return name


def stub(schema):
    """The text of _keys.pyi."""
    done = []
    section("", schema, done)
    return "\n".join([HEAD, *done])


if __name__ == "__main__":
    schema_file, made = sys.argv[1:]
    Path(made).write_text(stub(json.loads(Path(schema_file).read_text(encoding="utf-8"))), encoding="utf-8")
