"""Answers of views made short for who reads them by the token: no empty members, places as one text."""

from __future__ import annotations

from typing import Any, Final

__all__ = ["compact", "place"]

_PLACE: Final = frozenset({"repository", "path", "line", "file", "web"})
_OF_PLACE: Final = frozenset({"file", "line", "file_repository"})
_OF_END: Final = frozenset({"kind", "outward", "quality", "title"})
"""Members of an interface that others of it say: its role, and its quality of service."""


def compact(value: Any) -> Any:
    """Return a JSON value without members that are null or empty or say the same twice, with each place as `FILE:LINE`.

    A place is what `kg.views.evidence` makes. What is false or zero stays.
    """
    if isinstance(value, dict):
        if value.keys() >= _PLACE:
            return place(value)
        twice = _said_twice(value)
        pairs = ((name, compact(member)) for name, member in value.items() if name not in twice)
        return {name: member for name, member in pairs if member not in (None, "", [], {})}
    if isinstance(value, list):
        return [compact(member) for member in value]
    return value


def _said_twice(value: dict[str, Any]) -> frozenset[str]:
    """Return the members of an object that say what its evidence, or others of an interface, say as well."""
    evidence = value.get("evidence")
    if not isinstance(evidence, dict) or not evidence.keys() >= _PLACE:
        return frozenset()
    return _OF_PLACE | _OF_END if value.keys() >= {"role", "resolution"} else _OF_PLACE


def place(evidence: dict[str, Any]) -> str:
    """Return where a fact stands: the file on this machine, else its page on the web, else its path in the source."""
    line = f":{evidence['line']}" if evidence["line"] else ""
    if evidence["file"]:
        return f"{evidence['file']}{line}"
    if evidence["web"]:
        return str(evidence["web"])
    source = f"{evidence['repository']} " if evidence["repository"] else ""
    return f"{source}{evidence['path']}{line}"
