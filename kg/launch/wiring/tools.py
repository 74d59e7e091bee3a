"""Command line tools that a configuration starts as nodes: their arguments name what they publish and subscribe to.

`ontology/tools.toml` defines the words; its head explains it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import zip_longest
from typing import TYPE_CHECKING, Final

from kg.facts import InstanceInterface, Interface, NodeReference, Resolution, Role
from kg.holes import is_partial
from kg.launch.wiring.plugin_table import load_rows
from kg.launch.wiring.simulation_table import filled
from kg.launch.wiring.values import shown
from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.facts import StartedNode
    from kg.launch.wiring.interfaces import Ends
    from kg.launch.wiring.values import Settings

TOOL: Final = "command line"
"""The origin of interfaces that a command line names."""
_EACH: Final = "{each}"
_UNKNOWN: Final = "a part of the command line is known only at run time"


@dataclass(frozen=True, slots=True)
class Tool:
    """A row of the table."""

    ros: int
    package: str
    executable: tuple[str, ...]
    ends: tuple[str, ...]
    source: str
    operands: tuple[str, ...] = ()
    first: str | None = None
    options: tuple[str, ...] = ()
    class_: str | None = None


def tool_ends(started: StartedNode, ends: Ends, repository: str) -> Iterator[InstanceInterface]:
    """Yield the ends that the command line of a tool names; `repository` is the source of the configuration."""
    rows = (row for row in _rows() if row.ros == ends.ros)
    found = next((one for row in rows if (one := _read(row, started, ends.settings)) is not None), None)
    if found is None:
        return
    row, values, rest = found
    owner = NodeReference(started.location.repository or repository, row.package, started.plugin or row.executable[0])
    for text in row.ends:
        for each in rest if _EACH in text else ("",):
            role, *parts = text.split(" ", 2)
            kind, name = (filled(part, {**values, "each": each}) for part in parts)
            if not name or kind is None:
                continue
            resolved, remap = ends.place.resolve(name), None
            partial = is_partial(resolved)
            if not partial:
                resolved, remap = ends.remapping.apply(resolved, Role(role))
            resolution = Resolution.PARTIAL if partial else Resolution.LAUNCH_ARGUMENT
            reason = _UNKNOWN if partial else None
            declared = Interface(
                Role(role), name, _type(kind), resolution, started.location, origin=TOOL, reason=reason
            )
            yield InstanceInterface(declared, owner, resolved, resolution, remap, reason=reason)


def _read(row: Tool, started: StartedNode, settings: Settings) -> tuple[Tool, dict[str, str], list[str]] | None:
    """Return the operands of a tool by their names, and the words after them; None for another program."""
    is_program = started.package == row.package and started.executable in row.executable
    if not is_program and (started.plugin is None or started.plugin != row.class_):
        return None
    words = _operands(settings.words, row.options)
    if words and row.first is not None and words.pop(0) != row.first:
        return None
    values = {name: word for name, word in zip_longest(row.operands, words[: len(row.operands)]) if word is not None}
    if row.ros != 1:
        given = {name: settings.own.get(name) for name in row.operands}
        set_here = {name: shown(one.value) for name, one in given.items() if one is not None}
        values = {name: text for name, text in set_here.items() if text is not None} | values
    return row, values, words[len(row.operands) :]


def _operands(words: list[str], options: tuple[str, ...]) -> list[str]:
    """Return words without options and their arguments."""
    found: list[str] = []
    skip = False
    for word in words:
        if not skip and not word.startswith("-"):
            found.append(word)
        skip = not skip and word in options
    return found


def _type(kind: str) -> str | None:
    """Return a type as `package/Name`; None for an unknown one."""
    parts = kind.split("/")
    known = len(parts) > 1 and not is_partial(kind)
    return f"{parts[0]}/{parts[-1]}" if known else None


@cache
def _rows() -> tuple[Tool, ...]:
    return load_rows(folder("ontology") / "tools.toml", "tool", Tool)
