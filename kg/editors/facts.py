"""Facts about lines of code and launch files in editors: what a line creates or starts, and what is connected to it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from lsprotocol import types

from kg.editors.texts import path_of, uri_of
from kg.errors import KgError
from kg.render.text import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from pygls.workspace import Workspace

    from kg.editors.source import Source

_MOST: Final = 8
"""Number of nodes at the other side that a hover lists."""


class Facts:
    """What the store knows of the lines of open files."""

    def __init__(self, workspace: Workspace, source: Source) -> None:
        self._workspace = workspace
        self._source = source

    def hover(self, uri: str, position: types.Position) -> types.Hover | None:
        """Return what the line at a position creates or starts."""
        found = self._line(uri, position)
        words = [*map(_interface, found["ends"]), *map(_start, found["starts"])]
        text = "\n\n".join(words)
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, text)) if text else None

    def definition(self, uri: str, position: types.Position) -> list[types.Location]:
        """Return the code of the nodes that a line starts, and the files that define the types of its interfaces."""
        found = self._line(uri, position)
        return self._locations(
            [
                *(one["evidence"] for one in found["starts"]),
                *(place for one in found["ends"] for place in one["definitions"]),
            ]
        )

    def references(self, uri: str, position: types.Position, *, declaration: bool) -> list[types.Location]:
        """Return the lines of all ends of the interfaces of a line; `declaration` adds its own."""
        ends = self._line(uri, position)["ends"]
        sides = ("own", "others") if declaration else ("others",)
        return self._locations(each["evidence"] for one in ends for side in sides for each in one[side])

    def _line(self, uri: str, position: types.Position) -> Mapping[str, Any]:
        path = path_of(uri)
        try:
            return self._source.line(path, position.line + 1) if path is not None else _NOTHING
        except KgError:  # no store yet, or one that another process writes: the next question finds it
            return _NOTHING

    def _locations(self, places: Iterable[Mapping[str, Any]]) -> list[types.Location]:
        pairs = dict.fromkeys((one["file"], one["line"] or 1) for one in places if one["file"])
        return [
            types.Location(
                uri_of(Path(file), self._workspace), types.Range(types.Position(at - 1, 0), types.Position(at - 1, 0))
            )
            for file, at in pairs
        ]


_NOTHING: Final[Mapping[str, Any]] = {"ends": (), "starts": ()}


def _interface(end: Mapping[str, Any]) -> str:
    """Return an interface in words: its name and type, its conditions, and the other side."""
    kind = f" {_code(end['type'])}" if end["type"] else ""
    head = f"{end['node']} **{end['title']}** {_code(end['name'] or 'a name that is not known')}{kind}"
    return "\n".join([head, *([f"\n{printable(end['quality'])}"] if end["quality"] else []), *_others(end["others"])])


def _others(others: list[Mapping[str, Any]]) -> Iterator[str]:
    if others:
        yield ""
    for one in others[:_MOST]:
        launched = f" in {_code(one['systems'][0])}" if one["systems"] else ""
        yield f"- {_code(one['instance'] or one['node'])} {one['title']}{launched}: {_link(one['evidence'])}"
    if len(others) > _MOST:
        yield f"- {len(others) - _MOST} more"


def _start(one: Mapping[str, Any]) -> str:
    return f"**starts** {_code(one['name'])}, {_code(one['node'])}: {_link(one['evidence'])}"


def _code(text: str) -> str:
    """Return a text as code of Markdown."""
    return f"`{printable(text).replace('`', chr(39))}`"


def _link(place: Mapping[str, Any]) -> str:
    """Return a place as a link that editors open."""
    shown = printable(f"{place['path']}:{place['line']}").replace("[", "(").replace("]", ")")
    return f"[{shown}]({Path(place['file']).as_uri()}#L{place['line']})" if place["file"] else shown
