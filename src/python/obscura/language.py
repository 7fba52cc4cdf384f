"""What the scene language's JSON Schema says of its keys."""

from __future__ import annotations


def properties(node: dict) -> dict:
    """The keys of what is a table, a list of tables, or either; none of what may be something else."""
    if "anyOf" in node:
        ways = [properties(way) for way in node["anyOf"]]
        return ways[0] if all(ways) else {}
    return node.get("properties") or node.get("items", {}).get("properties") or {}


def is_list(node: dict) -> bool:
    """Whether a key is a list of tables, as [[ball]] is."""
    return node.get("type") == "array" and "properties" in node.get("items", {})
