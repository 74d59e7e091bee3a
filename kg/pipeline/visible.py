"""Node types of a package as visible to other packages of a build: their names, and a digest of the rest."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.facts import DataFile, Known, NodeName

if TYPE_CHECKING:
    from kg.graph.nodes import Stated

_BYTES: Final = 16


def visible_types(
    stated: Iterable[Stated], programs: Iterable[str] = (), data: Iterable[DataFile] = ()
) -> tuple[tuple[Stated, ...], Known]:
    """Return the node types of a package in the order of results, and their view for other packages."""
    ordered = sorted(stated, key=lambda one: (one.node.name, str(one.node.location)))
    names: list[NodeName] = []
    for _, several in groupby(ordered, key=lambda one: one.node.name):
        same = list(several)
        # A reference names all node types with that name, so each depends on the others.
        marks = " ".join(map(_mark, same))
        for at, one in enumerate(same):
            node, mark = one.node, digest(f"{at} {marks}".encode())
            names.append(NodeName(node.name, node.kind, node.executable, node.plugin, node.aliases, mark))
    return tuple(ordered), Known(tuple(names), tuple(programs), tuple(data))


def _mark(stated: Stated) -> str:
    """Return a digest of a node type in which lines count only by their order.

    A comment moves lines, but the results of wiring contain no lines of code.
    """
    content = msgspec.to_builtins(stated)
    places = {place: at for at, place in enumerate(sorted(set(_places(content))))}
    return digest(msgspec.msgpack.encode(_without_lines(content, places)))


def _places(content: Any) -> Iterator[tuple[str, str, int]]:
    if isinstance(content, Mapping):
        if _is_place(content):
            yield _place(content)
            return
        content = content.values()
    if not isinstance(content, str) and hasattr(content, "__iter__"):
        for one in content:
            yield from _places(one)


def _without_lines(content: Any, places: Mapping[tuple[str, str, int], int]) -> Any:
    if isinstance(content, dict):
        if _is_place(content):
            return places[_place(content)]
        return {key: _without_lines(value, places) for key, value in content.items()}
    return [_without_lines(one, places) for one in content] if isinstance(content, list | tuple) else content


def _is_place(content: Mapping[str, Any]) -> bool:
    return content.keys() == {"path", "line", "repository"}


def _place(content: Mapping[str, Any]) -> tuple[str, str, int]:
    return content["repository"] or "", content["path"], content["line"]


def digest(content: bytes) -> str:
    """Return a digest in hexadecimal digits."""
    return hashlib.blake2b(content, digest_size=_BYTES).hexdigest()
