"""The table of plugins of simulators, `ontology/simulation.toml`, whose head explains it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Final

from kg.facts import Role
from kg.holes import is_partial
from kg.launch.wiring.plugin_table import load_rows
from kg.resources import folder

_FILE: Final = "simulation.toml"
_END: Final = re.compile(
    r"(?P<role>[a-z_]+) (?P<type>\w+/\w+) (?P<name>\S+)"
    r"(?: (?P<ask>if|unless) (?P<element>[^\s=]+)(?:=(?P<value>\S+))?)?"
)
_HOLE: Final = re.compile(r"\{([^{}=]+)(?:=((?:[^{}]|\{[^{}]*\})*))?\}")
_MOST_DEPTH: Final = 4


@dataclass(frozen=True, slots=True)
class End:
    """An end that a plugin makes, if `element` asks for it: `wanted` is the value it must have, None for any."""

    role: Role
    type: str
    name: str
    element: str | None = None
    wanted: str | None = None
    negated: bool = False

    def is_there(self, values: Mapping[str, str]) -> bool:
        """Return whether a plugin with these texts of elements makes the end, as far as they are known."""
        if self.element is None:
            return True
        text = values.get(self.element, "")
        if is_partial(text):
            return True
        holds = bool(text) if self.wanted is None else text.lower() == self.wanted.lower()
        return holds is not self.negated

    def elements(self) -> list[str]:
        """Return the elements that its name is made of, in their order."""
        return [match[1] for match in _HOLE.finditer(self.name)]


@dataclass(frozen=True, slots=True)
class Device:
    """A row for plugins; the head of the table explains the fields."""

    library: tuple[str, ...]
    ros: int
    package: str
    source: str
    ends: tuple[str, ...]
    below: str = ""
    model: bool = False
    each: str | None = None
    words: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Simulator:
    """A row for programs that load plugins, with what these offer themselves."""

    ros: int
    package: str
    executable: tuple[str, ...]
    library: str
    source: str
    ends: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Spawner:
    """A row for programs that hand a description to a simulator: their options by meaning."""

    ros: int
    package: str
    executable: tuple[str, ...]
    source: str
    parameter: tuple[str, ...] = ()
    topic: tuple[str, ...] = ()
    namespace: tuple[str, ...] = ()
    model: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Manager:
    """A row for plugins that manage controllers as nodes; the head of the table explains the fields."""

    library: tuple[str, ...]
    ros: int
    package: str
    source: str
    named: str
    name: tuple[str, ...]
    namespace: str
    parameters: str
    remapping: str


@cache
def read_end(text: str) -> End:
    """Return the end that a text of the table describes; `ValueError` if malformed."""
    match = _END.fullmatch(text)
    if match is None:
        raise ValueError(f"`{text}` names no endpoint of a plugin")
    negated = match["ask"] == "unless"
    return End(Role(match["role"]), match["type"], match["name"], match["element"], match["value"], negated)


def filled(pattern: str, values: Mapping[str, str], depth: int = 0) -> str | None:
    """Return a name of the table with the texts of elements in it; None where one is missing."""
    parts: list[str] = []
    end = 0
    for match in _HOLE.finditer(pattern):
        text = values.get(match[1])
        if text is None and match[2] is not None and depth < _MOST_DEPTH:
            text = filled(match[2], values, depth + 1)
        if text is None:
            return None
        parts += pattern[end : match.start()], text
        end = match.end()
    return "".join(parts) + pattern[end:]


def device_of(library: str, ros: int) -> Device | None:
    """Return the row for a library, named as in `filename`."""
    return _devices().get((_stem(library), ros))


def manager_of(library: str, ros: int) -> Manager | None:
    """Return the row for a library that manages controllers, named as in `filename`."""
    return _managers().get((_stem(library), ros))


def _stem(library: str) -> str:
    return library.rpartition("/")[2].removesuffix(".so").removeprefix("lib")


def simulator_of(package: str | None, executable: str | None, ros: int) -> Simulator | None:
    """Return the row for a program that loads plugins."""
    return next((row for row in load()[1] if _is_of(row, package, executable, ros)), None)


def spawner_of(package: str | None, executable: str | None, ros: int) -> Spawner | None:
    """Return the row for a program that hands descriptions to a simulator."""
    return next((row for row in load()[2] if _is_of(row, package, executable, ros)), None)


def _is_of(row: Simulator | Spawner, package: str | None, executable: str | None, ros: int) -> bool:
    return (row.ros, row.package) == (ros, package) and executable in row.executable


@cache
def load() -> tuple[tuple[Device, ...], tuple[Simulator, ...], tuple[Spawner, ...], tuple[Manager, ...]]:
    """Return the rows of the table of the installation; a `UsageError` KG002 names the problems of it."""
    path = folder("ontology") / _FILE
    return (
        load_rows(path, "device", Device),
        load_rows(path, "simulator", Simulator),
        load_rows(path, "spawner", Spawner),
        load_rows(path, "manager", Manager),
    )


@cache
def _managers() -> dict[tuple[str, int], Manager]:
    return {(name, row.ros): row for row in load()[3] for name in row.library}


@cache
def _devices() -> dict[tuple[str, int], Device]:
    return {(name, row.ros): row for row in load()[0] for name in row.library}
